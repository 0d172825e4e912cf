// Formulas as sequences of operations: for numbers, for Taylor series, and recorded by the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sfdae/sfdae.h>

#include <vector>

#include "../taylor_series.h"
#include "formula.h"

namespace campaign {

enum class Purpose { values, recording };  // recorded opaque functions do not contain their formulas

class Program {
 public:
  Program() = default;
  Program(const Formulas& formulas, const std::vector<Formula>& roots, Purpose purpose = Purpose::values);

  // Values of the roots. x and slopes: those of the unknowns, slopes NULL if there are none in the formulas.
  void evaluate(double t, const double* x, const double* slopes, double* values) const;
  // Taylor series of the roots, of that order, along those of t, the unknowns and their slopes.
  void expand(int order, const TaylorSeries& t, const std::vector<TaylorSeries>& x,
              const std::vector<TaylorSeries>& slopes, std::vector<TaylorSeries>& values) const;
  // The roots as the library records them.
  std::vector<sfdae_expression> record(sfdae_expression t, const std::vector<sfdae_expression>& x,
                                       const std::vector<sfdae_expression>& slopes) const;

  int num_roots() const { return static_cast<int>(roots_.size()); }

 private:
  const Formulas* formulas_ = nullptr;
  std::vector<Node> nodes_;  // arguments are places in this list
  std::vector<int> roots_;
  mutable std::vector<double> work_;
  mutable std::vector<TaylorSeries> series_;
};

}  // namespace campaign
