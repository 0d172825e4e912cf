// The minimal extension of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/minimal_extension.h"

#include <algorithm>
#include <random>

#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae::core {

MinimalExtension::MinimalExtension(RecordedProblem& problem) : problem_(problem), n_(problem.n()) {
  highest_c_ = *std::max_element(offsets().c.begin(), offsets().c.end());
  highest_d_ = *std::max_element(offsets().d.begin(), offsets().d.end());
  number_rows_and_columns();
  make_pattern();
}

void MinimalExtension::number_rows_and_columns() {
  place_.resize(index(n_));
  for (int j = 0; j < n_; ++j) place_[index(j)].assign(index(offsets().d[index(j)] + 1), -1);
  for (int stage = first_stage(); stage <= 0; ++stage) {
    first_rows_.push_back(num_rows());
    first_columns_.push_back(num_columns());
    for (int i = 0; i < n_; ++i)
      if (offsets().c[index(i)] + stage >= 0) rows_.push_back({i, offsets().c[index(i)] + stage});
    for (int j = 0; j < n_; ++j) {
      if (offsets().d[index(j)] + stage < 0) continue;
      place_[index(j)][index(-stage)] = num_columns();
      columns_.push_back({j, offsets().d[index(j)] + stage});
    }
  }
  first_rows_.push_back(num_rows());
  first_columns_.push_back(num_columns());
}

// With F_k = sum over the coefficients of f, x'_k = (k + 1) x_(k+1): dF_k / dx_l = (f_x)_(k-l) + l (f_x')_(k-l+1).
void MinimalExtension::make_pattern() {
  const Tape& tape = problem_.evaluator().tape();
  const std::size_t length = index(highest_c_ + 1);
  std::vector<int> entry_of(columns_.size(), -1);
  first_.assign(1, 0);
  for (const Row& row : rows_) {
    const int begin = first_.back();
    const auto add = [&](int unknown, int order, std::size_t target, int coefficient, double factor) {
      int& entry = entry_of[index(column_of(unknown, order))];
      if (entry < begin) {
        entry = static_cast<int>(column_.size());
        column_.push_back(column_of(unknown, order));
      }
      terms_.push_back({entry, target * length + index(coefficient), factor});
    };
    for (std::size_t e = tape.first_target[index(row.equation)]; e < tape.first_target[index(row.equation + 1)];
         ++e) {
      const int unknown = tape.targets[e].unknown;
      if (tape.targets[e].derivative)
        for (int l = 1; l <= row.order + 1; ++l) add(unknown, l, e, row.order - l + 1, l);
      else
        for (int l = 0; l <= row.order; ++l) add(unknown, l, e, row.order - l, 1.0);
    }
    first_.push_back(static_cast<int>(column_.size()));
  }
  coefficients_.assign(tape.targets.size() * length, 0.0);
  values_.assign(column_.size(), 0.0);
}

CallbackError MinimalExtension::evaluate(const Jet& jet, int order) {
  F_.resize(index(n_) * index(highest_c_ + 2));
  return problem_.residuals(jet.t, jet.x.data(), order, F_.data());
}

CallbackError MinimalExtension::residuals(const Jet& jet, double* r) {
  CallbackError error = evaluate(jet, highest_c_);
  for (const Row& row : rows_) *r++ = F_[index(row.equation) + index(row.order) * index(n_)];
  return error;
}

CallbackError MinimalExtension::slopes(const Jet& jet, double* r) {
  CallbackError error = evaluate(jet, highest_c_ + 1);
  for (const Row& row : rows_) *r++ = (row.order + 1) * F_[index(row.equation) + index(row.order + 1) * index(n_)];
  return error;
}

CallbackError MinimalExtension::stage_residuals(int stage, const Jet& jet, double* r) {
  const int first = first_row(stage), last = first_row(stage + 1);
  CallbackError error = evaluate(jet, std::max(0, highest_c_ + stage));
  for (int i = first; i < last; ++i) {
    const Row& row = rows_[index(i)];
    *r++ = F_[index(row.equation) + index(row.order) * index(n_)];
  }
  return error;
}

// Of f_i^(k) by x_j^(l), l - k = d_j - c_i: l! / k! ... as Taylor coefficients l or 1 times the entry of the system Jacobian.
CallbackError MinimalExtension::linearize_stage(int stage, const Jet& jet, StageMatrix& matrix) {
  const Tape& tape = problem_.evaluator().tape();
  leading_.resize(tape.targets.size());
  no_orders_.resize(index(n_), 0);
  CallbackError error = problem_.gradient_entries(jet.t, jet.x.data(), 0, no_orders_, leading_.data());
  if (error.status != SFDAE_OK) return error;
  matrix.first.assign(1, 0);
  matrix.column.clear();
  matrix.values.clear();
  for (int i = first_row(stage); i < first_row(stage + 1); ++i) {
    const Row& row = rows_[index(i)];
    for (std::size_t e = tape.first_target[index(row.equation)]; e < tape.first_target[index(row.equation + 1)];
         ++e) {
      const Tape::Leaf& leaf = tape.targets[e];
      if (!offsets().is_leading(row.equation, {leaf.unknown, leaf.derivative ? 1 : 0})) continue;
      const int order = row.order + (leaf.derivative ? 1 : 0);
      matrix.column.push_back(column_of(leaf.unknown, order) - first_column(stage));
      matrix.values.push_back((leaf.derivative ? order : 1) * leading_[e]);
    }
    matrix.first.push_back(static_cast<int>(matrix.column.size()));
  }
  return error;
}

void MinimalExtension::perturb(double size) {
  std::minstd_rand generator(1);
  for (double& value : values_) value *= 1.0 + size * symmetric_random(generator);
}

CallbackError MinimalExtension::linearize(const Jet& jet) {
  CallbackError error = problem_.gradient_entries(jet.t, jet.x.data(), highest_c_, offsets().c, coefficients_.data());
  if (error.status != SFDAE_OK) return error;
  std::fill(values_.begin(), values_.end(), 0.0);
  for (const Term& term : terms_) values_[index(term.entry)] += term.factor * coefficients_[term.coefficient];
  return error;
}

}  // namespace sfdae::core
