// Times at which inputs of recorded equations have kinks.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/time_breakpoints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "expression/kernel.h"
#include "linalg/index.h"

namespace sfdae::core {

// Where a table's argument has to be, and the time of that which is the next one so far.
struct TimeBreakpoints::Search {
  double t, direction;
  const PointFunction* table = nullptr;  // null: the zero of a condition
  std::optional<double> found;
  bool is_kink = false;  // t itself is one

  const std::vector<double>& targets() const {
    static const std::vector<double> zero = {0.0};
    return table != nullptr ? table->breakpoints() : zero;
  }
  bool is_after(double time) const {
    const double slack = 64.0 * std::numeric_limits<double>::epsilon() * std::max(std::fabs(t), std::fabs(time));
    return (time - t) * direction > slack;
  }
  // targets[k] is reached at that time; -1: something else happens.
  void note(double time, std::ptrdiff_t k = -1) {
    if (!std::isfinite(time)) return;
    if (time == t && !is_kink) is_kink = k < 0 || has_kink(static_cast<std::size_t>(k));
    if (!is_after(time)) return;
    if (!found || (*found - time) * direction > 0.0) found = time;
  }
  // The first derivative on both sides differs.
  bool has_kink(std::size_t k) const {
    constexpr double few = 1e-9;  // far beyond rounding errors
    const std::vector<double>& all = targets();
    if (table == nullptr || k == 0 || k + 1 == all.size()) return true;
    const double x = all[k], before = x - 1e-12 * (x - all[k - 1]);
    double slopes[2] = {};
    table->derivatives(1, &before, &slopes[0]);
    table->derivatives(1, &x, &slopes[1]);
    return std::fabs(slopes[1] - slopes[0]) > few * (std::fabs(slopes[0]) + std::fabs(slopes[1]));
  }
};

TimeBreakpoints::TimeBreakpoints(const TaylorEvaluator& evaluator)
    : evaluator_(evaluator), record_(evaluator.record()) {
  for (int i = 0; i < record_.num_nodes(); ++i) {
    if (record_.node(i).operation != Operation::function || evaluator.tape().slot_of[index(i)] < 0) continue;
    const int argument = record_.call(i).arguments.front();
    const bool is_input = !record_.is_active(argument) && varies_in_time(record_.dependence(argument));
    if (is_input && !record_.call(i).function->breakpoints().empty()) tables_.push_back(i);
  }
}

std::optional<double> TimeBreakpoints::next(double t, double direction) const {
  Search found{t, direction, nullptr, std::nullopt, false};
  for (int table : tables_) {
    found.table = record_.call(table).function.get();
    search(record_.call(table).arguments.front(), {0.0, 1.0}, found);
  }
  return found.found;
}

bool TimeBreakpoints::is_kink(double t) const {
  Search found{t, 1.0, nullptr, std::nullopt, false};
  for (int table : tables_) {
    found.table = record_.call(table).function.get();
    search(record_.call(table).arguments.front(), {0.0, 1.0}, found);
  }
  return found.is_kink;
}

// The value of a node that depends on parameters alone.
std::optional<double> TimeBreakpoints::number_of(int i) const {
  if (varies_in_time(record_.dependence(i))) return std::nullopt;
  const Node& node = record_.node(i);
  if (node.operation == Operation::constant) return record_.constant(node.a);
  if (node.operation == Operation::parameter) return evaluator_.parameter(node.a);
  if (node.operation == Operation::function) return std::nullopt;
  double values[3] = {};
  const Operands operands = record_.operands(i);
  for (int k = 0; k < operands.size(); ++k) {
    const std::optional<double> value = number_of(operands[k]);
    if (!value) return std::nullopt;
    values[k] = *value;
  }
  return evaluate(node.operation, values[0], values[1], values[2]);
}

std::optional<TimeBreakpoints::Line> TimeBreakpoints::line_of(int i) const {
  const Node& node = record_.node(i);
  if (const auto number = number_of(i)) return Line{*number, 0.0};
  switch (node.operation) {
    case Operation::time: return Line{0.0, 1.0};
    case Operation::negate:
    case Operation::add:
    case Operation::subtract: return line_of_sum(node);
    case Operation::multiply:
    case Operation::divide: {
      const bool is_first = node.operation == Operation::multiply && number_of(node.a).has_value();
      const auto line = line_of(is_first ? node.b : node.a);
      const auto factor = number_of(is_first ? node.a : node.b);
      if (!line || !factor || (node.operation == Operation::divide && *factor == 0.0)) return std::nullopt;
      const double by = node.operation == Operation::divide ? 1.0 / *factor : *factor;
      return Line{line->offset * by, line->slope * by};
    }
    default: return std::nullopt;
  }
}

std::optional<TimeBreakpoints::Line> TimeBreakpoints::line_of_sum(const Node& node) const {
  const auto first = line_of(node.a);
  if (!first) return std::nullopt;
  if (node.operation == Operation::negate) return Line{-first->offset, -first->slope};
  const auto second = line_of(node.b);
  if (!second) return std::nullopt;
  const double sign = node.operation == Operation::add ? 1.0 : -1.0;
  return Line{first->offset + sign * second->offset, first->slope + sign * second->slope};
}

// Times at which outer(node) is one of the targets.
void TimeBreakpoints::search(int i, const Line& outer, Search& search_for) const {
  const Node& node = record_.node(i);
  if (const auto line = line_of(i)) {
    const double slope = outer.slope * line->slope, offset = outer.offset + outer.slope * line->offset;
    if (slope == 0.0) return;
    const std::vector<double>& targets = search_for.targets();
    const bool rises = slope * search_for.direction > 0.0;
    const double now = offset + slope * search_for.t;
    // One of the two beside the argument may be at t but for rounding errors.
    const auto place = std::lower_bound(targets.begin(), targets.end(), now) - targets.begin();
    const auto last = static_cast<std::ptrdiff_t>(targets.size()) - 1;
    const auto first = std::clamp<std::ptrdiff_t>(place - (rises ? 1 : 3), 0, last);
    for (auto k = first; k <= std::min(last, first + 3); ++k)
      search_for.note((targets[static_cast<std::size_t>(k)] - offset) / slope, k);
    return;
  }
  switch (node.operation) {
    case Operation::negate: return search(node.a, {outer.offset, -outer.slope}, search_for);
    case Operation::add:
    case Operation::subtract: {
      const double sign = node.operation == Operation::add ? 1.0 : -1.0;
      if (const auto b = number_of(node.b))
        return search(node.a, {outer.offset + sign * outer.slope * *b, outer.slope}, search_for);
      if (const auto a = number_of(node.a))
        return search(node.b, {outer.offset + outer.slope * *a, sign * outer.slope}, search_for);
      return;
    }
    case Operation::multiply:
      if (const auto a = number_of(node.a)) return search(node.b, {outer.offset, outer.slope * *a}, search_for);
      if (const auto b = number_of(node.b)) return search(node.a, {outer.offset, outer.slope * *b}, search_for);
      return;
    case Operation::divide:
      if (const auto b = number_of(node.b); b && *b != 0.0)
        search(node.a, {outer.offset, outer.slope / *b}, search_for);
      return;
    case Operation::modulo: return search_period(node, outer, search_for);
    case Operation::choose: {
      search(node.b, outer, search_for);
      search(node.c, outer, search_for);
      const PointFunction* const table = std::exchange(search_for.table, nullptr);
      search(node.a, {0.0, 1.0}, search_for);
      search_for.table = table;
      return;
    }
    default: return;
  }
}

// The remainder of a linear function, a = k b + r: where r is a target, and where k changes.
void TimeBreakpoints::search_period(const Node& node, const Line& outer, Search& search_for) const {
  const auto line = line_of(node.a);
  const auto period = number_of(node.b);
  if (!line || !period || *period == 0.0 || line->slope == 0.0 || outer.slope == 0.0) return;
  const double b = *period, k = std::floor(line->at(search_for.t) / b);
  const auto note = [&](double remainder, std::ptrdiff_t place) {
    for (int turn = -1; turn <= 2; ++turn)
      search_for.note(((k + turn) * b + remainder - line->offset) / line->slope, place);
  };
  note(0.0, -1);
  const std::vector<double>& targets = search_for.targets();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double remainder = (targets[i] - outer.offset) / outer.slope;
    if (remainder / b >= 0.0 && remainder / b < 1.0) note(remainder, static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace sfdae::core
