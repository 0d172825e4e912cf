// A nonlinear problem F(t, x, x') = 0: what delivers Taylor coefficients of F and of its derivatives along a jet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "expression/lane_evaluator.h"
#include "expression/taylor_evaluator.h"
#include "problem/problem.h"
#include "problem/taylor_data.h"
#include "sfdae/sfdae.h"
#include "structure/structure.h"

namespace sfdae::core {

// A jet is n x (order + 1): column k holds the Taylor coefficients x_k of x(t + s) = sum x_k s^k.
class NonlinearProblem : public Problem {
 public:
  virtual ~NonlinearProblem() = default;

  int m() const { return m_; }
  int n() const { return n_; }
  const std::vector<int>& prescribed() const { return inputs_.components; }
  // How often each equation is differentiated at most (m counts, or none): rows of the derivative array above that
  // are left out, their residuals are zero.
  void set_differentiations(std::vector<int> counts) {
    differentiations_ = std::move(counts);
    counts_are_given_ = true;
  }
  // By the user, even if they leave out nothing.
  bool counts_are_given() const { return counts_are_given_; }
  const std::vector<int>& differentiations() const { return follows_structure_ ? proposed_ : differentiations_; }
  // Null where there is none, or nothing is known of it.
  virtual const Structure* structure() { return nullptr; }
  // That of the derivatives which confirm the structure; null where there is none.
  virtual TaylorEvaluator* structure_evaluator() { return nullptr; }
  // The offsets are these counts, in place of those set. Nothing changes where there is no structure.
  void follow_structure(bool follows);
  bool follows_structure() const { return follows_structure_; }
  // Values of the prescribed components.
  CallbackError evaluate_prescribed(double t, double* values);

  // F: m x (order + 1), Taylor coefficients of F along a jet of order + 1.
  CallbackError residuals(double t, const double* jet, int order, double* F);
  // F as residuals(), at `count` points side by side, a column being a block for each unknown or equation. False:
  // they have to be evaluated one by one, for whatever reason; what was written is not to be used.
  bool residuals_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets, int order, LaneBlock* F);
  // Whether it is of use to try.
  virtual bool has_lanes(int) const { return false; }
  // F_x' and F_x are the same at all points as long as this stays what it is; -1: that is not known.
  virtual long constant_matrices() { return -1; }
  // E(k) = (F_x')_k, A(k) = -(F_x)_k, f(k) = -F_k along a jet of order highest + 1: Taylor coefficients in
  // time_scale, scaled as TaylorData does (rows, preferred_rows), with column j of E and A multiplied by
  // units[j] (may be empty).
  struct Scaling {
    double time_scale = 0.0;  // 0: chosen
    RowScaling rows = RowScaling::each;
    const std::vector<double>* preferred_rows = nullptr;
    const Units* units = nullptr;
    bool once_more = false;  // every equation may be differentiated once more
  };
  CallbackError linearize(double t, const double* jet, Orders orders, const Scaling& scaling, TaylorData& data);

  long evaluations() const { return evaluations_; }  // of F along jets
  long linearizations() const { return linearizations_; }

 protected:
  NonlinearProblem(int m, int n, PrescribedInputs inputs) : m_(m), n_(n), inputs_(std::move(inputs)) {}

  virtual CallbackError evaluate_values(double t, const double* jet, int order, double* F) = 0;
  virtual bool evaluate_lanes(const LaneBlock*, const LaneBlock*, int, LaneBlock*) { return false; }
  CallbackError stopped(double t) const;
  // Plain Taylor coefficients of F, F_x' and F_x into f(k), E(k), A(k).
  virtual CallbackError evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) = 0;
  long linearizations_ = 0;
  long evaluations_ = 0;

 private:
  CallbackError drop_rounding_errors(double t, const double* jet, Orders orders, TaylorData& data);

  int m_, n_;
  PrescribedInputs inputs_;
  std::vector<int> differentiations_, proposed_;
  bool counts_are_given_ = false, follows_structure_ = false;
};

// Functions of the user's with known patterns, in place of formulas.
class SuppliedEquations : public EquationSource {
 public:
  // After an evaluation that has failed.
  const CallbackError& error() const { return error_; }
  // Derivatives are differences: what structure cannot see is not to be found in them.
  virtual bool has_differences() const { return false; }
  // Where the first total derivative by t is not available.
  virtual void allow_differences_in_time(bool) {}
  // What was evaluated: the user may have changed what functions depend on.
  virtual void forget() {}

 protected:
  CallbackError error_;
};

// Arrays have all their rows while this lives, whatever the structure proposes to leave out.
class WithoutStructure {
 public:
  explicit WithoutStructure(NonlinearProblem& problem) : problem_(problem), followed_(problem.follows_structure()) {
    problem_.follow_structure(false);
  }
  WithoutStructure(const WithoutStructure&) = delete;
  WithoutStructure& operator=(const WithoutStructure&) = delete;
  ~WithoutStructure() { problem_.follow_structure(followed_); }
  bool changes_rows() const { return followed_; }

 private:
  NonlinearProblem& problem_;
  bool followed_;
};

// Recorded equations, or others that are evaluated as if they were.
class RecordedProblem final : public NonlinearProblem {
 public:
  RecordedProblem(std::shared_ptr<const Record> record, PrescribedInputs inputs)
      : NonlinearProblem(record->m(), record->n(), std::move(inputs)), evaluator_(std::move(record)) {}
  // Of the same recording, which is shared, with the values that parameters have now; nothing is prescribed.
  explicit RecordedProblem(const TaylorEvaluator& evaluator)
      : NonlinearProblem(evaluator.record().m(), evaluator.record().n(), {}), evaluator_(evaluator) {}
  // Functions of the user's: an opaque record.
  RecordedProblem(std::shared_ptr<const Record> record, std::shared_ptr<SuppliedEquations> source)
      : NonlinearProblem(record->m(), record->n(), {}),
        evaluator_(std::move(record), source),
        source_(std::move(source)) {}
  // Null for formulas.
  const SuppliedEquations* source() const { return source_.get(); }
  void allow_differences_in_time(bool allowed) {
    if (source_) source_->allow_differences_in_time(allowed);
  }
  void forget_source() {
    if (source_) source_->forget();
  }
  // A copy shares the recording.
  RecordedProblem(const RecordedProblem&) = default;
  TaylorEvaluator& evaluator() { return evaluator_; }
  long constant_matrices() override;
  bool has_lanes(int order) const override { return !source_ && order <= LaneEvaluator::highest_order; }
  const Structure* structure() override;
  TaylorEvaluator* structure_evaluator() override { return &evaluator_; }
  const std::shared_ptr<const Structure>& shared_structure() {
    structure();
    return structure_;
  }
  // See TaylorEvaluator::entries.
  CallbackError gradient_entries(double t, const double* jet, int order, const std::vector<int>& limits,
                                 double* values);
  CallbackError gradient_entries(double t, const double* jet, VaryingEntries& varying, double* values);
  // The same at `count` points side by side, jets as in residuals_side_by_side(). Null: they have to be evaluated one
  // by one, for whatever reason. Valid until the next evaluation.
  const LaneBlock* gradient_entries_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets, int order,
                                                 const std::vector<int>& limits);
  // Each equation up to its limit, see TaylorEvaluator::values_within; rows that `differentiations` leaves out are
  // evaluated, too.
  CallbackError residuals_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits,
                                 int more, double* F);
  CallbackError gradient_entries_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits,
                                        double* values);
  // The same at `count` points side by side, see LaneEvaluator::evaluate_within. Null: as
  // gradient_entries_side_by_side().
  const LaneEvaluator* evaluate_within(int count, const LaneEvaluator::Points& points,
                                       const std::shared_ptr<const OrderLimits>& limits, bool with_gradients);
  // Made elsewhere.
  void count_linearizations(int count) { linearizations_ += count; }
  // Those found last.
  const LaneBlock* last_entries_side_by_side() const { return lanes_.gradients(); }
  // evaluate: calls that function of the evaluator, whose answer it gives.
  template <class Evaluate>
  CallbackError gradients_for(double t, Evaluate evaluate) {
    CallbackError error = stopped(t);
    if (error.status != SFDAE_OK) return error;
    ++linearizations_;
    return evaluate(evaluator_) ? error : failure(t);
  }
  // After an evaluation that has failed.
  CallbackError evaluation_error(double t) const { return failure(t); }

 protected:
  CallbackError evaluate_values(double t, const double* jet, int order, double* F) override;
  bool evaluate_lanes(const LaneBlock* t, const LaneBlock* jets, int order, LaneBlock* F) override;
  CallbackError evaluate_gradients(double t, const double* jet, Orders orders, TaylorData& data) override;

 private:
  CallbackError failure(double t) const;
  TaylorEvaluator evaluator_;
  std::shared_ptr<SuppliedEquations> source_;
  LaneEvaluator lanes_;
  bool structure_is_known_ = false;
  std::shared_ptr<const Structure> structure_;
  std::optional<bool> has_constant_matrices_;
};

}  // namespace sfdae::core
