// Functions of t alone whose values decide which branch recorded equations take.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/switching_functions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "expression/false_position.h"
#include "expression/instruction_operands.h"
#include "expression/point_function.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

constexpr double undecided = std::numeric_limits<double>::quiet_NaN();

bool is_table(const Instruction& instruction) {
  return instruction.code == Code::function && !instruction.call->function->breakpoints().empty();
}

bool switches(const Instruction& instruction) {
  return instruction.code == Code::choose || instruction.code == Code::floor || instruction.code == Code::modulo ||
         is_table(instruction);
}

// Flags for the knots: the derivative of that order differs on both sides. Ends of the data do not count: beyond them
// there is no value, or another choice.
std::vector<char> jumps_of(const PointFunction& table) {
  constexpr double few = 1e-9;  // far beyond rounding errors
  const std::vector<double>& all = table.breakpoints();
  std::vector<char> has_jump(all.size(), 0);
  for (std::size_t k = 1; k + 1 < all.size(); ++k) {
    double before = 0.0, after = 0.0;  // constant between breakpoints
    table.derivatives(table.jumping_order(), &all[k - 1], &before);
    table.derivatives(table.jumping_order(), &all[k], &after);
    has_jump[k] = std::fabs(after - before) > few * (std::fabs(after) + std::fabs(before)) ? 1 : 0;
  }
  return has_jump;
}

std::size_t knots_up_to(const std::vector<double>& knots, double x) {
  return static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), x) - knots.begin());
}

double branch_of(Code code, const FunctionCall* call, Interval argument) {
  if (code == Code::choose) return argument.low > 0.0 ? 1.0 : argument.high <= 0.0 ? 0.0 : undecided;
  const auto number = [&](double x) {
    return code == Code::function ? static_cast<double>(knots_up_to(call->function->breakpoints(), x))
                                  : std::floor(x);
  };
  const double first = number(argument.low), last = number(argument.high);
  return first == last ? first : undecided;
}

// The border that an argument, rising or falling from a value known as an interval, meets first.
double next_border(Code code, const FunctionCall* call, Interval from, bool goes_up) {
  if (code == Code::choose) return 0.0;
  if (code != Code::function) return goes_up ? std::floor(from.low) + 1.0 : std::floor(from.high);
  const std::vector<double>& knots = call->function->breakpoints();
  const std::size_t above = knots_up_to(knots, goes_up ? from.low : from.high);
  return goes_up ? knots[std::min(above, knots.size() - 1)] : knots[std::max<std::size_t>(above, 1) - 1];
}

}  // namespace

SwitchingFunctions::SwitchingFunctions(const TaylorEvaluator& evaluator)
    : values_(evaluator), roots_(index(evaluator.tape().num_slots), 0) {
  const Tape& tape = evaluator.tape();
  std::vector<char> is_of_time = slots_of_time(tape);
  for (const Instruction& instruction : tape.of_time.all()) add_use(instruction, switches(instruction));
  if (tape.time >= 0) is_of_time[index(tape.time)] = 1;
  for (const int slot : tape.residuals) roots_[index(slot)] = 1;
  for (const Instruction& instruction : tape.of_state.all()) {
    for_operands(instruction, [&](int slot) { roots_[index(slot)] = 1; });
    if (instruction.code != Code::choose || is_of_time[index(instruction.a)] == 0) continue;
    roots_[index(instruction.v)] = 1;
    add_use(instruction, true);
  }
  enclosures_.emplace(tape, slots_);
  const auto is_open = [&](const Switch& of) {
    return !enclosures_->is_enclosed(of.a) || !enclosures_->is_enclosed(of.b);
  };
  for (Use& use : uses_)
    if (use.which >= 0 && is_open(switches_[index(use.which)])) use.which = -1;
  for (Arguments* const all : {&throughout_, &at_start_, &at_middle_, &at_end_}) {
    all->values.resize(count());
    all->slopes.resize(count());
  }
  is_used_ = roots_;
}

void SwitchingFunctions::add_use(const Instruction& instruction, bool is_switch) {
  uses_.push_back({instruction, is_switch ? static_cast<int>(switches_.size()) : -1});
  if (!is_switch) return;
  slots_.push_back(instruction.a);
  slots_.push_back(instruction.code == Code::modulo ? instruction.b : instruction.a);
  const bool of_table = instruction.code == Code::function;
  switches_.push_back({instruction.code, slots_.size() - 2, slots_.size() - 1, instruction.call,
                       of_table ? jumps_of(*instruction.call->function) : std::vector<char>()});
}

void SwitchingFunctions::enclose(Interval t, Arguments& arguments) {
  values_.at(t.low);
  enclosures_->enclose(values_.numbers(), t);
  for (std::size_t k = 0; k < count(); ++k) {
    const TimeSeries &a = (*enclosures_)[switches_[k].a], &b = (*enclosures_)[switches_[k].b];
    const bool is_quotient = switches_[k].code == Code::modulo;
    arguments.values[k] = is_quotient ? a.value / b.value : a.value;
    arguments.slopes[k] = is_quotient ? (a.slope - arguments.values[k] * b.slope) / b.value : a.slope;
  }
}

void SwitchingFunctions::find_branches(Interval t, Branch* branches) {
  enclose(t, throughout_);
  for (std::size_t k = 0; k < count(); ++k)
    branches[k] = {branch_of(switches_[k].code, switches_[k].call, throughout_.values[k]), false};
  find_used(branches);
}

// Follows the dependences of the equations backward.
void SwitchingFunctions::find_used(Branch* branches) {
  std::copy(roots_.begin(), roots_.end(), is_used_.begin());
  for (auto use = uses_.rbegin(); use != uses_.rend(); ++use) {
    const Instruction& instruction = use->instruction;
    bool has_used = false;
    for_results(instruction, [&](int slot) { has_used = has_used || is_used_[index(slot)] != 0; });
    if (!has_used) continue;
    if (use->which >= 0) branches[use->which].is_used = true;
    const double number = use->which >= 0 ? branches[use->which].number : undecided;
    const int left_out = instruction.code != Code::choose || std::isnan(number) ? -1
                         : number > 0.0                                         ? instruction.c
                                                                                : instruction.b;
    const char left_out_before = left_out >= 0 ? is_used_[index(left_out)] : 0;
    for_operands(instruction, [&](int slot) { is_used_[index(slot)] = 1; });
    const bool is_needed = left_out == instruction.a || left_out == (number > 0.0 ? instruction.b : instruction.c);
    if (left_out >= 0 && !is_needed) is_used_[index(left_out)] = left_out_before;
  }
}

std::optional<Crossing> SwitchingFunctions::find_crossing(Interval t, double from, Branch* branches) {
  const double middle = 0.5 * (t.low + t.high);
  enclose(Interval::of(t.low), at_start_);
  enclose(Interval::of(middle), at_middle_);
  enclose(Interval::of(t.high), at_end_);
  std::optional<Crossing> found;
  for (std::size_t k = 0; k < count(); ++k) {
    if (!branches[k].is_used || !std::isnan(branches[k].number)) continue;
    const Switch& of = switches_[k];
    const Interval slope = throughout_.slopes[k], start = at_start_.values[k], end = at_end_.values[k];
    const bool is_monotone = slope.low > 0.0 || slope.high < 0.0;
    // [Moo66] Chapter 6: the mean value form.
    const Interval values =
        is_monotone ? hull(start, end) : at_middle_.values[k] + slope * (t - Interval::of(middle));
    branches[k].number = branch_of(of.code, of.call, values);
    if (!std::isnan(branches[k].number) || !is_monotone || found) continue;
    const bool is_forward = from == t.low;
    found = Crossing{k, next_border(of.code, of.call, is_forward ? start : end, (slope.low > 0.0) == is_forward)};
  }
  return found;
}

double SwitchingFunctions::value(const Switch& of, double t) {
  const double* const slots = values_.at(t);
  const double a = slots[slots_[of.a]];
  return of.code == Code::modulo ? a / slots[slots_[of.b]] : a;
}

double SwitchingFunctions::locate(const Crossing& crossing, Interval t) {
  const Switch& of = switches_[crossing.which];
  const auto beyond = [&](double time) { return value(of, time) - crossing.border; };
  const Bracket bracket{t.low, t.high, beyond(t.low), beyond(t.high)};
  if ((bracket.at_a > 0.0) == (bracket.at_b > 0.0))
    return std::fabs(bracket.at_a) < std::fabs(bracket.at_b) ? bracket.a : bracket.b;
  return zero_between(beyond, bracket);
}

int SwitchingFunctions::jumping_order(std::size_t which, double before, double after) const {
  const Switch& of = switches_[which];
  if (of.code != Code::function || std::isnan(before) || std::isnan(after)) return 0;
  const auto first = static_cast<std::size_t>(std::min(before, after));
  const auto end = static_cast<std::size_t>(std::max(before, after));
  for (std::size_t k = first; k < end; ++k)
    if (of.has_jump[k] != 0) return of.call->function->jumping_order() - static_cast<int>(of.call->by.size());
  return std::numeric_limits<int>::max();
}

}  // namespace sfdae::core
