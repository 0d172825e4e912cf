// Error estimate of sensitivities for Radau steps: that of x (radau_error_estimate.h), for all columns of S at once.
//
// The last points with the slopes of their steps' polynomials are kept for the divided difference of order 2s. Errors
// of what the constraints determine do not count, as for x.
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
  // At a point from which steps start; S, Sdot: n x count.
  void start(double t, const std::vector<double>& S, const std::vector<double>& Sdot);
  bool has_started() const { return count_ > 0; }
  // Reading: as it was; of S with `size` numbers. Throws DamagedArchive.
  void archive(Archive& archive, std::size_t size);
  // Until start() or start_within().
  void forget() { count_ = 0; }
  // S at the stages of a step h from the last point, where the system has solved for them.
  struct Step {
    const RadauMethod& method;
    double h;
    bool forgets_past;  // earlier points do not say how smooth S is
    const std::vector<double>& stages;
  };
  // At the start t of a step that has been solved, where nothing is known of those before: the slope is that of the
  // step.
  void start_within(const Step& step, double t, const std::vector<double>& S);
  // weights: those of each column, which are updated.
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

  // The attempt judged last: from where, its size and embedded error.
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
