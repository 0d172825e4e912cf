// Steps of regular problems of strangeness index 0.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/index_zero_step.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "system/kept_matrix.h"

namespace sfdae::core {

namespace {

// Unknowns for which a factorization takes as long as one iteration: 2/3 n^3 operations at three times the speed of
// the 2 n^2 of a solution.
constexpr double unknowns_per_iteration = 9.0;
// Steps that need more are better made smaller; as for other nonlinear systems.
constexpr int most_newton_iterations = 12;
// A rate that is measured once may be small by chance. Chosen, not measured.
constexpr double least_rate = 1e-3;

// Of the smallest value kept: changes of a matrix that leave its rank as it is, with room for what the smallest entry
// of a pivoted QR factorization is above the smallest singular value.
constexpr double negligible_change = 0.1;

// Unknowns for each constraint from which on errors are mapped by the kernel of E: 4 n a operations instead of the
// 2 n^2 + 4 n d + d^2 of the form.
constexpr int few_constraints = 4;

// c tau E - A as the matrix of a step.
struct FullMatrix {
  const TaylorData& data;
  int unknowns() const { return data.n; }
  void step_matrix(double c_tau, View M) const {
    const ConstView E = data.E(0), A = data.A(0);
    const std::size_t area = index(data.n) * index(data.n);
    for (std::size_t i = 0; i < area; ++i) M.data[i] = c_tau * E.data[i] - A.data[i];
  }
};

bool is_zero_row(ConstView E, int i) {
  for (int j = 0; j < E.cols; ++j)
    if (E(i, j) != 0.0) return false;
  return true;
}

// A bound of the 2-norm of the matrix whose entries are entry(i, j): the geometric mean of its 1-norm and its
// infinity-norm. sums: rows zeros.
template <class Entry>
double norm_bound(int rows, int cols, double* sums, Entry entry) {
  double largest_column = 0.0, largest_row = 0.0;
  for (int j = 0; j < cols; ++j) {
    double column = 0.0;
    for (int i = 0; i < rows; ++i) {
      const double size = std::fabs(entry(i, j));
      column += size;
      sums[i] += size;
    }
    largest_column = std::max(largest_column, column);
  }
  for (int i = 0; i < rows; ++i) largest_row = std::max(largest_row, sums[i]);
  return std::sqrt(largest_column * largest_row);
}

}  // namespace

void IndexZeroStep::resize() {
  const CharacteristicValues& values = problem_.analysis().values;
  const int n = problem_.n();
  is_possible_ = values.mu == 0 && problem_.m() == n && values.d + values.a == n && problem_.analysis().v_hat == 0 &&
                 problem_.prescribed().empty();
  has_jacobian_ = false;
  if (!is_possible_) return;
  origin_.n = n;
  origin_.set_order(problem_.jet_order());
  rows_.assign(index(n), 0.0);
  matrix_.resize(n);
  change_.assign(index(n) + 1, 0.0);
  is_constraint_.assign(index(n), 0);
  has_kernel_ = false;
  if (maps_by_kernel()) kernel_.assign(index(n) * index(values.a), 0.0);
}

PointStatus IndexZeroStep::renew(const Jet& jet, const std::vector<double>* rows) {
  has_jacobian_ = has_kernel_ = false;
  matrix_.forget();
  const PointStatus status = problem_.linearize(jet, rows, data_);
  if (status != PointStatus::ok) return status;
  origin_ = jet;
  rows_.assign(data_.row_scale.begin(), data_.row_scale.end());
  has_jacobian_ = true;
  return PointStatus::ok;
}

void IndexZeroStep::take(const Jet& jet, const TaylorData& data) {
  data_ = data;
  has_kernel_ = false;
  matrix_.forget();
  origin_ = jet;
  rows_.assign(data_.row_scale.begin(), data_.row_scale.end());
  has_jacobian_ = true;
}

// The rows of E that vanish; true if they are the constraints.
bool IndexZeroStep::find_constraints(const TaylorData& data) {
  for (int i = 0; i < data.n; ++i) is_constraint_[index(i)] = is_zero_row(data.E(0), i) ? 1 : 0;
  return std::count(is_constraint_.begin(), is_constraint_.end(), 1) == problem_.analysis().values.a;
}

// Few enough for errors to be mapped by them. Else errors are mapped by the form that was judged.
bool IndexZeroStep::maps_by_kernel() const {
  const int a = problem_.analysis().values.a;
  return a > 0 && few_constraints * a <= problem_.n();
}

bool IndexZeroStep::has_ranks_of(const TaylorData& judged, const NullSpaceForm& form) {
  if (data_.time_scale != judged.time_scale || !find_constraints(data_)) return false;
  for (int i = 0; i < data_.n; ++i)
    if ((is_constraint_[index(i)] != 0) != is_zero_row(judged.E(0), i)) return false;
  const Arena::Frame frame(arena_);
  double* factors = arena_.take(index(data_.n));  // to the rows as they were judged
  for (std::size_t i = 0; i < index(data_.n); ++i) factors[i] = judged.row_scale[i] / data_.row_scale[i];
  return is_near(judged, form, factors);
}

// [Z1^T E; A2] has to stay regular: E on the kernel of A2, which turns by |dA2| / |A2|.
bool IndexZeroStep::is_near(const TaylorData& judged, const NullSpaceForm& form, const double* factors) {
  const int n = data_.n;
  const ConstView E = data_.E(0), A = data_.A(0), judged_E = judged.E(0), judged_A = judged.A(0);
  const Arena::Frame frame(arena_);
  const auto bound = [&](auto entry) { return norm_bound(n, n, arena_.zeros(index(n)), entry); };
  const double change_E = bound([&](int i, int j) { return factors[i] * E(i, j) - judged_E(i, j); });
  if (form.a == 0) return change_E <= negligible_change * form.smallest_of_G();
  const double change_A2 = bound(
      [&](int i, int j) { return is_constraint_[index(i)] != 0 ? factors[i] * A(i, j) - judged_A(i, j) : 0.0; });
  if (change_A2 > negligible_change * form.smallest_constraint()) return false;
  if (form.d == 0) return true;
  const double turn = bound([&](int i, int j) { return judged_E(i, j); }) * change_A2 / form.smallest_constraint();
  return change_E + turn <= negligible_change * form.smallest_of_G();
}

// Of the Jacobian.
bool IndexZeroStep::prepare_kernel() {
  if (has_kernel_) return true;
  if (!find_constraints(data_)) return false;
  const int n = data_.n;
  const Arena::Frame frame(arena_);
  const View regular = arena_.matrix(n, n);  // [Z1^T E; A2]
  int* pivots = arena_.integers(n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) regular(i, j) = is_constraint_[index(i)] != 0 ? data_.A(0)(i, j) : data_.E(0)(i, j);
  if (!factor_lu(regular, pivots)) return false;
  const View K{kernel_.data(), n, problem_.analysis().values.a, n};
  fill(K, 0.0);
  for (int i = 0, column = 0; i < n; ++i)
    if (is_constraint_[index(i)] != 0) K(i, column++) = 1.0;
  solve_lu(regular, pivots, K);
  has_kernel_ = true;
  return true;
}

// dx = dw - K A2 dw: A2 dx = 0, E dx = E dw.
bool IndexZeroStep::error_in_x(const double* dw, int count, double* dx) {
  if (!is_possible_ || !has_jacobian_ || !maps_by_kernel() || !prepare_kernel()) return false;
  const int n = data_.n, a = problem_.analysis().values.a;
  const Units& units = problem_.units();
  const Arena::Frame frame(arena_);
  double* residual = arena_.take(index(a));
  for (int k = 0; k < count; ++k, dw += n, dx += n) {
    for (int i = 0; i < n; ++i) dx[i] = dw[i] / units[i];
    for (int i = 0, row = 0; i < n; ++i) {
      if (is_constraint_[index(i)] == 0) continue;
      double sum = 0.0;
      for (int j = 0; j < n; ++j) sum += data_.A(0)(i, j) * dx[j];
      residual[row++] = sum;
    }
    multiply(-1.0, Op::plain, ConstView{kernel_.data(), n, a, n}, residual, 1.0, dx);
    for (int i = 0; i < n; ++i) dx[i] *= units[i];
  }
  return true;
}

bool IndexZeroStep::prepare_matrix(double c, const Shared& shared) {
  if (matrix_.is_valid()) {
    deviation_ = matrix_.is_for(c) ? 0.0 : deviation_of(c, matrix_.c());
    waste_ += iterations_wasted(deviation_);
    if (deviation_ <= largest_deviation && waste_ * unknowns_per_iteration <= data_.n) {
      shared.chord.set_rate(std::max(shared.chord.rate(), deviation_));
      return true;
    }
  }
  deviation_ = waste_ = 0.0;
  return matrix_.factor(FullMatrix{data_}, data_.time_scale, c, shared.factorizations);
}

bool IndexZeroStep::blames_matrix() {
  if (deviation_ <= harmless_deviation) return false;
  matrix_.forget();
  return true;
}

PointStatus IndexZeroStep::evaluate(const IterationTask& task, Jet& jet) {
  const int n = jet.n;
  double* xdot = jet.column(1);
  for (int i = 0; i < n; ++i) xdot[i] = task.c * jet.x[index(i)] + task.w_rest[i];
  const PointStatus status = problem_.residuals(jet.t, jet.x.data(), 0, change_.data());
  for (int i = 0; i < n; ++i) change_[index(i)] *= -data_.time_scale * data_.row_scale[index(i)];
  return status;
}

// Its size in units of the tolerance, less what rounding errors contribute.
double IndexZeroStep::apply_change(const IterationTask& task, const std::vector<double>& noise, double factor,
                                   Jet& jet) {
  const Units& units = problem_.units();
  double norm = 0.0;
  for (int i = 0; i < jet.n; ++i) {
    const std::size_t k = index(i);
    const double change = factor * change_[k];
    norm = std::max(norm, (std::fabs(change) - noise[k]) * units[i] * task.inverse_weights[k]);
    if (!std::isfinite(change)) return change;
    jet.x[k] += change * units[i];
  }
  return norm;
}

PointStatus IndexZeroStep::solve(const IterationTask& task, const Shared& shared, Jet& jet) {
  if (!prepare_matrix(task.c, shared)) return PointStatus::singular;
  ChordIteration& chord = shared.chord;
  const double factor = deviation_ > 0.0 ? 2.0 / (1.0 + task.c / matrix_.c()) : 1.0;
  const ChordTarget target{task.tolerance, std::max(least_rate, deviation_)};
  double before = 0.0;
  chord.begin();
  for (int iteration = 0; iteration < most_newton_iterations; ++iteration) {
    const PointStatus status = evaluate(task, jet);
    if (status != PointStatus::ok) return status;
    matrix_.solve(change_.data());
    const double norm = apply_change(task, shared.noise, factor, jet);
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    const auto is_out_of_date = [&] { return have_fallen(task.steep_arguments, origin_, jet); };
    if (chord.has_converged(target, iteration, norm, before, is_out_of_date)) {
      for (int i = 0; i < jet.n; ++i) jet.column(1)[i] = task.c * jet.x[index(i)] + task.w_rest[i];
      return PointStatus::ok;
    }
    if (ChordIteration::is_too_slow(iteration, norm, before)) return PointStatus::not_converged;
    before = norm;
  }
  return PointStatus::not_converged;
}

void IndexZeroStep::archive(Archive& archive, long& factorizations) {
  if (!is_possible_) return;
  bool has_matrix = matrix_.is_valid();
  archive.small(has_jacobian_, has_matrix);
  if (!has_jacobian_) return;
  archive.real(origin_.t);
  archive.reals(origin_.x, index(origin_.n) * index(origin_.order + 1));
  archive.reals(rows_, index(origin_.n));
  archive.real(waste_);
  matrix_.archive_c(archive);
  if (!archive.is_reading()) return;
  const Jet origin = origin_;
  const std::vector<double> rows = rows_;
  if (renew(origin, &rows) != PointStatus::ok) throw DamagedArchive();
  if (has_matrix && !matrix_.factor(FullMatrix{data_}, data_.time_scale, matrix_.c(), factorizations))
    throw DamagedArchive();
}

}  // namespace sfdae::core
