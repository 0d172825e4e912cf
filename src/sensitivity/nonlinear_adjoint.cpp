// Adjoint sensitivities of a nonlinear problem, backward in time.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/nonlinear_adjoint.h"

#include <algorithm>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "sensitivity/sensitivity_point.h"

namespace sfdae::core {

namespace {

KeptPoint kept(const Jet& jet, const double* xdot) {
  KeptPoint point{jet, {}};
  if (xdot != nullptr) point.xdot.assign(xdot, xdot + jet.n);
  return point;
}

const Jet& stage_of(const NonlinearSystem& system, const StageMethod& method, int i) {
  const NonlinearStages* solved = system.stages();
  return solved == nullptr || i + 1 == method.s ? system.jet() : solved->jet(i);
}

class NonlinearTwin final : public SystemTwin {
 public:
  NonlinearTwin(const RecordedProblem& problem, const AnalysisSettings& settings, bool keeps_slopes)
      : problem_(problem), settings_(settings), keeps_slopes_(keeps_slopes) {
    problem_.stop_with(problem);
  }
  void restore(Archive& archive) override {
    system_ = std::make_unique<NonlinearSystem>(problem_, settings_, archive);
  }
  void stand_between(const KeptPoint& from, const KeptPoint& to) override {
    const PointStatus status = system_->set_points(from.jet, to.jet);
    if (status == PointStatus::callback_error) system_->callback_error().raise();
    if (status != PointStatus::ok)
      throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                    format("the characteristic values known do not hold at t = %.15g.", to.jet.t));
  }
  bool stop_is_requested() const override { return problem_.stop_is_requested(); }
  NonlinearSystem& system() override { return *system_; }
  KeptPoint point(const double* xdot) const override { return kept(system_->jet(), keeps_slopes_ ? xdot : nullptr); }
  KeptPoint stage(const StageMethod& method, int i, const double* xdot) const override {
    return kept(stage_of(*system_, method, i), keeps_slopes_ ? xdot : nullptr);
  }

 private:
  RecordedProblem problem_;
  AnalysisSettings settings_;
  bool keeps_slopes_;
  std::unique_ptr<NonlinearSystem> system_;
};

}  // namespace

NonlinearAdjoint::NonlinearAdjoint(NonlinearSystem& system, RecordedProblem& problem, std::vector<int> parameters)
    : system_(system),
      problem_(problem),
      parameters_(problem, std::move(parameters)),
      sparse_step_(problem, parameters_) {
  sparse_step_.prepare(system_.analyzed_equations().analysis());
}

KeptPoint NonlinearAdjoint::point(const double* xdot) const {
  return kept(system_.jet(), keeps_slopes() ? xdot : nullptr);
}

KeptPoint NonlinearAdjoint::stage(const StageMethod& method, int i, const double* xdot) const {
  return kept(stage_of(system_, method, i), keeps_slopes() ? xdot : nullptr);
}

std::unique_ptr<SystemTwin> NonlinearAdjoint::twin() {
  return std::make_unique<NonlinearTwin>(problem_, system_.settings(), keeps_slopes());
}

bool NonlinearAdjoint::has_constraints() const {
  AdjointPoint kind;
  kind.take_kind(system_.analyzed_equations());
  return !kind.is_ordinary();
}

NonlinearAdjoint::Work& NonlinearAdjoint::work() {
  if (!work_) work_ = std::make_unique<Work>();
  return *work_;
}

PointStatus NonlinearAdjoint::linearize(AdjointPoint& at, const KeptPoint& point) {
  const double* const xdot = point.xdot.empty() ? nullptr : point.xdot.data();
  const PointStatus status = at.linearize(system_.analyzed_equations(), parameters_,
                                          {point.jet, xdot, system_.linearization().ranks()}, work().arena);
  callback_error_ = at.callback_error();
  return status;
}

PointStatus NonlinearAdjoint::add_gradient(AdjointPoint& at, const KeptPoint& point,
                                           const AdjointPoint::Weights& weights, View gradient) {
  const PointStatus status = at.add_gradient(parameters_, point.jet, weights, gradient, work().arena);
  callback_error_ = at.callback_error();
  return status;
}

// Weights of S are those of S / unit, times the unit.
View NonlinearAdjoint::scaled(ConstView weights) {
  const View result = work().arena.matrix(weights.rows, weights.cols);
  for (int q = 0; q < weights.cols; ++q)
    for (int i = 0; i < weights.rows; ++i) result(i, q) = weights(i, q) * system_.units()[i];
  return result;
}

void NonlinearAdjoint::to_user(ConstView scaled, View weights) const {
  for (int q = 0; q < weights.cols; ++q)
    for (int i = 0; i < weights.rows; ++i) weights(i, q) = scaled(i, q) / system_.units()[i];
}

// S = xp + T2 z, K T2 z = Z1^T f - K xp - tau Z1^T E rest, K = c tau Z1^T E - Z1^T A. Transposed, for weights s of S:
// (K T2)^T nu = T2^T s, s - K^T nu for xp, -tau (Z1^T E)^T nu for rest.
PointStatus NonlinearAdjoint::step_back(const KeptPoint& point, double c, const AdjointValues& values) {
  if (sparse_step_.is_possible()) {
    const PointStatus status = sparse_step_.solve_back(
        {point.jet.t, point.jet.x.data(), point.xdot.data(), c, nullptr}, values.weights, values.gradient);
    callback_error_ = sparse_step_.callback_error();
    return status;
  }
  AdjointPoint& at = work().points[0];
  PointStatus status = linearize(at, point);
  if (status != PointStatus::ok) return status;
  const int n = unknowns(), d = at.d(), count = values.weights.cols;
  const double tau = at.time_scale();
  const Arena::Frame frame(work().arena);
  const View K = work().arena.matrix(d, n), M = work().arena.matrix(d, d), nu = work().arena.matrix(d, count),
             s = scaled(values.weights);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < d; ++i) K(i, j) = c * tau * at.ZE()(i, j) - at.ZA()(i, j);
  if (at.is_ordinary()) {
    copy(K, M);
    copy(s, nu);
  } else {
    multiply(1.0, Op::plain, K, Op::plain, at.T2(), 0.0, M);
    multiply(1.0, Op::transposed, at.T2(), Op::plain, s, 0.0, nu);
  }
  int* pivots = work().arena.integers(d + 1);
  if (!factor_lu(M, pivots)) return PointStatus::singular;
  solve_lu_transposed(M, pivots, nu);
  multiply(-1.0, Op::transposed, K, Op::plain, nu, 1.0, s);
  status = add_gradient(at, point, {nu, s}, values.gradient);
  multiply(-tau, Op::transposed, at.ZE(), Op::plain, nu, 0.0, s);
  to_user(s, values.weights);
  return status;
}

// The equations of sensitivity_stages.h: weights of z at the last stage, nu of all rows, and their contributions by
// slopes_i = sum_j w_ij (S_start - xp_j), w_ij = tau / h D_ij.
PointStatus NonlinearAdjoint::step_back(const StageMethod& method, double h, const KeptPoint* points,
                                        const AdjointValues& values) {
  for (int i = 0; i < method.s; ++i) {
    const PointStatus status = linearize(work().points[index(i)], points[i]);
    if (status != PointStatus::ok) return status;
    if (i == 0) work().stages.resize(method.s, unknowns(), work().points[0].d(), 0);
    work().stages.keep_matrices(i, work().points[index(i)]);
  }
  const AdjointPoint& end = work().points[index(method.s - 1)];
  const int n = unknowns(), d = end.d(), count = values.weights.cols;
  const Arena::Frame frame(work().arena);
  const View nu = work().arena.matrix(method.s * d, count), s = scaled(values.weights);
  fill(nu, 0.0);
  const View last = nu.block((method.s - 1) * d, 0, d, count);
  if (end.is_ordinary()) copy(s, last);
  else multiply(1.0, Op::transposed, end.T2(), Op::plain, s, 0.0, last);
  if (!work().stages.factor(method, h, work().arena)) return PointStatus::singular;
  work().stages.solve_transposed(nu);

  const View slopes = work().arena.matrix(n * method.s, count), start = work().arena.matrix(n, count),
             xp = work().arena.matrix(n, count);
  for (int i = 0; i < method.s; ++i)
    multiply(work().points[index(i)].time_scale() / h, Op::transposed, work().points[index(i)].ZE(), Op::plain,
             nu.block(i * d, 0, d, count), 0.0, slopes.block(i * n, 0, n, count));
  fill(start, 0.0);
  for (int j = 0; j < method.s; ++j) {
    AdjointPoint& at = work().points[index(j)];
    const View nu_j = nu.block(j * d, 0, d, count);
    if (j + 1 == method.s) copy(s, xp);
    else fill(xp, 0.0);
    multiply(1.0, Op::transposed, at.ZA(), Op::plain, nu_j, 1.0, xp);
    for (int i = 0; i < method.s; ++i)
      for (int q = 0; q < count; ++q)
        for (int k = 0; k < n; ++k) {
          const double of_slope = method.D_at(i, j) * slopes(i * n + k, q);
          xp(k, q) -= of_slope;
          start(k, q) += of_slope;
        }
    const PointStatus status = add_gradient(at, points[j], {nu_j, xp}, values.gradient);
    if (status != PointStatus::ok) return status;
  }
  to_user(start, values.weights);
  return PointStatus::ok;
}

// S = xp + T2 z with Z1^T E T2 z = Z1^T E (guess - xp).
PointStatus NonlinearAdjoint::restore_back(const KeptPoint& point, const AdjointValues& values) {
  AdjointPoint& at = work().points[0];
  PointStatus status = linearize(at, point);
  if (status != PointStatus::ok || at.is_ordinary()) return status;
  const int n = unknowns(), d = at.d(), count = values.weights.cols;
  const Arena::Frame frame(work().arena);
  const View G = work().arena.matrix(d, d), z = work().arena.matrix(d, count), none = work().arena.matrix(d, count),
             s = scaled(values.weights), of_guess = work().arena.matrix(n, count);
  multiply(1.0, Op::plain, at.ZE(), Op::plain, at.T2(), 0.0, G);
  multiply(1.0, Op::transposed, at.T2(), Op::plain, s, 0.0, z);
  int* pivots = work().arena.integers(d + 1);
  if (!factor_lu(G, pivots)) return PointStatus::singular;
  solve_lu_transposed(G, pivots, z);
  multiply(1.0, Op::transposed, at.ZE(), Op::plain, z, 0.0, of_guess);
  for (int q = 0; q < count; ++q)
    for (int i = 0; i < n; ++i) s(i, q) -= of_guess(i, q);
  fill(none, 0.0);
  status = add_gradient(at, point, {none, s}, values.gradient);
  to_user(of_guess, values.weights);
  return status;
}

// basis = T2, coordinates = (Z1^T E T2)^-1 Z1^T E, offset = (I - basis coordinates) xp.
PointStatus NonlinearAdjoint::find_tangent_space(const KeptPoint& point, TangentSpace& space) {
  SensitivityPoint at;
  Arena arena;  // once for an integration
  const int n = unknowns();
  space.offset = Matrix(n, count());
  at.take_kind(system_.analyzed_equations());
  if (at.is_ordinary()) return PointStatus::ok;
  const PointStatus status = at.linearize(system_.analyzed_equations(), parameters_,
                                          {point.jet, nullptr, system_.linearization().ranks()}, arena);
  callback_error_ = at.callback_error();
  if (status != PointStatus::ok) return status;
  const int d = at.d();
  const Arena::Frame frame(arena);
  const View G = arena.matrix(d, d), C = arena.matrix(d, n), z = arena.matrix(d, count()),
             xp = arena.matrix(n, count());
  int* pivots = arena.integers(d + 1);
  multiply(1.0, Op::plain, at.ZE(), Op::plain, at.T2(), 0.0, G);
  copy(at.ZE(), C);
  copy(at.xp(), xp);
  if (!factor_lu(G, pivots)) return PointStatus::singular;
  solve_lu(G, pivots, C);
  multiply(1.0, Op::plain, C, Op::plain, xp, 0.0, z);
  multiply(-1.0, Op::plain, at.T2(), Op::plain, z, 1.0, xp);
  space.inconsistency = at.inconsistency();
  space.basis = Matrix(n, d);
  space.coordinates = Matrix(d, n);
  for (int i = 0; i < n; ++i) {
    const double unit = system_.units()[i];
    for (int j = 0; j < d; ++j) {
      space.basis(i, j) = unit * at.T2()(i, j);
      space.coordinates(j, i) = C(j, i) / unit;
    }
    for (int j = 0; j < count(); ++j) space.offset(i, j) = unit * xp(i, j);
  }
  return PointStatus::ok;
}

}  // namespace sfdae::core
