// Conditions on x or x' of recorded equations, g(t, x, x') > 0, and the branches of choices: the one by the sign of g,
// or one that is held regardless of g. With branches held, equations are smooth where g passes zero.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "expression/condition_functions.h"
#include "expression/passed_switch.h"
#include "expression/record.h"
#include "expression/sliding_layers.h"
#include "expression/switch_search.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Returns whether equations switch by conditions on x, or on t and parameters.
bool contains_switches(const Record& record);
// Returns the same equations with conditions that can be held and lists of all other switches. layers: nodes that are
// conditions of layers.
std::shared_ptr<const Record> with_conditions(std::shared_ptr<const Record> record,
                                              const std::vector<int>& layers = {});

class HeldConditions {
 public:
  // evaluator: of equations with such conditions, must outlive this object. changed: called when branches change; none:
  // branches cannot be held, as other equations are integrated, and hold() does nothing.
  HeldConditions(TaylorEvaluator& evaluator, std::function<void()> changed);
  // Conditions of user-supplied functions. evaluator: has a source, and these conditions as its equations.
  struct SuppliedResiduals {
    int m;
    std::function<bool(double t, const double* jet, double* F)> evaluate;  // with the branches that are held
  };
  HeldConditions(TaylorEvaluator& evaluator, std::function<void()> changed, SuppliedResiduals supplied);

  // The number of conditions on x or x'.
  std::size_t count() const { return functions_.count(); }
  ConditionFunctions& functions() { return functions_; }
  // The search for switches of conditions on t and x alone, and the numbers of these conditions.
  SwitchSearch& search() { return search_; }
  const std::vector<std::size_t>& searched() const { return searched_; }
  bool is_of_layer(std::size_t condition) const { return conditions_[condition].is_of_layer; }
  // Calls SwitchSearch::find_simple, with values of all conditions.
  bool find_simple_switches(const PointsOfCurve& points, const double* g_start, const double* g_end);
  bool can_be_held() const { return changed_ != nullptr; }
  // From now on equations take the branches of these values of g.
  void hold(const double* g);
  // From now on equations take the branches of g itself.
  void release();
  // The layers of these equations, which must outlive this object; null: none.
  SlidingLayers* layers() const { return layers_; }
  void set_layers(SlidingLayers* layers) { layers_ = layers; }
  // Returns the equation that contains a condition, as messages call it.
  std::string equation_with(std::size_t condition) const;

  // Returns the conditions with other branches at the second values of g than at the first. Their times are the zeros
  // of g interpolated linearly. Edges of layers are left out.
  struct Values {
    double t;
    const std::vector<double>& g;
  };
  std::vector<PassedSwitch> passed(const Values& before, const Values& after) const;

  using Point = ConditionFunctions::Point;
  // Behavior of residuals at the zero of condition k on the line between two points at which its signs differ, with the
  // other conditions as these values of g have them: a jump, a kink, or no dependence.
  enum class Passing { jump, kink, nothing };
  Passing passing(std::size_t k, const double* g, const Point& from, const Point& to);

  // Finds the first of the points between two others at which branches change residuals more than at the second of the
  // two, `to`, so that `to` does not show it. Compares the branches of g at a point with those of the given values of
  // g. The uncertainty of g is its change as x changes by `changes`.
  std::optional<std::size_t> first_hidden(const double* g, const std::vector<Point>& between, const Point& to,
                                          const double* changes);

  // Functions of t alone that switch equations, at times that depend on parameters.
  ConditionFunctions& timed_functions() { return timed_functions_; }
  // timed_switches: those that switch from one time to another, some rounding errors later, unless they jump
  // themselves, where others switch. jumps_between: whether residuals at this x jump there, also compared with an
  // earlier time.
  std::vector<std::size_t> timed_switches(double from, double to);
  bool jumps_between(double from, double to, double earlier, const double* x);

  // Arguments of floors, remainders and tables that depend on x or x'; their branches cannot be held. stepped_switch:
  // one that switches from one point to another.
  ConditionFunctions& stepped_functions() { return stepped_functions_; }
  std::optional<std::size_t> stepped_switch(const Point& from, const Point& to);
  std::string equation_with_stepped(std::size_t which) const;

 private:
  std::string equation_with_node(int node) const;
  double value_on_line(std::size_t k, const Point& from, const Point& to, double part);
  bool residuals(double t, const double* jet, const double* g, std::vector<double>& F);
  bool changes_of_branches(const Point& at, const double* g, const double* changes, std::vector<double>& result);
  bool leaves_no_trace(const Point& at, const double* g, const double* changes);

  TaylorEvaluator& evaluator_;
  std::function<void()> changed_;
  SuppliedResiduals supplied_;
  const std::vector<Condition>& conditions_;
  ConditionFunctions functions_, timed_functions_, stepped_functions_;
  std::vector<std::size_t> searched_;
  SwitchSearch search_;
  bool are_held_ = false;
  SlidingLayers* layers_ = nullptr;
  std::optional<TaylorEvaluator> beside_;  // of the same equations, for points that are looked at
  struct {
    std::vector<double> start, end;
  } g_searched_;
  std::vector<double> jet_, values_, other_, at_end_, here_, on_line_;
  struct {
    std::vector<double> before, after;
  } stepped_branches_;
};

}  // namespace sfdae::core
