// Conditions that a user declares for functions, and the branches that hold when these functions are called.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "problem/colored_differences.h"
#include "problem/patterned_equations.h"

namespace sfdae::core {

// The user's declaration: `count` functions g(t, x, x'), and the address that branches are written to.
struct DeclaredConditions {
  int count = 0;
  sfdae_conditions_function function = nullptr;
  int* branches = nullptr;
  void* user = nullptr;
};

// The functions g as equations of a record, with derivatives by differences; total derivatives up to order 1.
class ConditionEquations final : public PatternedEquations {
 public:
  // problem: of limits; must outlive this object.
  ConditionEquations(const DeclaredConditions& declared, const Problem& problem, int num_unknowns);
  bool has_differences() const override { return true; }
  CallbackError call(double t, const double* x, const double* xdot, double* g);

 protected:
  CallbackError coefficient(double t, const double* jet, int k, double* g) override;
  CallbackError coefficient_of_entries(double t, const double* jet, int k, double* g_x, double* g_xdot) override;

 private:
  DeclaredConditions declared_;
  GroupedPattern pattern_;
  ChangeSizes of_x_, of_xdot_;
};

class CallbackConditions {
 public:
  // problem: whose functions have these conditions; must outlive this object.
  CallbackConditions(const DeclaredConditions& declared, const Problem& problem, int num_unknowns);

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
  std::shared_ptr<ConditionEquations> equations_;
  TaylorEvaluator evaluator_;
  std::vector<double> g_;
  int kept_ = 0;
};

}  // namespace sfdae::core
