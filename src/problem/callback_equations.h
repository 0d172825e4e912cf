// Callbacks with sparsity patterns as the equations of an opaque record.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "problem/callback_problem.h"
#include "problem/linear_problem.h"
#include "problem/nonlinear_problem.h"

namespace sfdae::core {

// Base of both kinds. If the first total derivative is not available, and differences are allowed, it is a difference
// along the jet: only x' at outputs needs it.
class PatternedEquations : public SuppliedEquations {
 public:
  void set_targets(const Tape& tape, const JacobianPatterns& patterns);
  void allow_differences_in_time(bool allowed) override { differences_in_time_ = allowed || has_differences(); }

  bool values(double t, const double* jet, int order, double* F) override;
  bool entries(double t, const double* jet, int order, const std::vector<int>& limits, double* values) override;

 protected:
  // base: of limits.
  PatternedEquations(const Problem& base, int m, int n) : base_(base), m_(m), n_(n) {}
  int m() const { return m_; }
  int n() const { return n_; }

  // Taylor coefficient k of F along a jet of order k + 1, and of the entries of F_x and F_x' along it.
  virtual CallbackError coefficient(double t, const double* jet, int k, double* F) = 0;
  virtual CallbackError coefficient_of_entries(double t, const double* jet, int k, double* F_x, double* F_xdot) = 0;

 private:
  CallbackError difference_in_time(double t, const double* jet, double* F_1);
  bool fail(CallbackError error);

  const Problem& base_;
  int m_, n_;
  bool differences_in_time_ = false;
  // The entry of each target of the tape; of F_x' if `derivative`.
  struct Place {
    int entry, equation;
    bool derivative;
  };
  std::vector<Place> places_;
  std::vector<double> F_x_, F_xdot_;
};

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
