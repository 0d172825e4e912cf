// The equations of the minimal extension differentiated by parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/sensitivity_equations.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

SensitivityEquations::SensitivityEquations(MinimalExtension& extension, ParameterSeries& parameters,
                                           const std::vector<int>& numbers)
    : extension_(extension), parameters_(parameters), formulas_(extension.problem(), parameters, numbers) {
  std::size_t next = 0;
  for (int c : extension_.offsets().c) {
    first_row_.push_back(next);
    next += index(c + 1);
    slope_limits_.push_back(c + 1);
  }
  row_.assign(next, -1);
  for (int row = 0; row < extension_.num_rows(); ++row) {
    const auto [equation, order] = extension_.rows()[index(row)];
    row_[first_row_[index(equation)] + index(order)] = row;
  }
  if (formulas_.are_there()) list_varying();
}

// Lists all terms of varying entries except zeros.
void SensitivityEquations::list_varying() {
  std::vector<char> varies(extension_.column().size(), 0);
  std::vector<int> terms(varies.size(), 0);
  const auto is_zero = [this](std::size_t e, std::size_t k) { return k > 0 && formulas_.is_number(e); };
  extension_.for_each_term([&](std::size_t entry, std::size_t e, std::size_t k, double factor) {
    if (!formulas_.is_number(e)) varies[entry] = 1;
    if (!is_zero(e, k)) terms[entry] += factor == 1.0 ? 1 : 2;
  });
  std::vector<char> has_terms(varies.size(), 0);
  extension_.for_each_term([&](std::size_t entry, std::size_t e, std::size_t k, double factor) {
    if (varies[entry] == 0 || is_zero(e, k)) return;
    if (has_terms[entry] == 0) varying_.push_back(static_cast<int>(entry));
    if (terms[entry] == 1) alone_.push_back(source_of(entry, e, k));
    else terms_.push_back({source_of(entry, e, k), has_terms[entry] == 0, factor});
    has_terms[entry] = 1;
  });
  std::size_t e = extension_.problem().evaluator().tape().targets.size();
  for (const ParameterGradient::Place& place : parameters_.places()) {
    const std::size_t first = index(place.column) * index(extension_.num_rows());
    for (int k = 0; k <= extension_.offsets().c[index(place.equation)] && !formulas_.is_number(e); ++k)
      right_sources_.push_back(source_of(first + index(row_of(place.equation, k)), e, index(k)));
    ++e;
  }
}

// Copies the rows from F_p_.
void SensitivityEquations::take_parameter_rows(SensitivityRows& rows) const {
  const std::size_t num_rows = index(extension_.num_rows()), n = index(extension_.n());
  const std::size_t length = n * index(extension_.highest_level() + 1);
  rows.right.resize(num_rows * index(count()) + 1);
  for (std::size_t q = 0; q < index(count()); ++q)
    for (std::size_t row = 0; row < num_rows; ++row) {
      const auto [equation, order] = extension_.rows()[row];
      rows.right[q * num_rows + row] = -F_p_[q * length + index(order) * n + index(equation)];
    }
}

void SensitivityEquations::take_parameters() {
  parameters_.take_parameters();
  formulas_.take_parameters();
}

// coefficient: returns that of a source.
template <class Coefficient>
void SensitivityEquations::take_formulas(Coefficient coefficient, SensitivityRows& rows) const {
  if (rows.version != formulas_.version()) return take_all_formulas(coefficient, rows);
  double *const values = rows.values.data(), *const right = rows.right.data();
  for (const Source& source : alone_) values[source.to] = coefficient(source);
  for (const Term& term : terms_) {
    const double value = term.factor * coefficient(term.source);
    values[term.source.to] = term.is_first ? value : values[term.source.to] + value;
  }
  for (const Source& source : right_sources_) right[source.to] = -coefficient(source);
}

template <class Coefficient>
void SensitivityEquations::take_all_formulas(Coefficient coefficient, SensitivityRows& rows) const {
  rows.version = -1;  // while memory may be missing
  rows.values.resize(extension_.column().size());
  const auto coefficient_of = [&](std::size_t e, std::size_t k) { return coefficient(source_of(0, e, k)); };
  extension_.take_derivatives(coefficient_of, rows.values.data());
  const std::size_t num_rows = index(extension_.num_rows());
  rows.right.assign(num_rows * index(count()) + 1, 0.0);
  std::size_t e = extension_.problem().evaluator().tape().targets.size();
  for (const ParameterGradient::Place& place : parameters_.places()) {
    for (int k = 0; k <= extension_.offsets().c[index(place.equation)]; ++k)
      rows.right[index(place.column) * num_rows + index(row_of(place.equation, k))] = -coefficient_of(e, index(k));
    ++e;
  }
  rows.version = formulas_.version();
}

bool SensitivityEquations::linearize_by_formulas(const Jet& jet, SensitivityRows& rows) {
  if (!formulas_.are_there()) return false;
  const double* const values = formulas_.evaluate(jet.t, jet.x.data(), extension_.highest_level());
  if (values == nullptr) return false;
  take_formulas([values](const Source& source) { return values[source.place]; }, rows);
  return true;
}

// If the formulas cannot be evaluated, the extension may succeed, or report the error.
CallbackError SensitivityEquations::linearize(const Jet& jet, SensitivityRows& rows) {
  if (linearize_by_formulas(jet, rows)) return {};
  rows.version = -1;
  CallbackError error = extension_.linearize(jet);
  if (error.status != SFDAE_OK) return error;
  rows.values = extension_.values();
  const int length = extension_.n() * (extension_.highest_level() + 1);
  F_p_.resize(index(length) * index(count()) + 1);
  error = parameters_.values(jet.t, jet.x.data(), extension_.highest_level(),
                             View{F_p_.data(), length, count(), std::max(length, 1)});
  if (error.status == SFDAE_OK) take_parameter_rows(rows);
  return error;
}

CallbackError SensitivityEquations::linearize(const std::vector<Jet>& jets, int count,
                                              std::vector<SensitivityRows>& rows) {
  // Eight lanes for one point would be a waste.
  constexpr int fewest_side_by_side = 3;
  if (rows.size() < index(count)) rows.resize(index(count));
  if (count >= fewest_side_by_side && linearize_side_by_side(jets, count, rows)) return {};
  for (int i = 0; i < count; ++i) {
    CallbackError error = linearize(jets[index(i)], rows[index(i)]);
    if (error.status != SFDAE_OK) return error;
  }
  return {};
}

bool SensitivityEquations::linearize_side_by_side(const std::vector<Jet>& jets, int count,
                                                  std::vector<SensitivityRows>& rows) {
  if (!formulas_.are_there()) return false;
  lanes_.load(jets, count, extension_.n(), extension_.jet_order());
  if (!formulas_.evaluate_side_by_side(count, lanes_.t.data(), lanes_.coefficients.data(),
                                       extension_.highest_level()))
    return false;
  for (int i = 0; i < count; ++i)
    take_formulas([&](const Source& source) { return formulas_.of_lanes(index(source.e))[source.k].lane[i]; },
                  rows[index(i)]);
  return true;
}

// With x'_k = (k + 1) x_(k+1): coefficient k of (df/dx') S' + (df/dx) S + df/dp, times k, is that of the derivative
// of row k - 1.
CallbackError SensitivityEquations::slopes(const Jet& jet, const double* S, double* r) {
  RecordedProblem& problem = extension_.problem();
  const Tape& tape = problem.evaluator().tape();
  const int n = extension_.n(), order = extension_.highest_level() + 1, length = n * (order + 1);
  entries_.assign(tape.targets.size() * index(order + 1), 0.0);
  F_p_.resize(index(length) * index(count()) + 1);
  CallbackError error = problem.gradient_entries(jet.t, jet.x.data(), order, slope_limits_, entries_.data());
  if (error.status == SFDAE_OK)
    error = parameters_.values(jet.t, jet.x.data(), order, View{F_p_.data(), length, count(), std::max(length, 1)});
  if (error.status != SFDAE_OK) return error;
  for (std::ptrdiff_t q = 0; q < count(); ++q, S += index(n) * index(order + 2))
    for (int row = 0; row < extension_.num_rows(); ++row) {
      const int equation = extension_.rows()[index(row)].equation, k = extension_.rows()[index(row)].order + 1;
      double sum = F_p_[index(static_cast<int>(q)) * index(length) + index(k) * index(n) + index(equation)];
      for (std::size_t e = tape.first_target[index(equation)]; e < tape.first_target[index(equation + 1)]; ++e) {
        const double* const coefficients = entries_.data() + e * index(order + 1);
        const double* const of_unknown = S + tape.targets[e].unknown;
        const int shift = tape.targets[e].derivative ? 1 : 0;
        for (int l = 0; l <= k; ++l)
          sum += coefficients[k - l] * (shift == 1 ? l + 1.0 : 1.0) * of_unknown[std::ptrdiff_t(l + shift) * n];
      }
      *r++ = k * sum;
    }
  return error;
}

void SensitivitySlots::set(const MinimalExtension& extension, const StateChoice& choice) {
  held_.clear();
  slopes_.clear();
  of_x_.clear();
  const std::vector<int>& first = extension.first();
  for (int row = 0; row < extension.num_rows(); ++row)
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      const int column = extension.column()[index(e)], unknown = extension.columns()[index(column)].unknown;
      if (choice.is_held(column)) held_.push_back({row, unknown, index(e)});
      if (choice.is_slope(column)) slopes_.push_back({row, unknown, index(e)});
    }
  for (int j = 0; j < extension.n(); ++j) of_x_.push_back(choice.slot(extension.column_of(j, 0)));
}

}  // namespace sfdae::core
