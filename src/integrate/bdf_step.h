// A step tried by BDF: formula and solution.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/bdf_history.h"

namespace sfdae::core {

// alpha_k = 1 + 1/2 + ... + 1/k, the leading coefficient of BDF k for equal steps.
inline constexpr double bdf_alpha[max_bdf_order + 1] = {0.0, 1.0, 1.5, 11.0 / 6.0, 25.0 / 12.0, 137.0 / 60.0};

struct BdfStep {
  void resize(std::size_t n, std::size_t size_w, bool needs_x);
  // D_h w = p'(t) + c (w - p(t)) with the predictor p through the newest points of the history. Leaves p(t) in
  // w, or the predicted x if needs_x.
  void set_formula(const BdfHistory& history, bool is_constant, bool needs_x);

  double t = 0.0, h = 0.0;
  int order = 1;
  bool has_fixed_leading = false;  // c = alpha_k / h
  double c = 0.0;
  std::vector<double> w_rest, x_rest;  // D_h w = c w + w_rest; x_rest: empty if not needed
  std::vector<double> w, x;            // at t
};

}  // namespace sfdae::core
