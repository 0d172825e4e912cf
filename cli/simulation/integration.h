// Integration from start to stop: steps, outputs and events.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "simulation/event_iteration.h"
#include "simulation/output.h"

namespace sfdae::cli {

class Integration {
 public:
  // Components of a simulation.
  struct Parts {
    const System& system;
    const Settings& settings;  // without NaN
    Modes& modes;
    LibraryCalls& calls;
    Switches& switches;
    Discrete& discrete;
    EventIteration& events;
    Output& output;
    Result& result;
  };

  explicit Integration(const Parts& parts);

  // Starts from consistent values. Throws Failure.
  void run(Values& values, sfdae::Point& point);

 private:
  // The last point of the solution.
  struct Reached {
    Values& values;
    sfdae::Point& point;
  };

  void run_to_end(Values& values, sfdae::Point& point);
  void start(Reached& at);
  int step(Reached& at, double target);
  void add_row(Reached& at);
  void add_due_output(Reached& at);
  void add_row_before(const Reached& at, const Values& before);
  bool happens(Reached& at, const std::vector<int>& roots, const std::string& contradiction);
  bool was_elsewhere(const Reached& at, int root);
  void recover_lost_changes(Reached& at, const std::vector<int>& roots);
  bool settle_at_start(Reached& at);
  void finish(Reached& at);
  bool repair(Reached& at, const Values& before, bool is_first);
  std::vector<int> branches_that_end(Reached& at);
  double end_of_step(const Reached& at) const;
  void interpolate(const Reached& at, double t, Values& values, sfdae::Point& point);
  bool set_due_samples(Values& values);
  std::optional<double> next_time_event(Values& values);
  double output_time(long number) const;
  void move_to_due(Reached& at, double t) const;
  bool roots_jump(Values before, Values after);
  void count_event(const std::string& text, const Values& before, const Values& after);
  void add_statistics();
  std::string describe(const std::vector<int>& roots, const Values& before, const Values& after) const;

  Parts parts_;
  TimeRounding rounding_;
  std::shared_ptr<Mode> mode_;
  std::vector<double> key_;  // identifies its equations
  Values root_values_;       // arguments of the event functions
  std::vector<double> roots_at_start_, distances_at_start_;
  std::vector<long> next_sample_;
  sfdae::Statistics baseline_{};  // of the mode, before the current piece
  bool is_piece_open_ = false;    // its statistics have not been added
  bool is_started_ = false, is_first_step_ = true, needs_derivatives_ = false, has_warned_ = false;
  double start_ = 0.0;  // of the current piece
  long next_output_ = 1, num_steps_ = 0;
  // Closely spaced events up to the last one.
  struct CloseEvents {
    double last;
    int count = 0;
    std::vector<int> changes;  // by switch
  } close_events_;
  bool is_over_ = false;  // terminate() acted
};

}  // namespace sfdae::cli
