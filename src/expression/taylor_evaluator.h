// Taylor coefficients of recorded equations along a jet, and of their gradients.
//
// [GW08] A. Griewank, A. Walther: Evaluating Derivatives, 2nd ed. SIAM, 2008. Chapter 13.
//
// Values: one forward sweep in truncated power series. Gradients: a backward sweep for each equation, over the part
// of the graph that it depends on. With the adjoint v~ of a value v, again a power series,
//     F(x + dx) - F(x) = v~ dv + O(dv^2),     v = f(a):  a~ += f'(a) v~,
// so that the coefficients of x~_j and of x'~_j are those of F_x and F_x'.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "expression/diagnosis.h"
#include "expression/domain_boundary.h"
#include "expression/equation_source.h"
#include "expression/order_limits.h"
#include "expression/record.h"
#include "expression/tape.h"
#include "expression/varying_entries.h"
#include "linalg/index.h"

namespace sfdae::core {

// Highest orders, 0 ... 62; -1: none.
struct SeriesOrders {
  int F = -1, F_xdot = -1, F_x = -1;
  int of_gradients() const { return F_xdot > F_x ? F_xdot : F_x; }
  int highest() const { return F > of_gradients() ? F : of_gradients(); }
};

class TaylorEvaluator {
 public:
  // source: evaluates equations without formulas; null: the record does. Only one evaluator at a time uses it.
  explicit TaylorEvaluator(std::shared_ptr<const Record> record, std::shared_ptr<EquationSource> source = nullptr);
  // Shares the recording, and copies the present values of parameters.
  TaylorEvaluator(const TaylorEvaluator& other) = default;
  TaylorEvaluator& operator=(const TaylorEvaluator&) = delete;

  const Record& record() const { return *record_; }
  const std::shared_ptr<const Record>& shared_record() const { return record_; }
  const Tape& tape() const { return tape_; }

  // Along x(t + s) = sum x_k s^k. jet: n x (order + 2), column k is x_k. F: m x (order + 1), column k holds the Taylor
  // coefficients F_k of F(t + s, x(t + s), x'(t + s)). False: see failure(); the output is undefined. limits: none, or
  // the highest order of each equation that is used.
  bool values(double t, const double* jet, int order, double* F, const std::vector<int>* limits = nullptr);
  // Same for the chosen equations alone; others are not touched. Not for equations of a source.
  bool values_of(const std::vector<int>& equations, double t, const double* jet, int order, double* F);

  // Coefficients of F and of the matrices F_x' and F_x: order k is the m x n matrix at k m n. The order of the jet is
  // the highest one requested; outputs of order -1 are not touched and may be null. limits: none, or the highest order
  // wanted of each equation; gradients of others are zero, F is not to be used.
  bool gradients(double t, const double* jet, SeriesOrders orders, double* F, double* F_xdot, double* F_x,
                 const std::vector<int>* limits = nullptr);

  // Gradients without identical zeros: the Taylor coefficients of the derivative by tape().targets[e] from values[e
  // (order + 1)] on, those of equation i up to the order limits[i]; others are not touched. jet: of order + 1.
  bool entries(double t, const double* jet, int order, const std::vector<int>& limits, double* values);

  // Values and entries as above, each equation up to its limit + more, if that is not negative; others are not
  // evaluated. Values: m x (highest + more + 1), entries: from values[e (highest + 1)] on. Only the columns of the jet
  // that these orders need are read. There is no allocation after prepare() while limits stay and `more` is not
  // positive.
  bool values_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits, int more,
                     double* F);
  bool entries_within(double t, const double* jet, const std::shared_ptr<const OrderLimits>& limits, double* values);
  void prepare(const std::shared_ptr<const OrderLimits>& limits) {
    if (!source_) reserve(limits->highest, limits);
  }

  // As entries() of order 0, with `values` from the last call with `varying`: constant entries are not evaluated again
  // before parameters change.
  bool entries(double t, const double* jet, VaryingEntries& varying, double* values);

  // Relative errors beyond rounding errors: see EquationSource::noise.
  // True if a source, not formulas, evaluates the equations.
  bool has_source() const { return source_ != nullptr; }
  double noise_of_entries() const { return source_ ? source_->noise() : 0.0; }

  // Valid after a call that returned false.
  const EvaluationFailure& failure() const { return failure_; }

  // Infinite derivatives at the boundary of a domain are replaced by those of a point about this far inside.
  void set_movement(Movement movement) { movement_ = std::move(movement); }

  int num_parameters() const { return static_cast<int>(parameters_.size()); }
  // Number of a parameter of the user's.
  std::optional<int> find_parameter(const std::string& name) const;
  double parameter(int i) const { return parameters_[index(i)]; }
  void set_parameter(int i, double value);
  // Number of changes since the equations were recorded.
  long changes_of_parameters() const { return changes_of_parameters_; }

 private:
  // The tape's lists with offsets in place of slots. Empty if both are the same, with one coefficient in a slot: large
  // systems seldom need more, and instructions and edges are the largest part of a recording.
  struct Program {
    InstructionList of_parameters, of_time, of_state;
    InstructionsByOrder by_order;  // in place of of_state where there are limits
    std::vector<Edge> edges;
    std::vector<int> factors;
  };

  const InstructionList& instructions(InstructionList Tape::*of_tape, InstructionList Program::*of_program) const {
    return stride_ == 1 ? tape_.*of_tape : program_.*of_program;
  }
  void reserve(int order) { reserve(order, limits_); }
  void reserve(int order, const std::shared_ptr<const OrderLimits>& limits);
  bool load(double t, const double* jet, int order);
  bool load_within(double t, const double* jet, int more);
  bool note_not_finite();
  struct Pass {
    double t;
    int order;
    bool with_slopes;
    std::optional<int> more;  // than the limit of each equation; none: all to the same order
  };
  void run(const Pass& pass);
  template <class Execute>
  void run_state(const Pass& pass, Execute execute) const;
  void run_before_state(double t, int order);
  bool run_at_boundary(const Pass& pass);
  BoundarySweep sweep_at_boundary(const Pass& pass, BoundarySweep::Unknowns unknowns);
  std::vector<double> residuals_in_slots(int order) const;
  template <class Write>
  bool write_or_diagnose(const Pass& pass, Write write);
  bool varying_entries(double t, const double* jet, const VaryingEntries& varying, double* values);
  bool write_values(int order, double* F, const std::vector<int>* limits);
  bool write_values_within(int more, double* F);
  // Evaluates equation(0), equation(1), ..., equation(count - 1).
  template <class EquationAt>
  bool write_values_of(int count, EquationAt equation, int order, double* F,
                       const std::vector<int>* limits = nullptr);
  template <class Order>
  bool write_value(int equation, Order order, double* F);
  bool write_entries(int order, const std::vector<int>& limits, double* values);
  bool write_gradients(SeriesOrders orders, double* F_xdot, double* F_x, const std::vector<int>* limits);
  template <class Order>
  void sweep_back(int equation, Order order);
  bool ask_for_gradients(double t, const double* jet, SeriesOrders orders, double* F_xdot, double* F_x,
                         const std::vector<int>* limits);
  void clear_gradients(SeriesOrders orders, double* F_xdot, double* F_x) const;
  bool write_adjoints(int equation, SeriesOrders orders, double* F_xdot, double* F_x) const;
  template <class CoefficientsOf>
  bool write_targets(int equation, SeriesOrders orders, double* F_xdot, double* F_x,
                     CoefficientsOf coefficients_of) const;
  bool fail(int equation, int order, int order_of_gradients);

  std::shared_ptr<const Record> record_;
  std::shared_ptr<EquationSource> source_;
  std::shared_ptr<const Tape> shared_tape_;
  const Tape& tape_ = *shared_tape_;
  std::shared_ptr<const OrderLimits> limits_;  // that the program is made for, or null
  Program program_;
  std::vector<double> parameters_;
  int stride_ = 0;  // of slots
  std::vector<double> slots_, adjoints_;
  bool parameters_changed_ = true;
  long changes_of_parameters_ = 0;
  double time_ = 0.0;    // at which values that depend on t alone are known,
  int time_order_ = -1;  // to this order
  Movement movement_;
  FailedEquation failed_{};
  EvaluationFailure failure_;
};

}  // namespace sfdae::core
