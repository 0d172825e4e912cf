// Steps that end where conditions on x switch, so that what jumps there jumps (docs/design/steps.md).
//
// As a rule steps lead across such times: the error test sees what w does. With derivatives of equations that is not
// enough, as both ends of a step may be consistent though E x has to jump between them. If a condition has switched in
// a step and E x has moved otherwise than its slopes say, the step is tried again with the branches of its start held:
// equations are smooth then, also beyond the zero of the condition, which is located by steps from the same point. The
// last of these is accepted. Then the branch changes, and with it x, by impulses of the new equations where E x cannot
// stay. The same is done where steps fail. Conditions may also switch back within a step: where its end does not show
// what they do to the equations in between, the step ends in between.
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

  // n: unknowns. conditions: may be null; they live longer.
  void resize(HeldConditions* conditions, std::size_t n);
  // x has changed at the last point; branches that are held stay.
  void start() { known_ = std::numeric_limits<double>::quiet_NaN(); }
  // Branches have changed, and the steps go on with these values of x.
  void start_after_change(const std::vector<double>& x);
  // Before that: returns the conditions whose branches have changed.
  std::vector<PassedSwitch> changed() const;

  // A step has been tried with success: whether conditions switch in it, or branches are held.
  bool explain_step(const Integrator& integrator);
  // The same: it is accepted, or the next one, from the same point, ends at end(). With
  // sensitivities these jump where x' does: any condition is located where residuals jump.
  Verdict judge(const Integrator& integrator, bool with_sensitivities);
  std::optional<double> end() const { return next_.end; }
  // A step has been tried with success: whether the next one ends at end(), as conditions do what its ends do not show.
  bool ends_between_switches(const Integrator& integrator);
  // A step has been tried with success, in which what cannot be held has switched, and E x moves otherwise than slopes
  // say: the next one ends at end(). Throws Failure where E x jumps.
  bool steps_with_jump(const Integrator& integrator);
  // Then, without branches held: whether x, or sensitivities, may have jumped in it.
  bool may_jump(const Integrator& integrator, bool with_sensitivities);
  // A step has failed, for whatever reason: whether the next attempt is of the same size.
  bool is_tried_with_branches_held(const Integrator& integrator, StepOutcome outcome);
  // Branches should have been held there, and these equations cannot hold them.
  bool lacks_branches() const { return obstacle_.lacks_branches && !obstacle_.is_accepted; }
  void go_on_without_branches() { obstacle_.is_accepted = true; }
  // Returns the conditions that have switched in the step judged last, if it is accepted.
  std::vector<PassedSwitch> passed() const;
  // The step judged last has become the last one.
  void commit(const Integrator& integrator);
  // Throws Failure where x moves along a surface, and another condition stays so near to its zero that it cannot be
  // known on which side it is.
  void demand_distinct(const Integrator& integrator);

  // A condition is zero between the last point and another one, next to it: change_branches() is due before the next
  // step, and leads there.
  bool is_due() const { return is_due_; }
  double t_after() const { return after_.t; }
  const std::vector<double>& x_after() const { return after_.x; }
  // t, or the point behind such a zero that is next to t.
  double beside(double t) const { return (t - passed_.from) * (t - passed_.to) <= 0.0 ? passed_.to : t; }
  // Returns the values after the zero, with branches that agree with them; values_after computes values by impulses,
  // with the branches that are held. start_after_change() has to follow, or restore_branches(), as where this throws
  // Failure.
  ConsistentPoint change_branches(const Integrator& integrator, const std::function<ConsistentPoint()>& values_after);

  // Returns the conditions of the surfaces that x moves along, if change_branches() failed last because they switched
  // again and again; else none.
  const std::vector<RegularizedCondition>& sliding() const { return passed_.sliding; }

  // Returns dt/dp of that zero: ConditionFunctions::shifts. Throws Failure where there is no such derivative.
  std::vector<double> shifts(const ConsistentPoint& at, ConstView S, const std::vector<int>& parameters);

  // Gives the equations the branches of the last point.
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
  std::vector<double> branches_;                             // numbers with their signs
  bool is_held_ = false, is_due_ = false;
  Attempt tried_, before_, after_;  // the last attempt; the nearest ones on both sides of the zero
  bool has_after_ = false, is_last_ = false, has_tried_ = false;
  struct Passed {
    double from = 0.0, to = 0.0;   // the points before and after it
    std::vector<double> x;         // at the second one
    std::vector<double> branches;  // that it leads to, as change_branches() has found them
    std::vector<int> visits;       // of each condition: how often it switched while E x did not move
    std::vector<RegularizedCondition> sliding;
    bool has_moved = false;  // E x has, since
    bool are_kinks = false;  // conditions have switched again and again where residuals are continuous
  };
  Passed passed_;  // the zero passed last
  struct Obstacle {
    std::vector<double> x;  // the last point at the first failure
    int failures = 0;       // since then, while E x did not move
    bool lacks_branches = false, is_accepted = false;
  };
  Obstacle obstacle_;  // of steps that fail where branches cannot be held
  struct Nearness {
    std::vector<char> is_near;  // conditions, all the time since
    std::vector<double> x;      // the point where the first of them came near
    std::vector<double> gradients;
  };
  Nearness near_;
  struct Next {
    std::optional<double> end;  // of the next attempt
    int slow = 0;               // attempts in a row that have not halved the interval
  };
  Next next_;
  std::vector<double> slopes_, slopes_before_, change_, tolerances_;
};

}  // namespace sfdae::core
