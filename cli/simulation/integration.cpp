// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/integration.h"

#include <algorithm>
#include <cmath>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Events within this part of the interval after the previous one are close; max_close_events of them accumulate.
constexpr double close_events = 1e-9;
constexpr int max_close_events = 1000, max_close_changes = 20;  // in total, and for one relation
constexpr long default_max_steps = 100000;
// A zero that steps cannot cross counts as reached within this multiple of the nominal size. (Chosen.)
constexpr double reached = 1e-10;
// A contradiction this soon after the start of a piece, relative to its first step, existed at the start.
constexpr double at_start = 1e-4;

bool uses_derivatives(const System& system) {
  const auto depends = [&](Formula f) { return f >= 0 && system.formulas.depends(f, on_derivative); };
  return std::any_of(system.at_events.discrete.begin(), system.at_events.discrete.end(),
                     [&](const auto& it) { return depends(it.value); }) ||
         std::any_of(system.switches.begin(), system.switches.end(), [&](const auto& it) { return depends(it.g); }) ||
         std::any_of(system.reactions.begin(), system.reactions.end(),
                     [&](const auto& it) { return depends(it.value); });
}

std::string at_place(const System& system, Location at) { return " (" + place(system.model, at) + ")"; }

// Describes the change of a switch to this value.
std::string change_in_words(const System& system, int number, double value) {
  const Switch& it = system.switches[at(number)];
  const std::string what = it.kind != Switch::Kind::relation ? " jumps"
                           : value != 0.0                    ? " becomes true"
                                                             : " becomes false";
  return it.text + what + at_place(system, it.at);
}

}  // namespace

Integration::Integration(const Parts& parts)
    : parts_(parts),
      rounding_(parts.settings.stop - parts.settings.start),
      root_values_(parts.system),
      next_sample_(parts.system.samples.size(), 0),
      needs_derivatives_(uses_derivatives(parts.system)),
      close_events_{parts.settings.start, 0, std::vector<int>(parts.system.switches.size(), 0)} {
  sfdae_statistics_init(&parts_.result.statistics, sizeof parts_.result.statistics);
}

double Integration::output_time(long number) const {
  const Settings& s = parts_.settings;
  return number >= s.num_outputs ? s.stop
                                 : s.start + (s.stop - s.start) * static_cast<double>(number) / s.num_outputs;
}

void Integration::run(Values& values, sfdae::Point& point) {
  try {
    run_to_end(values, point);
  } catch (...) {
    add_statistics();
    throw;
  }
}

void Integration::run_to_end(Values& values, sfdae::Point& point) {
  Reached at{values, point};
  parts_.output.add(values);
  if (!settle_at_start(at)) return;
  while (values.t < parts_.settings.stop) {
    const double output = output_time(next_output_);
    const std::optional<double> time_event = next_time_event(values);
    const double target = time_event ? std::min(*time_event, output) : output;
    const bool is_there = rounding_.is_due(target, values.t);
    int status = SFDAE_OK;
    if (!is_there) {
      const Values before = values;
      const sfdae::Point point_before = point;
      try {
        status = step(at, target);
      } catch (const Failure& failure) {
        values = before, point = point_before;
        const std::vector<int> ends = branches_that_end(at);
        if (failure.status() != SFDAE_NOT_FINITE || ends.empty()) throw;
        if (!happens(at, ends, "")) return;
        if (is_started_) throw;  // with the same equations
        continue;
      }
      if (repair(at, before, is_first_step_)) {
        if (is_over_) return;
        continue;
      }
    }
    move_to_due(at, target);
    const bool is_time_due = time_event && rounding_.is_due(*time_event, values.t);
    if (is_time_due) move_to_due(at, *time_event);
    if (status == SFDAE_EVENT || is_time_due) {
      const std::vector<int> roots = status == SFDAE_EVENT ? mode_->solver.events() : std::vector<int>();
      if (!happens(at, roots, "")) return;
    } else if (parts_.settings.keeps_steps) {
      add_row(at);
    }
    if (is_started_) is_first_step_ = false;
    add_due_output(at);
  }
  finish(at);
}

// Moves to an output or event that is due up to roundoff: an internal step may end slightly before it.
void Integration::move_to_due(Reached& at, double t) const {
  if (t <= at.values.t || !rounding_.is_due(t, at.values.t)) return;
  at.values.t = at.point.t = std::min(t, parts_.settings.stop);
}

void Integration::add_row(Reached& at) {
  parts_.events.check_assertions(at.values);
  parts_.output.add(at.values);
}

// Outputs are due even if a step of the method or an event without effect ended the step there.
void Integration::add_due_output(Reached& at) {
  std::optional<double> last;
  for (; next_output_ <= parts_.settings.num_outputs; ++next_output_) {
    const double output = output_time(next_output_);
    if (!rounding_.is_due(output, at.values.t)) break;
    last = output;
    num_steps_ = 0;
  }
  if (!last || rounding_.is_same(parts_.result.trajectory.t.back(), at.values.t)) return;
  move_to_due(at, *last);
  add_row(at);
}

void Integration::start(Reached& at) {
  add_statistics();
  mode_ = parts_.modes.at_values(at.values);
  key_ = parts_.modes.equations_key(at.values);
  root_values_ = at.values;
  baseline_ = mode_->solver.statistics();
  const std::string where = "t = " + to_text(at.values.t);
  const auto begin = [&] {
    mode_->options.initial_values = SFDAE_INITIAL_NEAREST;
    mode_->options.fixed.clear();
    mode_->solver.set_options(mode_->options);
    mode_->solver.set_events(parts_.switches.num_roots(), [this](double t, sfdae::ConstVectorRef x,
                                                                 sfdae::ConstVectorRef xdot, sfdae::VectorRef g) {
      const std::vector<int>& unknowns = parts_.modes.unknowns();
      root_values_.t = t;
      for (std::size_t j = 0; j < unknowns.size(); ++j) {
        if (unknowns[j] < 0) continue;
        root_values_.variable[cli::at(unknowns[j])] = x[static_cast<int>(j)];
        root_values_.derivative[cli::at(unknowns[j])] = xdot[static_cast<int>(j)];
      }
      parts_.switches.evaluate_roots(root_values_, g.data());
    });
    return mode_->solver.start(at.point, parts_.settings.stop);
  };
  int status = parts_.calls.attempt(*mode_, begin);
  if (status == SFDAE_CHARACTERISTICS_CHANGED)  // known from another time: analyze again
    status = parts_.calls.attempt(*mode_, [&] {
      mode_->solver.analyze_at(at.point, parts_.settings.stop);
      return begin();
    });
  if (status < 0)
    throw Failure(outcome_of(status, is_started_ || at.values.t > parts_.settings.start ? Phase::integration
                                                                                        : Phase::initialization),
                  status, where + ": " + parts_.calls.message());
  if (status == SFDAE_NOT_UNIQUE && !has_warned_) {
    has_warned_ = true;
    parts_.result.warnings.push_back(where + ": " + parts_.calls.message());
  }
  parts_.modes.to_values(at.point, at.values);
  is_started_ = is_first_step_ = is_piece_open_ = true;
  start_ = at.values.t;
  roots_at_start_.resize(cli::at(parts_.switches.num_roots()));
  root_values_ = at.values;
  parts_.switches.evaluate_roots(root_values_, roots_at_start_.data());
  distances_at_start_ = parts_.switches.distances(root_values_);
}

int Integration::step(Reached& at, double target) {
  if (!is_started_) start(at);
  target = std::min(target, end_of_step(at));
  const long max_steps = parts_.settings.max_steps > 0 ? parts_.settings.max_steps : default_max_steps;
  if (++num_steps_ > max_steps)
    throw Failure(
        Outcome::not_finished, SFDAE_MAX_STEPS,
        "more than " + std::to_string(max_steps) + " steps between two outputs, at t = " + to_text(at.values.t));
  const int status = parts_.calls.run(*mode_, Phase::integration, "t = " + to_text(at.values.t), [&] {
    if (needs_derivatives_) return mode_->solver.step(target, at.point);
    const int result = sfdae_step(mode_->solver.get(), target, &at.point.t, at.point.x.data(), nullptr);
    if (result < 0) throw sfdae::Error(result, mode_->solver.message());
    return result;
  });
  parts_.modes.to_values(at.point, at.values);
  return status;
}

// Equations may end with their branch, such as sqrt(x) while x > 0. Steps cannot cross the zero then and shrink until
// they end just before it. Returns the directions of the roots reached, or nothing.
std::vector<int> Integration::branches_that_end(Reached& at) {
  std::vector<double> g(cli::at(parts_.switches.num_roots()));
  if (!is_started_ || g.empty()) return {};
  const std::vector<double> distances = parts_.switches.distances(at.values);
  parts_.switches.evaluate_roots(at.values, g.data());
  std::vector<int> result(g.size(), 0);
  for (std::size_t i = 0; i < g.size(); ++i) {
    const int number = parts_.switches.switch_of(static_cast<int>(i));
    const Switch& it = parts_.system.switches[cli::at(number)];
    const bool is_reached =
        std::fabs(g[i]) <= reached * it.nominal && std::fabs(g[i]) < std::fabs(roots_at_start_[i]);
    if (it.kind == Switch::Kind::relation && is_reached && distances[cli::at(number)] == 0.0)
      result[i] = g[i] > 0.0 ? -1 : 1;
  }
  return std::any_of(result.begin(), result.end(), [](int it) { return it != 0; }) ? result : std::vector<int>();
}

// For an output within an internal step, the end of the step is checked, too: repair() could not reach a contradiction
// there by interpolation after the next step.
double Integration::end_of_step(const Reached& at) const {
  const double end = parts_.switches.num_roots() > 0 ? mode_->solver.statistics().t_internal : at.values.t;
  return rounding_.is_due(end, at.values.t) ? parts_.settings.stop : end;
}

void Integration::interpolate(const Reached& at, double t, Values& values, sfdae::Point& point) {
  values = at.values;
  point.x.resize(at.point.x.size());
  const sfdae::Statistics steps = mode_->solver.statistics();  // no values before the last step
  point.t = std::clamp(t, std::min(steps.t_internal - steps.last_step, at.values.t), at.values.t);
  parts_.calls.run(*mode_, Phase::integration, "t = " + to_text(t), [&] { return mode_->solver.interpolate(point); });
  parts_.modes.to_values(point, values);
}

// Handles a switch that contradicts its argument although no event was found: the argument was zero at the start of the
// piece, or stayed zero for some time. Goes back to the beginning of the contradiction, which is an event.
bool Integration::repair(Reached& at, const Values& before, bool is_first) {
  if (parts_.switches.num_roots() == 0 || at.values.t == before.t) return false;
  Values high = at.values;
  sfdae::Point high_point = at.point;
  if (is_first) interpolate(at, 0.5 * (start_ + at.values.t), high, high_point);
  const int number = parts_.switches.contradiction(high, !is_first, distances_at_start_);
  if (number < 0) return false;
  double low = is_first ? start_ : before.t;
  const double first_step = high.t - low;
  for (int k = 0; k < 60 && !rounding_.is_same(low, high.t); ++k) {
    Values middle = at.values;
    sfdae::Point middle_point;
    interpolate(at, 0.5 * (low + high.t), middle, middle_point);
    if (parts_.switches.contradiction(middle, false, distances_at_start_) >= 0)
      high = middle, high_point = middle_point;
    else low = middle.t;
  }
  const double wanted = parts_.switches.wanted(high, number);
  if (is_first && high.t - start_ <= at_start * first_step) {
    high = before;
    parts_.modes.to_point(high, high_point);
  }
  at.values = high;
  at.point = high_point;
  parts_.switches.set(number, wanted, at.values);
  is_started_ = false;
  if (!happens(at, {}, change_in_words(parts_.system, number, wanted))) is_over_ = true;
  return true;
}

bool Integration::set_due_samples(Values& values) {
  bool has_due = false;
  for (std::size_t i = 0; i < next_sample_.size(); ++i) {
    const Sample& sample = parts_.system.samples[i];
    const auto time_of = [&](long number) { return sample.start + static_cast<double>(number) * sample.interval; };
    values.samples[i] = 0.0;
    if (time_of(next_sample_[i]) > values.t + rounding_.of(values.t, sample.start)) continue;
    values.samples[i] = 1.0;
    ++next_sample_[i];
    has_due = true;
  }
  return has_due;
}

std::optional<double> Integration::next_time_event(Values& values) {
  std::optional<double> next = parts_.switches.next_time(values);
  for (std::size_t i = 0; i < next_sample_.size(); ++i) {
    const Sample& sample = parts_.system.samples[i];
    const double t = sample.start + static_cast<double>(next_sample_[i]) * sample.interval;
    if (!next || t < *next) next = t;
  }
  return next;
}

// Right after the start: handles samples and relations of time that begin there.
bool Integration::settle_at_start(Reached& at) {
  const double t0 = at.values.t;
  for (std::size_t i = 0; i < next_sample_.size(); ++i) {
    const Sample& sample = parts_.system.samples[i];
    next_sample_[i] = std::max(0L, static_cast<long>(std::ceil((t0 - sample.start) / sample.interval -
                                                               rounding_.of(t0, sample.start) / sample.interval)));
  }
  key_ = parts_.modes.equations_key(at.values);
  Values probe = at.values;
  const bool has_due = set_due_samples(probe);
  if (has_due)  // happens() sets them again
    for (std::size_t i = 0; i < next_sample_.size(); ++i) next_sample_[i] -= probe.samples[i] != 0.0 ? 1 : 0;
  if (!has_due && !parts_.switches.update(probe)) return true;
  return happens(at, {}, "");
}

// Tells whether a root function moved away from zero since the start of the piece and came back; otherwise rounding
// errors put it on the wrong side at the start.
bool Integration::was_elsewhere(const Reached& at, int root) {
  if (!is_first_step_ || at.values.t == start_) return true;
  Values middle = at.values;
  sfdae::Point point;
  interpolate(at, 0.5 * (start_ + at.values.t), middle, point);
  std::vector<double> g(cli::at(parts_.switches.num_roots()));
  parts_.switches.evaluate_roots(middle, g.data());
  return std::fabs(g[cli::at(root)]) > 2.0 * std::fabs(roots_at_start_[cli::at(root)]);
}

// A relation whose function crosses zero toward its present value was different in between, unnoticed. This is an event
// of its own; without it, actions that wait for the relation to become true would be lost.
void Integration::recover_lost_changes(Reached& at, const std::vector<int>& roots) {
  bool has_lost = false;
  Values lost = at.values;
  for (int i = 0; i < static_cast<int>(roots.size()); ++i) {
    const int number = parts_.switches.switch_of(i);
    const bool is_relation = parts_.system.switches[cli::at(number)].kind == Switch::Kind::relation;
    if (!is_relation || roots[cli::at(i)] == 0) continue;
    Values passed = at.values;
    parts_.switches.pass(i, roots[cli::at(i)], passed);
    if (passed.switches[cli::at(number)] != at.values.switches[cli::at(number)] || !was_elsewhere(at, i)) continue;
    parts_.switches.pass(i, -roots[cli::at(i)], lost);
    has_lost = true;
  }
  if (!has_lost) return;
  at.values = lost;
  if (parts_.events.run(at.values, at.point, key_).needs_start) is_started_ = false;
}

// The row before an event. At the zero or just after it, an operation of the ending branch, such as sqrt(x) while x >
// 0, may be undefined: values slightly earlier then replace the limit.
void Integration::add_row_before(const Reached& at, const Values& before) {
  Values row = before;
  double back = rounding_.of(before.t);
  for (int k = 0; k < 4 && is_started_ && !parts_.output.is_defined(row); ++k, back *= 100.0) {
    Values earlier = before;
    sfdae::Point point;
    interpolate(at, before.t - back, earlier, point);
    row = before;
    parts_.modes.to_values(point, row);
  }
  parts_.output.add(row, before.t);
}

bool Integration::happens(Reached& at, const std::vector<int>& roots, const std::string& contradiction) {
  const Values untouched = at.values;
  recover_lost_changes(at, roots);
  const Values before = at.values;
  for (int i = 0; i < static_cast<int>(roots.size()); ++i)
    if (roots[cli::at(i)] != 0) parts_.switches.pass(i, roots[cli::at(i)], at.values);
  const bool has_sample = set_due_samples(at.values);
  parts_.switches.update(at.values);
  const bool is_event = has_sample || !contradiction.empty() || untouched.switches != at.values.switches ||
                        untouched.switches != before.switches || !are_same(untouched.variable, before.variable);
  if (!is_event) return true;
  if (parts_.result.trajectory.t.back() != at.values.t) add_row_before(at, untouched);
  std::string text = contradiction.empty() ? describe(roots, before, at.values) : contradiction;
  const EventResult result = parts_.events.run(at.values, at.point, key_);
  for (const std::string& acted : result.acted) text += (text.empty() ? "" : "; ") + acted;
  parts_.result.events.push_back({at.values.t, text});
  parts_.output.add(at.values);
  count_event(text, before, at.values);
  if (result.needs_start || roots_jump(untouched, at.values)) is_started_ = false;
  root_values_ = at.values;
  if (result.is_terminated) {
    parts_.result.message = result.message;
    add_statistics();
  }
  return !result.is_terminated;
}

// Tells whether the event changed event functions, which invalidates their recorded signs.
bool Integration::roots_jump(Values before, Values after) {
  const std::size_t count = cli::at(parts_.switches.num_roots());
  std::vector<double> g_before(count), g_after(count);
  parts_.switches.evaluate_roots(before, g_before.data());
  parts_.switches.evaluate_roots(after, g_after.data());
  return g_before != g_after;
}

void Integration::count_event(const std::string& text, const Values& before, const Values& after) {
  const double t = after.t;
  const bool is_close = t - close_events_.last <= close_events * (parts_.settings.stop - parts_.settings.start);
  if (!is_close) close_events_.changes.assign(after.switches.size(), 0);
  close_events_.count = is_close ? close_events_.count + 1 : 0;
  close_events_.last = t;
  int most_changes = 0;
  for (std::size_t s = 0; s < after.switches.size(); ++s)
    if (before.switches[s] != after.switches[s]) most_changes = std::max(most_changes, ++close_events_.changes[s]);
  if (close_events_.count > max_close_events || most_changes > max_close_changes)
    throw Failure(Outcome::not_finished, SFDAE_OK,
                  "events accumulate at t = " + to_text(t) + ", the last one: " + text +
                      ". A relation changes again and again (chattering, or an impact that never ends); give it a "
                      "hysteresis, or a state of rest.");
}

std::string Integration::describe(const std::vector<int>& roots, const Values& before, const Values& after) const {
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : "; ") + what; };
  std::vector<char> is_named(after.switches.size(), 0);
  for (int i = 0; i < static_cast<int>(roots.size()); ++i)
    if (roots[cli::at(i)] != 0) is_named[cli::at(parts_.switches.switch_of(i))] = 1;
  for (std::size_t s = 0; s < after.switches.size(); ++s) {
    if (is_named[s] == 0 && before.switches[s] == after.switches[s]) continue;
    add(change_in_words(parts_.system, static_cast<int>(s), after.switches[s]));
  }
  for (std::size_t i = 0; i < after.samples.size(); ++i)
    if (after.samples[i] != 0.0)
      add(parts_.system.samples[i].text + at_place(parts_.system, parts_.system.samples[i].at));
  return text;
}

void Integration::finish(Reached& at) {
  add_statistics();
  bool has_terminal = false;
  for (Formula f = 0; f < parts_.system.formulas.size(); ++f)
    has_terminal = has_terminal || parts_.system.formulas[f].operation == Operation::terminal;
  if (!has_terminal) return;
  at.values.is_terminal = true;
  happens(at, {}, "terminal()");
}

void Integration::add_statistics() {
  if (!is_piece_open_) return;
  is_piece_open_ = false;
  sfdae::Statistics now = mode_->solver.statistics();
  sfdae::Statistics& sum = parts_.result.statistics;
  sum.steps += now.steps;
  sum.error_failures += now.error_failures;
  sum.other_failures += now.other_failures;
  sum.reductions += now.reductions;
  sum.factorizations += now.factorizations;
  sum.evaluations_E += now.evaluations_E - baseline_.evaluations_E;
  sum.evaluations_A += now.evaluations_A - baseline_.evaluations_A;
  sum.evaluations_f += now.evaluations_f - baseline_.evaluations_f;
  sum.evaluations_F += now.evaluations_F - baseline_.evaluations_F;
  sum.linearizations += now.linearizations - baseline_.linearizations;
  if (sum.first_step == 0.0) sum.first_step = now.first_step;
  sum.last_order = now.last_order;
  sum.next_order = now.next_order;
  sum.last_step = now.last_step;
  sum.next_step = now.next_step;
  sum.t_internal = now.t_internal;
  sum.smallest_kept = sum.smallest_kept > 0.0 ? std::min(sum.smallest_kept, now.smallest_kept) : now.smallest_kept;
  sum.consistency = std::max(sum.consistency, now.consistency);
  sum.rounding = std::max(sum.rounding, now.rounding);
}

}  // namespace sfdae::cli
