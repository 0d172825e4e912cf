// Sensitivities of a solver: from the request to the integration that computes them.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <utility>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "solver/solver.h"

namespace sfdae::core {

namespace {

// Directions at the fixed time of the start: derivatives at the moving time, minus x' times the shift.
std::vector<double> directions_at(const SensitivityRequest& wanted, const std::vector<double>& xdot) {
  std::vector<double> directions = wanted.directions;
  for (std::size_t j = 0; j < wanted.shifts.size(); ++j)
    for (std::size_t i = 0; i < xdot.size(); ++i) directions[i + j * xdot.size()] -= xdot[i] * wanted.shifts[j];
  return directions;
}

std::unique_ptr<Companion> started_companion(Solver& solver, const SensitivityRequest& wanted,
                                             const ConsistentPoint& found, bool keeps_differentiated) {
  const std::vector<double>& x = found.x;
  std::unique_ptr<SensitivitySystem> system = solver.model.sensitivities(wanted.parameters);
  if (!system)
    refuse_argument(
        "there are no sensitivities of these equations: prescribed components, or linear equations with more or "
        "fewer equations than unknowns.");
  ConsistencyRequest request = solver.options.model.request_at(x.data());
  if (keeps_differentiated || (wanted.last_follows && request.kind == InitialValues::accept)) {
    request.kind = InitialValues::nearest;
    request.keeps_differentiated = true;
    request.weights.clear();
  }
  std::vector<double> S(wanted.directions.size());
  system->start(request, directions_at(wanted, found.xdot).data(), S.data());
  if (wanted.by_adjoint)
    return std::make_unique<DiscreteAdjoint>(system->adjoint(), std::move(S), wanted.max_kept_steps);
  return std::make_unique<Sensitivities>(std::move(system), wanted.options, std::move(S));
}

}  // namespace

void Solver::ask_for_sensitivities(std::optional<SensitivityRequest> request) {
  const bool wanted = request.has_value();
  const bool by_adjoint = wanted && request->by_adjoint;
  if (wanted != options.model.for_sensitivities || by_adjoint != options.model.for_adjoint) forget_analysis();
  end_integration();
  options.model.for_sensitivities = wanted;
  options.model.for_adjoint = by_adjoint;
  sensitivities = std::move(request);
}

void Solver::carry_sensitivities(const SensitivityRequest& wanted, const ConsistentPoint& found,
                                 bool keeps_differentiated) {
  integration->carry(started_companion(*this, wanted, found, keeps_differentiated));
}

CallResult Solver::differentiate_event(const EventSlopes& slopes, double* dt) {
  const int n = model.n(), count = integration->sensitivities()->count();
  std::vector<double> S(index(n) * index(count)), x(index(n)), xdot(index(n)), moved(index(count));
  CallResult result = integration->evaluate_sensitivities(slopes.t, S.data(), nullptr);
  if (result.status != SFDAE_OK) return result;
  integration->want_slopes(true);
  result = integration->interpolate(slopes.t, false, x.data(), xdot.data());
  if (result.status != SFDAE_OK) return result;
  double rate = slopes.g_t;
  for (int i = 0; i < n; ++i) rate += slopes.g_x[i] * xdot[index(i)];
  for (int j = 0; j < count; ++j) {
    double change = slopes.g_p != nullptr ? slopes.g_p[j] : 0.0;
    for (int i = 0; i < n; ++i) change += slopes.g_x[i] * S[index(i) + index(j) * index(n)];
    moved[index(j)] = -change / rate;
  }
  if (!all_finite(moved.data(), moved.size()))
    return {SFDAE_SINGULAR, format("g does not change with t at t = %.15g: g_t + g_x x' = %.3g.", slopes.t, rate)};
  std::copy(moved.begin(), moved.end(), dt);
  return {};
}

}  // namespace sfdae::core
