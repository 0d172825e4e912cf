// Steps that end where conditions on x switch, so that variables can jump there (docs/design/steps.md).
//
// Usually steps cross such times: the error test monitors w. With differentiated equations this is not enough, because
// both ends of a step may be consistent although E x has to jump between them. If a condition has switched in a step
// and E x has moved differently from the slopes, the step is repeated with the branches of its start held. The
// equations are then smooth, also beyond the zero of the condition, which steps from the same point locate. The last of
// these is accepted. Then the branch changes, and with it x, by impulses of the new equations if E x cannot stay. The
// same is done after failed steps. Conditions may also switch back within a step: if its end does not show their
// effect, the step ends in between.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "expression/held_conditions.h"
#include "expression/regularized_conditions.h"
#include "integrate/integrator.h"
#include "integrate/movement_test.h"
#include "linalg/archive.h"
#include "system/model.h"

namespace sfdae::core {

class ConditionSteps {
 public:
  enum class Verdict { accepted, again };

  // n: number of unknowns. conditions: may be null; not owned.
  void resize(HeldConditions* conditions, std::size_t n);
  // x has changed at the last point; branches that are held remain held.
  void start() { known_ = std::numeric_limits<double>::quiet_NaN(); }
  // Branches have changed; steps continue from these values of x.
  void start_after_change(const std::vector<double>& x);
  // Called before start_after_change(): the conditions whose branches have changed.
  std::vector<PassedSwitch> changed() const;

  // After a successful attempt: true if conditions switch in the step, or branches are held.
  bool explain_step(const Integrator& integrator);
  // After a successful attempt: accepts it, or the next one from the same point ends at end(). Sensitivities jump where
  // x' does: with_sensitivities, any condition is located at which residuals jump.
  Verdict judge(const Integrator& integrator, bool with_sensitivities);
  std::optional<double> end() const { return next_.end; }
  // After a successful attempt: true if conditions switch back within it unnoticed; then the next one ends at end().
  bool ends_between_switches(const Integrator& integrator);
  // After a successful attempt in which a condition that cannot be held has switched while E x moved differently from
  // the slopes: true, and the next one ends at end(). Throws Failure if E x jumps.
  bool steps_with_jump(const Integrator& integrator);
  // Afterwards, without branches held: true if x, or sensitivities, may have jumped in the step.
  bool may_jump(const Integrator& integrator, bool with_sensitivities);
  // After any failed step: true if the next attempt has the same size.
  bool is_tried_with_branches_held(const Integrator& integrator, StepOutcome outcome);
  // True if branches should have been held but these equations cannot hold them.
  bool lacks_branches() const { return obstacle_.lacks_branches && !obstacle_.is_accepted; }
  void go_on_without_branches() { obstacle_.is_accepted = true; }
  // The conditions that have switched in the step judged last, if it is accepted.
  std::vector<PassedSwitch> passed() const;
  // The step judged last has been taken.
  void commit(const Integrator& integrator);
  // Throws Failure if x moves along a surface while another condition stays so close to zero that its sign is
  // uncertain.
  void demand_distinct(const Integrator& integrator);

  // True if a condition is zero between the last point and x_after() next to it: change_branches() is required before
  // the next step, and leads there.
  bool is_due() const { return is_due_; }
  double t_after() const { return after_.t; }
  const std::vector<double>& x_after() const { return after_.x; }
  // t, or the point just after the last zero if t is within its interval.
  double beside(double t) const { return (t - passed_.from) * (t - passed_.to) <= 0.0 ? passed_.to : t; }
  // The values after the zero, with branches that agree with them; values_after computes values by impulses, with the
  // branches held. Must be followed by start_after_change(), or by restore_branches(), also if it throws Failure.
  ConsistentPoint change_branches(const Integrator& integrator, const std::function<ConsistentPoint()>& values_after);

  // The conditions of the surfaces along which x moves, if the last change_branches() failed because they switched
  // repeatedly; otherwise empty.
  const std::vector<RegularizedCondition>& sliding() const { return passed_.sliding; }

  // dt/dp of that zero, see ConditionFunctions::shifts. Throws Failure if the derivative does not exist.
  std::vector<double> shifts(const ConsistentPoint& at, ConstView S, const std::vector<int>& parameters);

  // Sets the branches of the equations to those of the last point.
  void restore_branches();
  bool is_plain() const { return !is_held_ && !is_due_; }
  void archive(Archive& archive);

 private:
  struct Attempt {
    double t = 0.0;
    std::vector<double> x, g;
  };
  bool has_switched(const std::vector<double>& g) const;
  bool jumps_at_zero(const Integrator& integrator, std::size_t k);
  bool switches_ahead(const Integrator& integrator, StepOutcome outcome);
  void note_obstacle(const Integrator& integrator);
  bool is_idle(const Integrator& integrator, const std::vector<double>& before);
  bool stays_at_passed(const Integrator& integrator);
  void take_attempt(const Integrator& integrator);
  void find_slopes(const Integrator& integrator, double t, const std::vector<double>& x, std::vector<double>& slopes);
  void evaluate(const Integrator& integrator, double t, const std::vector<double>& x, std::vector<double>& g);
  bool moves_as_slopes_say(const Integrator& integrator);
  bool are_kinks(const Integrator& integrator);
  void find_switches(const PointsOfCurve& points);
  void find_sampled(const PointsOfCurve& points);
  std::optional<double> first_hidden(const PointsOfCurve& points, const std::vector<double>& times);
  void find_branches(const Integrator& integrator);
  void hold();
  void release();
  Verdict locate(const Integrator& integrator);
  void find_tolerances(const Integrator& integrator, const double* x);
  double distance(const Integrator& integrator);
  double next_end(const Integrator& integrator, double distance);
  std::size_t contradiction(const Integrator& integrator, const ConsistentPoint& after,
                            const std::vector<double>& branches);
  void demand_progress(const Integrator& integrator);

  HeldConditions* conditions_ = nullptr;
  MovementTest movement_;
  double known_ = std::numeric_limits<double>::quiet_NaN();  // branches_ are those of the last point, at this time
  std::vector<double> branches_;                             // numbers; their signs are the branches
  bool is_held_ = false, is_due_ = false;
  Attempt tried_, before_, after_;  // the last attempt; the nearest ones on both sides of the zero
  bool has_after_ = false, is_last_ = false, has_tried_ = false;
  struct Passed {
    double from = 0.0, to = 0.0;   // the points before and after it
    std::vector<double> x;         // at the second one
    std::vector<double> branches;  // after the zero, found by change_branches()
    std::vector<int> visits;       // for each condition: number of switches while E x did not move
    std::vector<RegularizedCondition> sliding;
    bool has_moved = false;  // true if E x has moved since
    bool are_kinks = false;  // conditions have switched repeatedly while residuals were continuous
  };
  Passed passed_;  // the zero passed last
  struct Obstacle {
    std::vector<double> x;  // the last point at the first failure
    int failures = 0;       // since then, while E x did not move
    bool lacks_branches = false, is_accepted = false;
  };
  Obstacle obstacle_;  // for steps that fail because branches cannot be held
  struct Nearness {
    std::vector<char> is_near;  // conditions that have been near zero all the time since
    std::vector<double> x;      // the point where the first of them came near
    std::vector<double> gradients;
  };
  Nearness near_;
  struct Next {
    std::optional<double> end;     // of the next attempt
    int slow = 0;                  // consecutive attempts that have not halved the interval
    std::vector<double> times, g;  // within the step tried, where it may end; of all conditions at one of them
  };
  Next next_;
  std::vector<double> slopes_, slopes_before_, change_, tolerances_;
};

}  // namespace sfdae::core
