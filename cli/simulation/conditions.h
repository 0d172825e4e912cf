// Initial conditions, and which of them are independent on the manifold of consistent values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulation/tape.h"

namespace sfdae::cli {

// An initial condition: unknown = value, or left = right.
struct Condition {
  int unknown = -1;  // number among the unknowns; -1: an equation
  double value = 0.0;
  double factor = 1.0;  // left - right = factor (unknown - value)
  Formula left = -1, right = -1;
  std::string text;
  Location at;
};

// All conditions given by the model: fixed start values, then initial equations. unknowns: variables of the model.
std::vector<Condition> given_conditions(const System& system, const std::vector<int>& unknowns);

// Candidates to complete too few conditions: start values, the preferred ones first.
std::vector<Condition> possible_conditions(const System& system, const std::vector<int>& unknowns);

// The Euclidean norm, robust against underflow of the squares.
double norm(const std::vector<double>& x);

// Rows accepted one by one if they are independent of those before. A = L Q with orthonormal rows of Q.
class IndependentRows {
 public:
  // scale: rows smaller than a rounding level times this scale are zero.
  bool add(const std::vector<double>& row, double scale);
  int size() const { return static_cast<int>(Q_.size()); }

  // The smallest solution of A z = b.
  std::vector<double> solve(const std::vector<double>& b) const;

 private:
  std::vector<std::vector<double>> Q_, L_;
};

}  // namespace sfdae::cli
