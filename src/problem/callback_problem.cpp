// The user's function for total derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/callback_problem.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/factorials.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Number of gradients from one check of a group of unknowns to the next: costs a few percent of the evaluations.
constexpr int gradients_between_probes = 10;

void add_sizes(const ColumnPattern& pattern, const double* entries, const double* x, std::vector<double>& terms) {
  for (int j = 0; j < pattern.columns(); ++j)
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      terms[index(pattern.row[index(e)])] += std::fabs(entries[e] * x[j]);
}

// values -= factor entries, for a pattern within another one.
void subtract_entries(const ColumnPattern& pattern, const double* entries, double factor, const ColumnPattern& from,
                      std::vector<double>& values, int rows) {
  std::vector<int> place(index(rows), -1);
  for (int j = 0; j < from.columns(); ++j) {
    for (int e = from.start[index(j)]; e < from.start[index(j + 1)]; ++e) place[index(from.row[index(e)])] = e;
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      values[index(place[index(pattern.row[index(e)])])] -= factor * entries[e];
  }
}

// Selects the entries of a pattern from those of one that contains it.
void select_entries(const ColumnPattern& pattern, const ColumnPattern& from, const std::vector<double>& values,
                    int rows, double* entries) {
  std::vector<int> place(index(rows), -1);
  for (int j = 0; j < from.columns(); ++j) {
    for (int e = from.start[index(j)]; e < from.start[index(j + 1)]; ++e) place[index(from.row[index(e)])] = e;
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      entries[e] = values[index(place[index(pattern.row[index(e)])])];
  }
}

}  // namespace

void CallbackProblem::set_patterns(std::shared_ptr<const JacobianPatterns> patterns, JacobianForm form) {
  patterns_ = std::move(patterns);
  form_ = form;
  if (form == JacobianForm::dense) return;
  probe_ = std::make_unique<PatternProbe>(*patterns_, m());
  if (form != JacobianForm::differences) return;
  differences_ = std::make_unique<Differences>();
  differences_->F_x = {patterns_->F_x, group_columns(patterns_->F_x, m())};
  differences_->F_xdot = {patterns_->F_xdot, group_columns(patterns_->F_xdot, m())};
  const ColumnPattern both = united(patterns_->F_xdot, patterns_->F_x, m());
  differences_->united = {both, group_columns(both, m())};
}

void CallbackProblem::set_conditions(const DeclaredConditions& declared) {
  conditions_ = std::make_unique<CallbackConditions>(declared, *this, n());
}

void CallbackProblem::take_differences() {
  form_ = JacobianForm::differences;
  differences_ = std::make_unique<Differences>();
  differences_->F_x = differences_->F_xdot = differences_->united = full_pattern(m(), n());
}

void CallbackProblem::to_derivatives(const double* jet, int order) {
  derivatives_of_jet(jet, index(n()), order, derivatives_);
}

CallbackError CallbackProblem::check_finite(const char* name, const double* values, const ColumnPattern* pattern,
                                            const CallbackError& place) const {
  const std::size_t count = pattern != nullptr ? index(pattern->entries()) : index(m()) * index(n());
  if (values == nullptr || all_finite(values, count)) return {};
  CallbackError error = place;
  error.status = SFDAE_NOT_FINITE;
  error.function = name;
  int first = 0;
  while (all_finite(values + first, 1)) ++first;
  error.names = &equation_names();
  error.row = pattern != nullptr ? pattern->row[index(first)] : first % m();
  error.column = pattern != nullptr ? pattern->column_of(first) : first / m();
  return error;
}

// Calls the callback for this order and all outputs that the form has room for.
CallbackError CallbackProblem::invoke(double t, int order, const double* derivatives, const Outputs& to) {
  const auto [F, F_x, F_xdot] = to;
  const bool is_dense = form_ != JacobianForm::compressed;
  const std::size_t m_size = index(m()), area = m_size * index(n());
  std::fill_n(F, m_size, 0.0);
  if (F_x != nullptr) std::fill_n(F_x, is_dense ? area : index(patterns_->F_x.entries()), 0.0);
  if (F_xdot != nullptr) std::fill_n(F_xdot, is_dense ? area : index(patterns_->F_xdot.entries()), 0.0);
  CallbackError error;
  if (conditions_) error = conditions_->choose(t, derivatives);
  error.user_t = user_t();
  if (error.status != SFDAE_OK) return error;
  error.function = "F";
  error.order = order;
  error.t = t;
  if (is_checking_) ++check_evaluations_;
  error.code = function_(t, order, derivatives, F, F_x, F_xdot, user_);
  if (array_ && array_->fault().exists()) return faulty_array(error);
  if (error.code != 0) {
    error.status = error.code < 0                            ? SFDAE_CALLBACK_STOPPED
                   : error.code == SFDAE_ORDER_NOT_AVAILABLE ? SFDAE_ORDER_MISSING
                                                             : SFDAE_CALLBACK_FAILED;
    return error;
  }
  if (!all_finite(F, m_size)) {
    int first = 0;
    while (all_finite(F + first, 1)) ++first;
    error.status = SFDAE_NOT_FINITE;
    error.names = &equation_names();
    error.row = first;
    return error;
  }
  const CallbackError of_F_x = check_finite("F_x", F_x, is_dense ? nullptr : &patterns_->F_x, error);
  if (of_F_x.status != SFDAE_OK) return of_F_x;
  const CallbackError of_F_xdot = check_finite("F_xdot", F_xdot, is_dense ? nullptr : &patterns_->F_xdot, error);
  if (of_F_xdot.status != SFDAE_OK) return of_F_xdot;
  return is_dense && patterns_ ? beyond_pattern(to, error) : error;
}

CallbackError CallbackProblem::lacks(char which, int row, int column, double value,
                                     const CallbackError& place) const {
  CallbackError error = place;
  error.status = SFDAE_WRONG_PATTERN;
  error.function = which == 'x' ? "F_x" : "F_xdot";
  error.row = row;
  error.column = column;
  error.detail = lacking_entry(error.function, equation_names().row(row), column, value, error.where());
  return error;
}

// The user's derivative array has a Jacobian that is not finite or contradicts itself.
CallbackError CallbackProblem::faulty_array(const CallbackError& place) const {
  const ArrayFault& fault = array_->fault();
  CallbackError error = place;
  error.status = fault.is_finite() ? SFDAE_WRONG_DERIVATIVES : SFDAE_NOT_FINITE;
  error.row = fault.row % m();
  error.column = fault.column % n();
  error.names = &equation_names();
  error.detail = fault.message(array_->shape(), equation_names(), place.where());
  if (!fault.is_finite()) error.detail += " Return 1 from the callback to have the step reduced.";
  return error;
}

CallbackError CallbackProblem::beyond_pattern(const Outputs& dense, const CallbackError& place) const {
  for (const char which : {'x', 'd'}) {
    const double* matrix = which == 'x' ? dense.F_x : dense.F_xdot;
    if (matrix == nullptr) continue;
    const auto [row, column] = entry_beyond(which == 'x' ? patterns_->F_x : patterns_->F_xdot, m(), matrix);
    if (row >= 0) return lacks(which, row, column, matrix[index(row) + index(m()) * index(column)], place);
  }
  return place;
}

CallbackError CallbackProblem::call(double t, int order, const double* derivatives, const Outputs& to) {
  if (form_ == JacobianForm::dense || (to.F_x == nullptr && to.F_xdot == nullptr))
    return invoke(t, order, derivatives, to);
  const ColumnPattern& of_F_x = patterns_ ? patterns_->F_x : differences_->F_x.pattern;
  const ColumnPattern& of_F_xdot = patterns_ ? patterns_->F_xdot : differences_->F_xdot.pattern;
  std::vector<double> F_x(index(of_F_x.entries())), F_xdot(index(of_F_xdot.entries()));
  const CallbackError error = call_entries(t, order, derivatives, {to.F, F_x.data(), F_xdot.data()});
  if (error.status != SFDAE_OK) return error;
  if (to.F_x != nullptr) scatter(of_F_x, F_x.data(), m(), to.F_x);
  if (to.F_xdot != nullptr) scatter(of_F_xdot, F_xdot.data(), m(), to.F_xdot);
  return error;
}

CallbackError CallbackProblem::call_entries(double t, int order, const double* derivatives, const Outputs& to) {
  CallbackError error;
  if (form_ == JacobianForm::dense) {
    dense_F_x_.resize(index(m()) * index(n()));
    dense_F_xdot_.resize(dense_F_x_.size());
    error = invoke(t, order, derivatives, {to.F, dense_F_x_.data(), dense_F_xdot_.data()});
    if (error.status != SFDAE_OK) return error;
    gather(patterns_->F_x, dense_F_x_.data(), m(), to.F_x);
    gather(patterns_->F_xdot, dense_F_xdot_.data(), m(), to.F_xdot);
    return error;
  }
  error = form_ == JacobianForm::compressed ? invoke(t, order, derivatives, to)
                                            : differentiate(t, order, derivatives, to);
  if (error.status != SFDAE_OK || order > 0 || is_checking_ || !probe_ || until_probe_-- > 0) return error;
  error = probe(t, derivatives, to);
  // If the caller does not report the missing entry, as for a trial point, the next gradient checks again.
  until_probe_ = error.status == SFDAE_OK ? gradients_between_probes - 1 : 0;
  return error;
}

// (F_x)^(k) = dF^(k) / dx, (F_x')^(k) = dF^(k) / dx' - k (F_x)^(k - 1)
CallbackError CallbackProblem::differentiate(double t, int order, const double* derivatives, const Outputs& to) {
  CallbackError error = invoke(t, order, derivatives, {to.F});
  if (error.status != SFDAE_OK) return error;
  const CallbackConditions::Kept kept(conditions_.get());
  std::vector<double> jet(derivatives, derivatives + index(n()) * index(order + 2));
  Differences& own = *differences_;
  own.of_x.note(derivatives, n());
  own.of_xdot.note(derivatives + n(), n());
  const std::vector<double> F(to.F, to.F + m());
  const FunctionOfJet evaluate = [&](const double* moved, double* F_moved) {
    ++evaluations_;
    return invoke(t, order, moved, {F_moved});
  };
  std::vector<double> terms(F);
  for (double& term : terms) term = std::fabs(term);
  const ChangingJet of_x{jet, n(), 0}, of_xdot{jet, n(), 1};
  error = ColoredDifferences(evaluate, of_x, own.of_x, F).find(own.F_x, terms, to.F_x);
  if (error.status != SFDAE_OK) return error;
  ColoredDifferences by_xdot(evaluate, of_xdot, own.of_xdot, F);
  if (order == 0) {
    error = by_xdot.find(own.F_xdot, terms, to.F_xdot);
    own.is_linear_in_xdot = by_xdot.is_linear();
    return error;
  }
  std::vector<double> both(index(own.united.pattern.entries()));
  error = by_xdot.find(own.united, terms, both.data());
  if (error.status != SFDAE_OK) return error;
  std::vector<double> F_below(index(m())), F_x_below(index(own.F_x.pattern.entries())),
      F_xdot_below(index(own.F_xdot.pattern.entries()));
  error = differentiate(t, order - 1, derivatives, {F_below.data(), F_x_below.data(), F_xdot_below.data()});
  if (error.status != SFDAE_OK) return error;
  subtract_entries(own.F_x.pattern, F_x_below.data(), order, own.united.pattern, both, m());
  select_entries(own.F_xdot.pattern, own.united.pattern, both, m(), to.F_xdot);
  return error;
}

CallbackError CallbackProblem::probe(double t, const double* derivatives, const Outputs& entries) {
  const std::vector<double> F(entries.F, entries.F + m());
  std::vector<double> terms(index(m()), 0.0);
  add_sizes(patterns_->F_x, entries.F_x, derivatives, terms);
  add_sizes(patterns_->F_xdot, entries.F_xdot, derivatives + n(), terms);
  const FunctionOfJet evaluate = [&](const double* moved, double* F_moved) { return invoke(t, 0, moved, {F_moved}); };
  PatternProbe::Missing missing;
  CallbackError error;
  const CallbackConditions::Kept kept(conditions_.get());
  const long before = probe_->evaluations();
  const bool found = probe_->finds(evaluate, {derivatives, derivatives + 2 * n()}, {F, terms}, missing, error);
  evaluations_ += probe_->evaluations() - before;
  if (!found) return error;
  CallbackError place;
  place.t = t;
  place.user_t = user_t();
  return lacks(missing.level == 0 ? 'x' : 'd', missing.row, missing.column, missing.value, place);
}

CallbackError CallbackProblem::evaluate_values(double t, const double* jet, int order, double* F) {
  to_derivatives(jet, order + 1);
  const DerivativeArrayFunction::Ascending ascending(array_for_all_orders(), order);
  for (int k = 0; k <= order; ++k) {
    double* F_k = F + index(m()) * index(k);
    const CallbackError error = call(t, k, derivatives_.data(), {F_k});
    if (error.status != SFDAE_OK) return error;
    for (int i = 0; i < m(); ++i) F_k[i] /= factorial(k);
  }
  return {};
}

CallbackError CallbackProblem::evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) {
  const int highest = std::max({orders.E, orders.A, orders.f});
  to_derivatives(jet, highest + 1);
  unused_.resize(index(m()));
  const DerivativeArrayFunction::Ascending ascending(array_for_all_orders(), highest);
  for (int k = 0; k <= highest; ++k) {
    const double scale = 1.0 / factorial(k);
    double* F = k <= orders.f ? data.f(k) : unused_.data();
    double* A = k <= orders.A ? data.A(k).data : nullptr;
    double* E = k <= orders.E ? data.E(k).data : nullptr;
    const CallbackError error = call(t, k, derivatives_.data(), {F, A, E});
    if (error.status != SFDAE_OK) return error;
    const std::size_t area = index(m()) * index(n());
    multiply_all(scale, F, index(m()));
    if (A != nullptr) multiply_all(scale, A, area);
    if (E != nullptr) multiply_all(scale, E, area);
  }
  data.difference_noise = {};
  if (differences_)
    data.difference_noise = {differences_->is_linear_in_xdot ? 0.0 : noise_of_differences, noise_of_differences};
  return {};
}

}  // namespace sfdae::core
