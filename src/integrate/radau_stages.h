// A step tried by a Radau method: its stages and its end.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/radau_method.h"
#include "integrate/radau_node.h"

namespace sfdae::core {

struct RadauStages {
  void resize(std::size_t n, std::size_t size_w, int most_stages);
  // The last stage of a step from `start` as a node, whose time is set.
  void take_end(const RadauMethod& method, const RadauNode& start, RadauNode& end) const;

  // n x s and leading_size() x s.
  std::vector<double> x, w;
};

struct RadauStep {
  const RadauMethod* method = nullptr;
  double h = 0.0;
  RadauStages stages;
  RadauNode end;
};

// slope := sum_j weights[j stride] (values_j - start) / h, values_j the columns of `values`.
struct SlopeFormula {
  int s;
  const double* weights;
  int stride;
  double h;
};
void slope_of_stages(const SlopeFormula& formula, const std::vector<double>& start, const std::vector<double>& values,
                     double* slope);

}  // namespace sfdae::core
