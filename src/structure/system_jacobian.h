// The system Jacobian J_ij = d f_i / d x_j^(d_j - c_i) where equation i contains that derivative, else 0 [P01]; sparse, by rows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "structure/structure.h"

namespace sfdae::core {

class SystemJacobian {
 public:
  SystemJacobian(const Structure& structure, const Tape& tape);

  // Of the jets wanted; 1 unless equations were replaced.
  int jet_order() const { return order_ + 1; }
  // False: the equations cannot be evaluated there. jet: of jet_order(), at least.
  bool evaluate(TaylorEvaluator& evaluator, double t, const double* jet);

  // Entries that differ from these by more than a part of them become zero.
  void drop_changes_from(const std::vector<double>& values);

  // The entries of equation i are first()[i], ..., first()[i + 1] - 1.
  const std::vector<int>& first() const { return first_; }
  const std::vector<int>& unknown() const { return unknown_; }
  const std::vector<double>& values() const { return values_; }

 private:
  // values_[entry] += factor times a Taylor coefficient of a derivative of a recorded equation.
  struct Term {
    int entry;
    std::size_t coefficient;
    double factor;
  };

  int order_;
  std::vector<int> first_{0}, unknown_;
  std::vector<int> limits_;  // of the coefficients of each recorded equation
  std::vector<Term> terms_;
  std::vector<double> coefficients_, values_;
};

}  // namespace sfdae::core
