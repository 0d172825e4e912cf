// A cascade of k operational amplifiers as differentiators, of finite gain G or ideal.
//
// Unknowns v0, i0, (g, o, i)_s, s = 1, ..., k; p_1 = v0, p_s = o_(s-1):
//
//   v0 = sin t,   i0 + v0' - g_1' = 0,
//   (g_s - p_s)' + g_s - o_s = 0,   g_s + o_s / G = 0,   o_s - g_s + i_s + [s < k] (o_s - g_(s+1))' = 0
//
// Finite G: with g_s = -o_s / G stage s is o_s' + (1 + G) o_s = -G p_s', one degree of freedom each. i0 and the i_s
// follow without differentiation from the sums of the rows that share a derivative: mu = 0, d = k.
// Ideal, g_s = 0: o_s = -p_s', o_k is the k-th derivative of sin t: mu = k, d = 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linear_problem.h"

namespace campaign {

struct OpAmpCascade {
  int stages = 1;
  double gain = 1e5;
  bool ideal = false;
};

LinearProblem op_amp_problem(const OpAmpCascade& cascade);

// The periodic solution, which is the one through its value at any t; of size 1, but g_s of size 1 / G.
std::vector<double> op_amp_solution(const OpAmpCascade& cascade, double t);

}  // namespace campaign
