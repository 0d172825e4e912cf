// Times at which data have kinks or jumps: those of tables in recorded equations, and times given by the user.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "expression/passed_switch.h"
#include "expression/switching_times.h"

namespace sfdae::core {

// The times at which recorded equations switch because of t alone (switching_times.h), and those that the user gives.
class TimeBreakpoints {
 public:
  // Parameters have the values that the evaluators, which must outlive this object, have at the time of a call.
  explicit TimeBreakpoints(const std::vector<const TaylorEvaluator*>& evaluators);

  // The user's times, increasing, in addition to those of tables. jumps: flags of those at which x may jump.
  void set_times(std::vector<double> times, std::vector<char> jumps);
  void take_times(const TimeBreakpoints& other) { set_times(other.times_, other.jumps_); }
  // Adds times to the present ones.
  void add_times(const TimeBreakpoints& other);
  bool has_times() const { return !times_.empty(); }
  std::size_t num_times() const { return times_.size(); }
  // Magnitude of times of the integration, used if the user's times are all 0.
  void set_size(double size);
  // Start of the gap of the user's next time beyond t, and beyond a gap that holds t; infinite: there is none.
  double end_of_piece(double t, double direction) const;

  // With `true`, equations count as smooth functions of t, and only the user's times remain.
  void take_switches_for_smooth(bool are_smooth) { are_smooth_ = are_smooth; }

  // Unknowns depend on derivatives up to this order; those up to the first count in any case.
  void set_differentiations(int count) { differentiations_ = count; }

  // The next time, from t toward another one, at which a step has to end, if there is one; it may be beyond that one. A
  // kink is a time at which values, first derivatives or other derivatives that unknowns depend on may jump: both ends
  // of its gap are such times. The result is t itself if rounding errors alone decide a condition from t on. Allocates
  // nothing.
  struct End {
    double t;
    double slack = 0.0;  // times that differ by less are as good: only derivatives of higher order jump there
  };
  std::optional<End> next(double t, double toward);
  // Times about a kink within which rounding errors decide the side on which functions are evaluated.
  struct Gap {
    double start, end;
    bool is_jump = false;  // of x, too
    bool ends_at(double t) const;
    bool begins_at(double t, double direction) const;
    double far_end(double direction) const { return direction > 0.0 ? end : start; }
  };
  // The gap that holds t; its ends belong to it.
  std::optional<Gap> gap_at(double t);
  // Conditions, floors, remainders and tables of t alone that have switched from one time to another.
  std::vector<PassedSwitch> passed(double from, double to) {
    return are_smooth_ ? std::vector<PassedSwitch>() : switches_.passed(from, to);
  }
  // Returns whether two times are in the gap of one switch without a kink, and so count as one.
  bool are_one(double t, double other);

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Search;

  Search search(double t, double toward);
  void search_inputs(Search& search, double toward);

  void search_times(Search& search) const;

  SwitchingTimes inputs_;
  TimedSwitches switches_;
  std::vector<double> times_;
  std::vector<char> jumps_;
  double size() const;  // the largest of these
  double size_of_times_ = 1.0;
  int differentiations_ = 0;
  bool are_smooth_ = false;
};

}  // namespace sfdae::core
