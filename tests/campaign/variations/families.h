// Families of problems: random data of a case, and its copies.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "laws.h"
#include "small_problem.h"

namespace campaign {

enum class Family { gain_equation, rectifier, peak_rectifier, friction, friction_multibody, pulses };
inline constexpr std::array<const char*, 6> family_names = {
    "x' = b - g law(x)", "rectifier", "peak rectifier", "friction", "friction, multibody", "pulses"};

// What all copies have in common.
struct Case {
  Family family = Family::gain_equation;
  LawOfCase law;
  Gain gain = Gain::one;
  bool own_gain = false;  // of the copy's own x; else of a further state r
  Addition addition = Addition::none;
  bool on_line = false;       // multibody: positions in a plane, held on a line
  bool has_resistor = false;  // rectifier: between source and law
  double end = 1.0;           // the interval is 0 ... end
  std::vector<double> outputs;
  std::vector<SmallProblem> copies;                            // with different data
  int num_copies = 1;                                          // copy k has the data of copies[k % size]
  double largest_gain_exponent = 0.0, smallest_width = 1e300;  // what is known to be hard
};

Case random_case(int number, int seed);

}  // namespace campaign
