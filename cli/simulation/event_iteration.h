// Event iteration: all equations are solved with pre() fixed, then pre() takes the new values, until nothing changes
// (Modelica Language Specification 3.6, section 8.6 and appendix B).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulation/discrete.h"
#include "simulation/library_calls.h"
#include "simulation/modes.h"
#include "simulation/switches.h"

namespace sfdae::cli {

struct EventResult {
  bool needs_start = false;  // the integration has to be restarted
  bool is_terminated = false;
  std::string message;             // of terminate
  std::vector<std::string> acted;  // descriptions of when clauses
};

class EventIteration {
 public:
  // interval: length of the time to be simulated.
  EventIteration(const System& system, Modes& modes, LibraryCalls& calls, Switches& switches, Discrete& discrete,
                 double interval, std::vector<std::string>& warnings);

  // In: values and point before the event, with the switches and samples of the event already set. key: identifies the
  // equations that have been integrated. Throws Failure.
  EventResult run(Values& values, sfdae::Point& point, const std::vector<double>& key);

  // After initialization: executes what becomes active when pre() takes the initial values. Relations are taken
  // literally; those of time do not yet have their values after the start. Throws Failure.
  EventResult run_at_start(Values& values, sfdae::Point& point);

  // Checks assertions; those that are warnings are reported once. Throws Failure.
  void check_assertions(Values& values);

 private:
  bool discrete_values_follow(Values& values, std::vector<double>& largest);
  void settle(Values& values, sfdae::Point& point);
  void solve(Values& values, sfdae::Point& point);
  void solve_keeping_states(Values& values, sfdae::Point& point, const std::vector<int>& fixed);
  std::vector<int> with_states(std::vector<int> fixed, const std::vector<char>& of_variable) const;
  bool attempt(Mode& mode, sfdae::Point& point, const std::vector<int>& fixed);
  std::vector<int> states_to_keep(Mode& mode, const sfdae::Point& point, const std::vector<int>& fixed);
  bool react(Values& values, sfdae::Point& point, EventResult& result);
  void assertion_failed(const Reaction& reaction, double t);
  std::string changing(const Values& before, const Values& values) const;

  const System& system_;
  Modes& modes_;
  LibraryCalls& calls_;
  Switches& switches_;
  Discrete& discrete_;
  double interval_;
  std::vector<std::string>& warnings_;
  std::vector<double> solved_key_;
  bool has_solved_ = false;  // equations, at this event
  bool is_at_start_ = false;
  std::vector<char> is_reported_;  // by reaction: assertions that are warnings
};

}  // namespace sfdae::cli
