// Least-squares polynomials through points of a solution, for extrapolation over a short distance.
//
// [F57] G. E. Forsythe: Generation and use of orthogonal polynomials for data-fitting. J. SIAM 5 (1957) 74-88.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "watch/trail.h"

namespace sfdae::core {

class CourseFit {
 public:
  // Fits these nodes, at least three at different times.
  explicit CourseFit(const std::vector<const Trail::Node*>& nodes);

  int degree() const { return static_cast<int>(alpha_.size()) - 1; }  // the highest degree
  // Degree of the fit of component i that predicts best at t, and the error expected there: the next coefficient's
  // contribution plus that of the deviations of the nodes.
  struct Accuracy {
    int degree = 0;
    double error = 0.0;
  };
  Accuracy accuracy(std::size_t i, double t) const;
  // Value and slope of component i by the fit of this degree.
  struct Value {
    double x, xdot;
  };
  Value evaluate(std::size_t i, int degree, double t) const;

 private:
  double scaled(double t) const { return (t - origin_) / unit_; }

  double origin_, unit_;
  std::size_t n_;
  std::vector<double> alpha_, beta_, gamma_;  // recurrence and squared norms of the polynomials
  std::vector<double> coefficients_;          // n x (degree + 1)
  std::vector<double> deviations_;  // n x (degree + 1): of the nodes, root mean square per degree of freedom
};

}  // namespace sfdae::core
