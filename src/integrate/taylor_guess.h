// Taylor coefficients of an integrator's polynomial as initial guesses for points within its last step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "system/strangeness_free_system.h"

namespace sfdae::core {

struct TaylorGuess {
  // n x (order + 1): at the point, and at the end and the start of the step. at_start is computed when needed first;
  // empty: neither end is known.
  std::vector<double> here, before, at_start;

  void assign_zero(std::size_t size) {
    for (std::vector<double>* v : {&here, &before}) v->assign(size, 0.0);
    at_start.clear();
  }
  // The polynomial has changed.
  void forget_ends() { at_start.clear(); }
  struct Times {
    double t, newest, start;
  };
  template <class Polynomial>
  Guess within(const Polynomial& polynomial, const Times& times, int order) {
    polynomial.taylor(times.t, order, here.data());
    if (at_start.empty()) {
      polynomial.taylor(times.newest, order, before.data());
      at_start.resize(here.size());
      polynomial.taylor(times.start, order, at_start.data());
    }
    return {here.data(), before.data(), nullptr, at_start.data()};
  }
};

}  // namespace sfdae::core
