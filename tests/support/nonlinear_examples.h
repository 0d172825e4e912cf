// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear problems as the core sees them: records of small examples, and problem, analysis and system in one object.
#ifndef SFDAE_TESTS_NONLINEAR_EXAMPLES_H
#define SFDAE_TESTS_NONLINEAR_EXAMPLES_H

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "array/nonlinear_system.h"
#include "c_api/expressions.h"
#include "recorded.h"
#include "reduction/index_analysis.h"
#include "starts/consistent_jets.h"
#include "test_set/formula_problems.h"
#include "test_set/pendulum.h"
#include "test_set/recorded.h"

namespace sfdae_test {

using RecordPointer = std::shared_ptr<const Record>;

inline RecordPointer record_of_formulas(const std::string& name) {
  const FormulaProblem& p = formula_problem(name);
  const auto equations = [&p](int, const auto& t, const auto* x, const auto* xdot, auto* F) {
    p.residual(t, x, xdot, F);
  };
  RecordedEquations<decltype(equations)> recorded(p.data, equations);
  return sfdae::core::record_equations(&decltype(recorded)::write, p.data.m, p.data.n, &recorded);
}

// mu = 2, d = 2, a = 3.
inline RecordPointer record_of_pendulum() {
  const TestProblem p = pendulum();
  const auto equations = [](int, const auto& t, const auto* x, const auto* xdot, auto* F) {
    pendulum_residual(t, x, xdot, F);
  };
  RecordedEquations<decltype(equations)> recorded(p, equations);
  return sfdae::core::record_equations(&decltype(recorded)::write, p.m, p.n, &recorded);
}

// x1' = -x1 x2, x2^2 = x1 x2: x1 = x2 = 1 / (1 + t). mu = 0, d = 1, a = 1.
inline RecordPointer record_of_hyperbola() {
  Recording r(2);
  return r.finish({r.xdot[0] + r.x[0] * r.x[1], r.x[1] * r.x[1] - r.x[0] * r.x[1]});
}

// The hyperbola with its second equation once more, multiplied by 2 + x1: v = 1.
inline RecordPointer record_with_redundant_equation() {
  Recording r(2);
  const Term constraint = r.x[1] - r.x[0];
  return r.finish({r.xdot[0] + r.x[0] * r.x[1], constraint, constraint * (2.0 + r.x[0])});
}

// x1' = x1 x3, x2 = x1^2, x3 free: mu = 0, d = 1, a = 1, u = 1. With x3 = c(t) prescribed, x1 = x1(0) exp(integral of
// c).
inline RecordPointer record_with_free_component() {
  Recording r(3);
  return r.finish({r.xdot[0] - r.x[0] * r.x[2], r.x[1] - r.x[0] * r.x[0]});
}

// F = (F1, F2 + x2' F1, x3' + x3 - x1) with F1 = x1^2 + x1 - sin t - sin^2 t and F2 = x2 - x1: x1 = x2 = sin t, mu = 0,
// d = 1, a = 2. Off the manifold F1 = 0 the pivot F1 of x2' makes a differential equation of the second one.
inline RecordPointer record_with_rising_rank() {
  Recording r(3);
  const Term s = sin(r.t), F1 = r.x[0] * r.x[0] + r.x[0] - s - s * s;
  return r.finish({F1, r.x[1] - r.x[0] + r.xdot[1] * F1, r.xdot[2] + r.x[2] - r.x[0]});
}

struct NonlinearExample {
  explicit NonlinearExample(RecordPointer record, sfdae::core::PrescribedInputs inputs = {})
      : problem(std::make_unique<sfdae::core::RecordedProblem>(std::move(record), std::move(inputs))) {}

  // Analyzed at t from a guess of x.
  void analyze(double t, double toward, const std::vector<double>& x, std::vector<char> fixed = {}) {
    sfdae::core::ConsistentJets jets(*problem, t, x.data(), std::move(fixed));
    analysis = sfdae::core::analyze_index(jets, t, toward, settings, arena, decisions);
    units = jets.units();
    jet = jets.jet_at(t, analysis.values.mu);
    system = std::make_unique<sfdae::core::NonlinearSystem>(*problem, settings, analysis, units, jet);
  }

  std::unique_ptr<sfdae::core::NonlinearProblem> problem;
  sfdae::core::AnalysisSettings settings;
  sfdae::core::Arena arena;
  std::vector<sfdae::core::RankDecision> decisions;
  sfdae::core::IndexAnalysis analysis;
  sfdae::core::Units units;
  sfdae::core::Jet jet;
  std::unique_ptr<sfdae::core::NonlinearSystem> system;
};

}  // namespace sfdae_test

#endif
