// Error estimate of sensitivities for Radau steps: that of x (radau_error_estimate.h), for all columns of S at once.
//
// The last points with the slopes of their steps' polynomials are stored for the divided difference of order 2s. As for
// x, errors in directions that constraints determine are ignored.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "integrate/error_weights.h"
#include "integrate/hermite_table.h"
#include "integrate/radau_control.h"
#include "integrate/radau_method.h"
#include "integrate/radau_node.h"
#include "linalg/archive.h"
#include "system/sensitivity_system.h"

namespace sfdae::core {

class SensitivityErrorEstimate {
 public:
  // Starts at a point from which steps start; S, Sdot: n x count.
  void start(double t, const std::vector<double>& S, const std::vector<double>& Sdot);
  bool has_started() const { return count_ > 0; }
  // Reading restores the state; S has `size` numbers. Throws DamagedArchive.
  void archive(Archive& archive, std::size_t size);
  // Stops the estimate until start() or start_within().
  void forget() { count_ = 0; }
  // S at the stages of a step h from the last point, at which the system has solved for them.
  struct Step {
    const RadauMethod& method;
    double h;
    bool forgets_past;  // earlier points do not show the smoothness of S
    const std::vector<double>& stages;
  };
  // Starts at the start t of a step that has been solved, without previous points: the slope is that of the step.
  void start_within(const Step& step, double t, const std::vector<double>& S);
  // weights: one for each column; they are updated.
  ErrorTerms estimate(SensitivitySystem& system, const Step& step, std::vector<ErrorWeights>& weights);
  // The step estimated last has been taken.
  void append();

 private:
  void update(std::vector<ErrorWeights>& weights, double h);
  double norm(const std::vector<ErrorWeights>& weights, double exponent) const;
  double norm(const std::vector<ErrorWeights>& weights) const;
  void judge_several_stages(SensitivitySystem& system, const Step& step, const std::vector<ErrorWeights>& weights,
                            ErrorTerms& terms);
  void add_decay(SensitivitySystem& system, const Step& step, const std::vector<ErrorWeights>& weights,
                 ErrorTerms& terms);
  void reserve(std::size_t size);
  std::size_t size() const { return end_.w.size(); }

  // The attempt judged last: its start, its size and its embedded error.
  struct Attempt {
    double t = 0.0, h = 0.0, embedded = 0.0;
  };
  bool is_jump_at_start(const Attempt& attempt) const;

  Attempt last_;
  std::vector<RadauNode> nodes_;  // the newest first; w is S
  int count_ = 0;
  RadauNode end_;
  HermiteTable table_;
  std::vector<double> difference_, mapped_, columns_, largest_, nearby_;
};

}  // namespace sfdae::core
