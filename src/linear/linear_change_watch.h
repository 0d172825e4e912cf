// Changes of the characteristic values of a linear problem during an integration: noticed between steps, located.
//
// A value that vanishes at an isolated point leaves traces: the sign of det[E1; A2] (bases aligned from step to step),
// or smallest kept values of the rank decisions, or sizes of rows, that would run straight through zero if one of them
// had its sign changed. These are only suspicions; locate() confirms them by narrowing the point down.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "linear/change_location.h"
#include "linear/change_trace.h"
#include "linear/linear_system.h"
#include "system/change_watch.h"

namespace sfdae::core {

// For linear problems, where every point can be reduced without a solution.
class LinearChangeWatch final : public ChangeWatch {
 public:
  explicit LinearChangeWatch(LinearSystem& system);
  void start(double direction) override;
  StepSearch find(double t_last) override;
  void accept() override;
  std::optional<LocatedChange> locate(double left, double right) override {
    return locate_change(system_, left, right);
  }
  void archive(Archive& archive, double direction) override;

 private:
  struct Sample {
    double t = 0.0;
    std::vector<double> values;  // kept values of A^ and E T2, then row norms
  };
  static void keep(const ChangeTrace& trace, Sample& sample);
  static bool breaks_trend(const Sample& older, const Sample& last, const ChangeTrace& now);

  LinearSystem& system_;
  Sample older_, last_;
  Sample trend_[2];
  ChangeTrace now_;
  int samples_ = 0;
};

}  // namespace sfdae::core
