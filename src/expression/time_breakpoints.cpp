// Times at which data have kinks or jumps.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/time_breakpoints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "expression/kernel.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Of the rounding errors of an argument: the gap about a kink is so much to either side. (Chosen: a linear function
// of t, modulo a period, has a few of them.)
constexpr double half_gap = 64.0 * std::numeric_limits<double>::epsilon();
// Of half a gap: ends of gaps that are as near as that are the same one.
constexpr double same_end = 0.25;

bool is_table(const PointFunction& function) { return !function.breakpoints().empty(); }

// At each breakpoint: whether the derivative of that order differs on both sides; the ends count.
std::vector<char> jumps_of(const PointFunction& table) {
  constexpr double few = 1e-9;  // far beyond rounding errors
  const std::vector<double>& all = table.breakpoints();
  std::vector<char> has_jump(all.size(), 1);
  for (std::size_t k = 1; k + 1 < all.size(); ++k) {
    double before = 0.0, after = 0.0;  // constant between breakpoints
    table.derivatives(table.jumping_order(), &all[k - 1], &before);
    table.derivatives(table.jumping_order(), &all[k], &after);
    has_jump[k] = std::fabs(after - before) > few * (std::fabs(after) + std::fabs(before)) ? 1 : 0;
  }
  return has_jump;
}

}  // namespace

// What is found, looking from t.
struct TimeBreakpoints::Search {
  double t, direction;
  int differentiations;
  std::optional<double> end = {};  // of a step
  std::optional<Gap> gap = {};     // that holds t

  static double half_of_gap(double time, double size) { return half_gap * std::max(std::fabs(time), size); }

  // size: of the terms of a linear function of t, in units of t.
  void note_kink(double time, double size, bool is_jump = false) {
    if (!std::isfinite(time)) return;
    const double half = half_of_gap(time, size);
    note_end(time - direction * half, same_end * half);
    note_end(time + direction * half, same_end * half);
    if (std::fabs(t - time) > (1.0 + same_end) * half) return;
    const Gap here{time - half, time + half, is_jump};
    gap = gap ? Gap{std::min(gap->start, here.start), std::max(gap->end, here.end), gap->is_jump || is_jump} : here;
  }
  void note_smooth(double time) {
    if (std::isfinite(time)) note_end(time, half_of_gap(time, std::fabs(t)));
  }
  void note_end(double time, double slack) {
    if ((time - t) * direction <= slack) return;
    if (!end || (*end - time) * direction > 0.0) end = time;
  }
};

TimeBreakpoints::TimeBreakpoints(const std::vector<const TaylorEvaluator*>& evaluators) {
  for (const TaylorEvaluator* evaluator : evaluators) inputs_.emplace_back(*evaluator);
}

TimeBreakpoints::Search TimeBreakpoints::search(double t, double direction) {
  const QuietArithmetic quiet;  // what is unknown is NaN
  Search found{.t = t, .direction = direction, .differentiations = std::max(differentiations_, 1)};
  for (Inputs& inputs : inputs_) inputs.search(found);
  search_times(found);
  return found;
}

void TimeBreakpoints::set_times(std::vector<double> times, std::vector<char> jumps) {
  times_ = std::move(times);
  jumps_ = std::move(jumps);
}

void TimeBreakpoints::add_times(const TimeBreakpoints& other) {
  std::map<double, char> jumps;
  for (const TimeBreakpoints* given : {static_cast<const TimeBreakpoints*>(this), &other})
    for (std::size_t k = 0; k < given->times_.size(); ++k) {
      char& is_jump = jumps[given->times_[k]];
      if (given->jumps_[k] != 0) is_jump = 1;
    }
  std::vector<double> times;
  std::vector<char> flags;
  for (const auto& [t, is_jump] : jumps) {
    times.push_back(t);
    flags.push_back(is_jump);
  }
  set_times(std::move(times), std::move(flags));
}

double TimeBreakpoints::size() const {
  const double largest = times_.empty() ? 0.0 : std::max(std::fabs(times_.front()), std::fabs(times_.back()));
  return largest > 0.0 ? largest : size_of_times_;
}

// Two on each side: gaps may hold each other's times.
void TimeBreakpoints::search_times(Search& search_for) const {
  const auto place = std::lower_bound(times_.begin(), times_.end(), search_for.t) - times_.begin();
  const auto last = std::min<std::ptrdiff_t>(place + 2, static_cast<std::ptrdiff_t>(times_.size()));
  for (auto k = std::max<std::ptrdiff_t>(place - 2, 0); k < last; ++k)
    search_for.note_kink(times_[static_cast<std::size_t>(k)], size(), jumps_[static_cast<std::size_t>(k)] != 0);
}

double TimeBreakpoints::end_of_piece(double t, double direction) const {
  const auto count = static_cast<std::ptrdiff_t>(times_.size());
  const auto above = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin();
  const std::ptrdiff_t step = direction > 0.0 ? 1 : -1;
  for (std::ptrdiff_t k = direction > 0.0 ? above : above - 1; k >= 0 && k < count; k += step) {
    const double time = times_[static_cast<std::size_t>(k)], half = Search::half_of_gap(time, size());
    if ((time - t) * direction > (1.0 + same_end) * half) return time - direction * half;
  }
  return direction * infinity;
}

std::optional<double> TimeBreakpoints::next(double t, double direction) { return search(t, direction).end; }

bool TimeBreakpoints::Gap::ends_at(double t) const {
  const double near = same_end * 0.5 * (end - start);
  return std::fabs(t - start) <= near || std::fabs(t - end) <= near;
}

bool TimeBreakpoints::Gap::begins_at(double t, double direction) const {
  return std::fabs(t - far_end(-direction)) <= same_end * 0.5 * (end - start);
}

std::optional<TimeBreakpoints::Gap> TimeBreakpoints::gap_at(double t) { return search(t, 1.0).gap; }

// ---- The tables of one evaluator -----------------------------------------------------------------------------------

const TimeBreakpoints::Curve& TimeBreakpoints::Inputs::curve(int i) const { return curves_[index(place_[index(i)])]; }

TimeBreakpoints::Curve TimeBreakpoints::Inputs::constant(double value) {
  return {.value = value, .offset = value, .slope = 0.0};
}

TimeBreakpoints::Curve TimeBreakpoints::Inputs::multiple(const Curve& a, double factor) {
  Curve result = a;
  result.offset *= factor;
  result.slope *= factor;
  result.size *= std::fabs(factor);
  return result;
}

TimeBreakpoints::Curve TimeBreakpoints::Inputs::sum(const Curve& a, const Curve& b) {
  return {.offset = a.offset + b.offset,
          .slope = a.slope + b.slope,
          .size = std::max({a.size, b.size, std::fabs(a.offset), std::fabs(b.offset)}),
          .has_choice = a.has_choice || b.has_choice,
          .first = std::max(a.first, b.first),
          .last = std::min(a.last, b.last)};
}

TimeBreakpoints::Inputs::Inputs(const TaylorEvaluator& evaluator)
    : evaluator_(evaluator), record_(evaluator.record()) {
  std::vector<char> is_needed(index(record_.num_nodes()), 0);
  const std::vector<bool> live = live_nodes(record_);
  for (int i = 0; i < record_.num_nodes(); ++i) {
    if (record_.node(i).operation != Operation::function || !live[index(i)]) continue;
    const FunctionCall& call = record_.call(i);
    const int argument = call.arguments.front();
    if (record_.is_active(argument) || !varies_in_time(record_.dependence(argument)) || !is_table(*call.function))
      continue;
    const std::vector<double>& places = call.function->breakpoints();
    const double size = std::max(std::fabs(places.front()), std::fabs(places.back()));
    const int order = call.function->jumping_order() - static_cast<int>(call.by.size());
    tables_.push_back({i, jumps_of(*call.function), order, size});
    is_needed[index(argument)] = 1;
  }
  if (tables_.empty()) return;
  place_.assign(index(record_.num_nodes()), -1);
  for (int i = record_.num_nodes() - 1; i >= 0; --i) {
    if (is_needed[index(i)] == 0) continue;
    const Operands operands = record_.operands(i);
    for (int k = 0; k < operands.size(); ++k) is_needed[index(operands[k])] = 1;
  }
  for (int i = 0; i < record_.num_nodes(); ++i) {
    if (is_needed[index(i)] == 0) continue;
    place_[index(i)] = static_cast<int>(nodes_.size());
    nodes_.push_back(i);
  }
  curves_.resize(nodes_.size());
}

void TimeBreakpoints::Inputs::search(Search& search_for) {
  for (std::size_t k = 0; k < nodes_.size(); ++k) curves_[k] = curve_of(nodes_[k], search_for);
  for (const Table& table : tables_) search_table(table, search_for);
}

// The value of an operation on what is known.
double TimeBreakpoints::Inputs::value_of(int i) const {
  const Node node = record_.node(i);
  const Operands operands = record_.operands(i);
  double values[PointFunction::max_arguments] = {};
  for (int k = 0; k < operands.size(); ++k) {
    values[k] = curve(operands[k]).value;
    if (!std::isfinite(values[k])) return unknown;
  }
  if (node.operation != Operation::function)
    return evaluate(node.operation, values[0], values[1], values[2]).value_or(unknown);
  // Others are the user's, who does not expect calls from here.
  const FunctionCall& call = record_.call(i);
  double result = 0.0;
  const int order = static_cast<int>(call.by.size());
  return is_table(*call.function) && call.function->derivatives(order, values, &result) == 0 ? result : unknown;
}

TimeBreakpoints::Curve TimeBreakpoints::Inputs::curve_of(int i, Search& search_for) const {
  const Node node = record_.node(i);
  switch (node.operation) {
    case Operation::constant: return constant(record_.constant(node.a));
    case Operation::parameter: return constant(evaluator_.parameter(node.a));
    case Operation::time: return {.value = search_for.t, .offset = 0.0, .slope = 1.0};
    case Operation::choose: return curve_of_choice(node, search_for);
    default: break;
  }
  Curve result;
  switch (node.operation) {
    case Operation::negate: result = multiple(curve(node.a), -1.0); break;
    case Operation::add: result = sum(curve(node.a), curve(node.b)); break;
    case Operation::subtract: result = sum(curve(node.a), multiple(curve(node.b), -1.0)); break;
    case Operation::multiply:
      result = curve(node.a).slope == 0.0   ? multiple(curve(node.b), curve(node.a).offset)
               : curve(node.b).slope == 0.0 ? multiple(curve(node.a), curve(node.b).offset)
                                            : Curve();
      break;
    case Operation::divide:
      if (curve(node.b).slope == 0.0) result = multiple(curve(node.a), 1.0 / curve(node.b).offset);
      break;
    case Operation::modulo: result = remainder(curve(node.a), curve(node.b), search_for); break;
    default: break;
  }
  result.value = value_of(i);
  const Operands operands = record_.operands(i);
  bool is_constant = true;
  for (int k = 0; k < operands.size(); ++k) {
    is_constant = is_constant && curve(operands[k]).slope == 0.0;
    result.has_choice = result.has_choice || curve(operands[k]).has_choice;
  }
  if (is_constant) result.offset = result.value, result.slope = 0.0;
  return result;
}

TimeBreakpoints::Curve TimeBreakpoints::Inputs::curve_of_choice(const Node& node, Search& search_for) const {
  const Curve& condition = curve(node.a);
  if (condition.is_rising_or_falling())
    search_for.note_kink(-condition.offset / condition.slope, condition.size_in_time());
  if (std::isnan(condition.value)) return {};
  Curve result = curve(condition.value > 0.0 ? node.b : node.c);
  result.has_choice = true;
  return result;
}

// The remainder of a linear function, a = k b + r: it begins anew where k changes.
TimeBreakpoints::Curve TimeBreakpoints::Inputs::remainder(const Curve& a, const Curve& b, Search& search_for) {
  if (!a.is_rising_or_falling() || b.slope != 0.0) return {};
  const double k = std::floor(a.value / b.offset);
  const double size = std::max(a.size_in_time(), std::fabs(b.offset / a.slope));  // the same on both sides
  const double times[] = {(k * b.offset - a.offset) / a.slope, ((k + 1.0) * b.offset - a.offset) / a.slope};
  for (double time : times) search_for.note_kink(time, size);
  Curve result = sum(a, constant(-k * b.offset));
  result.first = std::min(times[0], times[1]);
  result.last = std::max(times[0], times[1]);
  return result;
}

// Times at which the argument is at a breakpoint.
void TimeBreakpoints::Inputs::search_table(const Table& table, Search& search_for) const {
  const FunctionCall& call = record_.call(table.node);
  const Curve& argument = curve(call.arguments.front());
  if (!argument.is_rising_or_falling()) return;
  const std::vector<double>& places = call.function->breakpoints();
  const double offset = argument.offset, slope = argument.slope, now = offset + slope * search_for.t;
  const double size = std::max(table.size / std::fabs(slope), argument.size_in_time());
  // One of the two beside the argument may be at t but for rounding errors.
  const auto last = static_cast<std::ptrdiff_t>(places.size()) - 1;
  const auto place = std::lower_bound(places.begin(), places.end(), now) - places.begin();
  const auto first = std::clamp<std::ptrdiff_t>(place - (slope * search_for.direction > 0.0 ? 1 : 3), 0, last);
  for (auto k = first; k <= std::min(last, first + 3); ++k) {
    const double time = (places[static_cast<std::size_t>(k)] - offset) / slope;
    const double half = Search::half_of_gap(time, size);
    // There a period ends.
    if (!(time - argument.first > half && argument.last - time > half)) continue;
    // Beyond the ends of the data there is nothing, but another choice.
    const bool is_end = k == 0 || k == last;
    const bool has_kink = table.has_jump[static_cast<std::size_t>(k)] != 0 &&
                          (is_end ? argument.has_choice : table.order <= search_for.differentiations);
    if (has_kink) search_for.note_kink(time, size);
    else search_for.note_smooth(time);
  }
}

}  // namespace sfdae::core
