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

namespace {

// Of the rounding errors of an argument: the gap about a kink is so much to either side. (Chosen: a linear function of t,
// modulo a period, has a few of them.)
constexpr double half_gap = 64.0 * std::numeric_limits<double>::epsilon();
// Of half a gap: ends of gaps that are as near as that are the same one.
constexpr double same_end = 0.25;

// At each breakpoint: whether the first derivative on both sides differs; the ends count.
std::vector<char> kinks_of(const PointFunction& table) {
  constexpr double few = 1e-9;  // far beyond rounding errors
  const std::vector<double>& all = table.breakpoints();
  std::vector<char> has_kink(all.size(), 1);
  for (std::size_t k = 1; k + 1 < all.size(); ++k) {
    const double x = all[k], before = x - 1e-12 * (x - all[k - 1]);
    double slopes[2] = {};
    table.derivatives(1, &before, &slopes[0]);
    table.derivatives(1, &x, &slopes[1]);
    has_kink[k] = std::fabs(slopes[1] - slopes[0]) > few * (std::fabs(slopes[0]) + std::fabs(slopes[1])) ? 1 : 0;
  }
  return has_kink;
}

}  // namespace

// Where a table's argument has to be, and the time of that which is the next one so far.
struct TimeBreakpoints::Search {
  Search(double time, double its_direction) : t(time), direction(its_direction) {}

  double t, direction;
  const Table* table = nullptr;
  const std::vector<double>* targets = nullptr;
  bool is_condition = false;  // the zero of a condition is searched
  bool has_choice = false;    // on the way to the table: it may go on beyond its ends
  std::optional<double> found;
  std::optional<Gap> gap;  // that holds t

  bool has_kink(std::ptrdiff_t k) const {
    if (is_condition || k < 0) return true;
    const auto last = static_cast<std::ptrdiff_t>(targets->size()) - 1;
    return table->has_kink[static_cast<std::size_t>(k)] != 0 && (has_choice || (k > 0 && k < last));
  }
  // targets[k] is reached at that time; -1: something else happens. size: of the terms of a linear function of t.
  void note(double time, double size, std::ptrdiff_t k = -1) {
    if (!std::isfinite(time)) return;
    if (!has_kink(k)) return note_end(time, half_gap * std::max(std::fabs(t), std::fabs(time)));
    const double half = half_gap * std::max(std::fabs(time), size);
    note_end(time - direction * half, same_end * half);
    note_end(time + direction * half, same_end * half);
    if (std::fabs(t - time) > (1.0 + same_end) * half) return;
    const Gap here{time - half, time + half};
    gap = gap ? Gap{std::min(gap->start, here.start), std::max(gap->end, here.end)} : here;
  }
  void note_end(double time, double slack) {
    if ((time - t) * direction <= slack) return;
    if (!found || (*found - time) * direction > 0.0) found = time;
  }
};

TimeBreakpoints::TimeBreakpoints(const std::vector<const TaylorEvaluator*>& evaluators) {
  for (const TaylorEvaluator* evaluator : evaluators) inputs_.emplace_back(*evaluator);
}

TimeBreakpoints::Inputs::Inputs(const TaylorEvaluator& evaluator)
    : evaluator_(evaluator), record_(evaluator.record()) {
  for (int i = 0; i < record_.num_nodes(); ++i) {
    if (record_.node(i).operation != Operation::function || evaluator.tape().slot_of[index(i)] < 0) continue;
    const int argument = record_.call(i).arguments.front();
    const bool is_input = !record_.is_active(argument) && varies_in_time(record_.dependence(argument));
    const PointFunction& function = *record_.call(i).function;
    const std::vector<double>& places = function.breakpoints();
    if (!is_input || places.empty()) continue;
    tables_.push_back({i, kinks_of(function), std::max(std::fabs(places.front()), std::fabs(places.back()))});
  }
}

std::optional<double> TimeBreakpoints::next(double t, double direction) const {
  Search found(t, direction);
  for (const Inputs& inputs : inputs_) inputs.search(found);
  return found.found;
}

bool TimeBreakpoints::Gap::ends_at(double t) const {
  const double near = same_end * 0.5 * (end - start);
  return std::fabs(t - start) <= near || std::fabs(t - end) <= near;
}

std::optional<TimeBreakpoints::Gap> TimeBreakpoints::gap_at(double t) const {
  Search found(t, 1.0);
  for (const Inputs& inputs : inputs_) inputs.search(found);
  return found.gap;
}

void TimeBreakpoints::Inputs::search(Search& search_for) const {
  for (const Table& table : tables_) {
    const FunctionCall& call = record_.call(table.node);
    search_for.table = &table;
    search_for.targets = &call.function->breakpoints();
    search(call.arguments.front(), {0.0, 1.0}, search_for);
  }
}

// The value of a node that depends on parameters alone.
std::optional<double> TimeBreakpoints::Inputs::number_of(int i) const {
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

std::optional<TimeBreakpoints::Line> TimeBreakpoints::Inputs::line_of(int i) const {
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

std::optional<TimeBreakpoints::Line> TimeBreakpoints::Inputs::line_of_sum(const Node& node) const {
  const auto first = line_of(node.a);
  if (!first) return std::nullopt;
  if (node.operation == Operation::negate) return Line{-first->offset, -first->slope};
  const auto second = line_of(node.b);
  if (!second) return std::nullopt;
  const double sign = node.operation == Operation::add ? 1.0 : -1.0;
  return Line{first->offset + sign * second->offset, first->slope + sign * second->slope};
}

// Times at which outer(node) is one of the targets.
void TimeBreakpoints::Inputs::search(int i, const Line& outer, Search& search_for) const {
  const Node& node = record_.node(i);
  if (const auto line = line_of(i)) {
    const double slope = outer.slope * line->slope, offset = outer.offset + outer.slope * line->offset;
    if (slope == 0.0) return;
    const std::vector<double>& targets = *search_for.targets;
    const bool rises = slope * search_for.direction > 0.0;
    const double now = offset + slope * search_for.t;
    const double size = std::max(search_for.table->size, std::fabs(offset)) / std::fabs(slope);
    // One of the two beside the argument may be at t but for rounding errors.
    const auto place = std::lower_bound(targets.begin(), targets.end(), now) - targets.begin();
    const auto last = static_cast<std::ptrdiff_t>(targets.size()) - 1;
    const auto first = std::clamp<std::ptrdiff_t>(place - (rises ? 1 : 3), 0, last);
    for (auto k = first; k <= std::min(last, first + 3); ++k)
      search_for.note((targets[static_cast<std::size_t>(k)] - offset) / slope, size, k);
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
    case Operation::choose: return search_choice(node, outer, search_for);
    default: return;
  }
}

// Its condition may be a choice, too.
void TimeBreakpoints::Inputs::search_choice(const Node& node, const Line& outer, Search& search_for) const {
  static const std::vector<double> zero = {0.0};
  const bool had_choice = std::exchange(search_for.has_choice, true);
  search(node.b, outer, search_for);
  search(node.c, outer, search_for);
  const std::vector<double>* const targets = std::exchange(search_for.targets, &zero);
  const bool was_condition = std::exchange(search_for.is_condition, true);
  search(node.a, {0.0, 1.0}, search_for);
  search_for.targets = targets;
  search_for.is_condition = was_condition;
  search_for.has_choice = had_choice;
}

// The remainder of a linear function, a = k b + r: where r is a target, and where k changes.
void TimeBreakpoints::Inputs::search_period(const Node& node, const Line& outer, Search& search_for) const {
  const auto line = line_of(node.a);
  const auto period = number_of(node.b);
  if (!line || !period || *period == 0.0 || line->slope == 0.0 || outer.slope == 0.0) return;
  const double b = *period, k = std::floor(line->at(search_for.t) / b);
  const std::vector<double>& targets = *search_for.targets;
  const double size =
      std::max({search_for.table->size, std::fabs(b), std::fabs(line->offset)}) / std::fabs(line->slope);
  const auto note = [&](double remainder, std::ptrdiff_t place) {
    for (int turn = -1; turn <= 2; ++turn)
      search_for.note(((k + turn) * b + remainder - line->offset) / line->slope, size, place);
  };
  note(0.0, -1);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double remainder = (targets[i] - outer.offset) / outer.slope;
    if (remainder / b > 0.0 && remainder / b < 1.0) note(remainder, static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace sfdae::core
