// Sensitivities of hybrid systems: what becomes of them at transitions.
//
// At a transition at t, g(t, x) = 0, time and values move with a parameter p by
//
//     dt/dp = -(g_x S + g_p) / (g_t + g_x x'),   dx/dp = S + x' dt/dp
//
// with g_p of surfaces of switches, which are formulas; other functions know no parameters.
// The map to the values after it, M(t, x, p), is differentiated along these; S after is the derivative less x' after
// times dt/dp, made consistent with the equations of the mode that begins [GFB99].
//
// [GFB99] S. Galan, W. F. Feehery, P. I. Barton: Parametric sensitivity functions for hybrid discrete/continuous
// systems. Appl.
//         Numer. Math. 31 (1999), 17-47.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "c_api/hybrid.h"
#include "c_api/map_differences.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// The first step of differences, in sizes of what moves. (Chosen: rounding errors of jumps are some 1e-14, so that
// this leaves 1e-11 of them.)
constexpr double first_step = 1e-3;
// What else than x moves a map counts for that part of it, where derivatives are looked at for whether they are 0.
// (Chosen.)
constexpr double minor = 1e-3;
// What moves less than that, of what else moves a map, may be rounding errors alone: those of values at rest. (Chosen.)
constexpr double negligible = 1e-6;

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

// By how many of its sizes x moves along dx.
double speed(const double* dx, const Vector& sizes) {
  double largest = 0.0;
  for (std::size_t i = 0; i < sizes.size(); ++i) largest = std::max(largest, std::fabs(dx[i]) / sizes[i]);
  return largest;
}

// What x is known to change little in.
double time_of(const sfdae_solver& solver) {
  const StepState state = solver.integration->stepper().state();
  const double step = std::max(std::fabs(state.last.h), std::fabs(state.next_step));
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

// Columns with other numbers of rows: those that are left out were the last ones, those that are added are 0.
Vector with_rows(int rows, const Vector& columns, int wanted) {
  const std::size_t from = index(rows), to = index(wanted), count = columns.size() / from;
  Vector result(to * count, 0.0);
  for (std::size_t j = 0; j < count; ++j)
    std::copy_n(columns.data() + j * from, std::min(from, to), result.data() + j * to);
  return result;
}

// The function of a transition at the point of the run, and how it changes.
class TransitionRate {
 public:
  TransitionRate(const sfdae_hybrid& hybrid, const sfdae_transition& given)
      : hybrid_(hybrid),
        run_(hybrid.run),
        given_(given),
        n_(index(hybrid.mode().solver->model.n())),
        sizes_(sizes_of(hybrid.mode().solver->options.model.tolerances, run_.x, n_)),
        time_(time_of(*hybrid.mode().solver)) {}

  // With t, along x'.
  CallResult with_time(double& rate) const { return along(1.0, run_.xdot.data(), 0.0, rate); }
  // Along dx.
  CallResult along(const double* dx, double& change) const {
    return along(0.0, dx, minor * speed(dx, sizes_), change);
  }
  // Whether it only touches 0, within the tolerances: the parabola through its values in the last step does not go
  // beyond.
  CallResult is_tangent(double rate, bool& answer) const {
    constexpr double in_tolerances = 10.0, apart = 0.1, beside = 0.11;
    answer = false;
    Integration& integration = *hybrid_.mode().solver->integration;
    const StepState state = integration.stepper().state();
    const double h = state.last.h, from = state.t - h;
    if (h == 0.0) return {};
    double margin = 0.0, value[3];
    CallResult result = find_margin(hybrid_, given_, margin);
    // g bends by some of its sizes in a step at most.
    if (result.status >= 0 && rate * h * rate * h > in_tolerances * 20.0 * margin * size_) return {};
    // Three places within the step, as near to the transition as may be.
    const double middle = from + std::clamp((run_.t - from) / h, beside, 1.0 - beside) * h;
    Vector x(sizes_.size()), xdot(sizes_.size()), g(1);
    for (int k = 0; k < 3 && result.status >= 0; ++k) {
      const double t = middle + (k - 1) * apart * h;
      result = integration.interpolate(t, true, x.data(), xdot.data());
      if (result.status >= 0) result = this->value(t, x, xdot, g);
      value[k] = g[0];
    }
    if (result.status < 0) return result;
    const double bend = std::fabs(value[0] - 2.0 * value[1] + value[2]) / (apart * h * apart * h);
    answer = !(rate * rate > in_tolerances * 2.0 * margin * bend);
    return {};
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
  // What it is measured by: by what it does if x moves by its size, or t by a step.
  CallResult find_size() {
    Vector g(1), here(1);
    CallResult result = value(run_.t, run_.x, run_.xdot, here);
    if (result.status >= 0) result = value(run_.t + first_step * time_, run_.x, run_.xdot, g);
    if (std::isfinite(g[0])) size_ = std::max(size_, std::fabs(g[0] - here[0]) / first_step);
    for (std::size_t i = 0; i < n_ && result.status >= 0; ++i) {
      Vector x(run_.x);
      x[i] += first_step * sizes_[i];
      result = value(run_.t, x, run_.xdot, g);
      if (std::isfinite(g[0])) size_ = std::max(size_, std::fabs(g[0] - here[0]) / first_step);
    }
    return result;
  }

 private:
  // least: as Differencing has it, in what the function is measured by.
  CallResult along(double dt, const double* dx, double least, double& rate) const {
    rate = 0.0;
    const double fastest = std::max(std::fabs(dt) / time_, speed(dx, sizes_));
    if (fastest == 0.0) return {};
    DerivativeAlong derivative;
    CallResult result =
        differentiate_along([&](double s, Vector& g) { return value(run_.t + s * dt, moved(s, dx), run_.xdot, g); },
                            {{size_}, first_step / fastest, least}, derivative);
    if (result.status < 0) return result;
    if (!derivative.is_there())
      return {SFDAE_SINGULAR, format("the function of the transition at t = %.15g has no derivative there, and "
                                     "sensitivities after it do not exist.",
                                     run_.t)};
    rate = derivative.value[0];
    return result;
  }
  Vector moved(double s, const double* dx) const {
    Vector x(run_.x);
    for (std::size_t i = 0; i < n_; ++i) x[i] += s * dx[i];
    return x;
  }
  CallResult value(double t, const Vector& x, const Vector& xdot, Vector& g) const {
    const int returned = given_.function(t, x.data(), xdot.data(), g.data(), given_.user);
    return returned != 0 ? of_callback(name_of_function(given_), run_, returned) : CallResult{};
  }

  const sfdae_hybrid& hybrid_;
  const HybridRun& run_;
  const sfdae_transition& given_;
  std::size_t n_;
  Vector sizes_;
  double time_, size_ = std::numeric_limits<double>::min();
};

// Of the surface of a switch, where it is one.
CallResult change_by_parameters(const sfdae_hybrid& hybrid, const HybridTransition& transition, Vector& changes) {
  if (transition.surface == nullptr) return {};
  const HybridRun& run = hybrid.run;
  try {
    changes =
        transition.surface->change_by(hybrid.sensitivities->names, transition.given.function, run.t, run.x.data());
  } catch (const Failure& failure) {
    return {failure.status(), std::string("the surface of a switch: ") + failure.what()};
  }
  return {};
}

// dt/dp of an event.
CallResult find_shifts_of_event(sfdae_hybrid& hybrid, const HybridTransition& transition, const Vector& S) {
  HybridRun& run = hybrid.run;
  const sfdae_transition& given = transition.given;
  const std::size_t n = index(hybrid.width());
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
  bool is_tangent = false;
  result = function.with_time(rate);
  if (result.status >= 0) result = function.is_tangent(rate, is_tangent);
  Vector by_parameters(run.shifts.size(), 0.0);
  if (result.status >= 0) result = change_by_parameters(hybrid, transition, by_parameters);
  by_parameters.resize(run.shifts.size(), 0.0);  // columns of values have none
  for (std::size_t j = 0; j < run.shifts.size() && result.status >= 0; ++j) {
    double change = 0.0;
    result = function.along(S.data() + j * n, change);
    change += by_parameters[j];
    run.shifts[j] = rate != 0.0 ? -change / rate : 0.0;
    is_tangent = is_tangent || rate == 0.0 || !std::isfinite(run.shifts[j]);
  }
  if (result.status >= 0 && is_tangent)
    return {SFDAE_SINGULAR, format("the function of the transition at t = %.15g touches zero only, within the "
                                   "tolerances: the time of the transition has no derivative by parameters.",
                                   run.t)};
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

// The derivatives of the values after a jump by impulses along the directions of run.moved, which they replace, from
// its equations. False where these do not say them.
CallResult differentiate_jump(sfdae_hybrid& hybrid, const sfdae_transition& given, bool& is_found) {
  HybridRun& run = hybrid.run;
  sfdae_solver* solver = hybrid.modes[index(given.to)].solver;
  const int rows = solver->model.n(), count = static_cast<int>(run.shifts.size());
  Matrix after(rows, count);
  is_found = false;
  const int status = guarded(solver, [&]() -> CallResult {
    const UserTime user_time(solver->problem(), run.t);
    const View moved{run.moved.data(), rows, count, std::max(hybrid.width(), 1)};
    const MovingJump moving{run.t,
                            toward_from(run),
                            run.before.data(),
                            run.after.data(),
                            solver->sensitivities->parameters,
                            run.shifts.data(),
                            moved};
    try {
      is_found = solver->model.differentiate_jump(moving, solver->options.model, after);
    } catch (const Failure& failure) {
      if (ends_everything(failure.status())) throw;
    }
    if (is_found) copy(after, moved);
    return {};
  });
  return status < 0 ? of_mode(hybrid, given.to, status) : CallResult{};
}

// Whatever columns there were of transitions.
bool asks_for_the_same(const SensitivityRequest& asked, const SensitivityRequest& wanted) {
  const auto end = asked.parameters.end() - asked.num_of_values;
  return std::equal(asked.parameters.begin(), end, wanted.parameters.begin(), wanted.parameters.end()) &&
         asked.options == wanted.options && asked.by_adjoint == wanted.by_adjoint &&
         asked.max_kept_steps == wanted.max_kept_steps;
}

// With the adjoint there are columns of values before a transition, beside those of parameters.
void match_columns(const sfdae_hybrid& hybrid, SensitivityRequest& request) {
  const std::size_t columns = hybrid.run.shifts.size();
  request.parameters.resize(columns, -1);
  request.num_of_values = static_cast<int>(columns - hybrid.sensitivities->names.size());
}

}  // namespace

Vector directions_at_start(const sfdae_hybrid& hybrid) {
  return with_rows(hybrid.n(), hybrid.sensitivities->directions, hybrid.width());
}

CallResult ask_for_sensitivities(sfdae_hybrid& hybrid) {
  const auto& wanted = hybrid.sensitivities;
  for (int k = 0; k < static_cast<int>(hybrid.modes.size()); ++k) {
    sfdae_solver& solver = *hybrid.modes[index(k)].solver;
    if (!wanted) {
      if (solver.sensitivities) solver.ask_for_sensitivities(std::nullopt);
      continue;
    }
    if (solver.model.evaluator() == nullptr)
      return illegal_argument(hybrid.name_of(k) + " is given by callbacks; sensitivities need recorded equations.");
    SensitivityRequest request;
    for (const std::string& name : wanted->names)
      request.parameters.push_back(name.empty() ? -1 : solver.model.evaluator()->find_parameter(name).value_or(-1));
    request.directions.assign(index(solver.model.n()) * wanted->names.size(), 0.0);
    request.last_follows = hybrid.modes[index(k)].surface != nullptr;
    request.options = wanted->options;
    request.by_adjoint = wanted->by_adjoint;
    request.max_kept_steps = wanted->max_kept_steps;
    if (solver.sensitivities && asks_for_the_same(*solver.sensitivities, request)) continue;
    solver.ask_for_sensitivities(std::move(request));
  }
  return {};
}

CallResult find_shifts(sfdae_hybrid& hybrid, const HybridTransition& transition, bool at_once) {
  if (!hybrid.sensitivities) return {};
  HybridRun& run = hybrid.run;
  const int rows = hybrid.mode().solver->model.n();
  const std::size_t n = index(hybrid.width());
  Vector S(index(rows) * run.shifts.size());
  if (hybrid.sensitivities->by_adjoint) {
    CallResult found = find_columns(hybrid, at_once, S);
    if (found.status < 0) return found;
  } else {
    const int status = sfdae_get_sensitivities(hybrid.mode().solver, run.t, S.data(), nullptr);
    if (status < 0) return of_mode(hybrid, run.mode, status);
  }
  S = with_rows(rows, S, hybrid.width());
  if (transition.given.kind == SFDAE_TRANSITION_TIME) {
    std::fill(run.shifts.begin(), run.shifts.end(), 0.0);
  } else if (!at_once) {
    CallResult result = find_shifts_of_event(hybrid, transition, S);
    if (result.status < 0) return result;
  }
  for (std::size_t j = 0; j < run.shifts.size(); ++j)
    for (std::size_t i = 0; i < index(hybrid.n()); ++i) S[i + j * n] += run.xdot[i] * run.shifts[j];
  run.moved = std::move(S);
  run.time_before = time_of(*hybrid.mode().solver);
  return {};
}

CallResult carry_over(sfdae_hybrid& hybrid, const sfdae_transition& given) {
  if (!hybrid.sensitivities) return {};
  HybridRun& run = hybrid.run;
  sfdae_solver& solver = *hybrid.modes[index(given.to)].solver;
  match_columns(hybrid, *solver.sensitivities);
  const std::size_t n = index(hybrid.n()), rows = index(solver.model.n()), stride = index(hybrid.width());
  // The part of a mode, where there is one, is found anew.
  for (std::size_t j = 0; j < run.shifts.size(); ++j)
    std::fill(run.moved.data() + j * stride + n, run.moved.data() + (j + 1) * stride, 0.0);
  if (given.jump == nullptr) {
    bool is_found = false;
    CallResult result = differentiate_jump(hybrid, given, is_found);
    if (is_found || result.status < 0) return result;
  }
  Vector sizes = sizes_of(solver.options.model.tolerances, run.before, rows);
  const Vector sizes_after = sizes_of(solver.options.model.tolerances, run.after, rows);
  for (std::size_t i = 0; i < rows; ++i) sizes[i] = std::max(sizes[i], sizes_after[i]);
  const Vector sizes_before(sizes.begin(), sizes.begin() + hybrid.n());
  Vector here;
  for (std::size_t j = 0; j < run.shifts.size(); ++j) {
    const int parameter = given.jump == nullptr ? solver.sensitivities->parameters[j] : -1;
    double* const D = run.moved.data() + j * stride;
    const double pace = speed(D, sizes_before);
    double others = std::fabs(run.shifts[j]) / run.time_before;
    if (parameter >= 0) {
      const double value = std::fabs(solver.model.evaluator()->parameter(parameter));
      others = std::max(others, 1.0 / (value > 0.0 ? value : 1.0));
    }
    if (pace == 0.0 && others == 0.0) continue;
    // What D is the sum of may cancel.
    const double parts = std::max(pace, std::fabs(run.shifts[j]) * speed(run.xdot.data(), sizes_before));
    const Differencing how{sizes, first_step / std::max(pace, others),
                           parts > 0.0 ? std::max(parts, negligible * others) : minor * others, &here};
    const auto values = [&](double s, Vector& after) {
      Vector before(run.before);
      for (std::size_t i = 0; i < n; ++i) before[i] += s * D[i];
      const ParameterShift shift(solver.model, parameter, s);
      return values_after(hybrid, given, run.t + s * run.shifts[j], before, after);
    };
    DerivativeAlong derivative;
    CallResult result = differentiate_along(values, how, derivative);
    if (result.status < 0) return result;
    if (!derivative.is_there())
      return {
          SFDAE_SINGULAR,
          format("the values after the transition at t = %.15g, from %s to %s, have no derivative by those before "
                 "it: sensitivities after it do not exist.",
                 run.t, hybrid.name_of(given.from).c_str(), hybrid.name_of(given.to).c_str())};
    std::copy_n(derivative.value.begin(), rows, D);
  }
  return {};
}

void begin_sensitivities(sfdae_hybrid& hybrid, int mode) {
  if (!hybrid.sensitivities) return;
  sfdae_solver& solver = *hybrid.modes[index(mode)].solver;
  SensitivityRequest& request = *solver.sensitivities;
  match_columns(hybrid, request);
  request.directions = with_rows(hybrid.width(), hybrid.run.moved, solver.model.n());
  request.shifts = hybrid.run.shifts;
}

void end_sensitivities(sfdae_hybrid& hybrid, int mode) {
  if (!hybrid.sensitivities) return;
  SensitivityRequest& request = *hybrid.modes[index(mode)].solver->sensitivities;
  std::fill(request.directions.begin(), request.directions.end(), 0.0);
  request.shifts.clear();
}

}  // namespace sfdae::core
