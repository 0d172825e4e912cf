// Times at which data have kinks or jumps: where tables of recorded equations have, and where the user says so.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "expression/switching_times.h"

namespace sfdae::core {

// Where what recorded equations compute from t alone switches to another branch (switching_times.h), and where the user
// says so.
class TimeBreakpoints {
 public:
  // Parameters are those that the evaluators have when they are asked; they live as long as this.
  explicit TimeBreakpoints(const std::vector<const TaylorEvaluator*>& evaluators);

  // The user's, increasing, besides those of tables; jumps: flags, of those at which x may jump.
  void set_times(std::vector<double> times, std::vector<char> jumps);
  void take_times(const TimeBreakpoints& other) { set_times(other.times_, other.jumps_); }
  // Besides those that there are.
  void add_times(const TimeBreakpoints& other);
  bool has_times() const { return !times_.empty(); }
  std::size_t num_times() const { return times_.size(); }
  // Of times of an integration, where 0 is the only one of these.
  void set_size(double size);
  // Where the gap of the next one of these begins beyond t and any gap that holds t; infinite: there is none.
  double end_of_piece(double t, double direction) const;

  // Unknowns depend on derivatives up to this order; those up to the first count in any case.
  void set_differentiations(int count) { differentiations_ = count; }

  // Where a step from t toward another time has to end: the next one between them that is farther away than rounding
  // errors of t; another one may be found that is beyond. In place of a kink both ends of its gap: where values, first
  // derivatives or what unknowns depend on may jump, as a condition changes, a period ends, or a table has a knot, and
  // its degree is 1 or not above the number of differentiations. t itself: nothing can be said of times next to it, as
  // rounding errors alone decide about a condition. Nothing is allocated.
  struct End {
    double t;
    double slack = 0.0;  // where nothing but derivatives of higher order jumps: times so near are as good
  };
  std::optional<End> next(double t, double toward);
  // Times about a kink within which rounding errors decide on which side of it functions are evaluated.
  struct Gap {
    double start, end;
    bool is_jump = false;  // of x, too
    bool ends_at(double t) const;
    bool begins_at(double t, double direction) const;
    double far_end(double direction) const { return direction > 0.0 ? end : start; }
  };
  // That holds t; its ends belong to it.
  std::optional<Gap> gap_at(double t);
  // Both are within one gap of no kink: one time, that is.
  bool are_one(double t, double other);

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Search;

  Search search(double t, double toward);
  void search_inputs(Search& search, double toward);

  void search_times(Search& search) const;

  SwitchingTimes inputs_;
  std::vector<double> times_;
  std::vector<char> jumps_;
  double size() const;  // the largest of these
  double size_of_times_ = 1.0;
  int differentiations_ = 0;
};

}  // namespace sfdae::core
