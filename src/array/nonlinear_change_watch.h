// Changes of the characteristic values of a nonlinear problem, noticed between steps and located.
//
// x is known at points of the integration only, and equations are linearized at some of these. Signs and sizes there
// raise suspicions, as for linear problems (linear_change_watch.h). The interpolated solution dismisses them or shows
// where a shorter step is needed. A change found in a short step is reported (docs/design/singular_points.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "array/nonlinear_system.h"
#include "array/singularity_sample.h"
#include "array/singularity_search.h"
#include "array/structural_witness.h"
#include "system/change_watch.h"

namespace sfdae::core {

class NonlinearChangeWatch final : public ChangeWatch {
 public:
  explicit NonlinearChangeWatch(NonlinearSystem& system)
      : system_(system), search_(system.analyzed_equations(), system.linearization(), system.callback_error()) {}
  void start(double direction) override;
  StepSearch find(double t_last) override;
  void accept() override;
  // x is unknown between steps: shortened steps locate a change.
  std::optional<LocatedChange> locate(double, double) override { return std::nullopt; }
  std::optional<LocatedChange> find_ahead(double h) override;
  std::optional<LocatedChange> find_beyond() override;
  // Nothing is archived: the watch restarts at the last accepted point.
  void archive(Archive& archive, double direction) override;

 private:
  // The values of A2 or E T2: the largest sample so far, and the smallest one since.
  struct Fall {
    double highest = 0.0, lowest = 0.0;
    Jet at_highest, at_lowest;
    bool has_turned = false;  // a sign, from one sample to another
  };

  bool is_after(double t, double then) const { return (t - then) * direction_ > 0.0; }
  void take_samples();
  std::optional<LocatedChange> find_in_samples(double t_last);
  bool is_suspicious(const SingularitySample& now);
  bool is_short(double t_last) const;
  std::optional<LocatedChange> find_passed(bool is_turned);
  bool has_passed_zero(const Fall& fall, const Jet& now);
  std::optional<double> search_dips(const SingularitySample* older, const SingularitySample& last,
                                    const SingularitySample& now);
  std::optional<LocatedChange> change_at(double t, double t_last);
  bool is_confirmed_ahead(double t, double h) const;
  bool is_never_singular();
  std::optional<double> kept_consistently(double t);
  StructuralWitness& witness();
  void shift(SingularitySample& sample);
  void set_next_look();

  NonlinearSystem& system_;
  SingularitySearch search_;
  Arena arena_;
  double direction_ = 1.0;
  SingularitySample older_, last_;  // of accepted points; signs are compared with the last one
  int samples_ = 0;
  SingularitySample within_, end_;  // of the step that is tried
  bool has_within_ = false, has_end_ = false;
  bool is_within_sure_ = false;          // its jet has converged
  double next_look_ = 0.0;               // a linearly extrapolated value is zero then
  int failures_ = 0, next_failure_ = 0;  // of steps; when to look ahead
  std::optional<double> expected_;       // the singular point, from the last look ahead
  Fall falls_[2];
  Jet first_;  // of the integration
  // The structural analysis; made when it is first needed.
  std::optional<StructuralWitness> witness_;
  // The singular point found last, and the size of the step in which it was found.
  struct Suspect {
    double t, step;
    bool is_near(double time) const { return std::fabs(time - t) <= step; }
  };
  std::optional<Suspect> suspect_;
};

}  // namespace sfdae::core
