// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear problems F(t, x, x') = 0 of the literature: what is known about each of them.
//
// Each header beside this one holds the equations of one problem as a template over the scalar type, so that the same
// text serves plain numbers, Taylor series and recorded equations:
//
//   template <class V> void name_residual(const V& t, const V* x, const V* xdot, V* F);
//
// [TS] F. Mazzia, C. Magherini: Test Set for Initial Value Problem Solvers, release 2.4. Bari and Pisa, 2008.
#ifndef SFDAE_TESTS_TEST_PROBLEM_H
#define SFDAE_TESTS_TEST_PROBLEM_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "linear_family.h"

namespace sfdae_test {

struct ReferencePoint {
  double t;
  std::vector<double> x;  // the first components, as far as they are known
};

struct TestProblem {
  std::string name = {};
  int m = 0, n = 0;                  // equations, unknowns
  CharacteristicValues values = {};  // (mu; d, a, u, v)
  double t0 = 0.0, tf = 0.0;
  std::vector<double> x0 = {};                  // n entries, consistent as far as the data of the problem are
  std::vector<double> xdot0 = {};               // n entries or none; only those that F contains count
  std::vector<ReferencePoint> references = {};  // ordered by time
  double reference_digits = 15.0;               // correct digits of the counted components of the references
  std::vector<int> counted = {};                // components by which solutions are judged
  std::vector<double> restarts = {};            // where F is not smooth in t
};

inline std::vector<int> first_components(int count) {
  std::vector<int> components(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) components[static_cast<std::size_t>(i)] = i;
  return components;
}

// Correct digits of the worst counted component: -log10 max |x_i - reference_i| / |reference_i|.
inline double correct_digits(const TestProblem& problem, const ReferencePoint& reference, const double* x) {
  double worst = std::numeric_limits<double>::min();
  for (const int i : problem.counted) {
    const double exact = reference.x[static_cast<std::size_t>(i)];
    const double error = std::abs((x[i] - exact) / exact);
    if (!std::isfinite(error)) return -std::numeric_limits<double>::infinity();
    worst = std::max(worst, error);
  }
  return -std::log10(worst);
}

}  // namespace sfdae_test

#endif
