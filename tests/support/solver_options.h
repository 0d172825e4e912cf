// SPDX-License-Identifier: BSD-3-Clause
// Options of the C++ interface that most tests change.
#ifndef SFDAE_TESTS_SOLVER_OPTIONS_H
#define SFDAE_TESTS_SOLVER_OPTIONS_H

#include "sfdae/sfdae.hpp"

namespace sfdae_test {

inline sfdae::Options solver_options(double tolerance, int method) {
  sfdae::Options options;
  options.rtol = options.atol = tolerance;
  options.method = method;
  return options;
}

}  // namespace sfdae_test

#endif
