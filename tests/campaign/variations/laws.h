// Laws: increasing functions of one argument, zero at 0, as devices, dampers and friction have them; gains: positive
// factors that vary with time or with an unknown.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>

#include "../random_numbers.h"
#include "formula.h"

namespace campaign {

enum class Law {
  exponential,
  power_25,
  smooth_diode,
  hyperbolic_tangent,
  arc_tangent,
  root_quotient,
  absolute_quotient,
  hyperbolic_sine,
  cubic,
  table,
  opaque
};
inline constexpr std::array<const char*, 11> law_names = {"exp",     "power 25",      "exp of sqrt", "tanh",
                                                          "atan",    "u/sqrt(1+u^2)", "u/(1+|u|)",   "sinh",
                                                          "x + x^3", "table",         "callback"};
inline bool is_bounded(Law law) {
  return law == Law::hyperbolic_tangent || law == Law::arc_tangent || law == Law::root_quotient ||
         law == Law::absolute_quotient;
}

// A law with the data of a case, the same for all copies.
struct LawOfCase {
  Law law = Law::exponential;
  Law hidden = Law::root_quotient;  // within a callback
  Spline spline;                    // of the table
};
LawOfCase random_law(Law law, RandomNumbers& random);

// The law at u.
Formula apply(const LawOfCase& law, Formula u);

enum class Gain {
  one,
  exp_of_time,
  exp_of_minimum,
  exp_of_sum,
  exp_of_product,
  exp_of_quotient,
  exp_of_sine,
  power_of_unknown,
  unknown,
  sine_of_unknown
};
inline constexpr std::array<const char*, 10> gain_names = {"1",
                                                           "exp(t)",
                                                           "exp(min)",
                                                           "exp(sum)",
                                                           "exp(product)",
                                                           "exp(quotient)",
                                                           "exp(A sin u)",
                                                           "power of an unknown",
                                                           "an unknown",
                                                           "sin of an unknown"};

}  // namespace campaign
