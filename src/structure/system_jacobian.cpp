// Entries of the system Jacobian.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/system_jacobian.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sfdae::core {

SystemJacobian::SystemJacobian(const Structure& structure, const Tape& tape)
    : order_(structure.equations.highest_order()), limits_(index(structure.signature.size()), 0) {
  const std::size_t length = index(order_ + 1);
  std::vector<int> entry_of(index(structure.signature.size()), -1);
  for (int i = 0; i < structure.signature.size(); ++i) {
    for (const Signature::Entry& entry : structure.signature.row(i)) {
      if (!structure.offsets.is_leading(i, entry)) continue;
      entry_of[index(entry.unknown)] = static_cast<int>(unknown_.size());
      unknown_.push_back(entry.unknown);
    }
    for (const EquationTerm& term : structure.equations.of(i)) {
      int& limit = limits_[index(term.equation)];
      limit = std::max(limit, term.order);
      for (std::size_t e = tape.first_target[index(term.equation)]; e < tape.first_target[index(term.equation + 1)];
           ++e) {
        const Tape::Variable& leaf = tape.targets[e];
        const int entry = entry_of[index(leaf.unknown)];
        if (entry < 0) continue;
        const int s = structure.offsets.d[index(leaf.unknown)] - structure.offsets.c[index(i)];
        const SeriesTerm part = series_term(term, leaf.derivative, s);
        if (part.order >= 0) terms_.emplace_back(entry, e * length + index(part.order), part.factor);
      }
    }
    for (int e = first_.back(); e < static_cast<int>(unknown_.size()); ++e) entry_of[index(unknown_[index(e)])] = -1;
    first_.push_back(static_cast<int>(unknown_.size()));
  }
  first_.shrink_to_fit();
  unknown_.shrink_to_fit();
  note_places();
  terms_.shrink_to_fit();
  num_coefficients_ = tape.targets.size() * length;
  coefficients_.resize(num_coefficients_);
  values_.resize(unknown_.size());
}

// Notes places if each entry is one coefficient: as a rule, if nothing is replaced.
void SystemJacobian::note_places() {
  std::vector<char> is_met(unknown_.size(), 0);
  for (const EntryTerm& term : terms_)
    if (term.factor != 1.0 || is_met[index(term.entry)]++ != 0) return;
  if (terms_.size() != unknown_.size()) return;
  places_.resize(unknown_.size());
  for (const EntryTerm& term : terms_) places_[index(term.entry)] = term.coefficient;
  terms_.clear();
}

// VaryingEntries does not support series.
void SystemJacobian::expect_many_points() {
  if (varying_ || order_ > 0) return;
  std::vector<char> is_wanted(num_coefficients_, 0);
  for (const EntryTerm& term : terms_) is_wanted[term.coefficient] = 1;
  for (std::uint32_t place : places_) is_wanted[place] = 1;
  varying_.emplace(std::move(is_wanted));
}

void SystemJacobian::forget_values() {
  if (varying_) varying_->version = -1;
  std::vector<double>().swap(coefficients_);
  std::vector<double>().swap(values_);
}

bool SystemJacobian::evaluate(TaylorEvaluator& evaluator, double t, const double* jet) {
  coefficients_.resize(num_coefficients_);
  values_.resize(unknown_.size());
  const bool is_evaluated = varying_ ? evaluator.entries(t, jet, *varying_, coefficients_.data())
                                     : evaluator.entries(t, jet, order_, limits_, coefficients_.data());
  if (!is_evaluated) return false;
  // The sums have no -0.
  for (std::size_t e = 0; e < places_.size(); ++e) values_[e] = 0.0 + coefficients_[places_[e]];
  if (places_.empty()) sum_terms(terms_, coefficients_, values_);
  return true;
}

void SystemJacobian::drop_changes_from(const std::vector<double>& values) {
  constexpr double part = 1e-3;
  for (std::size_t e = 0; e < values_.size(); ++e)
    if (!(std::fabs(values[e] - values_[e]) <= part * std::fabs(values_[e]))) values_[e] = 0.0;
}

}  // namespace sfdae::core
