// Comparison of derivatives that callbacks supply with differences of the order below.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/derivative_check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "linalg/index.h"
#include "problem/failure.h"
#include "problem/supplied_line.h"

namespace sfdae::core {

namespace {

void compare(LinearProblem& problem, char which, double t, int order, DerivativeMismatch& worst) {
  const int rows = problem.m(), count = which == 'f' ? rows : rows * problem.n();
  SuppliedDerivative supplied{which, order, rows, 0, std::vector<double>(index(count))};
  const CallbackError error = problem.call(which, t, order, supplied.values.data());
  if (error.status == SFDAE_ORDER_MISSING) return;
  if (error.status != SFDAE_OK) error.raise();
  const double unit = unit_of_time(t);
  compare_with_differences(
      supplied, unit,
      [&](double offset, double* values) { return problem.call(which, t + offset, order - 1, values); }, worst);
}

// Available derivatives of orders 0 ... max_order of one function, one after the other.
class OrdersOfFunction {
 public:
  OrdersOfFunction(LinearProblem& problem, char which, int max_order)
      : problem_(problem),
        which_(which),
        highest_(max_order),
        rows_(problem.m()),
        count_(which == 'f' ? rows_ : rows_ * problem.n()) {}

  std::optional<DerivativeMismatch> mismatch(double t, double reach) {
    SuppliedLine line{0, count_, t, reach, {}, std::vector<double>(index(count_) * index(highest_ + 1))};
    CallbackError error = evaluate(t, line.base.data());
    if (error.status == SFDAE_ORDER_MISSING) {
      highest_ = error.order - 1;
      if (highest_ < 1) return {};
      line.base.resize(index(count_) * index(highest_ + 1));
      error = {};
    }
    if (error.status == SFDAE_CALLBACK_STOPPED || error.status == SFDAE_STOPPED) error.raise();
    if (error.status != SFDAE_OK) return {};
    line.count = count_ * highest_;
    line.evaluate = [&](double offset, double* values) { return evaluate(t + offset, values); };
    const auto found = contradictions(line, unconfirmed_entries(line), least_wrong_part);
    const LineContradiction* worst = nullptr;
    // Each order is compared with the one below: the lowest wrong one counts.
    for (const LineContradiction& c : found)
      if (worst == nullptr || order_of(c) < order_of(*worst) ||
          (order_of(c) == order_of(*worst) && c.strength > worst->strength))
        worst = &c;
    if (worst == nullptr) return {};
    const int entry = worst->entry % count_;
    return DerivativeMismatch{which_,          order_of(*worst),  entry % rows_, entry / rows_,
                              worst->supplied, worst->difference, 1.0,           1.0 / worst->strength};
  }

 private:
  int order_of(const LineContradiction& c) const { return c.entry / count_ + 1; }

  CallbackError evaluate(double t, double* values) {
    for (int k = 0; k <= highest_; ++k) {
      const CallbackError error = problem_.call(which_, t, k, values + index(count_) * index(k));
      if (error.status != SFDAE_OK && error.status != SFDAE_NOT_FINITE) return error;
    }
    return {};
  }

  LinearProblem& problem_;
  char which_;
  int highest_, rows_, count_;
};

}  // namespace

void demand_derivatives(LinearProblem& problem, double t, double toward, int max_order) {
  const DerivativeChecking checking(problem);
  const double direction = toward < t ? -1.0 : 1.0;
  const double reach = std::min(std::fabs(toward - t), problem.room(t, direction));
  for (char which : {'E', 'A', 'f'}) {
    if (problem.is_constant(which)) continue;
    if (const auto wrong = OrdersOfFunction(problem, which, max_order).mismatch(t, direction * reach))
      throw WrongDerivative(*wrong, t, problem.equation_names());
  }
}

DerivativeMismatch check_derivatives(LinearProblem& problem, double t, int max_order) {
  DerivativeMismatch worst;
  // Each order is compared with the one below: no statement is possible beyond the first mistake.
  for (int order = 1; order <= max_order && !worst.suspicious(); ++order)
    for (char which : {'E', 'A', 'f'})
      if (!problem.is_constant(which)) compare(problem, which, t, order, worst);
  return worst;
}

}  // namespace sfdae::core
