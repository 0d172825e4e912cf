// Sensitivities of hybrid systems and their changes at transitions.
//
// At a transition at t, g(t, x) = 0, time and values depend on a parameter p by
//
//     dt/dp = -(g_x S + g_p) / (g_t + g_x x'),   dx/dp = S + x' dt/dp
//
// with g_p of surfaces of switches, which are formulas; other functions have no parameters.
// The map to the values after it, M(t, x, p), is differentiated along these. S after the transition is this derivative
// minus x' after it times dt/dp, made consistent with the equations of the new mode [GFB99].
//
// [GFB99] S. Galan, W. F. Feehery, P. I. Barton: Parametric sensitivity functions for hybrid discrete/continuous
// systems. Appl.
//         Numer. Math. 31 (1999), 17-47.
// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/hybrid_sensitivities.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "hybrid/accumulation.h"
#include "hybrid/map_differences.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// First step of finite differences, relative to the size of the moved variable. (Chosen: rounding errors of jumps are
// about 1e-14, so their contribution is about 1e-11.)
constexpr double first_step = 1e-3;
// Derivatives of transition functions, and of maps before which x does not move, count as 0 below this part of the
// speed of the movement, in sizes. (Chosen.)
constexpr double minor = 1e-3;
// Movements of x below this part of the other changes may be rounding errors of values at rest. (Chosen.)
constexpr double negligible = 1e-6;

// Sizes of the components of x: their values, or atol / rtol if that is larger.
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

// Sizes of the values at a transition: the larger of those before and after it.
Vector sizes_at_transition(const Tolerances& tolerances, const ValuesAtTransition& values, std::size_t n) {
  Vector sizes = sizes_of(tolerances, values.before, n);
  const Vector after = sizes_of(tolerances, values.after, n);
  for (std::size_t i = 0; i < n; ++i) sizes[i] = std::max(sizes[i], after[i]);
  return sizes;
}

// Largest movement along dx, relative to the sizes of x.
double speed(const double* dx, const Vector& sizes) {
  double largest = 0.0;
  for (std::size_t i = 0; i < sizes.size(); ++i) largest = std::max(largest, std::fabs(dx[i]) / sizes[i]);
  return largest;
}

// Time scale of x: the step size.
double time_of(const Solver& solver) {
  const StepState state = solver.integration->stepper().state();
  const double step = std::max(std::fabs(state.last.h), std::fabs(state.next_step));
  return step > 0.0 ? step : 1.0;
}

// Scope in which a parameter has another value.
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

// Changes the number of rows of columns: the last rows are dropped, or rows of zeros are appended.
Vector with_rows(int rows, const Vector& columns, int wanted) {
  const std::size_t from = index(rows), to = index(wanted), count = columns.size() / from;
  Vector result(to * count, 0.0);
  for (std::size_t j = 0; j < count; ++j)
    std::copy_n(columns.data() + j * from, std::min(from, to), result.data() + j * to);
  return result;
}

// The function of a transition at the point of the run, and its derivatives.
class TransitionRate {
 public:
  TransitionRate(const HybridSystem& hybrid, const sfdae_transition& given)
      : hybrid_(hybrid),
        run_(hybrid.run),
        given_(given),
        n_(index(hybrid.mode().solver->model.n())),
        sizes_(sizes_of(hybrid.mode().solver->options.model.tolerances, run_.x, n_)),
        time_(time_of(*hybrid.mode().solver)) {}

  // With respect to t, along x'.
  double with_time() const { return along(1.0, run_.xdot.data(), 0.0); }
  // Along dx.
  double along(const double* dx) const { return along(0.0, dx, minor * speed(dx, sizes_)); }
  // True if the function only touches 0 within the tolerances: the parabola through its values in the last step does
  // not cross 0 clearly.
  bool is_tangent(double rate) const {
    constexpr double in_tolerances = 10.0, apart = 0.1, beside = 0.11;
    Integration& integration = *hybrid_.mode().solver->integration;
    const StepState state = integration.stepper().state();
    const double h = state.last.h, from = state.t - h;
    if (h == 0.0) return false;
    const double margin = margin_of(hybrid_, given_);
    // In a step g bends at most by some of its sizes.
    if (rate * h * rate * h > in_tolerances * 20.0 * margin * size_) return false;
    // Three places within the step, as near to the transition as possible.
    const double middle = from + std::clamp((run_.t - from) / h, beside, 1.0 - beside) * h;
    Vector x(sizes_.size()), xdot(sizes_.size());
    double value[3];
    for (int k = 0; k < 3; ++k) {
      const double t = middle + (k - 1) * apart * h;
      const CallResult result = integration.interpolate(t, true, x.data(), xdot.data());
      if (result.status < 0) throw Failure(result.status, result.message);
      value[k] = this->value(t, x, xdot);
    }
    const double bend = std::fabs(value[0] - 2.0 * value[1] + value[2]) / (apart * h * apart * h);
    return !(rate * rate > in_tolerances * 2.0 * margin * bend);
  }
  // True if the function depends on x'.
  bool has_slopes() {
    Vector xdot(run_.xdot);
    const double here = value(run_.t, run_.x, run_.xdot);
    size_ = std::max(std::fabs(here), std::numeric_limits<double>::min());
    // Different amounts for all components.
    for (std::size_t i = 0; i < n_; ++i)
      xdot[i] += (0.5 + std::fmod(0.618 * static_cast<double>(i), 1.0)) * sizes_[i] / time_;
    return here != value(run_.t, run_.x, xdot);
  }
  // Finds the size of the function: its change if x moves by its size, or t by a step.
  void find_size() {
    const double here = value(run_.t, run_.x, run_.xdot);
    const auto look_at = [&](double t, const Vector& x) {
      const double g = value(t, x, run_.xdot);
      if (std::isfinite(g)) size_ = std::max(size_, std::fabs(g - here) / first_step);
    };
    look_at(run_.t + first_step * time_, run_.x);
    for (std::size_t i = 0; i < n_; ++i) {
      Vector x(run_.x);
      x[i] += first_step * sizes_[i];
      look_at(run_.t, x);
    }
  }

 private:
  // least: see Differencing, in units of the size of the function.
  double along(double dt, const double* dx, double least) const {
    const double fastest = std::max(std::fabs(dt) / time_, speed(dx, sizes_));
    if (fastest == 0.0) return 0.0;
    const DerivativeAlong derivative =
        differentiate_along([&](double s, Vector& g) { g[0] = value(run_.t + s * dt, moved(s, dx), run_.xdot); },
                            {{size_}, first_step / fastest, least});
    if (derivative.is_there()) return derivative.value[0];
    throw Failure(SFDAE_SINGULAR, format("the function of the transition at t = %.15g has no derivative there, and "
                                         "sensitivities after it do not exist.",
                                         run_.t));
  }
  Vector moved(double s, const double* dx) const {
    Vector x(run_.x);
    for (std::size_t i = 0; i < n_; ++i) x[i] += s * dx[i];
    return x;
  }
  double value(double t, const Vector& x, const Vector& xdot) const {
    return function_at(run_, given_, t, x.data(), xdot.data());
  }

  const HybridSystem& hybrid_;
  const HybridRun& run_;
  const sfdae_transition& given_;
  std::size_t n_;
  Vector sizes_;
  double time_, size_ = std::numeric_limits<double>::min();
};

// Derivatives of a switch's surface by the parameters; 0 for other transitions and for columns of values.
Vector change_by_parameters(const HybridSystem& hybrid, const HybridTransition& transition) {
  const HybridRun& run = hybrid.run;
  Vector changes;
  try {
    if (transition.surface != nullptr)
      changes =
          transition.surface->change_by(hybrid.sensitivities->names, transition.given.function, run.t, run.x.data());
  } catch (const Failure& failure) {
    throw Failure(failure.status(), std::string("the surface of a switch: ") + failure.what());
  }
  changes.resize(run.moving.shifts.size(), 0.0);
  return changes;
}

// dt/dp of an event.
void find_shifts_of_event(HybridSystem& hybrid, const HybridTransition& transition, const Vector& S) {
  HybridRun& run = hybrid.run;
  const std::size_t n = index(hybrid.width());
  TransitionRate function(hybrid, transition.given);
  const bool has_slopes = function.has_slopes();
  function.find_size();
  if (has_slopes)
    refuse_argument(
        format("the function of the transition at t = %.15g depends on x'; with sensitivities it has to be one of t "
               "and x. Make x' an unknown.",
               run.t));
  const double rate = function.with_time();
  bool is_tangent = function.is_tangent(rate);
  const Vector by_parameters = change_by_parameters(hybrid, transition);
  Vector& shifts = run.moving.shifts;
  for (std::size_t j = 0; j < shifts.size(); ++j) {
    const double change = function.along(S.data() + j * n) + by_parameters[j];
    shifts[j] = rate != 0.0 ? -change / rate : 0.0;
    is_tangent = is_tangent || rate == 0.0 || !std::isfinite(shifts[j]);
  }
  if (is_tangent)
    throw Failure(SFDAE_SINGULAR, format("the function of the transition at t = %.15g touches zero only, within the "
                                         "tolerances: the time of the transition has no derivative by parameters.",
                                         run.t));
}

// The values after a transition from those before it, which may be perturbed.
void find_moved_values(HybridSystem& hybrid, const sfdae_transition& given, double t, const Vector& before,
                       Vector& after) {
  const HybridRun& run = hybrid.run;
  if (given.jump != nullptr) {
    after = before;
    demand_success("jump", run, given.jump(t, given.from, given.to, before.data(), after.data(), given.user));
    return;
  }
  hybrid.call(given.to, [&](Solver& solver) {
    const UserTime user_time(solver.problem(), t);
    after = solver.model.whole().jump({t, run.toward_from(), before.data()}, solver.options.model).x;
  });
}

// Differentiates the equations of a jump by impulses: the derivatives of the values after it along the directions in
// run.moving.moved replace these. Returns false if the equations do not determine them.
bool has_differentiated_jump(HybridSystem& hybrid, const sfdae_transition& given) {
  HybridRun& run = hybrid.run;
  bool is_found = false;
  hybrid.call(given.to, [&](Solver& solver) {
    const int rows = solver.model.n(), count = static_cast<int>(run.moving.shifts.size());
    Matrix after(rows, count);
    const UserTime user_time(solver.problem(), run.t);
    const View moved{run.moving.moved.data(), rows, count, std::max(hybrid.width(), 1)};
    const MovingJump moving{run.t,
                            run.toward_from(),
                            run.last.before.data(),
                            run.last.after.data(),
                            solver.sensitivities->parameters,
                            run.moving.shifts.data(),
                            moved};
    try {
      is_found = solver.model.differentiate_jump(moving, solver.options.model, after);
    } catch (const Failure& failure) {
      if (ends_everything(failure.status())) throw;
    }
    if (is_found) copy(after, moved);
  });
  return is_found;
}

// Compares requests, ignoring columns for values at transitions.
bool asks_for_the_same(const SensitivityRequest& asked, const SensitivityRequest& wanted) {
  const auto end = asked.parameters.end() - asked.num_of_values;
  return std::equal(asked.parameters.begin(), end, wanted.parameters.begin(), wanted.parameters.end()) &&
         asked.options == wanted.options && asked.by_adjoint == wanted.by_adjoint &&
         asked.max_kept_steps == wanted.max_kept_steps;
}

// With the adjoint there are columns of values before a transition in addition to those of parameters.
void match_columns(const HybridSystem& hybrid, SensitivityRequest& request) {
  const std::size_t columns = hybrid.run.moving.shifts.size();
  request.parameters.resize(columns, -1);
  request.num_of_values = static_cast<int>(columns - hybrid.sensitivities->names.size());
}

}  // namespace

Vector directions_at_start(const HybridSystem& hybrid) {
  return with_rows(hybrid.n(), hybrid.sensitivities->directions, hybrid.width());
}

void ask_for_sensitivities(HybridSystem& hybrid) {
  const auto& wanted = hybrid.sensitivities;
  for (int k = 0; k < static_cast<int>(hybrid.modes.size()); ++k) {
    Solver& solver = *hybrid.modes[index(k)].solver;
    if (!wanted) {
      if (solver.sensitivities) solver.ask_for_sensitivities(std::nullopt);
      continue;
    }
    if (solver.model.evaluator() == nullptr)
      refuse_argument(hybrid.name_of(k) + " is given by callbacks; sensitivities need recorded equations.");
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
}

void find_shifts(HybridSystem& hybrid, const HybridTransition& transition, bool at_once) {
  if (!hybrid.sensitivities) return;
  HybridRun& run = hybrid.run;
  const Solver& solver = *hybrid.mode().solver;
  if (!solver.integration || !solver.integration->has_companion())
    throw Failure(SFDAE_NOT_STARTED, hybrid.name_of(run.mode) + ": its solver has lost the sensitivities.");
  const int rows = solver.model.n();
  const std::size_t n = index(hybrid.width());
  Vector S;
  if (hybrid.sensitivities->by_adjoint) {
    S = find_columns(hybrid, at_once);
  } else {
    S.resize(index(rows) * run.moving.shifts.size());
    hybrid.call(run.mode,
                [&](Solver&) { return solver.integration->evaluate_sensitivities(run.t, S.data(), nullptr); });
  }
  S = with_rows(rows, S, hybrid.width());
  Vector& shifts = run.moving.shifts;
  if (transition.given.kind == SFDAE_TRANSITION_TIME) std::fill(shifts.begin(), shifts.end(), 0.0);
  else if (!at_once) find_shifts_of_event(hybrid, transition, S);
  for (std::size_t j = 0; j < shifts.size(); ++j)
    for (std::size_t i = 0; i < index(hybrid.n()); ++i) S[i + j * n] += run.xdot[i] * shifts[j];
  run.moving.moved = std::move(S);
  run.moving.time_before = time_of(solver);
}

void carry_over(HybridSystem& hybrid, const sfdae_transition& given) {
  if (!hybrid.sensitivities) return;
  HybridRun& run = hybrid.run;
  Solver& solver = *hybrid.modes[index(given.to)].solver;
  match_columns(hybrid, *solver.sensitivities);
  const std::size_t n = index(hybrid.n()), rows = index(solver.model.n()), stride = index(hybrid.width());
  auto& [shifts, moved, time_before] = run.moving;
  // The part of the mode above, if present, is computed again.
  for (std::size_t j = 0; j < shifts.size(); ++j)
    std::fill(moved.data() + j * stride + n, moved.data() + (j + 1) * stride, 0.0);
  if (given.jump == nullptr && has_differentiated_jump(hybrid, given)) return;
  const Vector sizes = sizes_at_transition(solver.options.model.tolerances, run.last, rows);
  const Vector sizes_before(sizes.begin(), sizes.begin() + hybrid.n());
  Vector here;
  for (std::size_t j = 0; j < shifts.size(); ++j) {
    const int parameter = given.jump == nullptr ? solver.sensitivities->parameters[j] : -1;
    double* const D = moved.data() + j * stride;
    const double pace = speed(D, sizes_before), shift = shifts[j];
    double others = std::fabs(shift) / time_before;
    if (parameter >= 0) {
      const double value = std::fabs(solver.model.evaluator()->parameter(parameter));
      others = std::max(others, 1.0 / (value > 0.0 ? value : 1.0));
    }
    if (pace == 0.0 && others == 0.0) continue;
    // The terms of the sum D may cancel.
    const double parts = std::max(pace, std::fabs(shift) * speed(run.xdot.data(), sizes_before));
    const Differencing how{sizes, first_step / std::max(pace, others),
                           parts > 0.0 ? std::max(parts, negligible * others) : minor * others, &here};
    const auto values = [&](double s, Vector& after) {
      Vector before(run.last.before);
      for (std::size_t i = 0; i < n; ++i) before[i] += s * D[i];
      const ParameterShift parameter_shift(solver.model, parameter, s);
      find_moved_values(hybrid, given, run.t + s * shift, before, after);
    };
    const DerivativeAlong derivative = differentiate_along(values, how);
    if (!derivative.is_there())
      throw Failure(
          SFDAE_SINGULAR,
          format("the values after the transition at t = %.15g, from %s to %s, have no derivative by those before "
                 "it: sensitivities after it do not exist.",
                 run.t, hybrid.name_of(given.from).c_str(), hybrid.name_of(given.to).c_str()));
    std::copy_n(derivative.value.begin(), rows, D);
  }
}

void begin_sensitivities(HybridSystem& hybrid, int mode) {
  if (!hybrid.sensitivities) return;
  Solver& solver = *hybrid.modes[index(mode)].solver;
  SensitivityRequest& request = *solver.sensitivities;
  match_columns(hybrid, request);
  request.directions = with_rows(hybrid.width(), hybrid.run.moving.moved, solver.model.n());
  request.shifts = hybrid.run.moving.shifts;
}

void end_sensitivities(HybridSystem& hybrid, int mode) {
  if (!hybrid.sensitivities) return;
  SensitivityRequest& request = *hybrid.modes[index(mode)].solver->sensitivities;
  std::fill(request.directions.begin(), request.directions.end(), 0.0);
  request.shifts.clear();
}

}  // namespace sfdae::core
