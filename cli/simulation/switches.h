// Values of switches: relations, floor and trunc are constant between events.
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

  // Sets switches from their arguments literally, for initial values; returns whether one changed.
  bool set_literally(Values& values);

  // Updates the switches at an event. Time switches get their value after t. A switch that has already changed at this
  // t keeps its value while its argument is zero up to roundoff. Returns whether one changed. only_first: at
  // most one changes, the first.
  bool update(Values& values, bool only_first = false);

  // Functions whose zeros are events.
  int num_roots() const { return static_cast<int>(roots_.size()); }
  void evaluate_roots(Values& values, double* g);
  bool roots_need_derivatives() const { return needs_derivatives_; }

  // Gives the switch of a root the value that holds after its function has risen (+1) or fallen (-1).
  void pass(int root, int direction, Values& values);
  void set(int number, double value, Values& values);
  // After reinit: updates switches whose arguments have changed.
  void forget_moved(Values& before, Values& after);
  int switch_of(int root) const { return roots_[at(root)].number; }

  // The number of a switch that clearly contradicts its argument, an event missed by its root function; -1 for none.
  // Learns the magnitudes of arguments if is_solution. at_start: distances() at the start of the piece; distances that
  // were as large there are rounding errors.
  int contradiction(Values& values, bool is_solution, const std::vector<double>& at_start);

  // Distance of the argument of each switch from the range in which its value holds; 0: it holds.
  std::vector<double> distances(Values& values);

  // The value that a switch should have.
  double wanted(Values& values, int number);

  // The next time at which a time switch changes. If not after t, the change is due, and update() makes it.
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
  std::vector<double> passed_at_;  // time of the last change of each switch; NaN: none yet
  bool needs_derivatives_ = false;
};

}  // namespace sfdae::cli
