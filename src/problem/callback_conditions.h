// Conditions that a user declares for functions, and the branches that hold when these functions are called.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/equation_source.h"
#include "expression/taylor_evaluator.h"
#include "problem/problem.h"

namespace sfdae::core {

// The user's declaration: `count` functions g(t, x, x'), and the address that branches are written to.
struct DeclaredConditions {
  int count = 0;
  sfdae_conditions_function function = nullptr;
  int* branches = nullptr;
  void* user = nullptr;
};

// The functions g as equations of a record, with derivatives by differences.
class ConditionSource final : public EquationSource {
 public:
  ConditionSource(const DeclaredConditions& declared, int num_unknowns);

  CallbackError call(double t, const double* x, const double* xdot, double* g);
  // order: 0 or 1.
  bool values(double t, const double* jet, int order, double* g) override;
  // order: 0.
  bool entries(double t, const double* jet, int order, const std::vector<int>& limits, double* values) override;
  void set_targets(const Tape& tape);

 private:
  bool find_derivative(double t, const double* jet, double* g_1);

  DeclaredConditions declared_;
  std::size_t n_;
  struct Target {
    std::size_t condition, column;  // the column of (x, x')
  };
  std::vector<Target> targets_;
};

class CallbackConditions {
 public:
  CallbackConditions(const DeclaredConditions& declared, int num_unknowns);

  // Has the functions g as equations and as conditions (held_conditions.h), whose parameters tell which branches are
  // held.
  TaylorEvaluator& evaluator() { return evaluator_; }
  // Writes the branches for a call of the user's functions at this point (x, then x'): those that are held, or those of
  // g.
  CallbackError choose(double t, const double* point);

  // While it lives, branches stay unchanged at all points.
  class Kept {
   public:
    explicit Kept(CallbackConditions* conditions) : conditions_(conditions) {
      if (conditions_ != nullptr) ++conditions_->kept_;
    }
    Kept(const Kept&) = delete;
    Kept& operator=(const Kept&) = delete;
    ~Kept() {
      if (conditions_ != nullptr) --conditions_->kept_;
    }

   private:
    CallbackConditions* conditions_;
  };

 private:
  DeclaredConditions declared_;
  std::size_t n_;
  std::shared_ptr<ConditionSource> source_;
  TaylorEvaluator evaluator_;
  std::vector<double> g_;
  int kept_ = 0;
};

}  // namespace sfdae::core
