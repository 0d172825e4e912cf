// Callbacks with sparsity patterns as the equations of an opaque record.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "problem/callback_problem.h"
#include "problem/linear_problem.h"
#include "problem/nonlinear_problem.h"
#include "problem/patterned_equations.h"

namespace sfdae::core {

class NonlinearEquations final : public PatternedEquations {
 public:
  // problem: with patterns; must outlive this object.
  explicit NonlinearEquations(CallbackProblem& problem);
  bool has_differences() const override { return problem_.form() == JacobianForm::differences; }
  double noise() const override;

 protected:
  CallbackError coefficient(double t, const double* jet, int k, double* F) override;
  CallbackError coefficient_of_entries(double t, const double* jet, int k, double* F_x, double* F_xdot) override;

 private:
  const double* derivatives_of(const double* jet, int order);

  CallbackProblem& problem_;
  std::vector<double> derivatives_, F_;
};

// F = E x' - A x - f
class LinearEquations final : public PatternedEquations {
 public:
  // problem: with patterns; must outlive this object.
  explicit LinearEquations(LinearProblem& problem);
  void forget() override { E_ = A_ = f_ = {}; }

 protected:
  CallbackError coefficient(double t, const double* jet, int k, double* F) override;
  CallbackError coefficient_of_entries(double t, const double* jet, int k, double* F_x, double* F_xdot) override;

 private:
  // Taylor coefficients of E, A or f at known_t_, as many as are known.
  struct Series {
    std::vector<std::vector<double>> coefficients;
  };
  CallbackError extend(char which, double t, int k, Series& series);
  CallbackError extend_all(double t, int k, bool with_f);

  LinearProblem& problem_;
  double known_t_ = 0.0;
  Series E_, A_, f_;
};

// These equations in the form that the minimal extension needs. source: of these patterns.
std::unique_ptr<RecordedProblem> opaque_problem(std::shared_ptr<PatternedEquations> source, int num_equations,
                                                const JacobianPatterns& patterns, const EquationNames& names);

}  // namespace sfdae::core
