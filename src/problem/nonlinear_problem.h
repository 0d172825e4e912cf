// A nonlinear problem F(t, x, x') = 0: source of Taylor coefficients of F and of its derivatives along a jet.
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
  // Largest number of differentiations of each equation (m counts, or none): rows of the derivative array above that
  // are left out, their residuals are zero.
  void set_differentiations(std::vector<int> counts) {
    differentiations_ = std::move(counts);
    counts_are_given_ = true;
  }
  // True if the user has set counts, even if they leave out nothing.
  bool counts_are_given() const { return counts_are_given_; }
  const std::vector<int>& differentiations() const { return follows_structure_ ? proposed_ : differentiations_; }
  // Null if there is no structure, or it is unknown.
  virtual const Structure* structure() { return nullptr; }
  // Evaluator of the derivatives that confirm the structure; null if there is none.
  virtual TaylorEvaluator* structure_evaluator() { return nullptr; }
  // Replaces the counts by the offsets of the structure. Without a structure nothing changes.
  void follow_structure(bool follows);
  bool follows_structure() const { return follows_structure_; }
  // Values of the prescribed components.
  CallbackError evaluate_prescribed(double t, double* values);

  // F: m x (order + 1), Taylor coefficients of F along a jet of order + 1.
  CallbackError residuals(double t, const double* jet, int order, double* F);
  // F as residuals(), at `count` points side by side, a column being a block for each unknown or equation. False: they
  // have to be evaluated one by one; the output is undefined.
  bool residuals_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets, int order, LaneBlock* F);
  // Returns whether side-by-side evaluation is worth a try.
  virtual bool has_lanes(int) const { return false; }
  // F_x' and F_x are the same at all points while this number does not change; -1: unknown.
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

// User-supplied functions with known patterns, in place of formulas.
class SuppliedEquations : public EquationSource {
 public:
  // Error of the last evaluation that failed.
  const CallbackError& error() const { return error_; }
  // Derivatives are finite differences: they do not reveal more than the structure.
  virtual bool has_differences() const { return false; }
  // Allows differences if the first total derivative by t is not available.
  virtual void allow_differences_in_time(bool) {}
  // Discards values, as the user may have changed data of the functions.
  virtual void forget() {}

 protected:
  CallbackError error_;
};

// While it lives, derivative arrays have all their rows, regardless of the structure.
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

// Recorded equations, or opaque ones that are evaluated through the same interface.
class RecordedProblem final : public NonlinearProblem {
 public:
  RecordedProblem(std::shared_ptr<const Record> record, PrescribedInputs inputs)
      : NonlinearProblem(record->m(), record->n(), std::move(inputs)), evaluator_(std::move(record)) {}
  // Shares the recording, and copies the present values of parameters; nothing is prescribed.
  explicit RecordedProblem(const TaylorEvaluator& evaluator)
      : NonlinearProblem(evaluator.record().m(), evaluator.record().n(), {}), evaluator_(evaluator) {}
  // User-supplied functions as an opaque record.
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
  // Same at `count` points side by side, jets as in residuals_side_by_side(). Null: they have to be evaluated one by
  // one. Valid until the next evaluation.
  const LaneBlock* gradient_entries_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets, int order,
                                                 const std::vector<int>& limits);
  // Each equation up to its limit, see TaylorEvaluator::values_within; includes rows that `differentiations` leaves
  // out.
  CallbackError residuals_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits,
                                 int more, double* F);
  CallbackError gradient_entries_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits,
                                        double* values);
  // Same at `count` points side by side, see LaneEvaluator::evaluate_within. Null: as for
  // gradient_entries_side_by_side().
  const LaneEvaluator* evaluate_within(int count, const LaneEvaluator::Points& points,
                                       const std::shared_ptr<const OrderLimits>& limits, bool with_gradients);
  // Counts linearizations made elsewhere.
  void count_linearizations(int count) { linearizations_ += count; }
  // Entries of the last side-by-side evaluation.
  const LaneBlock* last_entries_side_by_side() const { return lanes_.gradients(); }
  // evaluate: calls a function of the evaluator and returns its result.
  template <class Evaluate>
  CallbackError gradients_for(double t, Evaluate evaluate) {
    CallbackError error = stopped(t);
    if (error.status != SFDAE_OK) return error;
    ++linearizations_;
    return evaluate(evaluator_) ? error : failure(t);
  }
  // Error of the last evaluation that failed.
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
