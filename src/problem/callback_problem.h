// A nonlinear problem given by the user's function for total derivatives, or by that for the derivative array.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/opaque_record.h"
#include "problem/callback_conditions.h"
#include "problem/colored_differences.h"
#include "problem/derivative_array_function.h"
#include "problem/nonlinear_problem.h"
#include "problem/pattern_probe.h"

namespace sfdae::core {

// Jacobians that the user's function writes: all entries, those of patterns, or none.
enum class JacobianForm { dense, compressed, differences };

class CallbackProblem final : public NonlinearProblem {
 public:
  CallbackProblem(int m, int n, sfdae_total_derivative_function function, void* user, PrescribedInputs inputs)
      : NonlinearProblem(m, n, std::move(inputs)), function_(function), user_(user) {}
  CallbackProblem(std::shared_ptr<DerivativeArrayFunction> array, PrescribedInputs inputs)
      : CallbackProblem(array->shape().m, array->shape().n, DerivativeArrayFunction::evaluate, array.get(),
                        std::move(inputs)) {
    array_ = std::move(array);
  }

  // Keeps the user pointer of the function alive as long as this object.
  void own_user(std::shared_ptr<void> owned) { owned_user_ = std::move(owned); }
  // The user's function depends on conditions.
  void set_conditions(const DeclaredConditions& declared);
  CallbackConditions* conditions() { return conditions_.get(); }
  // Jacobians are finite differences, without patterns.
  void take_differences();
  // Dense Jacobians are compared with the patterns at each evaluation, others occasionally by moving unknowns.
  void set_patterns(std::shared_ptr<const JacobianPatterns> patterns, JacobianForm form);
  const std::shared_ptr<const JacobianPatterns>& patterns() const { return patterns_; }
  JacobianForm form() const { return form_; }
  // opaque: these equations as an opaque record, which must outlive this object; its structure is followed.
  void follow(RecordedProblem* opaque) { opaque_ = opaque; }
  const Structure* structure() override { return opaque_ != nullptr ? opaque_->structure() : nullptr; }
  TaylorEvaluator* structure_evaluator() override { return opaque_ != nullptr ? &opaque_->evaluator() : nullptr; }

  struct Outputs {
    double* F;
    double *F_x = nullptr, *F_xdot = nullptr;  // null: not asked for
  };
  // One order straight from the callback, plain derivatives. derivatives: those of x.
  CallbackError call(double t, int order, const double* derivatives, const Outputs& to);
  // Same with the entries of the patterns in place of matrices.
  CallbackError call_entries(double t, int order, const double* derivatives, const Outputs& to);

 protected:
  CallbackError evaluate_values(double t, const double* jet, int order, double* F) override;
  CallbackError evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) override;

 private:
  struct Differences {
    GroupedPattern F_x, F_xdot;
    GroupedPattern united;  // F_x' and what F^(k) depends on with it
    ChangeSizes of_x, of_xdot;
    bool is_linear_in_xdot = false;  // F, as far as seen at the latest point
  };

  void to_derivatives(const double* jet, int order);
  DerivativeArrayFunction* array_for_all_orders() { return form_ == JacobianForm::dense ? array_.get() : nullptr; }
  CallbackError invoke(double t, int order, const double* derivatives, const Outputs& to);
  CallbackError check_finite(const char* name, const double* values, const ColumnPattern* pattern,
                             const CallbackError& place) const;
  CallbackError faulty_array(const CallbackError& place) const;
  CallbackError beyond_pattern(const Outputs& dense, const CallbackError& place) const;
  CallbackError differentiate(double t, int order, const double* derivatives, const Outputs& to);
  CallbackError probe(double t, const double* derivatives, const Outputs& entries);
  CallbackError lacks(char which, int row, int column, double value, const CallbackError& place) const;

  sfdae_total_derivative_function function_;
  void* user_;
  std::shared_ptr<void> owned_user_;
  std::shared_ptr<DerivativeArrayFunction> array_;  // that function_ reads; else null
  std::vector<double> derivatives_;
  std::vector<double> unused_;  // F of orders that are not asked for
  std::unique_ptr<CallbackConditions> conditions_;

  std::shared_ptr<const JacobianPatterns> patterns_;
  JacobianForm form_ = JacobianForm::dense;
  RecordedProblem* opaque_ = nullptr;
  std::unique_ptr<Differences> differences_;
  std::unique_ptr<PatternProbe> probe_;
  int until_probe_ = 0;  // gradients
  std::vector<double> dense_F_x_, dense_F_xdot_;
};

}  // namespace sfdae::core
