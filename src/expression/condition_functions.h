// Functions g(t, x, x', p) on whose values branches of recorded equations depend: their values, how well these are
// known, and how the time at which one of them has a certain value moves with parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "expression/regularized_conditions.h"
#include "expression/taylor_evaluator.h"
#include "linalg/matrix.h"

namespace sfdae::core {

// Returns whether the condition with this value of g, which may be NaN, is met.
inline bool is_met(double g) { return std::isgreater(g, 0.0); }

class ConditionFunctions {
 public:
  // nodes: nodes of the record of the evaluator, which must outlive this object; parameters have the evaluator's values
  // at the time of a call. Parameters of conditions count as 0. With a source, the nodes are all of its equations, in
  // order.
  ConditionFunctions(const TaylorEvaluator& evaluator, const std::vector<int>& nodes);

  struct Point {
    double t;
    const double *x, *xdot;
  };

  std::size_t count() const { return alone_.size(); }
  bool depend_on_derivatives() const { return depend_on_derivatives_; }
  // Values at a point, one for each function; NaN if one cannot be evaluated. Allocates nothing.
  void evaluate(double t, const double* x, const double* xdot, double* g);
  // Values, and derivatives by the unknowns: count() x n, columns first, in an array with width() columns. Returns
  // false if they cannot be evaluated. Allocates nothing.
  bool linearize(double t, const double* x, const double* xdot, double* g, double* gradients);
  std::size_t width() const { return width_; }
  // Widths that a surface may have if a function has these slopes (n values, `stride` apart). The largest width is the
  // uncertainty of x by its tolerances; the best one is far below that and far above rounding errors. 0: none.
  struct Widths {
    double best, largest;
  };
  Widths widths(const double* slopes, std::size_t stride, const double* x, const double* tolerances) const;
  // Change of each function if x changes by `changes` (n values); 0 if it cannot be evaluated.
  std::vector<double> resolution(double t, const double* x, const double* xdot, const double* changes);
  // Returns the surfaces on which these functions, which are zero near the point, are to become continuous, with others
  // that are zero on the same surfaces. Functions of x', and those that do not pass zero there, have no such surface.
  // If a function is met now above a surface and now below it, there are none.
  std::vector<RegularizedCondition> surfaces(const std::vector<std::size_t>& functions, const Point& at,
                                             const double* tolerances);
  // Returns dt/dp of the time at which these functions have the values that they have at a point, for each direction j:
  // x moves by column j of S (n rows) and the parameter parameters[j] by 1 (none if that is negative). The result is
  // empty if the times of the functions move differently, or one of them stands still, and 0 if there are no functions.
  // No function depends on x'.
  std::optional<std::vector<double>> shifts(const std::vector<std::size_t>& functions, const Point& at, ConstView S,
                                            const std::vector<int>& parameters);

 private:
  struct Rates {
    std::vector<double> by_time, gradients;  // along x'; by unknowns and parameters, a column for each
  };
  void load(const double* x, const double* xdot);
  std::optional<Rates> rates(const Point& at);
  double width_of(std::size_t function, const Point& at, const double* tolerances);
  // Sides of a surface on which functions are met: above it, below it, both at different points, or none if they have
  // other zeros.
  enum class Side { none, above, below, both };
  std::vector<Side> sides_beside(std::size_t leader, const Point& at, const double* tolerances);
  struct Normal {
    std::vector<double> x, direction;  // a point on a surface, and a step away from it
  };
  std::vector<Side> sides_at(double t, const Normal& point);
  bool find_zero(std::size_t function, double t, const double* tolerances, double part, Normal& at);

  const TaylorEvaluator& evaluator_;
  std::size_t n_, width_;  // of unknowns; with parameters, which are unknowns of functions_
  std::optional<TaylorEvaluator> functions_;
  bool depend_on_derivatives_ = false;
  std::vector<char> depends_on_derivatives_;  // by functions
  std::vector<double> jet_;
  std::vector<std::vector<int>> alone_;  // each function's number
};

}  // namespace sfdae::core
