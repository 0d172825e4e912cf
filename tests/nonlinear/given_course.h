// SPDX-License-Identifier: BSD-3-Clause
// Sines that solutions of tests follow.
#ifndef SFDAE_TESTS_GIVEN_COURSE_H
#define SFDAE_TESTS_GIVEN_COURSE_H

#include <cmath>

#include "sfdae/expression.hpp"

namespace sfdae_test {

// mean + amplitude sin(rate t + phase)
struct GivenCourse {
  double mean, amplitude, rate, phase;
  template <class Number>
  Number value(const Number& t) const {
    using std::sin;
    return mean + amplitude * sin(rate * t + phase);
  }
  sfdae::Expression slope(const sfdae::Expression& t) const { return amplitude * rate * cos(rate * t + phase); }
};

}  // namespace sfdae_test

#endif
