// Taylor coefficients along one unmodified jet of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "problem/coefficient_source.h"
#include "problem/nonlinear_problem.h"
#include "system/jet.h"

namespace sfdae::core {

class JetCoefficients final : public CoefficientSource {
 public:
  JetCoefficients(NonlinearProblem& problem, const Jet& jet, const Units& units)
      : problem_(problem), jet_(jet), units_(units) {}
  int m() const override { return problem_.m(); }
  int n() const override { return problem_.n(); }
  std::vector<int> differentiations() const override { return problem_.differentiations(); }
  bool is_constant() const override { return false; }
  CallbackError evaluate(double, Orders orders, double time_scale, TaylorData& data,
                         RowScaling rows = RowScaling::each,
                         const std::vector<double>* preferred_rows = nullptr) override {
    return problem_.linearize(jet_.t, jet_.x.data(), orders, {time_scale, rows, preferred_rows, &units_}, data);
  }
  bool is_along_jet() const override { return true; }
  void set_units(Units units) override { units_ = std::move(units); }

 private:
  NonlinearProblem& problem_;
  const Jet& jet_;
  Units units_;
};

}  // namespace sfdae::core
