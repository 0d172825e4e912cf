// SPDX-License-Identifier: BSD-3-Clause
// A family as the core sees it: callbacks, analysis and strangeness-free system in one object.
#ifndef SFDAE_TESTS_ANALYZED_PROBLEM_H
#define SFDAE_TESTS_ANALYZED_PROBLEM_H

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "c_api/problems.h"
#include "family_problem.h"
#include "linalg/arena.h"
#include "linear/linear_system.h"
#include "problem/linear_problem.h"
#include "reduction/index_analysis.h"

namespace sfdae_test {

class AnalyzedProblem {
 public:
  // Analyzed at t; prepare may change the callbacks before.
  AnalyzedProblem(std::shared_ptr<const LinearFamily> family, double t, double toward,
                  sfdae::core::LeadingTerm leading = sfdae::core::LeadingTerm::automatic,
                  const sfdae::core::AnalysisSettings& analysis_settings = {},
                  const std::function<void(FamilyProblem&)>& prepare = {})
      : callbacks(std::move(family)),
        settings(analysis_settings),
        problem(prepared(callbacks, prepare)),
        system(problem, settings, sfdae::core::analyze_index(problem, t, toward, settings, arena, decisions),
               leading) {}

  const LinearFamily& family() const { return callbacks.family(); }
  std::vector<double> exact(double t) const { return solution(t).first; }
  std::vector<double> exact_derivative(double t) const { return solution(t).second; }

  FamilyProblem callbacks;
  sfdae::core::AnalysisSettings settings;
  sfdae::core::Arena arena;
  std::vector<sfdae::core::RankDecision> decisions;
  sfdae::core::LinearProblem problem;
  sfdae::core::LinearSystem system;

 private:
  static sfdae::core::LinearFunctions prepared(FamilyProblem& callbacks,
                                               const std::function<void(FamilyProblem&)>& prepare) {
    if (prepare) prepare(callbacks);
    return sfdae::core::functions_of(callbacks.problem);
  }
  std::pair<std::vector<double>, std::vector<double>> solution(double t) const {
    const auto n = static_cast<std::size_t>(callbacks.n());
    std::vector<double> x(n), xdot(n);
    family().exact(t, x.data(), xdot.data());
    return {x, xdot};
  }
};

}  // namespace sfdae_test

#endif
