// Times at which data have kinks or jumps: where tables of recorded equations have, and where the user says so.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Of tables whose argument is t, a linear function of t with coefficients that depend on parameters alone, such a
// function modulo a period, one of several of these as conditions on t choose, or a linear function of any of that.
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
  void set_size(double size) { size_of_times_ = size; }
  // Where the gap of the next one of these begins beyond t and any gap that holds t; infinite: there is none.
  double end_of_piece(double t, double direction) const;

  // Unknowns depend on derivatives up to this order; those up to the first count in any case.
  void set_differentiations(int count) { differentiations_ = count; }

  // Where a step has to end: the next one after t in a direction, +1 or -1, farther away than rounding errors of t. In
  // place of a kink, where values, first derivatives or what unknowns depend on may jump (of tables of degree 1 or a
  // degree that is not above the number of differentiations, where a condition changes, where a period ends), both
  // ends of its gap. Nothing is allocated.
  std::optional<double> next(double t, double direction);
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

 private:
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Search;

  // What a node is near the time of a search, by the branches of choices and the periods that hold then.
  struct Curve {
    double value = unknown;                     // at that time
    double offset = unknown, slope = unknown;   // of a linear function of t
    double size = 0.0;                          // of its terms
    bool has_choice = false;                    // it may be another function elsewhere
    double first = -infinity, last = infinity;  // of the period

    bool is_rising_or_falling() const { return std::fabs(slope) > 0.0; }
    double size_in_time() const { return std::max(size, std::fabs(offset)) / std::fabs(slope); }
  };

  // The tables of one evaluator. Every part of their arguments is looked at once, however often it is used.
  class Inputs {
   public:
    explicit Inputs(const TaylorEvaluator& evaluator);
    void search(Search& search);

   private:
    struct Table {
      int node;
      std::vector<char> has_jump;  // of the derivative of `order`, at each of its breakpoints
      int order;
      double size;  // of its arguments
    };

    const Curve& curve(int node) const;
    // Notes where conditions change and periods end.
    Curve curve_of(int node, Search& search) const;
    Curve curve_of_choice(const Node& node, Search& search) const;
    double value_of(int node) const;
    void search_table(const Table& table, Search& search) const;
    static Curve constant(double value);
    static Curve multiple(const Curve& a, double factor);
    static Curve sum(const Curve& a, const Curve& b);
    static Curve remainder(const Curve& a, const Curve& b, Search& search);

    const TaylorEvaluator& evaluator_;
    const Record& record_;
    std::vector<Table> tables_;
    std::vector<int> nodes_;     // that arguments of tables consist of, operands first
    std::vector<int> place_;     // of each node of the record among these
    std::vector<Curve> curves_;  // of these, about the time of the last search
  };

  Search search(double t, double direction);

  void search_times(Search& search) const;

  std::vector<Inputs> inputs_;
  std::vector<double> times_;
  std::vector<char> jumps_;
  double size() const;  // the largest of these
  double size_of_times_ = 1.0;
  int differentiations_ = 0;
};

}  // namespace sfdae::core
