// Least-squares polynomials through points of a solution, to be extrapolated a little.
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
  // Through these nodes, at least three at different times.
  explicit CourseFit(const std::vector<const Trail::Node*>& nodes);

  int degree() const { return static_cast<int>(alpha_.size()) - 1; }  // the highest
  // Where the fit of component i is of the degree that predicts best at t: that degree, and the error expected there:
  // what the next coefficient amounts to, and what the deviations of the nodes do.
  struct Accuracy {
    int degree = 0;
    double error = 0.0;
  };
  Accuracy accuracy(std::size_t i, double t) const;
  // Of component i, of this degree.
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
