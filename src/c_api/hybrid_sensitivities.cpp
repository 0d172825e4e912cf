// Sensitivities of hybrid systems: what becomes of them at transitions.
//
// At a transition at t, g(t, x) = 0, time and values move with a parameter p by
//
//     dt/dp = -g_x S / (g_t + g_x x'),   dx/dp = S + x' dt/dp
//
// The map to the values after it, M(t, x, p), is differentiated along these; S after is the derivative less x' after times
// dt/dp, made consistent with the equations of the mode that begins [GFB99].
//
// [GFB99] S. Galan, W. F. Feehery, P. I. Barton: Parametric sensitivity functions for hybrid discrete/continuous systems. Appl.
//         Numer. Math. 31 (1999), 17-47.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "c_api/hybrid.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Differences of fourth order: the first step, in sizes of what moves, and how many smaller ones are tried, each a tenth; the error,
// relative, that is good enough, and the one that is none any more: then there is no derivative. (Chosen: rounding errors of jumps
// are some 1e-14, so that 1e-3 leaves 1e-11 of them.)
constexpr double first_step = 1e-3, good = 1e-8, useless = 1e-3;
constexpr int most_steps = 4;
// Differences below that, in sizes of values, are none.
constexpr double rounding = 1e-11;

struct Derivative {
  Vector value;
  double step = 0.0;
  double error = std::numeric_limits<double>::infinity();  // relative
  bool is_there() const { return error <= useless; }
};

// As values, where they are numbers: others are no derivatives.
template <class Values>
CallResult finite_values(const Values& values, double s, Vector& to) {
  CallResult result = values(s, to);
  if (result.status >= 0 && !all_finite(to.data(), to.size()))
    return {SFDAE_NOT_FINITE,
            "near a transition, where it is differentiated, values after it, or its function, are not finite."};
  return result;
}

// Differences are those of both sides, and do not see a kink between them: what these differ by does not become smaller with the
// step there. The derivative is none then.
template <class Values>
CallResult find_kink(const Values& values, const Vector& sizes, Derivative& derivative) {
  constexpr double much_smaller = 1e-2, still_there = 0.1;
  const std::size_t n = sizes.size();
  Vector here(n), above(n), below(n);
  CallResult result = finite_values(values, 0.0, here);
  double before = 0.0;
  for (double step : {derivative.step, much_smaller * derivative.step}) {
    if (result.status >= 0) result = finite_values(values, step, above);
    if (result.status >= 0) result = finite_values(values, -step, below);
    if (result.status < 0) return result;
    double difference = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      difference = std::max(difference, std::fabs(above[i] + below[i] - 2.0 * here[i]) / sizes[i]);
    const bool is_kink = step < derivative.step && difference > rounding && difference / step > still_there * before;
    if (is_kink) derivative.error = std::numeric_limits<double>::infinity();
    before = difference / step;
  }
  return {};
}

// d/ds values(s) at 0. values(s, to) writes as many numbers as there are sizes. step: the first one. Smaller ones are tried where
// there are no values; it fails as the last call has where there are none for any.
template <class Values>
CallResult differentiate(const Values& values, const Vector& sizes, double step, Derivative& derivative) {
  const std::size_t n = sizes.size();
  CallResult failure;
  for (int attempt = 0; attempt < most_steps && derivative.error > good; ++attempt, step *= 0.1) {
    const double places[] = {1.0, -1.0, 2.0, -2.0};
    Vector at[4];
    CallResult result;
    for (int k = 0; k < 4 && result.status >= 0; ++k) {
      at[k].resize(n);
      result = finite_values(values, places[k] * step, at[k]);
    }
    const bool may_be_nearer = result.status == SFDAE_NOT_FINITE || result.status == SFDAE_NO_CONSISTENT_VALUES;
    if (result.status < 0 && !may_be_nearer) return result;
    if (result.status < 0) {
      failure = std::move(result);
      continue;
    }
    Derivative found{Vector(n), step, 0.0};
    double size = 0.0, error = 0.0, moved = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double near = (at[0][i] - at[1][i]) / (2.0 * step), far = (at[2][i] - at[3][i]) / (4.0 * step);
      found.value[i] = (4.0 * near - far) / 3.0;
      size = std::max(size, std::fabs(found.value[i]) / sizes[i]);
      error = std::max(error, std::fabs(found.value[i] - near) / sizes[i]);
      moved = std::max({moved, std::fabs(at[0][i] - at[1][i]) / sizes[i], std::fabs(at[2][i] - at[3][i]) / sizes[i]});
    }
    found.error = moved <= rounding ? 0.0 : error / size;
    if (found.error < derivative.error) derivative = std::move(found);
  }
  if (derivative.value.empty() && failure.status < 0) return failure;
  return find_kink(values, sizes, derivative);
}

// What values of x are measured by: themselves, or the size at which the absolute tolerance begins to count.
Vector sizes_of(const Tolerances& tolerances, const Vector& x, std::size_t n) {
  Vector sizes(n);
  double largest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double rtol = tolerances.rtol[i], atol = tolerances.atol[i];
    sizes[i] = std::max(std::fabs(x[i]), rtol > 0.0 ? atol / rtol : 0.0);
    largest = std::max(largest, sizes[i]);
  }
  for (double& size : sizes)
    if (size == 0.0) size = largest > 0.0 ? largest : 1.0;
  return sizes;
}

// By how many of its sizes a point moves along (dt, dx).
double speed(double dt, const double* dx, const Vector& sizes, double time) {
  double largest = std::fabs(dt) / time;
  for (std::size_t i = 0; i < sizes.size(); ++i) largest = std::max(largest, std::fabs(dx[i]) / sizes[i]);
  return largest;
}

// What x is known to change little in.
double time_of(const sfdae_solver& solver) {
  const StepState state = solver.integration->stepper().state();
  const double step = std::fabs(state.last.h > 0.0 || state.last.h < 0.0 ? state.last.h : state.next_step);
  return step > 0.0 ? step : 1.0;
}

// While it lives a parameter has another value.
class ParameterShift {
 public:
  ParameterShift(Model& model, int number, double by) : model_(model), number_(number) {
    if (number_ < 0) return;
    value_ = model_.evaluator()->parameter(number_);
    set(value_ + by);
  }
  ParameterShift(const ParameterShift&) = delete;
  ParameterShift& operator=(const ParameterShift&) = delete;
  ~ParameterShift() {
    if (number_ >= 0) set(value_);
  }

 private:
  void set(double value) {
    model_.evaluator()->set_parameter(number_, value);
    model_.parameters_changed();
  }
  Model& model_;
  int number_;
  double value_ = 0.0;
};

// The function of a transition at the point of the run, and how it changes.
class TransitionRate {
 public:
  TransitionRate(const sfdae_hybrid& hybrid, const sfdae_transition& given)
      : run_(hybrid.run),
        given_(given),
        n_(index(hybrid.n())),
        sizes_(sizes_of(hybrid.mode().solver->options.model.tolerances, run_.x, n_)),
        time_(time_of(*hybrid.mode().solver)) {}

  // Along (dt, dx).
  CallResult along(double dt, const double* dx, double& rate) const {
    rate = 0.0;
    const double fastest = speed(dt, dx, sizes_, time_);
    if (fastest == 0.0) return {};
    Derivative derivative;
    CallResult result =
        differentiate([&](double s, Vector& g) { return value(run_.t + s * dt, moved(s, dx), run_.xdot, g); },
                      {size_}, first_step / fastest, derivative);
    if (result.status < 0) return result;
    if (!derivative.is_there())
      return {SFDAE_SINGULAR, format("the function of the transition at t = %.15g has no derivative there, and "
                                     "sensitivities after it do not exist.",
                                     run_.t)};
    rate = derivative.value[0];
    return result;
  }
  // Whether it is one of t and x.
  CallResult has_slopes(bool& answer) {
    Vector here(1), there(1), xdot(run_.xdot);
    CallResult result = value(run_.t, run_.x, run_.xdot, here);
    size_ = std::max(std::fabs(here[0]), std::numeric_limits<double>::min());
    // By other amounts for all.
    for (std::size_t i = 0; i < n_; ++i)
      xdot[i] += (0.5 + std::fmod(0.618 * static_cast<double>(i), 1.0)) * sizes_[i] / time_;
    if (result.status >= 0) result = value(run_.t, run_.x, xdot, there);
    answer = here[0] != there[0];
    return result;
  }
  // What it is measured by where it does not change: by what it does if x moves by its size.
  CallResult find_size() {
    Vector g(1), here(1);
    CallResult result = value(run_.t, run_.x, run_.xdot, here);
    for (std::size_t i = 0; i < n_ && result.status >= 0; ++i) {
      Vector x(run_.x);
      x[i] += first_step * sizes_[i];
      result = value(run_.t, x, run_.xdot, g);
      if (std::isfinite(g[0])) size_ = std::max(size_, std::fabs(g[0] - here[0]) / first_step);
    }
    return result;
  }

 private:
  Vector moved(double s, const double* dx) const {
    Vector x(run_.x);
    for (std::size_t i = 0; i < n_; ++i) x[i] += s * dx[i];
    return x;
  }
  CallResult value(double t, const Vector& x, const Vector& xdot, Vector& g) const {
    const int returned = given_.function(t, x.data(), xdot.data(), g.data(), given_.user);
    return returned != 0 ? of_callback(name_of_function(given_), run_, returned) : CallResult{};
  }

  const HybridRun& run_;
  const sfdae_transition& given_;
  std::size_t n_;
  Vector sizes_;
  double time_, size_ = std::numeric_limits<double>::min();
};

// dt/dp of an event.
CallResult find_shifts_of_event(sfdae_hybrid& hybrid, const sfdae_transition& given, const Vector& S) {
  HybridRun& run = hybrid.run;
  const std::size_t n = index(hybrid.n());
  TransitionRate function(hybrid, given);
  bool has_slopes = false;
  CallResult result = function.has_slopes(has_slopes);
  if (result.status >= 0) result = function.find_size();
  if (result.status < 0) return result;
  if (has_slopes)
    return illegal_argument(
        format("the function of the transition at t = %.15g depends on x'; with sensitivities it has to be one of t "
               "and x. Make x' an unknown.",
               run.t));
  double rate = 0.0;
  result = function.along(1.0, run.xdot.data(), rate);
  for (std::size_t j = 0; j < run.shifts.size() && result.status >= 0; ++j) {
    double change = 0.0;
    result = function.along(0.0, S.data() + j * n, change);
    run.shifts[j] = -change / rate;
    if (result.status >= 0 && !std::isfinite(run.shifts[j]))
      return {SFDAE_SINGULAR, format("the function of the transition at t = %.15g does not pass through zero with t: "
                                     "the time of the transition has no derivative by parameters.",
                                     run.t)};
  }
  return result;
}

// The values after a transition from those before it, which may be moved.
CallResult values_after(sfdae_hybrid& hybrid, const sfdae_transition& given, double t, const Vector& before,
                        Vector& after) {
  const HybridRun& run = hybrid.run;
  if (given.jump != nullptr) {
    after = before;
    const int returned = given.jump(t, given.from, given.to, before.data(), after.data(), given.user);
    return returned != 0 ? of_callback("jump", run, returned) : CallResult{};
  }
  sfdae_solver* solver = hybrid.modes[index(given.to)].solver;
  const int status = guarded(solver, [&]() -> CallResult {
    const UserTime user_time(solver->problem(), t);
    after = solver->model.jump({t, toward_from(run), before.data()}, solver->options.model).x;
    return {};
  });
  return status < 0 ? of_mode(hybrid, given.to, status) : CallResult{};
}

}  // namespace

CallResult ask_for_sensitivities(sfdae_hybrid& hybrid) {
  const auto& wanted = hybrid.sensitivities;
  for (int k = 0; k < static_cast<int>(hybrid.modes.size()); ++k) {
    sfdae_solver& solver = *hybrid.modes[index(k)].solver;
    if (!wanted) {
      if (solver.sensitivities) take_sensitivities(solver, std::nullopt);
      continue;
    }
    if (solver.model.evaluator() == nullptr)
      return illegal_argument(hybrid.name_of(k) + " is given by callbacks; sensitivities need recorded equations.");
    SensitivityRequest request;
    for (const std::string& name : wanted->names)
      request.parameters.push_back(name.empty() ? -1 : solver.model.evaluator()->find_parameter(name).value_or(-1));
    request.directions.assign(wanted->directions.size(), 0.0);
    request.options = wanted->options;
    const auto& asked = solver.sensitivities;
    if (asked && asked->parameters == request.parameters && asked->options == request.options) continue;
    take_sensitivities(solver, std::move(request));
  }
  return {};
}

CallResult find_shifts(sfdae_hybrid& hybrid, const HybridTransition& transition, bool at_once) {
  if (!hybrid.sensitivities) return {};
  HybridRun& run = hybrid.run;
  const std::size_t n = index(hybrid.n());
  Vector S(hybrid.sensitivities->directions.size());
  const int status = sfdae_get_sensitivities(hybrid.mode().solver, run.t, S.data(), nullptr);
  if (status < 0) return of_mode(hybrid, run.mode, status);
  if (transition.given.kind == SFDAE_TRANSITION_TIME) {
    std::fill(run.shifts.begin(), run.shifts.end(), 0.0);
  } else if (!at_once) {
    CallResult result = find_shifts_of_event(hybrid, transition.given, S);
    if (result.status < 0) return result;
  }
  for (std::size_t j = 0; j < run.shifts.size(); ++j)
    for (std::size_t i = 0; i < n; ++i) S[i + j * n] += run.xdot[i] * run.shifts[j];
  run.moved = std::move(S);
  run.time_before = time_of(*hybrid.mode().solver);
  return {};
}

CallResult carry_over(sfdae_hybrid& hybrid, const sfdae_transition& given) {
  if (!hybrid.sensitivities) return {};
  HybridRun& run = hybrid.run;
  sfdae_solver& solver = *hybrid.modes[index(given.to)].solver;
  const std::size_t n = index(hybrid.n());
  Vector sizes = sizes_of(solver.options.model.tolerances, run.before, n);
  const Vector sizes_after = sizes_of(solver.options.model.tolerances, run.after, n);
  for (std::size_t i = 0; i < n; ++i) sizes[i] = std::max(sizes[i], sizes_after[i]);
  for (std::size_t j = 0; j < run.shifts.size(); ++j) {
    const int parameter = given.jump == nullptr ? solver.sensitivities->parameters[j] : -1;
    double* const D = run.moved.data() + j * n;
    double fastest = speed(run.shifts[j], D, sizes, run.time_before);
    if (parameter >= 0) {
      const double value = std::fabs(solver.model.evaluator()->parameter(parameter));
      fastest = std::max(fastest, 1.0 / (value > 0.0 ? value : 1.0));
    }
    if (fastest == 0.0) continue;
    const auto values = [&](double s, Vector& after) {
      Vector before(run.before);
      for (std::size_t i = 0; i < n; ++i) before[i] += s * D[i];
      const ParameterShift shift(solver.model, parameter, s);
      return values_after(hybrid, given, run.t + s * run.shifts[j], before, after);
    };
    Derivative derivative;
    CallResult result = differentiate(values, sizes, first_step / fastest, derivative);
    if (result.status < 0) return result;
    if (!derivative.is_there())
      return {
          SFDAE_SINGULAR,
          format("the values after the transition at t = %.15g, from %s to %s, have no derivative by those before "
                 "it: sensitivities after it do not exist.",
                 run.t, hybrid.name_of(given.from).c_str(), hybrid.name_of(given.to).c_str())};
    std::copy_n(derivative.value.begin(), n, D);
  }
  return {};
}

void begin_sensitivities(sfdae_hybrid& hybrid, int mode) {
  if (!hybrid.sensitivities) return;
  SensitivityRequest& request = *hybrid.modes[index(mode)].solver->sensitivities;
  request.directions = hybrid.run.moved;
  request.shifts = hybrid.run.shifts;
}

void end_sensitivities(sfdae_hybrid& hybrid, int mode) {
  if (!hybrid.sensitivities) return;
  SensitivityRequest& request = *hybrid.modes[index(mode)].solver->sensitivities;
  std::fill(request.directions.begin(), request.directions.end(), 0.0);
  request.shifts.clear();
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

constexpr int most_sensitivities = 10000;

CallResult check_modes(const sfdae_hybrid& hybrid) {
  if (hybrid.modes.empty()) return illegal_argument("there are no modes: call sfdae_add_mode first.");
  if (!hybrid.switches.empty())
    return illegal_argument("there are no sensitivities of hybrid systems with switches, along surfaces.");
  for (std::size_t k = 0; k < hybrid.modes.size(); ++k)
    if (hybrid.modes[k].solver->model.evaluator() == nullptr)
      return illegal_argument(hybrid.name_of(static_cast<int>(k)) +
                              " is given by callbacks; sensitivities need recorded equations.");
  return {};
}

CallResult read_names(const sfdae_hybrid& hybrid, int count, const char* const* names, HybridSensitivities& wanted) {
  wanted.names.assign(index(count), "");
  for (int j = 0; j < count && names != nullptr; ++j) {
    if (names[j] == nullptr) continue;
    const auto has_it = [&](const HybridMode& mode) {
      return mode.solver->model.evaluator()->find_parameter(names[j]).has_value();
    };
    if (std::none_of(hybrid.modes.begin(), hybrid.modes.end(), has_it))
      return illegal_argument(format("parameters[%d]: there is no parameter \"%.60s\" in any mode.", j, names[j]));
    wanted.names[index(j)] = names[j];
  }
  return {};
}

CallResult read_wanted(const sfdae_hybrid& hybrid, int count, const char* const* names, const double* directions,
                       const sfdae_sensitivity_options* options, HybridSensitivities& wanted) {
  CallResult checked = check_modes(hybrid);
  if (checked.status == SFDAE_OK) checked = read_names(hybrid, count, names, wanted);
  if (checked.status != SFDAE_OK) return checked;
  const std::size_t size = index(hybrid.n()) * index(count);
  if (directions != nullptr && !all_finite(directions, size))
    return illegal_argument("directions has entries that are not finite.");
  wanted.directions.assign(size, 0.0);
  if (directions != nullptr) std::copy_n(directions, size, wanted.directions.begin());
  SensitivityRequest request;
  checked = read_sensitivity_options(count, options, request);
  if (checked.status != SFDAE_OK) return checked;
  if (request.by_adjoint)
    return illegal_argument("adjoint = 1 is for single problems: steps are not kept over transitions.");
  wanted.options = std::move(request.options);
  return {};
}

bool has_sensitivities(const sfdae_hybrid& hybrid) {
  return hybrid.is_running() && hybrid.mode().solver->integration->sensitivities() != nullptr;
}

CallResult no_sensitivities() {
  return {SFDAE_NOT_STARTED,
          "there are no sensitivities: call sfdae_set_hybrid_sensitivities and sfdae_start_hybrid first."};
}

}  // namespace

extern "C" {

int sfdae_set_hybrid_sensitivities(sfdae_hybrid* hybrid, int count, const char* const* parameters,
                                   const double* directions, const sfdae_sensitivity_options* options) {
  return guarded(hybrid, [&]() -> CallResult {
    if (count < 0 || count > most_sensitivities)
      return illegal_argument(format("count = %d; it must be 0 ... %d.", count, most_sensitivities));
    std::optional<HybridSensitivities> wanted;
    if (count > 0) {
      const CallResult checked = read_wanted(*hybrid, count, parameters, directions, options, wanted.emplace());
      if (checked.status != SFDAE_OK) return checked;
    }
    // Nothing fails from here on.
    hybrid->sensitivities = std::move(wanted);
    hybrid->run.mode = -1;
    return {};
  });
}

int sfdae_get_hybrid_sensitivities(sfdae_hybrid* hybrid, double t, double* S, double* Sdot) {
  return guarded(hybrid, [&]() -> CallResult {
    if (!has_sensitivities(*hybrid)) return no_sensitivities();
    const int status = sfdae_get_sensitivities(hybrid->mode().solver, t, S, Sdot);
    return status < 0 ? of_mode(*hybrid, hybrid->run.mode, status) : CallResult{};
  });
}

int sfdae_get_passage_sensitivities(sfdae_hybrid* hybrid, double* dt) {
  return guarded(hybrid, [&]() -> CallResult {
    if (dt == nullptr) return illegal_argument("dt is NULL.");
    if (!has_sensitivities(*hybrid)) return no_sensitivities();
    const HybridRun& run = hybrid->run;
    if (run.forgotten == 0 && run.passages.empty())
      return {SFDAE_NOT_STARTED, "there was no transition since the start."};
    std::copy(run.shifts.begin(), run.shifts.end(), dt);
    return {};
  });
}

}  // extern "C"
