// Values of the formulas of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_recorded_terms.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

RecordedTerms::RecordedTerms(const Recorder& recorder, const MultibodyFormulas& formulas, bool has_kinematics)
    : sizes_(formulas.sizes), numbers_(formulas.sizes) {
  const int nq = sizes_.positions, nv = sizes_.velocities, nl = sizes_.holonomic, nk = sizes_.nonholonomic;
  if (has_kinematics) numbers_.S = Matrix(nq, nv);
  Values values;
  add_values(recorder, formulas.M, {Part::M, "M", nv, nv, 0, nv}, values);
  add_values(recorder, formulas.H, {Part::C, "H", nk, nv, nl, nl + nk}, values);
  add_values(recorder, formulas.h, {Part::rest, "h", nk, 1, nl, nk}, values);
  if (has_kinematics) add_values(recorder, formulas.S, {Part::S, "S", nq, nv, 0, nq}, values);
  position_.emplace(recorder.excerpt(nq, values.nodes, values.names));
  position_places_ = values.places;
  add_values(recorder, formulas.f, {Part::f, "f", nv, 1, 0, nv}, values);
  all_.emplace(recorder.excerpt(nq + nv, values.nodes, values.names));
  all_places_ = values.places;
  values_.resize(index(all_->record().m()));
}

double* RecordedTerms::entries_of(MultibodyTerms& terms, Part part) {
  switch (part) {
    case Part::M: return terms.M.data();
    case Part::S: return terms.S.data();
    case Part::C: return terms.C.data();
    case Part::rest: return terms.velocity_rest.data();
    default: return terms.f.data();
  }
}

void RecordedTerms::add_values(const Recorder& recorder, const std::vector<int>& formulas, const Block& block,
                               Values& values) {
  int known_zero = -1;
  for (int j = 0; j < block.columns; ++j)
    for (int i = 0; i < block.rows; ++i) {
      const int node = formulas[index(i) + index(j) * index(block.rows)];
      if (node == known_zero) continue;
      const std::size_t entry = index(block.first + i) + index(j) * index(block.ld);
      if (const auto number = recorder.number(node)) {
        entries_of(numbers_, block.part)[entry] = *number;
        if (*number == 0.0) known_zero = node;
        continue;
      }
      const auto [known, is_new] = values.known.try_emplace(node, values.nodes.size());
      values.places.push_back({block.part, entry, known->second});
      if (!is_new) continue;
      values.nodes.push_back(node);
      const bool is_matrix = block.part != Part::rest && block.part != Part::f;
      values.names.push_back(is_matrix ? format("%s(%d, %d)", block.name, i, j) : format("%s[%d]", block.name, i));
    }
}

bool RecordedTerms::evaluate(const double* x, bool with_forces, MultibodyTerms& terms, CallbackError& error) {
  TaylorEvaluator& evaluator = with_forces ? *all_ : *position_;
  if (!evaluator.values(error.t, x, 0, values_.data())) return report_failure(evaluator, error);
  const bool has_kinematics = numbers_.S.cols() > 0;
  if (has_kinematics && terms.S.cols() == 0) terms.S = numbers_.S;
  const auto copy_numbers = [&](Part part, std::size_t count) {
    std::copy_n(entries_of(numbers_, part), count, entries_of(terms, part));
  };
  const std::size_t nv = index(sizes_.velocities);
  if (terms.whose_numbers != this) {
    copy_numbers(Part::M, nv * nv);
    copy_numbers(Part::C, index(sizes_.constraints()) * nv);
    copy_numbers(Part::rest, index(sizes_.constraints()));
    if (has_kinematics) copy_numbers(Part::S, index(sizes_.positions) * nv);
    copy_numbers(Part::f, nv);
    terms.whose_numbers = this;
  }
  for (const Place& place : with_forces ? all_places_ : position_places_)
    entries_of(terms, place.part)[place.entry] = values_[place.value];
  return true;
}

}  // namespace sfdae::core
