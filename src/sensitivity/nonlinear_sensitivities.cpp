// Sensitivities of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/nonlinear_sensitivities.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "reduction/rank_sequence.h"
#include "sensitivity/nonlinear_adjoint.h"

namespace sfdae::core {

NonlinearSensitivities::NonlinearSensitivities(NonlinearSystem& system, RecordedProblem& problem,
                                               std::vector<int> parameters)
    : system_(system),
      problem_(problem),
      numbers_(std::move(parameters)),
      parameters_(problem, numbers_),
      sparse_step_(problem, parameters_),
      extended_step_(problem, parameters_),
      sparse_stages_(problem, parameters_),
      stage_lanes_(problem, parameters_, extended_step_) {}

View NonlinearSensitivities::scaled(const double* S) {
  const int n = unknowns();
  const View result = arena_.matrix(n, count());
  for (int j = 0; j < count(); ++j)
    for (int i = 0; i < n; ++i) result(i, j) = S[i + j * n] / system_.units()[i];
  return result;
}

void NonlinearSensitivities::to_user(ConstView S, double* to) const {
  const int n = unknowns();
  for (int j = 0; j < count(); ++j)
    for (int i = 0; i < n; ++i) to[i + j * n] = S(i, j) * system_.units()[i];
}

PointStatus NonlinearSensitivities::linearize(const Jet& jet, const double* xdot) {
  ++linearizations_;
  const PointStatus status = point_.linearize(system_.analyzed_equations(), parameters_,
                                              {jet, xdot, system_.linearization().ranks()}, arena_);
  callback_error_ = point_.callback_error();
  is_point_here_ = status == PointStatus::ok;
  return status;
}

PointStatus NonlinearSensitivities::linearize_here() {
  return is_point_here_ ? PointStatus::ok : linearize(system_.jet(), nullptr);
}

// ---- Steps -----------------------------------------------------------------------------------------------------

// With S = xp + T2 z and K = c tau Z1^T E - Z1^T A:  K T2 z = Z1^T f - K xp - tau Z1^T E rest.
PointStatus NonlinearSensitivities::solve_step(double c, const double* rest, const double* xdot, double* S) {
  has_stages_ = false;
  if (sparse_step_.is_possible()) {
    is_point_here_ = false;
    ++factorizations_;
    const PointStatus status = sparse_step_.solve({system_.jet().t, system_.jet().x.data(), xdot, c, rest}, S);
    callback_error_ = sparse_step_.callback_error();
    return status;
  }
  if (extended_step_.is_possible()) {
    is_point_here_ = false;
    ++factorizations_;
    const PointStatus status = extended_step_.solve(system_.jet(), c, rest, S);
    callback_error_ = extended_step_.callback_error();
    if (extended_step_.is_possible()) return status;
  }
  const PointStatus status = linearize(system_.jet(), xdot);
  if (status != PointStatus::ok) return status;
  const int n = unknowns(), d = point_.d();
  const double tau = point_.time_scale();
  if (factors_.matrix.cols() != d) factors_.matrix = Matrix(padded_rows(d), d);
  factors_.pivots.resize(index(d) + 1);
  const Arena::Frame frame(arena_);
  const View K = arena_.matrix(d, n), z = arena_.matrix(d, count()), result = arena_.matrix(n, count());
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < d; ++i) K(i, j) = c * tau * point_.ZE()(i, j) - point_.ZA()(i, j);
  copy(point_.Zf(), z);
  multiply(-tau, Op::plain, point_.ZE(), Op::plain, scaled(rest), 1.0, z);
  if (point_.is_ordinary()) {
    if (!solve_ordinary(K, z, scaled(S))) return PointStatus::singular;
    to_user(z, S);
    return PointStatus::ok;
  }
  const View M = factors_.matrix.view().top(d);
  multiply(1.0, Op::plain, K, Op::plain, point_.T2(), 0.0, M);
  multiply(-1.0, Op::plain, K, Op::plain, point_.xp(), 1.0, z);
  ++factorizations_;
  if (!factor_lu(M, factors_.pivots.data())) return PointStatus::singular;
  solve_lu(M, factors_.pivots.data(), z);
  copy(point_.xp(), result);
  multiply(1.0, Op::plain, point_.T2(), Op::plain, z, 1.0, result);
  to_user(result, S);
  return PointStatus::ok;
}

bool NonlinearSensitivities::solve_ordinary(ConstView K, View z, ConstView guess) {
  // Changes end at rounding errors; more iterations than these would cost more than a new factorization.
  constexpr double rounding = 1e-13;
  const int n = K.rows, most = std::min(8, n / (6 * count()));
  const View M = factors_.matrix.view().top(n);
  const Arena::Frame frame(arena_);
  const View solution = arena_.matrix(n, count()), change = arena_.matrix(n, count());
  copy(guess, solution);
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; factors_.are_kept && iteration < most; ++iteration) {
    copy(z, change);
    multiply(-1.0, Op::plain, K, Op::plain, solution, 1.0, change);
    solve_lu(M, factors_.pivots.data(), change);
    for (int j = 0; j < count(); ++j)
      for (int i = 0; i < n; ++i) solution(i, j) += change(i, j);
    const double size = max_abs(change);
    if (size <= rounding * max_abs(solution)) {
      copy(solution, z);
      return true;
    }
    if (!(size < 0.5 * before)) break;
    before = size;
  }
  copy(K, M);
  ++factorizations_;
  factors_.are_kept = factor_lu(M, factors_.pivots.data());
  if (factors_.are_kept) solve_lu(M, factors_.pivots.data(), z);
  return factors_.are_kept;
}

PointStatus NonlinearSensitivities::linearize_stage(const Jet& jet, const double* xdot) {
  if (extended_step_.is_possible()) {
    is_point_here_ = false;
    const PointStatus status = point_.linearize(system_.analyzed_equations(), parameters_, extended_step_,
                                                {jet, xdot, system_.linearization().ranks()}, arena_);
    callback_error_ = point_.callback_error();
    if (extended_step_.is_possible()) return status;
  }
  return linearize(jet, xdot);
}

PointStatus NonlinearSensitivities::keep(const StageMethod& method, int i, const Jet& jet, const double* xdot) {
  // The first stage decides the method for the step.
  if (i == 0) {
    if (xdot != nullptr && sparse_stages_.is_possible(method)) kept_ = StagesKept::sparse;
    else kept_ = stage_lanes_.begin(method.s) ? StagesKept::side_by_side : StagesKept::each;
  }
  if (kept_ == StagesKept::each) return keep_one(method, i, jet, xdot);
  is_point_here_ = false;
  if (kept_ == StagesKept::side_by_side) {
    stage_lanes_.keep(i, jet, xdot);
    return PointStatus::ok;
  }
  const PointStatus status = sparse_stages_.keep(method, i, jet.t, jet.x.data(), xdot);
  callback_error_ = sparse_stages_.callback_error();
  return status;
}

PointStatus NonlinearSensitivities::keep_one(const StageMethod& method, int i, const Jet& jet, const double* xdot) {
  const PointStatus status = linearize_stage(jet, xdot);
  if (status != PointStatus::ok) return status;
  stages_.resize(method.s, unknowns(), point_.d(), count());
  stages_.keep(i, point_);
  return PointStatus::ok;
}

// If that is not possible, linearizes one by one, which reports the error, or finds it harmless.
PointStatus NonlinearSensitivities::linearize_side_by_side(const StageMethod& method) {
  stages_.resize(method.s, unknowns(), extended_step_.num_states(), count());
  if (stage_lanes_.linearize(system_.analyzed_equations(), stages_)) return PointStatus::ok;
  std::vector<double> xdot;
  PointStatus status = PointStatus::ok;
  for (int i = 0; i < method.s && status == PointStatus::ok; ++i)
    status = keep_one(method, i, stage_lanes_.jet(i), stage_lanes_.xdot(i, xdot));
  return status;
}

PointStatus NonlinearSensitivities::keep_stage_of_step(const StageMethod& method, int i, const double* xdot) {
  const NonlinearStages* solved = system_.stages();
  return keep(method, i, solved == nullptr || i + 1 == method.s ? system_.jet() : solved->jet(i), xdot);
}

PointStatus NonlinearSensitivities::solve_kept_stages(const StageMethod& method, double h, const double* S_start,
                                                      double* S) {
  ++factorizations_;
  has_stages_ = false;
  if (kept_ == StagesKept::sparse) return sparse_stages_.solve(method, h, S_start, S);
  if (kept_ == StagesKept::side_by_side) {
    const PointStatus status = linearize_side_by_side(method);
    if (status != PointStatus::ok) return status;
  }
  const Arena::Frame frame(arena_);
  if (!stages_.solve(method, h, scaled(S_start), arena_)) return PointStatus::singular;
  const View result = arena_.matrix(unknowns(), count());
  for (int i = 0; i < method.s; ++i) {
    stages_.expand(i, result);
    to_user(result, S + size() * index(i));
  }
  has_stages_ = true;
  return PointStatus::ok;
}

// ---- Points ----------------------------------------------------------------------------------------------------

PointStatus NonlinearSensitivities::restore(const double* guess, double* S) {
  is_point_here_ = false;
  if (point_.is_ordinary()) {
    std::copy_n(guess, size(), S);
    return PointStatus::ok;
  }
  const PointStatus status = linearize(system_.jet(), nullptr);
  if (status != PointStatus::ok) return status;
  const Arena::Frame frame(arena_);
  const View change = scaled(guess), q = arena_.matrix(point_.d(), count()),
             result = arena_.matrix(unknowns(), count());
  copy(point_.xp(), result);
  for (int j = 0; j < count(); ++j)
    for (int i = 0; i < unknowns(); ++i) change(i, j) -= result(i, j);
  multiply(1.0, Op::plain, point_.ZE(), Op::plain, change, 0.0, q);
  point_.add_along_T2(q, result, arena_);
  to_user(result, S);
  return PointStatus::ok;
}

void NonlinearSensitivities::error_in_S(const double* errors, double* mapped) {
  if (has_stages_) {
    const Arena::Frame frame(arena_);
    const View result = arena_.matrix(unknowns(), count());
    if (stages_.map_errors(scaled(errors), result, arena_)) to_user(result, mapped);
    else std::copy_n(errors, size(), mapped);
    return;
  }
  // Errors without the form are not smaller than with it.
  if (point_.is_ordinary() || linearize_here() != PointStatus::ok) {
    std::copy_n(errors, size(), mapped);
    return;
  }
  const Arena::Frame frame(arena_);
  const View q = arena_.matrix(point_.d(), count()), result = arena_.matrix(unknowns(), count());
  multiply(1.0, Op::plain, point_.ZE(), Op::plain, scaled(errors), 0.0, q);
  fill(result, 0.0);
  point_.add_along_T2(q, result, arena_);
  to_user(result, mapped);
}

void NonlinearSensitivities::start(const ConsistencyRequest& request, const double* directions, double* S) {
  const int n = unknowns();
  parameters_.take_parameters();
  point_.forget();
  const PointStatus status = linearize(system_.jet(), nullptr);
  if (status == PointStatus::callback_error) callback_error_.raise();
  if (status != PointStatus::ok)
    throw Failure(
        SFDAE_CHARACTERISTICS_CHANGED,
        format("the characteristic values known do not hold at t = %.15g, where sensitivities are to start.",
               system_.jet().t));
  factors_.are_kept = false;
  sparse_step_.prepare(system_.analyzed_equations().analysis(), system_.jet());
  sparse_stages_.prepare(system_.analyzed_equations().analysis());
  extended_step_.prepare(system_.analyzed_equations(), system_.jet());
  if (point_.is_ordinary()) {
    std::copy_n(directions, size(), S);
    return;
  }
  for (int j = 0; j < count(); ++j) {
    const std::vector<double> direction(directions + j * n, directions + (j + 1) * n);
    ConsistencyRequest relative = request;
    for (int i = 0; i < n; ++i)
      relative.least_size = std::max(relative.least_size, std::fabs(direction[index(i)]) / system_.units()[i]);
    std::vector<double> found;
    try {
      found = consistent_point(point_.constraints_of(j, system_.units(), arena_), relative, direction);
    } catch (const Failure& failure) {
      throw Failure(failure.status(),
                    format("sensitivity %d, whose directions take the place of values: ", j) + failure.what());
    }
    std::copy(found.begin(), found.end(), S + static_cast<std::ptrdiff_t>(j) * n);
  }
}

std::unique_ptr<AdjointSystem> NonlinearSensitivities::adjoint() {
  return std::make_unique<NonlinearAdjoint>(system_, problem_, numbers_);
}

// ---- Checkpoints -----------------------------------------------------------------------------------------------

// Values that are evaluated once for a step are not archived.
void NonlinearSensitivities::archive(Archive& archive) {
  AnalyzedEquations& equations = system_.analyzed_equations();
  archive.counts(linearizations_, factorizations_);
  sparse_step_.archive(archive, equations.analysis());
  sparse_stages_.archive(archive, equations.analysis());
  extended_step_.archive(archive, equations);
  archive.small(factors_.are_kept);
  if (archive.is_reading()) point_.take_kind(equations);
  if (factors_.are_kept) archive_factors(archive);
}

// Archives the factors themselves: where they were computed, the equations may have been on another side of a kink.
void NonlinearSensitivities::archive_factors(Archive& archive) {
  const int n = unknowns();
  if (archive.is_reading()) {
    if (!point_.is_ordinary() || archive.rest() < index(n) * index(n)) throw DamagedArchive();
    factors_.matrix = Matrix(padded_rows(n), n);
    factors_.pivots.resize(index(n) + 1);
  }
  const View factors = factors_.matrix.view().top(n);
  for (int j = 0; j < n; ++j) {
    archive.reals(factors.column(j), index(n));
    if (factors(j, j) == 0.0) throw DamagedArchive();
  }
  archive.small(factors_.pivots.data(), index(n));
  for (int j = 0; j < n; ++j)
    if (factors_.pivots[index(j)] <= j || factors_.pivots[index(j)] > n) throw DamagedArchive();
}

// ---- S' --------------------------------------------------------------------------------------------------------

PointStatus NonlinearSensitivities::derivative(const double* S, double* Sdot) {
  const PointStatus status = linearize_here();
  if (status != PointStatus::ok) return status;
  if (point_.is_ordinary() && derivative_of_ordinary(S, Sdot)) return PointStatus::ok;
  if (derivative_from_array(S, Sdot)) return PointStatus::ok;
  if (callback_error_.status != SFDAE_OK && !callback_error_.is_recoverable()) return PointStatus::callback_error;
  if (!point_.is_ordinary()) correct_slopes(S, Sdot);
  return PointStatus::ok;
}

// tau E S' = A S + f.
bool NonlinearSensitivities::derivative_of_ordinary(const double* S, double* Sdot) {
  const int n = unknowns();
  const Arena::Frame frame(arena_);
  const View E = arena_.matrix(n, n), slopes = arena_.matrix(n, count());
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) E(i, j) = point_.time_scale() * point_.ZE()(i, j);
  copy(point_.Zf(), slopes);
  multiply(1.0, Op::plain, point_.ZA(), Op::plain, scaled(S), 1.0, slopes);
  int* pivots = arena_.integers(n);
  if (!factor_lu(E, pivots)) return false;
  solve_lu(E, pivots, slopes);
  to_user(slopes, Sdot);
  return true;
}

// M y = N S + g of level mu + 1 at the jet that fulfils it: y_1 = tau S'.
bool NonlinearSensitivities::derivative_from_array(const double* S, double* Sdot) {
  const Jet* jet = system_.next_level_jet();
  if (jet == nullptr) return false;
  AnalyzedEquations& equations = system_.analyzed_equations();
  const IndexAnalysis& analysis = equations.analysis();
  const int level = equations.mu() + 1, m = equations.m(), n = unknowns();
  const NonlinearProblem::Scaling scaling{analysis.time_scale, analysis.rows, nullptr, &system_.units(), true};
  ++linearizations_;
  callback_error_ = equations.problem().linearize(jet->t, jet->x.data(), {level, level, level}, scaling, next_.data);
  if (callback_error_.status != SFDAE_OK) return false;
  if (next_.f.rows() == 0) next_.f = Matrix(m * (level + 1), count());
  callback_error_ = parameters_.evaluate(next_.data, jet->x.data(), level, next_.f);
  if (callback_error_.status != SFDAE_OK) return false;
  StoredReduction reduction{next_.elimination};
  if (!reduce_with_known_values(next_.data, level, analysis, equations.settings().rank_tol, {arena_, next_.form},
                                reduction))
    return false;
  const Arena::Frame frame(arena_);
  const View known = scaled(S), result = arena_.matrix(n, count());
  double* transformed = arena_.take(index(next_.f.rows()) + 1);
  double* y = arena_.take(index(n) * index(level + 1));
  for (int j = 0; j < count(); ++j) {
    const double* f = next_.f.view().column(j);
    next_.elimination.transform(f, transformed, arena_);
    next_.elimination.recover(next_.data, {f, transformed}, known.column(j), y, arena_);
    for (int i = 0; i < n; ++i) result(i, j) = y[i] / next_.data.time_scale;
  }
  if (!all_finite(result.data, index(result.ld) * index(count() - 1) + index(n))) return false;
  to_user(result, Sdot);
  return true;
}

// Within T2, so that F1 = 0: Z1^T E T2 z = Z1^T (A S + f) / tau - Z1^T E S'.
void NonlinearSensitivities::correct_slopes(const double* S, double* Sdot) {
  const Arena::Frame frame(arena_);
  const View slopes = scaled(Sdot), q = arena_.matrix(point_.d(), count());
  copy(point_.Zf(), q);
  multiply(1.0, Op::plain, point_.ZA(), Op::plain, scaled(S), 1.0, q);
  multiply(-1.0, Op::plain, point_.ZE(), Op::plain, slopes, 1.0 / point_.time_scale(), q);
  point_.add_along_T2(q, slopes, arena_);
  to_user(slopes, Sdot);
}

}  // namespace sfdae::core
