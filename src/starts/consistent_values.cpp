// Consistent values under linear constraints. In null-space form every consistent x is xp + T2 z.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/consistent_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "starts/least_change.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Relative accuracy to which fixed components must fit the constraints; by judgement.
constexpr double fixed_tolerance = 1e-9;

// The points xp + T2 z with z = z0 + N y.
struct Candidates {
  Vector z0;
  Matrix N;
};

// Minimizes || D^-1 (xp + T2 z - x) || over the candidates; rows of zero weight are left out.
Vector nearest(const NullSpaceForm& form, const Vector& x, const Vector& inverse_weights,
               const Candidates& candidates) {
  const auto& [z0, N] = candidates;
  const int n = form.n;
  Matrix rows = product(form.T2(), N);
  Vector target(x), base(form.xp(), form.xp() + n);
  multiply(1.0, Op::plain, form.T2(), z0.data(), 1.0, base.data());
  for (int i = 0; i < n; ++i) {
    const double scale = inverse_weights[index(i)];
    target[index(i)] = scale * (x[index(i)] - base[index(i)]);
    for (int j = 0; j < rows.cols(); ++j) rows(i, j) *= scale;
  }
  const Vector y = least_squares(rows, target, n * unit_roundoff * max_abs(rows));
  Vector z(z0), result(form.xp(), form.xp() + n);
  multiply(1.0, Op::plain, N, y.data(), 1.0, z.data());
  multiply(1.0, Op::plain, form.T2(), z.data(), 1.0, result.data());
  return result;
}

// Candidates with given values in components J: T2_J z = x_J - xp_J; N spans the directions that remain.
Candidates with_components(const NullSpaceForm& form, const std::vector<int>& components, const Vector& missing,
                           Matrix& J) {
  const int count = static_cast<int>(components.size());
  J = Matrix(count, form.unknowns());
  for (int row = 0; row < count; ++row)
    for (int j = 0; j < J.cols(); ++j) J(row, j) = form.T2()(components[index(row)], j);
  // T2 has orthonormal columns: singular values of its rows are cosines, 1e-9 is as good as none.
  const Svd decomposition = svd(J);
  int rank = 0;
  for (double s : decomposition.s) rank += s > fixed_tolerance ? 1 : 0;
  return {least_squares(J, missing, fixed_tolerance),
          to_matrix(decomposition.V.view().columns(rank, form.unknowns() - rank))};
}

// Candidates with the fixed and the prescribed components of the given x. Throws Failure if fixed ones do not fit.
Candidates satisfy_fixed(const ConstrainedPoint& point, const ConsistencyRequest& request, const Vector& x) {
  const NullSpaceForm& form = point.form;
  std::vector<int> components;
  Vector missing;
  for (int i = 0; i < form.n; ++i) {
    const bool is_fixed = request.kind == InitialValues::fixed && request.fixed[index(i)] != 0;
    if (!is_fixed && !point.is_prescribed(i)) continue;
    components.push_back(i);
    missing.push_back(x[index(i)] - form.xp()[i]);
  }
  Matrix J;
  Candidates candidates = with_components(form, components, missing, J);
  Vector residual(missing);
  if (!components.empty()) multiply(-1.0, Op::plain, J, candidates.z0.data(), 1.0, residual.data());
  for (int row = 0; row < J.rows(); ++row) {
    // Relative to the terms of this component.
    const int i = components[index(row)];
    if (request.kind != InitialValues::fixed || request.fixed[index(i)] == 0) continue;
    double size = std::max({std::fabs(x[index(i)]), std::fabs(form.xp()[i]), request.least_size});
    for (int j = 0; j < J.cols(); ++j) size = std::max(size, std::fabs(J(row, j) * candidates.z0[index(j)]));
    if (std::fabs(residual[index(row)]) > fixed_tolerance * size)
      throw Failure(SFDAE_FIXED_VALUES,
                    format("the fixed components contradict the constraints at t = %.15g: x[%d] = %.6g would have to "
                           "change by %.3g. Fix fewer components, or correct their values.",
                           point.data.t, i, x[index(i)], -residual[index(row)]));
  }
  return candidates;
}

// Sizes of the scaled unknowns.
Vector scaled_sizes(const ConsistencyRequest& request, const Units& units) {
  Vector sizes = request.sizes();
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] /= units[i];
  return sizes;
}

// Among the candidates, x with the least change of E x, and then of x.
Vector with_differentiated_kept(const ConstrainedPoint& point, const ConsistencyRequest& request,
                                const Candidates& candidates, const Vector& user_x) {
  const NullSpaceForm& form = point.form;
  const Units& units = point.units;
  const int n = form.n;
  Vector base(form.xp(), form.xp() + n), x(user_x);
  multiply(1.0, Op::plain, form.T2(), candidates.z0.data(), 1.0, base.data());
  for (int i = 0; i < n; ++i) x[index(i)] /= units[i];
  const Matrix directions = product(form.T2(), candidates.N);
  const LeadingKernel& kernel = point.kernel();
  // Fixed components leave fewer directions, which have none in common with the kernel if all have none.
  const bool is_known = form.u == 0 || candidates.N.cols() == form.unknowns();
  const ChangeMeasure measure{scaled_sizes(request, units), is_known ? kernel.basis.cols() - form.u : 0,
                              least_cosine(n, point.kept)};
  // Once more if digits were cancelled: given values may be far too large.
  bool has_cancellation = true;
  for (int pass = 0; pass < 2 && has_cancellation; ++pass) {
    const Vector dx = least_change({base.data(), directions}, kernel, measure, x.data());
    has_cancellation = false;
    for (int i = 0; i < n; ++i) {
      if (!request.fixed.empty() && request.fixed[index(i)] != 0) continue;
      x[index(i)] += dx[index(i)];
      has_cancellation = has_cancellation || std::fabs(dx[index(i)]) > 2.0 * std::fabs(x[index(i)]);
    }
  }
  units.outward(x.data());
  return x;
}

// z0: E1 (xp + T2 z0 - x) = 0; N spans the free directions that remain. With Z1 spanning the range of E T2 these are
// the normal equations of min |E (xp + T2 z - x)|: E x changes as little as possible.
Candidates keep_differential(const NullSpaceForm& form, const TaylorData& data, const Vector& x) {
  const int n = form.n, m = form.m, unknowns = form.unknowns(), u = form.u;
  Matrix E = to_matrix(data.E(0));
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < n; ++j) E(i, j) /= data.row_scale[index(i)];
  // Rows of Uz^T make the rank full; they keep z0 out of the free directions.
  Matrix rows(m + u, unknowns);
  multiply(1.0, Op::plain, E, Op::plain, form.T2(), 0.0, rows.view().top(m));
  for (int i = 0; i < u; ++i)
    for (int j = 0; j < unknowns; ++j) rows(m + i, j) = form.Uz()(j, i);
  Vector target(index(m + u), 0.0), missing(x);
  for (int i = 0; i < n; ++i) missing[index(i)] -= form.xp()[i];
  multiply(1.0, Op::plain, E, missing.data(), 0.0, target.data());
  return {least_squares(rows, target, 0.0), to_matrix(form.Uz())};
}

// Fixed components exactly as given: the solution holds them to roundoff only.
Vector with_fixed(const ConsistencyRequest& request, const Vector& given, Vector x) {
  if (request.kind == InitialValues::fixed)
    for (std::size_t i = 0; i < x.size(); ++i)
      if (request.fixed[i] != 0) x[i] = given[i];
  return x;
}

}  // namespace

Vector violation(const NullSpaceForm& form, const Vector& x) {
  Vector along(index(form.unknowns()) + 1), r(x);
  multiply(1.0, Op::transposed, form.T2(), x.data(), 0.0, along.data());
  multiply(-1.0, Op::plain, form.T2(), along.data(), 1.0, r.data());
  for (int i = 0; i < form.n; ++i) r[index(i)] -= form.xp()[i];
  return r;
}

Vector consistent_point(const ConstrainedPoint& point, const ConsistencyRequest& request, const Vector& user_x) {
  // The null-space form is that of scaled unknowns.
  const NullSpaceForm& form = point.form;
  const Units& units = point.units;
  const int n = form.n;
  Vector x(user_x), inverse_weights(index(n));
  for (int i = 0; i < n; ++i) {
    x[index(i)] /= units[i];
    inverse_weights[index(i)] = units[i];
  }
  for (int i = 0; i < n && !request.weights.empty(); ++i) inverse_weights[index(i)] /= request.weights[index(i)];
  const bool plain_norm =
      std::all_of(inverse_weights.begin(), inverse_weights.end(), [](double w) { return w == 1.0; });
  Candidates candidates{Vector(index(form.unknowns()) + 1, 0.0), identity(form.unknowns())};
  if (request.kind == InitialValues::fixed || point.prescribed != nullptr)
    candidates = satisfy_fixed(point, request, x);
  if (request.kind == InitialValues::keep_differential) candidates = keep_differential(form, point.data, x);
  if (request.differentiated_stay())
    return with_fixed(request, user_x, with_differentiated_kept(point, request, candidates, user_x));
  Vector consistent(form.xp(), form.xp() + n);
  const bool any_change = point.prescribed == nullptr &&
                          (request.kind == InitialValues::nearest || request.kind == InitialValues::accept);
  if (plain_norm && any_change) {
    // xp + T2 T2^T x
    Vector& z = candidates.z0;
    multiply(1.0, Op::transposed, form.T2(), x.data(), 0.0, z.data());
    multiply(1.0, Op::plain, form.T2(), z.data(), 1.0, consistent.data());
  } else {
    consistent = nearest(form, x, inverse_weights, candidates);
  }
  for (int i = 0; i < n; ++i) consistent[index(i)] *= units[i];
  return with_fixed(request, user_x, std::move(consistent));
}

namespace {

Vector differentiated_change(const LeadingKernel& kernel, const ConstrainedPoint& point,
                             const ConsistencyRequest& request, const Vector& dx) {
  Vector scaled(dx);
  for (std::size_t i = 0; i < dx.size(); ++i) scaled[i] /= point.units[i];
  scaled = differentiated_part(kernel, scaled_sizes(request, point.units), scaled);
  point.units.outward(scaled.data());
  return scaled;
}

}  // namespace

Vector differentiated_change(const ConstrainedPoint& point, const ConsistencyRequest& request, const Vector& dx) {
  return differentiated_change(point.kernel(), point, request, dx);
}

ValueChange change_of_differentiated(const ConstrainedPoint& point, const ConsistencyRequest& request,
                                     const Vector& given, const Vector& found) {
  if (!request.differentiated_stay()) return {};
  // Errors of the directions times the terms in the constraints of x_i are no change of x_i; two digits of room
  // (chosen). Directions along unknowns have no errors, but sums have roundoff. The largest unknown is no measure: it
  // may be a current of amperes among charges of picocoulombs.
  constexpr double room = 1e2, most_rounding = 1e-8, few_roundings = 4.0 * unit_roundoff;
  const Units& units = point.units;
  const int n = point.form.n;
  Vector dx(index(n)), sizes(index(n)), tolerances(request.tolerances);
  for (int i = 0; i < n; ++i) {
    dx[index(i)] = found[index(i)] - given[index(i)];
    sizes[index(i)] = std::max(std::fabs(given[index(i)]), std::fabs(found[index(i)])) / units[i];
  }
  const LeadingKernel& kernel = point.kernel();
  const double error = kernel.is_coordinates() ? few_roundings : room * error_of_directions(n, point.kept);
  const Vector part = differentiated_change(kernel, point, request, dx);
  for (int i = 0; i < n; ++i) {
    if (std::fabs(part[index(i)]) <= tolerances[index(i)]) continue;
    const double size = size_in_constraints({point.form.xp(), point.form.T2()}, i, sizes.data());
    const double rounding = std::min(error, most_rounding) * std::max(size, sizes[index(i)]);
    tolerances[index(i)] = std::max(tolerances[index(i)], rounding * units[i]);
  }
  ValueChange change = largest_change(given.data(), part.data(), tolerances, n);
  change.is_part = !kernel.is_coordinates();
  return change;
}

void report_change(const ConsistencyRequest& request, double t, const Vector& given, const Vector& consistent,
                   ConsistencyResult& result) {
  for (std::size_t i = 0; i < given.size(); ++i) {
    const double change = std::fabs(consistent[i] - given[i]);
    if (request.kind == InitialValues::accept) {
      if (change > request.tolerances[i])
        throw Failure(SFDAE_INCONSISTENT_VALUES,
                      format("initial values violate the constraints at t = %.15g: residual %.3g, the nearest "
                             "consistent point differs by %.3g in x[%d]. Let them be made consistent, or correct x.",
                             t, result.residual_before, change, static_cast<int>(i)));
    } else if (change > result.largest_change) {
      result.largest_change = change;
      result.component = static_cast<int>(i);
    }
  }
  if (!all_finite(consistent.data(), consistent.size()))
    throw Failure(SFDAE_NOT_FINITE, format("consistent values at t = %.15g overflow: rescale the problem.", t));
}

}  // namespace sfdae::core
