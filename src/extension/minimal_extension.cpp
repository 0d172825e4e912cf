// The minimal extension of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/minimal_extension.h"

#include <algorithm>
#include <random>
#include <utility>

#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

// True if value k is coefficient k, of all coefficients: nothing is differentiated or replaced.
bool are_as_recorded(const std::vector<EntryTerm>& terms, std::size_t coefficients) {
  if (terms.size() != coefficients) return false;
  for (std::size_t k = 0; k < terms.size(); ++k)
    if (index(terms[k].entry) != k || terms[k].coefficient != k || terms[k].factor != 1.0) return false;
  return true;
}

ExtensionLayout layout_of(const Offsets& offsets) {
  const int n = static_cast<int>(offsets.c.size());
  ExtensionLayout layout;
  layout.highest_d = *std::max_element(offsets.d.begin(), offsets.d.end());
  for (int d : offsets.d) {
    layout.first_place.push_back(static_cast<int>(layout.places.size()));
    layout.places.resize(layout.places.size() + index(d + 1), -1);
  }
  for (int stage = layout.first_stage(); stage <= 1; ++stage) {
    layout.first_rows.push_back(static_cast<int>(layout.rows.size()));
    layout.first_columns.push_back(static_cast<int>(layout.columns.size()));
    if (stage > 0) break;
    for (int i = 0; i < n; ++i)
      if (offsets.c[index(i)] + stage >= 0) layout.rows.push_back({i, offsets.c[index(i)] + stage});
    for (int j = 0; j < n; ++j) {
      if (offsets.d[index(j)] + stage < 0) continue;
      layout.places[index(layout.first_place[index(j)] - stage)] = static_cast<int>(layout.columns.size());
      layout.columns.push_back({j, offsets.d[index(j)] + stage});
    }
  }
  layout.rows.shrink_to_fit();
  layout.columns.shrink_to_fit();
  layout.places.shrink_to_fit();
  layout.first_place.shrink_to_fit();
  return layout;
}

// (D^m f)_k = (k + m)! / k! f_(k+m)
ExtensionSums sums_of(const Structure& structure, const std::vector<ExtensionLayout::Row>& rows, int n) {
  ExtensionSums sums;
  std::vector<int> levels(index(n), 0);
  const bool are_sums = structure.equations.num_replaced() > 0;
  if (are_sums) sums.first_part.push_back(0);
  for (const ExtensionLayout::Row& row : rows) {
    for (const EquationTerm& term : structure.equations.of(row.equation)) {
      double factor = term.factor;
      for (int k = row.order + 1; k <= row.order + term.order; ++k) factor *= k;
      int& level = levels[index(term.equation)];
      level = std::max(level, row.order + term.order);
      if (are_sums) sums.parts.push_back({term.equation, row.order + term.order, factor});
    }
    if (are_sums) sums.first_part.push_back(static_cast<int>(sums.parts.size()));
  }
  sums.levels = std::make_shared<const OrderLimits>(std::move(levels));
  if (!are_sums && sums.levels->highest > 0)
    for (const ExtensionLayout::Row& row : rows) sums.places.push_back(row.equation + row.order * n);
  sums.parts.shrink_to_fit();
  sums.first_part.shrink_to_fit();
  return sums;
}

}  // namespace

MinimalExtension::MinimalExtension(RecordedProblem& problem, std::shared_ptr<const Structure> structure,
                                   std::shared_ptr<OrderedBlocks> ordered)
    : problem_(problem),
      structure_(std::move(structure)),
      ordered_(std::move(ordered)),
      n_(problem.n()),
      layout_(layout_of(offsets())),
      sums_(sums_of(*structure_, layout_.rows, n_)),
      highest_level_(sums_.levels->highest),
      leading_(*structure_, problem.evaluator().tape()) {
  make_pattern();
  problem_.evaluator().prepare(sums_.levels);
}

// With F_k = sum over the coefficients of f, x'_k = (k + 1) x_(k+1): dF_k / dx_l = (f_x)_(k-l) + l (f_x')_(k-l+1).
// Derivatives that are not in the signature have cancelled.
void MinimalExtension::make_pattern() {
  const Tape& tape = problem_.evaluator().tape();
  const std::size_t length = index(highest_level_ + 1);
  std::vector<int> highest_order(index(n_), -1);  // of the unknowns in a row
  std::vector<int> entry_of(layout_.columns.size(), -1);
  first_.reserve(layout_.rows.size() + 1);
  first_.assign(1, 0);
  for (int row = 0; row < num_rows(); ++row) {
    const int begin = first_.back();
    const auto [equation, row_order] = layout_.rows[index(row)];
    for (const Signature::Entry& entry : structure_->signature.row(equation))
      highest_order[index(entry.unknown)] = entry.order + row_order;
    const auto add = [&](int unknown, int order, std::size_t target, int coefficient, double factor) {
      if (order > highest_order[index(unknown)]) return;
      int& entry = entry_of[index(column_of(unknown, order))];
      if (entry < begin) {
        entry = static_cast<int>(column_.size());
        column_.push_back(column_of(unknown, order));
      }
      terms_.emplace_back(entry, target * length + index(coefficient), factor);
    };
    for (const Part& part : parts(row))
      for (std::size_t e = tape.first_target[index(part.equation)]; e < tape.first_target[index(part.equation + 1)];
           ++e) {
        const int unknown = tape.targets[e].unknown;
        if (tape.targets[e].derivative)
          for (int l = 1; l <= part.order + 1; ++l) add(unknown, l, e, part.order - l + 1, l * part.factor);
        else
          for (int l = 0; l <= part.order; ++l) add(unknown, l, e, part.order - l, part.factor);
      }
    for (const Signature::Entry& entry : structure_->signature.row(equation))
      highest_order[index(entry.unknown)] = -1;
    first_.push_back(static_cast<int>(column_.size()));
  }
  column_.shrink_to_fit();
  if (are_as_recorded(terms_, tape.targets.size() * length)) terms_ = {};
  else coefficients_.assign(tape.targets.size() * length, 0.0);
  terms_.shrink_to_fit();
}

CallbackError MinimalExtension::evaluate(const Jet& jet, int more) {
  F_.resize(std::max(F_.size(), index(n_) * index(highest_level_ + 1 + std::max(more, 0))));
  return problem_.residuals_within(jet.t, jet.x.data(), sums_.levels, more, F_.data());
}

double MinimalExtension::value_of(int row) const {
  double value = 0.0;
  for (const Part& part : parts(row)) value += part.factor * F_[index(part.equation) + index(part.order) * index(n_)];
  return value;
}

// Adds 0.0, as the sums below have no -0.
CallbackError MinimalExtension::residuals_as_recorded(const Jet& jet, double* r) {
  CallbackError error = problem_.residuals_within(jet.t, jet.x.data(), sums_.levels, 0, r);
  for (int row = 0; row < num_rows(); ++row) r[row] += 0.0;
  return error;
}

CallbackError MinimalExtension::residuals(const Jet& jet, double* r) {
  if (are_rows_as_recorded()) return residuals_as_recorded(jet, r);
  CallbackError error = evaluate(jet, 0);
  const double* const F = F_.data();
  if (!sums_.places.empty()) {
    for (int place : sums_.places) *r++ = F[place];
    return error;
  }
  const Part* part = sums_.parts.data();
  for (int row = 0; row < num_rows(); ++row) {
    double value = 0.0;
    for (const Part* const last = sums_.parts.data() + sums_.first_part[index(row + 1)]; part != last; ++part)
      value += part->factor * F[part->equation + part->order * n_];
    r[row] = value;
  }
  return error;
}

const LaneEvaluator* MinimalExtension::evaluate_lanes(const std::vector<Jet>& jets, int count, bool with_gradients) {
  if (!problem_.has_lanes(highest_level_) || count > lane_count) return nullptr;
  // If nothing is replaced, coefficients of x_j beyond d_j are not read.
  lanes_.load(jets, count, n_, sums_.places.empty() ? jet_order() : layout_.highest_d);
  const auto points = LaneEvaluator::points_of(lanes_.t.data(), lanes_.coefficients.data(), highest_level_, n_);
  return problem_.evaluate_within(count, points, sums_.levels, with_gradients);
}

bool MinimalExtension::linearize_side_by_side(const std::vector<Jet>& jets, int count, LaneArray& values) {
  const LaneEvaluator* const evaluated = evaluate_lanes(jets, count, true);
  if (evaluated == nullptr) return false;
  const LaneBlock* const coefficients = evaluated->gradients();
  if (terms_.empty()) {
    values.assign(coefficients,
                  coefficients + problem_.evaluator().tape().targets.size() * index(highest_level_ + 1));
    return true;
  }
  values.assign(column_.size(), LaneBlock());
  for (const EntryTerm& term : terms_)
    for (int l = 0; l < lane_count; ++l)
      values[index(term.entry)].lane[l] += term.factor * coefficients[term.coefficient].lane[l];
  return true;
}

bool MinimalExtension::residuals_side_by_side(const std::vector<Jet>& jets, int count, double* r) {
  const LaneEvaluator* const evaluated = evaluate_lanes(jets, count, false);
  if (evaluated == nullptr) return false;
  for (int row = 0; row < num_rows(); ++row) {
    LaneBlock value;
    const LaneBlock* only = &value;
    if (!sums_.places.empty())
      only = evaluated->value(layout_.rows[index(row)].equation) + layout_.rows[index(row)].order;
    else
      for (const Part& part : parts(row)) {
        const LaneBlock& coefficient = evaluated->value(part.equation)[part.order];
        for (int l = 0; l < lane_count; ++l) value.lane[l] += part.factor * coefficient.lane[l];
      }
    for (int l = 0; l < count; ++l) r[row + l * num_rows()] = only->lane[l];
  }
  return true;
}

CallbackError MinimalExtension::slopes(const Jet& jet, double* r) {
  CallbackError error = evaluate(jet, 1);
  for (int row = 0; row < num_rows(); ++row) {
    *r = 0.0;
    for (const Part& part : parts(row)) {
      const int next = part.order + 1;
      *r += part.factor * next * F_[index(part.equation) + index(next) * index(n_)];
    }
    ++r;
  }
  return error;
}

// Rows of f_i end with order c_i + stage.
CallbackError MinimalExtension::stage_residuals(int stage, const Jet& jet, double* r) {
  if (stage == 0 && are_rows_as_recorded()) return residuals_as_recorded(jet, r);
  CallbackError error = evaluate(jet, stage);
  for (int row = first_row(stage); row < first_row(stage + 1); ++row) *r++ = value_of(row);
  return error;
}

// Derivatives of f_i^(k) by x_j^(l), l - k = d_j - c_i: Taylor coefficients l! / k! times those of the system Jacobian.
CallbackError MinimalExtension::linearize_stage(int stage, const Jet& jet, StageMatrix& matrix) {
  CallbackError error = problem_.gradients_for(
      jet.t, [&](TaylorEvaluator& evaluator) { return leading_.evaluate(evaluator, jet.t, jet.x.data()); });
  if (error.status != SFDAE_OK) return error;
  matrix.first.assign(1, 0);
  matrix.column.clear();
  matrix.values.clear();
  for (int i = first_row(stage); i < first_row(stage + 1); ++i) {
    const auto [equation, row_order] = layout_.rows[index(i)];
    for (int e = leading_.first()[index(equation)]; e < leading_.first()[index(equation + 1)]; ++e) {
      const int unknown = leading_.unknown()[index(e)], order = offsets().d[index(unknown)] + stage;
      double factor = 1.0;
      for (int l = row_order + 1; l <= order; ++l) factor *= l;
      matrix.column.push_back(column_of(unknown, order) - first_column(stage));
      matrix.values.push_back(factor * leading_.values()[index(e)]);
    }
    matrix.first.push_back(static_cast<int>(matrix.column.size()));
  }
  return error;
}

void MinimalExtension::perturb(double size) {
  std::minstd_rand generator(1);
  for (double& value : values_) value *= 1.0 + size * symmetric_random(generator);
}

CallbackError MinimalExtension::linearize(const Jet& jet, std::vector<double>& values) {
  values.resize(column_.size());
  double* const entries = terms_.empty() ? values.data() : coefficients_.data();
  CallbackError error = problem_.gradient_entries_within(jet.t, jet.x.data(), sums_.levels, entries);
  if (error.status != SFDAE_OK) return error;
  if (!terms_.empty()) sum_terms(terms_, coefficients_, values);
  return error;
}

}  // namespace sfdae::core
