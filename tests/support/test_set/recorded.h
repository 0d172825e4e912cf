// SPDX-License-Identifier: BSD-3-Clause
// Equations written as templates, handed to the library for recording.
#ifndef SFDAE_TESTS_TEST_SET_RECORDED_H
#define SFDAE_TESTS_TEST_SET_RECORDED_H

#include <algorithm>
#include <vector>

#include "sfdae/expression.hpp"
#include "sfdae/sfdae.h"
#include "test_problem.h"

namespace sfdae_test {

// equations(segment, t, x, xdot, F) as in for_each_problem_of_test_set. `this` is the user data of `write`.
template <class Equations>
class RecordedEquations {
 public:
  RecordedEquations(const TestProblem& problem, const Equations& equations, int segment = 0)
      : m_(static_cast<std::size_t>(problem.m)), n_(problem.n), equations_(equations), segment_(segment) {}

  // A sfdae_equations_function.
  static int write(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                   sfdae_expression* residual, void* user) {
    const auto& self = *static_cast<const RecordedEquations*>(user);
    const std::vector<sfdae::Expression> unknowns(x, x + self.n_), slopes(xdot, xdot + self.n_);
    std::vector<sfdae::Expression> F(self.m_);
    self.equations_(self.segment_, sfdae::Expression(t), unknowns.data(), slopes.data(), F.data());
    std::transform(F.begin(), F.end(), residual, [](const sfdae::Expression& e) { return e.c(); });
    return 0;
  }

 private:
  std::size_t m_;
  int n_;
  const Equations& equations_;
  int segment_;
};

}  // namespace sfdae_test

#endif
