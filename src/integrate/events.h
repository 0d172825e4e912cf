// Events: zeros of functions g(t) along an integration, found in the order in which they happen and located to rounding.
//
// A function is armed, with a sign, once it is clearly not zero. An event is the change from that sign to zero or to the
// other sign; it disarms the function. So nothing happens twice, and a function that is zero, or nothing but rounding
// errors, is silent. Nothing here knows of integrators.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"

namespace sfdae::core {

// Where the values of g come from.
class EventValues {
 public:
  virtual ~EventValues() = default;
  // g at t, cheap, with the accuracy of an interpolation; false if there is no such thing.
  virtual bool approximate(double t, double* g) = 0;
  // g at t with the values that are returned there. may_improve: approximate() may become better around t by this.
  virtual void determine(double t, bool may_improve, double* g) = 0;
  // How much g changes where rounding errors change what it depends on, at the point determined last.
  virtual void rounding(double* noise) = 0;
  // The point determined last is a candidate; the last candidate becomes the point searched last.
  virtual void keep() = 0;
  virtual void accept() = 0;
};

// Narrows down the first point where one of several functions has lost its sign: Illinois steps, and bisection where they
// are slow. "before" and "after" are meant in the direction of integration.
class ZeroBracket {
 public:
  void resize(int count);
  // signs[i]: that of g_before[i], or 0 if the function does not matter. At least one is lost at `after`, none before.
  void start(const std::vector<int>& signs, double before, const std::vector<double>& g_before, double after,
             const std::vector<double>& g_after);
  static bool is_lost(int sign, double g) { return sign != 0 && sign * g <= 0.0; }
  bool is_lost(const std::vector<double>& g) const;

  // Width at which both ends count as one point.
  double resolution() const;
  bool is_resolved() const;
  // Where to evaluate next; place() tells the values, and returns true if the point is the new end `after`.
  double next();
  bool place(double t, const std::vector<double>& g);
  double before() const { return before_; }
  double after() const { return after_; }
  const std::vector<double>& g_after() const { return g_after_; }

 private:
  double secant() const;

  std::vector<int> signs_;
  double before_ = 0.0, after_ = 0.0;
  std::vector<double> g_before_, g_after_;
  double floor_ = 0.0;      // of the resolution
  double factor_ = 1.0;     // of g_before, to make Illinois of the secant method
  int last_side_ = 0;       // which end was replaced last: -1 before, +1 after
  double old_width_ = 0.0;  // at the beginning of a few steps
  int steps_ = 0;
  int slow_rounds_ = 0;  // in which the width was not halved
};

class EventSearch {
 public:
  // directions[i]: 0, or +1 / -1 if only rising / falling zeros count, in the direction of integration.
  explicit EventSearch(std::vector<int> directions);
  int count() const { return static_cast<int>(directions_.size()); }

  // Begins at t. Zeros within `rounding` of it belong to the start. Functions that fired at t have to be armed anew.
  void start(EventValues& values, double t, double rounding);
  // Searches from where the last search ended to `end`: true if there is an event, and t() then is just behind it or on
  // it; else t() = end. Where values fail this throws, and nothing has happened. depth: the interval is halved as often
  // at least.
  bool search(EventValues& values, double end, int depth);

  bool is_started() const { return started_; }
  void reset() { started_ = false; }
  double t() const { return t_; }
  // +1 rising, -1 falling, for the event found last; 0 else.
  const std::vector<int>& fired() const { return fired_; }
  void forget_event();
  void archive(Archive& archive);

 private:
  struct Sample {
    double t = 0.0;
    int depth = 0;
    std::vector<double> g, bend;  // bend: second difference of g over the interval that was halved
  };
  static constexpr int max_pending = 24;

  void determine(EventValues& values, double t, bool may_improve, std::vector<double>& g);
  bool counts(std::size_t i) const { return directions_[i] == 0 || directions_[i] == -signs_[i]; }
  bool must_split(const Sample& to, int depth) const;
  void split(EventValues& values);
  bool is_suspicious(const std::vector<double>& g) const;
  double threshold_after_event(std::size_t i, double g) const;
  bool is_event(const std::vector<double>& g) const;
  void move_on(EventValues& values, double t, const std::vector<double>& g);
  void update_signs(EventValues& values, const std::vector<double>& g);
  bool locate(EventValues& values, const Sample& to);
  void narrow(EventValues& values, const Sample& to);
  bool guess(EventValues& values, double to, double& t);
  void include_simultaneous(EventValues& values, double limit);

  std::vector<int> directions_;
  bool started_ = false;
  // The point searched last: signs of armed functions, 0 for the others, which are armed above threshold_.
  double t_ = 0.0;
  std::vector<double> g_;
  std::vector<int> signs_, fired_;
  std::vector<int> vain_;                 // attempts in vain to arm a function, since the start or its event
  std::vector<double> threshold_, size_;  // size_: of g around its event
  double start_ = 0.0, start_rounding_ = 0.0;

  // Of the search under way.
  Sample from_;                  // left end of the interval looked at
  std::vector<Sample> pending_;  // right ends, the nearest last
  std::size_t num_pending_ = 0;
  double determined_t_ = 0.0;
  bool has_determined_ = false;
  ZeroBracket bracket_, rough_bracket_;
  std::vector<int> watched_;  // signs that count, else 0
  std::vector<double> trial_, rough_before_, rough_after_, noise_;
};

}  // namespace sfdae::core
