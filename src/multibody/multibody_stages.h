// The stages of a step of a mechanical system, a column of numbers for each: values, changes of an iteration, and their
// input. A step at one point has one column.
//
// Memory grows with the number of stages and is never freed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "multibody/multibody_form.h"
#include "multibody/multibody_point.h"
#include "system/stage_method.h"

namespace sfdae::core {

// Discretization of w' at s points that are solved for together:
//
//     D_h w_i = sum_j D_ij (w_j - w) / h,   or   c w_1 + w   where there is no method.
struct MultibodyDiscretization {
  int s = 1;
  const StageMethod* method = nullptr;
  double h = 0.0, c = 0.0;
  const double* w = nullptr;
  // The c of the step matrix.
  double coefficient() const { return method != nullptr ? method->gamma / h : c; }
  // Rate of change of the moves of MultibodyStages with w_i.
  double rate_of_moves() const { return method != nullptr ? 1.0 : c; }
};

struct MultibodyColumns {
  int rows = 0;
  std::vector<double> entries;
  void reserve(int columns) {
    const std::size_t count = index(columns) * index(rows) + 1;
    if (entries.size() < count) entries.resize(count);
  }
  double* column(int i) { return entries.data() + static_cast<std::ptrdiff_t>(i) * rows; }
  View view(int columns) { return {entries.data(), rows, columns, std::max(rows, 1)}; }
};

struct MultibodyStages {
  void resize(const MultibodySizes& sizes, int differential) {
    for (auto* columns : {&qv, &particular, &changes}) columns->rows = sizes.positions + sizes.velocities;
    rates.rows = sizes.positions;
    a.rows = sizes.velocities;
    mu.rows = sizes.constraints();
    for (auto* columns : {&moves, &r, &z}) columns->rows = differential;
    point.resize(sizes);
    residuals.assign(index(sizes.constraints()) + 1, 0.0);
    times.clear();
  }
  void reserve(int s, const MultibodyForm& form) {
    if (times.size() >= index(s)) return;
    while (tangents.size() < index(s)) {
      Tangents more;
      form.resize_tangents(more);
      tangents.push_back(std::move(more));
    }
    for (auto* columns : {&qv, &particular, &changes, &rates, &a, &mu, &moves, &r, &z}) columns->reserve(s);
    orientations.resize(index(s));
    times.resize(index(s));  // last: it says that there is room for all
  }

  std::vector<double> times;
  MultibodyColumns qv;                             // (q, v)
  MultibodyColumns particular;                     // changes of (q, v) that remove residuals of the constraints
  MultibodyColumns changes;                        // of (q, v), the last ones
  MultibodyColumns rates;                          // q' after these particular changes
  MultibodyColumns a, mu;                          // before the last changes
  MultibodyColumns moves;                          // Q1^T (w_i - w); without a method Q1^T D_h w
  MultibodyColumns r, z;                           // residuals and changes in local coordinates
  std::vector<Tangents> tangents;                  // not where stages are side by side (multibody_lanes.h)
  std::vector<MultibodyOrientation> orientations;  // of the constraints, once solved
  MultibodyPoint point;                            // where something is evaluated just now
  std::vector<double> residuals;                   // C v + r there
};

}  // namespace sfdae::core
