// The user's functions E, A, f of a linear problem: called, checked, counted, differentiated where necessary.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "linalg/archive.h"
#include "problem/taylor_data.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// What went wrong in a callback. status: SFDAE_OK, _CALLBACK_STOPPED, _CALLBACK_FAILED, _NOT_FINITE, _ORDER_MISSING
// or _STOPPED (a stop request).
struct Trouble {
  int status = SFDAE_OK;
  const char* function = "";
  int order = 0;
  int code = 0;      // what the callback returned
  int row = 0;       // of the first entry that is not finite
  int column = 0;
  double t = 0.0;

  // A smaller step may help.
  bool is_recoverable() const { return status == SFDAE_CALLBACK_FAILED || status == SFDAE_NOT_FINITE; }
  std::string message() const;
};

// How derivatives that callbacks do not provide are computed.
struct DifferenceOptions {
  bool allowed = false;
  double step = 0.0;  // 0: chosen
  double span = 1.0;  // length of the interval of interest, a first guess for the step
};

class LinearProblem {
 public:
  explicit LinearProblem(const sfdae_linear_problem& problem);

  int m() const { return problem_.num_equations; }
  int n() const { return problem_.num_unknowns; }
  bool is_constant() const { return problem_.constant_E != 0 && problem_.constant_A != 0; }
  bool is_constant_E() const { return problem_.constant_E != 0; }
  bool is_constant(char which) const { return functions_[slot(which)].constant; }
  const std::vector<int>& prescribed() const { return prescribed_; }

  // Derivatives up to the orders asked for, scaled to Taylor coefficients with the given time scale (0: chosen).
  // A stop request ends the evaluation with SFDAE_STOPPED.
  // preferred_rows: as for TaylorData::scale.
  Trouble evaluate(double t, Orders orders, double time_scale, TaylorData& data, RowScaling rows = RowScaling::each,
                   const std::vector<double>* preferred_rows = nullptr);
  // evaluate() multiplies column j of E and A by scale[j] (powers of two) from now on: unknowns x_j / scale[j]. Empty: 1.
  void set_column_scale(std::vector<double> scale) { column_scale_ = std::move(scale); }
  const std::vector<double>& column_scale() const { return column_scale_; }
  // Plain derivatives of the orders asked for, unscaled.
  Trouble evaluate_plain(double t, Orders orders, TaylorData& data);
  // Values of the prescribed components.
  Trouble evaluate_prescribed(double t, double* values);

  // One derivative straight from the callback: which = 'E', 'A' or 'f'. No differences.
  Trouble call(char which, double t, int order, double* values);

  // Also forgets which orders were not available.
  void set_differences(const DifferenceOptions& options);
  // Evaluations within [lowest, highest] take no differences from outside.
  void set_limits(double lowest, double highest) {
    lowest_t_ = lowest;
    highest_t_ = highest;
  }

  // The limit behind, for integration in a direction.
  double limit_behind(double direction) const { return direction > 0.0 ? lowest_t_ : highest_t_; }
  // Distance from t to the limit in a direction (+1 or -1).
  double room(double t, double direction) const { return direction > 0.0 ? highest_t_ - t : t - lowest_t_; }

  // Length of the interval of interest.
  double span() const { return differences_.span; }

  // Units of the unknowns and what was found out about derivatives.
  void archive(Archive& archive);

  long evaluations(char which) const { return functions_[slot(which)].calls; }
  void request_stop() { stop_requested_.store(true, std::memory_order_relaxed); }
  // True once for every request.
  bool take_stop_request() { return stop_requested_.exchange(false, std::memory_order_relaxed); }
  bool stop_is_requested() const { return stop_requested_.load(std::memory_order_relaxed); }

 private:
  struct Function {
    char name;
    int rows, columns;
    bool constant;
    long calls = 0;
    int highest_order = std::numeric_limits<int>::max();  // known to be available
    double difference_step = 0.0;                          // 0: not chosen yet
    std::vector<double> constant_value;
  };

  static std::size_t slot(char which) { return which == 'E' ? 0u : which == 'A' ? 1u : 2u; }
  Trouble fill(Function& function, double t, int order, double* values, double* errors);
  // errors[k]: of the k-th derivative, relative to the largest value of the function.
  Trouble differentiate(Function& function, double t, int first, int last, double* values, double* errors);
  // The step is made smaller where the limits are too close.
  Trouble sample(Function& function, double t, double& step, std::vector<double>& samples, int& shift);
  Trouble choose_difference_step(Function& function, double t, int last);

  sfdae_linear_problem problem_;
  std::vector<int> prescribed_;
  std::vector<double> column_scale_;
  std::array<Function, 3> functions_;
  DifferenceOptions differences_;
  double lowest_t_ = -std::numeric_limits<double>::infinity();
  double highest_t_ = std::numeric_limits<double>::infinity();
  std::atomic<bool> stop_requested_{false};
};

}  // namespace sfdae::core
