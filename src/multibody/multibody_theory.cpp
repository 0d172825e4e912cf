// A mechanical system linearized at one point.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_theory.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_equations.h"
#include "multibody/multibody_force_differences.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

void demand(PointStatus status, const CallbackError& error, double t) {
  if (status == PointStatus::callback_error) error.raise();
  if (status != PointStatus::ok)
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                  format("[M C^T; C 0] is singular for the ranks known at t = %.15g.", t));
}

// to := factor from, for the listed rows.
void copy_rows(double factor, ConstView from, const std::vector<int>& rows, View to) {
  for (int j = 0; j < to.cols; ++j)
    for (int k = 0; k < to.rows; ++k) to(k, j) = factor * from(rows[index(k)], j);
}

Matrix kinematics(const MultibodyPoint& point) {
  return point.terms.S.rows() > 0 ? point.terms.S : identity(static_cast<int>(point.v.size()));
}

// [Q1 Q2]
Matrix directions(const Partition& partition) {
  Matrix Q(partition.Q.rows(), partition.Q.cols());
  copy(partition.Q1(), Q.view().columns(0, Q.cols() - partition.rank));
  copy(partition.Q2(), Q.view().columns(Q.cols() - partition.rank, partition.rank));
  return Q;
}

// Q Q^T
Matrix projector(ConstView Q) {
  Matrix P(Q.rows, Q.rows);
  multiply(1.0, Op::plain, Q, Op::transposed, Q, 0.0, P);
  return P;
}

}  // namespace

MultibodyTheory::MultibodyTheory(MultibodyProblem& problem, const MultibodySettings& settings, double t,
                                 const double* x)
    : sizes_(problem.sizes()), jacobian_(sizes_) {
  CallbackError error;
  SystemCounts counts;
  MultibodyEquations equations(problem, error, counts);
  point_.resize(sizes_);
  point_.set(t, x, x + sizes_.positions);
  demand(equations.at_velocity(point_), error, t);
  point_.measure_rows();
  form_.resize(sizes_, settings.ranks.positions, settings.ranks.velocities);
  form_.set_rank_tol(settings.rank_tol);
  const MultibodyForm::Ranks found = form_.choose(point_, Coordinates::orthogonal, arena_);
  const bool has_ranks =
      found.positions.rank == settings.ranks.positions && found.velocities.rank == settings.ranks.velocities;
  const Partition& partition = form_.velocities();
  if (!has_ranks || !point_.factor(partition.rows, partition.rank)) demand(PointStatus::singular, error, t);
  point_.solve_accelerations(partition.rows, partition.rank);
  point_.take_least_norm(partition, arena_);
  demand(equations.derivatives(point_, jacobian_), error, t);
  if (!form_.build_tangents(point_, arena_)) demand(PointStatus::singular, error, t);
  form_.build(point_, jacobian_, arena_);
  differentiate_forces(problem);
}

// K (da; dmu) = (force_q dq + force_v dv; -(C a + s)_q dq - (C a + s)_v dv), independent rows.
void MultibodyTheory::differentiate_forces(MultibodyProblem& problem) {
  const Partition& partition = form_.velocities();
  const int nq = sizes_.positions, nv = sizes_.velocities, nc = sizes_.constraints(), r = partition.rank;
  mu_qv_ = Matrix(nc, nq + nv);
  if (r == 0) return;
  Matrix rates(nv + r, nq + nv);
  const View forces = rates.view().top(nv), rest = rates.view().block(nv, 0, r, nq + nv);
  copy(jacobian_.force_q, forces.columns(0, nq));
  copy(jacobian_.force_v, forces.columns(nq, nv));
  copy_rows(-1.0, jacobian_.acceleration_q, partition.rows, rest.columns(0, nq));
  copy_rows(-1.0, jacobian_.acceleration_v, partition.rows, rest.columns(nq, nv));
  point_.solve(rates.view());
  for (int j = 0; j < nq + nv; ++j) {
    for (int k = 0; k < r; ++k) mu_qv_(partition.rows[index(k)], j) = rest(k, j);
    point_.take_least_norm(partition, mu_qv_.view().column(j), arena_);
  }
  if (r < nc) add_redundant_part(problem);
}

// mu = C p stays in the range of C while that turns: N^T dmu = N^T (C p)_q dq with p held, N^T C = 0. (C p)_q is the
// derivative of C v + r at v = p, less that at v = 0.
void MultibodyTheory::add_redundant_part(MultibodyProblem& problem) {
  const int nq = sizes_.positions, nv = sizes_.velocities, nc = sizes_.constraints();
  const std::vector<double> mu(point_.mu.begin(), point_.mu.begin() + nc);
  const std::vector<double> p =
      least_squares(point_.terms.C, mu, unit_roundoff * nv * singular_values(point_.terms.C).front());
  const std::vector<double> zero(index(nv), 0.0);
  MultibodyJacobian at_p(sizes_), at_0(sizes_);
  MultibodyTerms terms = point_.terms;
  const auto linearize = [&](const std::vector<double>& v, MultibodyJacobian& jacobian) {
    CallbackError error = problem.at_velocity(point_.t, point_.q.data(), v.data(), terms);
    if (error.status == SFDAE_OK)
      error =
          problem.linearize({point_.t, point_.q.data(), v.data(), zero.data(), point_.mu.data()}, terms, jacobian);
    if (error.status != SFDAE_OK) error.raise();
  };
  linearize(p, at_p);
  linearize(zero, at_0);
  for (int j = 0; j < nq; ++j) {
    std::vector<double> change(index(nc));
    for (int i = 0; i < nc; ++i) change[index(i)] = at_p.velocity_q(i, j) - at_0.velocity_q(i, j);
    std::vector<double> in_range = change;
    point_.take_least_norm(form_.velocities(), in_range.data(), arena_);
    for (int i = 0; i < nc; ++i) mu_qv_(i, j) += change[index(i)] - in_range[index(i)];
  }
}

std::vector<double> MultibodyTheory::derivative(MultibodyProblem& problem) {
  const int size = sizes_.positions + sizes_.velocities;
  std::vector<double> xdot(index(sizes_.unknowns()), 0.0);
  point_.rates(xdot.data());
  std::copy(point_.a.begin(), point_.a.end(), xdot.begin() + sizes_.positions);
  if (sizes_.constraints() == 0) return xdot;
  CallbackError error;
  SystemCounts counts;
  MultibodyEquations equations(problem, error, counts);
  MultibodyPoint neighbour;
  neighbour.resize(sizes_);
  MultibodyForceDifferences differences(equations, form_.velocities(), neighbour, arena_);
  if (!differences.derivative(point_, 1.0, xdot.data() + size)) std::fill(xdot.begin() + size, xdot.end(), 0.0);
  return xdot;
}

Matrix MultibodyTheory::A2() const {
  const Partition &positions = form_.positions(), &velocities = form_.velocities();
  const int nq = sizes_.positions, nv = sizes_.velocities, nc = sizes_.constraints(), rq = positions.rank,
            rv = velocities.rank;
  Matrix A2(rq + rv + nc, sizes_.unknowns());
  const View of_q = A2.view().columns(0, nq), of_v = A2.view().columns(nq, nv);
  copy_rows(-1.0, point_.terms.g_q, positions.rows, of_q.top(rq));
  copy_rows(-1.0, jacobian_.velocity_q, velocities.rows, of_q.block(rq, 0, rv, nq));
  copy_rows(-1.0, point_.terms.C, velocities.rows, of_v.block(rq, 0, rv, nv));
  copy(mu_qv_, A2.view().block(rq + rv, 0, nc, nq + nv));
  for (int i = 0; i < nc; ++i) A2(rq + rv + i, nq + nv + i) = -1.0;
  return A2;
}

Matrix MultibodyTheory::f2(const double* mu) const {
  const Partition &positions = form_.positions(), &velocities = form_.velocities();
  const int nc = sizes_.constraints(), rq = positions.rank, rv = velocities.rank;
  Matrix f2(rq + rv + nc, 1), residuals(nc, 1);
  point_.velocity_residuals(residuals.data());
  for (int k = 0; k < rq; ++k) f2(k, 0) = -point_.terms.g[index(positions.rows[index(k)])];
  for (int k = 0; k < rv; ++k) f2(rq + k, 0) = -residuals(velocities.rows[index(k)], 0);
  for (int i = 0; i < nc; ++i) f2(rq + rv + i, 0) = point_.mu[index(i)] - mu[i];
  return f2;
}

double MultibodyTheory::redundant_residual() const {
  const Partition &positions = form_.positions(), &velocities = form_.velocities();
  std::vector<double> residuals(index(sizes_.constraints()) + 1);
  point_.velocity_residuals(residuals.data());
  double largest = 0.0;
  for (std::size_t k = index(positions.rank); k < positions.rows.size(); ++k)
    largest = std::max(largest, std::fabs(point_.terms.g[index(positions.rows[k])]));
  for (std::size_t k = index(velocities.rank); k < velocities.rows.size(); ++k)
    largest = std::max(largest, std::fabs(residuals[index(velocities.rows[k])]));
  return largest;
}

// A basis of ker A2 in local coordinates.
Matrix MultibodyTheory::tangent() const {
  const int size = sizes_.positions + sizes_.velocities, nc = sizes_.constraints(), d = differential();
  Matrix tangent(sizes_.unknowns(), d);
  const View changes = tangent.view().top(size);
  form_.expand(identity(d), changes);
  multiply(1.0, Op::plain, mu_qv_, Op::plain, changes, 0.0, tangent.view().block(size, 0, nc, d));
  return tangent;
}

Matrix MultibodyTheory::T2() const { return orthonormalized(tangent()); }

Matrix MultibodyTheory::Z1() const {
  const int nq = sizes_.positions, nv = sizes_.velocities, d = differential();
  const Matrix from = tangent();
  Matrix range(sizes_.unknowns(), d);
  copy(from.view().top(nq), range.view().top(nq));
  multiply(1.0, Op::plain, point_.terms.M, Op::plain, from.view().block(nq, 0, nv, d), 0.0,
           range.view().block(nq, 0, nv, d));
  return orthonormalized(std::move(range));
}

ExtendedSystem MultibodyTheory::extended(const Partition& positions, const Partition& velocities,
                                         const double* x) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, rq = positions.rank, rv = velocities.rank,
            order = sizes_.unknowns() + rq + rv;
  const double* mu = x + nq + nv;
  ExtendedSystem result{directions(positions),
                        directions(velocities),
                        Matrix(order, order),
                        Matrix(order, order),
                        std::vector<double>(index(order), 0.0),
                        std::vector<double>(index(rq + rv), 0.0)};
  std::vector<double> rates(index(nq));
  point_.rates(rates.data());
  multiply(1.0, Op::transposed, positions.Q2(), rates.data(), 0.0, result.w.data());
  multiply(1.0, Op::transposed, velocities.Q2(), point_.a.data(), 0.0, result.w.data() + rq);
  write_kinematics(positions, result);
  write_dynamics(velocities, mu, result, nq);
  write_constraints(positions, velocities, result, nq + nv);
  write_accelerations(velocities, result, nq + nv + rq + rv);
  write_least_norm(mu, result, nq + nv + rq + 2 * rv);
  return result;
}

// Q1 Q1^T q' + Q2 wq = S v, which q' fulfils.
void MultibodyTheory::write_kinematics(const Partition& positions, ExtendedSystem& to) const {
  const int nq = sizes_.positions, nv = sizes_.velocities;
  const View E = to.E, A = to.A;
  copy(projector(positions.Q1()), E.block(0, 0, nq, nq));
  if (point_.terms.S.rows() > 0) copy(jacobian_.kinematics_q, A.block(0, 0, nq, nq));
  copy(kinematics(point_), A.block(0, nq, nq, nv));
  copy_multiple(-1.0, positions.Q2(), A.block(0, sizes_.unknowns(), nq, positions.rank));
}

// M (Q1 Q1^T v' + Q2 wv) = f - C^T mu
void MultibodyTheory::write_dynamics(const Partition& velocities, const double* mu, ExtendedSystem& to,
                                     int row) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, nc = sizes_.constraints(), rv = velocities.rank;
  const MultibodyTerms& terms = point_.terms;
  const View E = to.E, A = to.A;
  double* const f = to.f.data() + row;
  multiply(1.0, Op::plain, terms.M, Op::plain, projector(velocities.Q1()), 0.0, E.block(row, nq, nv, nv));
  copy(jacobian_.force_q, A.block(row, 0, nv, nq));
  copy(jacobian_.force_v, A.block(row, nq, nv, nv));
  copy_multiple(-1.0, transpose(terms.C), A.block(row, nq + nv, nv, nc));
  multiply(-1.0, Op::plain, terms.M, Op::plain, velocities.Q2(), 0.0, A.block(row, A.cols - rv, nv, rv));
  std::copy_n(terms.f.data(), nv, f);
  multiply(-1.0, Op::plain, terms.M, point_.a.data(), 1.0, f);
  multiply(-1.0, Op::transposed, terms.C, mu, 1.0, f);
}

// g = 0, C v + r = 0
void MultibodyTheory::write_constraints(const Partition& positions, const Partition& velocities, ExtendedSystem& to,
                                        int row) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, rq = positions.rank, rv = velocities.rank;
  const View A = to.A;
  std::vector<double> residuals(index(sizes_.constraints()) + 1);
  point_.velocity_residuals(residuals.data());
  copy_rows(-1.0, point_.terms.g_q, positions.rows, A.block(row, 0, rq, nq));
  for (int k = 0; k < rq; ++k) to.f[index(row + k)] = -point_.terms.g[index(positions.rows[index(k)])];
  row += rq;
  copy_rows(-1.0, jacobian_.velocity_q, velocities.rows, A.block(row, 0, rv, nq));
  copy_rows(-1.0, point_.terms.C, velocities.rows, A.block(row, nq, rv, nv));
  for (int k = 0; k < rv; ++k) to.f[index(row + k)] = -residuals[index(velocities.rows[index(k)])];
}

// C (Q1 Q1^T v' + Q2 wv) + s = 0, which a fulfils.
void MultibodyTheory::write_accelerations(const Partition& velocities, ExtendedSystem& to, int row) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, rv = velocities.rank;
  const Matrix& C = point_.terms.C;
  const View E = to.E, A = to.A;
  copy_rows(1.0, product(C, projector(velocities.Q1())), velocities.rows, E.block(row, nq, rv, nv));
  copy_rows(-1.0, jacobian_.acceleration_q, velocities.rows, A.block(row, 0, rv, nq));
  copy_rows(-1.0, jacobian_.acceleration_v, velocities.rows, A.block(row, nq, rv, nv));
  copy_rows(-1.0, product(C, velocities.Q2()), velocities.rows, A.block(row, A.cols - rv, rv, rv));
}

// N^T mu = 0, N^T C = 0, from the given mu; none without redundant constraints.
void MultibodyTheory::write_least_norm(const double* mu, ExtendedSystem& to, int row) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, nc = sizes_.constraints(), count = to.E.rows() - row;
  if (count == 0) return;
  const View A = to.A;
  const Matrix N = to_matrix(svd(point_.terms.C).U.view().columns(nc - count, count));
  copy(transpose_product(N, mu_qv_), A.block(row, 0, count, nq + nv));
  copy_multiple(-1.0, transpose(N), A.block(row, nq + nv, count, nc));
  multiply(-1.0, Op::transposed, N, mu, 0.0, to.f.data() + row);
}

DerivativeArray array_of_level_0(MultibodyProblem& problem, const Jet& jet) {
  const MultibodySizes& sizes = problem.sizes();
  const int nq = sizes.positions, nv = sizes.velocities, nl = sizes.holonomic, nk = sizes.nonholonomic,
            nc = sizes.constraints(), n = sizes.unknowns();
  const double *q = jet.column(0), *v = q + nq, *mu = v + nv, *qdot = jet.column(1), *vdot = qdot + nq;
  MultibodyPoint point;
  point.resize(sizes);
  point.set(jet.t, q, v);
  std::copy_n(vdot, nv, point.a.data());
  std::copy_n(mu, nc, point.mu.data());
  MultibodyTerms& terms = point.terms;
  MultibodyJacobian jacobian(sizes);
  CallbackError error = problem.at_velocity(jet.t, q, v, terms);
  if (error.status == SFDAE_OK) error = problem.linearize(point.state(), terms, jacobian);
  if (error.status != SFDAE_OK) error.raise();

  DerivativeArray array{Matrix(n, n), Matrix(n, n), std::vector<double>(index(n), 0.0)};
  const View E = array.M, A = array.N;
  double* g = array.g.data();
  copy(identity(nq), E.block(0, 0, nq, nq));
  copy(terms.M, E.block(nq, nq, nv, nv));
  if (terms.S.rows() > 0) copy(jacobian.kinematics_q, A.block(0, 0, nq, nq));
  copy(kinematics(point), A.block(0, nq, nq, nv));
  copy(jacobian.force_q, A.block(nq, 0, nv, nq));
  copy(jacobian.force_v, A.block(nq, nq, nv, nv));
  copy_multiple(-1.0, transpose(terms.C), A.block(nq, nq + nv, nv, nc));
  copy_multiple(-1.0, terms.g_q, A.block(nq + nv, 0, nl, nq));
  copy_multiple(-1.0, jacobian.velocity_q.view().block(nl, 0, nk, nq), A.block(nq + nv + nl, 0, nk, nq));
  copy_multiple(-1.0, terms.C.view().block(nl, 0, nk, nv), A.block(nq + nv + nl, nq, nk, nv));
  point.rates(g);
  for (int i = 0; i < nq; ++i) g[i] -= qdot[i];
  std::copy_n(terms.f.data(), nv, g + nq);
  multiply(-1.0, Op::plain, terms.M, vdot, 1.0, g + nq);
  multiply(-1.0, Op::transposed, terms.C, mu, 1.0, g + nq);
  for (int i = 0; i < nl; ++i) g[nq + nv + i] = -terms.g[index(i)];
  std::vector<double> residuals(index(nc) + 1);
  point.velocity_residuals(residuals.data());
  for (int i = nl; i < nc; ++i) g[nq + nv + i] = -residuals[index(i)];
  return array;
}

}  // namespace sfdae::core
