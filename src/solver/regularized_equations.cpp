// SPDX-License-Identifier: BSD-3-Clause
#include "solver/regularized_equations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

bool is_leader(const RegularizedCondition& condition) { return condition.condition == condition.leader; }

// Throws DamagedArchive, or Failure.
void demand_surfaces(const std::vector<RegularizedCondition>& round, std::size_t conditions) {
  for (const RegularizedCondition& each : round) {
    const bool has_leader = std::any_of(round.begin(), round.end(), [&](const RegularizedCondition& other) {
      return is_leader(other) && other.condition == each.leader;
    });
    if (!has_leader || each.condition >= conditions || !std::isfinite(each.width) || !(each.width > 0.0))
      throw DamagedArchive();
  }
  const std::ptrdiff_t surfaces = std::count_if(round.begin(), round.end(), is_leader);
  if (surfaces > static_cast<std::ptrdiff_t>(most_surfaces))
    throw Failure(SFDAE_ZENO, format("%td conditions lead back to their zeros at the same time.", surfaces));
}

}  // namespace

std::shared_ptr<const Record> RegularizedEquations::regular(const TaylorEvaluator& given) {
  std::shared_ptr<const Record> record = given.shared_record();
  for (const FlatEquation& term : parts_.terms)
    if (term.equation < 0 || term.equation >= record->m() || term.unknown < 0 || term.unknown >= record->n() ||
        !std::isfinite(term.center) || !(term.width > 0.0) || !std::isfinite(term.slope))
      throw DamagedArchive();
  if (!parts_.terms.empty()) record = with_terms(*record, parts_.terms);
  for (const auto& round : parts_.rounds) {
    demand_surfaces(round, record->conditions().size());
    layers_.add(record, given, round);
    record = with_regularized(*record, round);
  }
  return record;
}

namespace {

// Archives a number, and returns it or the one read. The encoding has no redundant bits.
std::size_t archived(Archive& archive, std::size_t number) {
  long after = static_cast<long>(number) + 1, unused = 0;
  archive.counts(after, unused);
  if (after < 1 || unused != 0) throw DamagedArchive();
  return static_cast<std::size_t>(after - 1);
}

}  // namespace

void archive_regularization(Archive& archive, Regularization& regularization) {
  const auto archive_size = [&archive](auto& list) {
    const std::size_t count = archived(archive, list.size());
    if (!archive.is_reading()) return;
    if (count > archive.rest()) throw DamagedArchive();
    list.resize(count);
  };
  WordHash hash;
  archive_size(regularization.terms);
  hash.add(regularization.terms.size());
  for (FlatEquation& term : regularization.terms) {
    term.equation = static_cast<int>(archived(archive, index(term.equation)));
    term.unknown = static_cast<int>(archived(archive, index(term.unknown)));
    const std::array<double*, 3> values = {&term.center, &term.width, &term.slope};
    hash.add_all(std::array<int, 2>{term.equation, term.unknown});
    for (double* const value : values) {
      archive.real(*value);
      hash.add(value, 1);
    }
  }
  archive_size(regularization.rounds);
  hash.add(regularization.rounds.size());
  for (auto& round : regularization.rounds) {
    archive_size(round);
    hash.add(round.size());
    for (RegularizedCondition& each : round) {
      each.condition = archived(archive, each.condition);
      each.leader = archived(archive, each.leader);
      each.is_opposite = archived(archive, each.is_opposite ? 1 : 0) == 1;
      archive.real(each.width);
      hash.add(each.condition);
      hash.add(2 * each.leader + (each.is_opposite ? 1 : 0));
      hash.add(&each.width, 1);
    }
  }
  const double sum = hash.value_as_real();
  double saved = sum;
  archive.real(saved);
  if (saved != sum) throw DamagedArchive();
}

RegularizedEquations::RegularizedEquations(const TaylorEvaluator& given, Regularization its_parts,
                                           std::function<void()> changed)
    : parts_(std::move(its_parts)), model_(make_model(regular(given))) {
  TaylorEvaluator& evaluator = *model_->evaluator();
  for (int i = 0; i < given.record().num_user_parameters(); ++i) evaluator.set_parameter(i, given.parameter(i));
  model_->parameters_changed();
  conditions_ = std::make_unique<HeldConditions>(evaluator, std::move(changed));
  conditions_->set_layers(&layers_);
}

}  // namespace sfdae::core
