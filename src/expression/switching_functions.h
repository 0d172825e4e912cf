// Functions of t alone whose values decide which branch recorded equations take: conditions of choices, arguments of
// floor, quotients of remainders, arguments of tables.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "expression/time_enclosures.h"
#include "expression/values_of_time.h"

namespace sfdae::core {

// The branch that a switching function takes on an interval of t.
struct Branch {
  // For a condition 1 or 0; for floor and remainders an integer; for a table the number of knots up to its argument.
  // NaN: there may be several branches on the interval.
  double number;
  bool is_used;  // equations depend on it, with the branches that others take on the interval
};

// A crossing of a border between two branches, the only one of that border on an interval.
struct Crossing {
  std::size_t which;
  double border;  // the value of the switching function there
};

// The switching functions of one evaluator. User-supplied functions are not called: functions that depend on them are
// excluded.
class SwitchingFunctions {
 public:
  // The evaluator must outlive this object; parameters have its values at the time of a call.
  explicit SwitchingFunctions(const TaylorEvaluator& evaluator);

  std::size_t count() const { return switches_.size(); }
  long version() const { return values_.version(); }

  // Branches on an interval. This and the functions below allocate nothing.
  void find_branches(Interval t, Branch* branches);
  // After find_branches: decides more branches by values at the middle and at both ends, together with enclosures of
  // slopes. The result is a crossing by one of the undecided functions, if one of them rises or falls throughout the
  // interval: the one that is met first from the end `from` of the interval.
  std::optional<Crossing> find_crossing(Interval t, double from, Branch* branches);
  // The time of a crossing within an interval, to the last bit.
  double locate(const Crossing& crossing, Interval t);
  // The least order of derivatives by t that may jump at a change of branch.
  int jumping_order(std::size_t which, double before, double after) const;

 private:
  struct Switch {
    Code code;
    std::size_t a, b;  // operands, as numbers of slots_
    const FunctionCall* call;
    std::vector<char> has_jump;  // of a table, at each knot
  };
  struct Use {
    Instruction instruction;
    int which;  // switch, or -1
  };
  // Enclosures of the arguments of all switches, and of their derivatives by t.
  struct Arguments {
    std::vector<Interval> values, slopes;
  };
  void add_use(const Instruction& instruction, bool is_switch);
  void enclose(Interval t, Arguments& arguments);
  void find_used(Branch* branches);
  double value(const Switch& of, double t);

  ValuesOfTime values_;
  std::vector<Switch> switches_;
  std::vector<int> slots_;   // of operands of switches
  std::vector<Use> uses_;    // of slots of the tape, operands first
  std::vector<char> roots_;  // slots that x and x' are combined with, and residuals
  std::vector<char> is_used_;
  std::optional<TimeEnclosures> enclosures_;
  Arguments throughout_, at_start_, at_middle_, at_end_;
};

}  // namespace sfdae::core
