// Evaluates recorded equations at several points in one pass of their tape: values and Taylor coefficients that equal
// those of TaylorEvaluator bit by bit, gradients, and coefficients of gradients.
//
// The tape and the parameters belong to a TaylorEvaluator; this object is the additional memory of one thread.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "linalg/index.h"
#include "linalg/lanes.h"

namespace sfdae::core {

class LaneEvaluator {
 public:
  static constexpr int highest_order = 2;
  // x(t + s) = sum x_k s^k: x[k] points to the unknowns. Coefficients beyond the order (beyond the next order, if x'
  // occurs) are not read.
  struct Points {
    const LaneBlock* t;
    std::array<const LaneBlock*, highest_order + 2> x;
  };
  // Jets of order + 1 of n unknowns, coefficient after coefficient.
  static Points points_of(const LaneBlock* t, const LaneBlock* jets, int order, int n) {
    Points points{t, {}};
    for (int k = 0; k <= order + 1; ++k) points.x[index(k)] = jets + static_cast<std::ptrdiff_t>(k) * n;
    return points;
  }

  // Coefficients of F up to the order, and F_x if asked for. Returns false if anything is not finite at any of the
  // points; the TaylorEvaluator can tell the reason. F_x is for equations without x' alone.
  bool evaluate(const TaylorEvaluator& source, const Points& points, int order, bool with_gradients);

  // Coefficients of F_x and F_x' up to limits[i], at most the order, of equation i: gradients(), those of target e of
  // the tape from e (order + 1) on; coefficients beyond limits are undefined. False: as above.
  bool evaluate_entries(const TaylorEvaluator& source, const Points& points, int order,
                        const std::vector<int>& limits);

  // Values and coefficients of gradients, those of each equation up to its limit; the highest one is at most
  // highest_order, and gradients have so many places and one more for each target.
  bool evaluate_within(const TaylorEvaluator& source, const Points& points,
                       const std::shared_ptr<const OrderLimits>& limits, bool with_gradients);

  // Value of equation i, coefficient after coefficient.
  const LaneBlock* value(int i) const { return slots_.data() + values_[index(i)]; }
  // Entries of F_x that can differ from zero, in the order of the targets of the tape.
  const LaneBlock* gradients() const { return gradients_.data(); }

 private:
  struct Wanted {
    int order;
    bool with_gradients;
    const int* limits;       // of the orders of gradients; null: 0
    bool are_values_within;  // the limits of the instructions
  };
  bool evaluate_all(const TaylorEvaluator& source, const Points& points, const Wanted& wanted);
  void reserve(const TaylorEvaluator& source, int order, const std::shared_ptr<const OrderLimits>& limits);
  bool parameters_are_new(const TaylorEvaluator& source);

  int stride_ = 0;  // of slots
  // Slots are offsets.
  InstructionList of_parameters_, of_time_, of_state_;
  std::shared_ptr<const OrderLimits> limits_;  // that the instructions are ordered by, or null
  InstructionsByOrder by_order_;               // in place of of_state_ where there are limits
  std::vector<int> factors_, values_;
  LaneArray slots_, adjoints_, gradients_;
  std::vector<double> parameters_;
  LaneBlock t_;
  int time_order_ = -1;  // of values that depend on t alone, at t_; -1: not known
};

}  // namespace sfdae::core
