// Values of switches: relations, floor and trunc keep theirs between events.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "simulation/tape.h"
#include "simulation/time_rounding.h"

namespace sfdae::cli {

class Switches {
 public:
  // interval: length of the simulation.
  Switches(const System& system, double interval);

  // As arguments say, to the letter: for initial values.
  bool set_literally(Values& values);

  // At events. Switches by time have the value that holds after t. Those that have changed at this t already keep their
  // value while their argument is where they change, but for rounding. Returns whether one changed. only_first: at most
  // one changes, the first.
  bool update(Values& values, bool only_first = false);

  // Functions whose zeros are events.
  int num_roots() const { return static_cast<int>(roots_.size()); }
  void evaluate_roots(Values& values, double* g);
  bool roots_need_derivatives() const { return needs_derivatives_; }

  // The switch of a root has the value that holds after its function has risen (+1) or fallen (-1).
  void pass(int root, int direction, Values& values);
  void set(int number, double value, Values& values);
  // After reinit: switches whose arguments have moved take their values from them.
  void forget_moved(Values& before, Values& after);
  int switch_of(int root) const { return roots_[at(root)].number; }

  // A switch that contradicts its argument clearly, which is an event that its root function did not show: -1 for
  // none. Learns the sizes of arguments where is_solution. at_start: distances() at the start of the piece; what was
  // as far on the wrong side there was rounding.
  int contradiction(Values& values, bool is_solution, const std::vector<double>& at_start);

  // How far the argument of each switch is from where its value holds, 0: it holds.
  std::vector<double> distances(Values& values);

  // The value that a switch should have.
  double wanted(Values& values, int number);

  // The next time at which one by time leaves its value. Not after t: it is due, and update() changes it.
  std::optional<double> next_time(Values& values);

 private:
  struct Root {
    int number;
    int bound;  // of floor and trunc: 0 lower, 1 upper
  };

  double literal(const Switch& it, double g) const;
  double outside(const Switch& it, double g, double value) const;
  double offset(int number) const { return arguments_[static_cast<int>(system_.switches.size()) + number]; }
  std::optional<double> time_of_change(int number, double value) const;
  double value_after(int number, double t) const;

  const System& system_;
  TimeRounding rounding_;
  Tape arguments_;  // g of every switch, then offsets of those by time
  std::vector<Root> roots_;
  std::vector<double> sizes_;
  std::vector<double> passed_at_;  // when each switch changed last; NaN: not yet
  bool needs_derivatives_ = false;
};

}  // namespace sfdae::cli
