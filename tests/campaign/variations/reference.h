// Reference solutions, independent of the library: Radau IIA with three stages and Newton's method in full, on a mesh
// made by comparing one step with four, and again on that mesh with every step halved; the difference is the error
// estimate.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "program.h"
#include "reference_method.h"
#include "small_problem.h"

namespace campaign {

struct ReferencePoint {
  double t;
  std::vector<double> x;           // states
  std::vector<double> transition;  // dx / d(x of the point before), row by row
};

// The solution at outputs. Values are those of all unknowns.
class Reference {
 public:
  // tolerance: of the error estimate, relative to the size of a state.
  Reference(const SmallProblem& problem, double end, const std::vector<double>& outputs, double tolerance);

  bool is_known() const { return known_; }  // the method got through
  double error() const { return error_; }   // largest estimate at outputs, relative to the sizes of states
  const std::vector<double>& start() const { return start_; }
  const std::vector<std::vector<double>>& values() const { return values_; }
  const std::vector<double>& sizes() const { return sizes_; }  // largest absolute values on the mesh
  // Errors of all unknowns at an output that perturbations of rtol |x| + atol of the states at any one time lead to.
  std::vector<double> perturbed(std::size_t output, double rtol, const std::vector<double>& atol) const;
  // The largest difference to the second method at outputs, relative to the sizes of states.
  double difference_of_second_method() const;

 private:
  bool make_mesh(const std::vector<double>& outputs, double tolerance, double part_of_longest);
  double attempt(double t, double end);
  bool advance(double t, double h, std::vector<double>& x, int depth, bool second) const;
  void note_values(const std::vector<double>& outputs);

  const SmallProblem& problem_;
  ReferenceMethod method_;
  Program further_, gradients_;  // values of the further unknowns, and their derivatives by states
  double end_ = 0.0, error_ = 0.0;
  bool known_ = false;
  std::vector<ReferencePoint> points_;
  std::vector<std::size_t> output_points_;
  std::vector<double> start_, sizes_;
  std::vector<std::vector<double>> values_;
};

}  // namespace campaign
