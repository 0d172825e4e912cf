// User-supplied functions with sparsity patterns as the equations of an opaque record.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/opaque_record.h"
#include "expression/tape.h"
#include "problem/nonlinear_problem.h"

namespace sfdae::core {

// Base of all kinds. If the first total derivative is not available, and differences are allowed, it is a difference
// along the jet.
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

}  // namespace sfdae::core
