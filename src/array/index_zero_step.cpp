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
// A rate that is measured once may be small by chance. Chosen, not measured.
constexpr double least_rate = 1e-3;

// Change of a matrix, relative to its smallest kept value, that leaves its rank unchanged. It leaves room because the
// smallest entry of a pivoted QR factorization may exceed the smallest singular value.
constexpr double negligible_change = 0.1;

// Least number of unknowns per constraint for mapping errors by the kernel of E: 4 n a operations instead of the 2 n^2
// + 4 n d + d^2 of the form.
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

// Finds the rows of E that vanish; true if there are as many as constraints.
bool IndexZeroStep::find_constraints(const TaylorData& data) {
  for (int i = 0; i < data.n; ++i) is_constraint_[index(i)] = is_zero_row(data.E(0), i) ? 1 : 0;
  return std::count(is_constraint_.begin(), is_constraint_.end(), 1) == problem_.analysis().values.a;
}

// True if the constraints are few enough to map errors by the kernel of E; otherwise the judged form maps them.
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

// [Z1^T E; A2] has to stay nonsingular: E on the kernel of A2, which turns by |dA2| / |A2|.
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

// Computes K of the Jacobian: E K = 0, A2 K = I.
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

// The equations of one step for the chord iteration.
class IndexZeroStep::Equations {
 public:
  Equations(IndexZeroStep& step, const IterationTask& task, const Shared& shared, Jet& jet)
      : step_(step),
        task_(task),
        noise_(shared.noise),
        factor_(step.deviation_ > 0.0 ? 2.0 / (1.0 + task.c / step.matrix_.c()) : 1.0),
        jet_(jet) {}

  void set_slopes() {
    for (int i = 0; i < jet_.n; ++i) jet_.column(1)[i] = task_.c * jet_.x[index(i)] + task_.w_rest[i];
  }

  std::size_t num_rows() const { return index(jet_.n); }
  PointStatus evaluate(double* rows) {
    const TaylorData& data = step_.data_;
    set_slopes();
    const PointStatus status = step_.problem_.residuals(jet_.t, jet_.x.data(), 0, rows);
    for (int i = 0; i < jet_.n; ++i) rows[i] *= -data.time_scale * data.row_scale[index(i)];
    return status;
  }

  void add(RowSums kind, double* rows) const {
    const TaylorData& data = step_.data_;
    const double c_tau = std::fabs(task_.c) * data.time_scale;
    for (int j = 0; j < jet_.n; ++j) {
      const double unit = step_.problem_.units()[j], x = jet_.x[index(j)];
      double size = std::fabs(factor_ * step_.change_[index(j)]) * unit, rest = 0.0;
      if (kind == RowSums::of_values) size = std::fabs(x), rest = data.time_scale * std::fabs(task_.w_rest[j]);
      if (kind == RowSums::of_tolerances) size = 1.0 / task_.inverse_weights[j];
      for (int i = 0; i < jet_.n; ++i)
        rows[i] += (std::fabs(data.A(0)(i, j)) * size + std::fabs(data.E(0)(i, j)) * (c_tau * size + rest)) / unit;
    }
  }

  // Returns the size of the change in units of the tolerance, less its rounding errors.
  double change(const double* rows) {
    const Units& units = step_.problem_.units();
    std::copy_n(rows, num_rows(), step_.change_.data());
    step_.matrix_.solve(step_.change_.data());
    double norm = 0.0;
    for (int i = 0; i < jet_.n; ++i) {
      const std::size_t k = index(i);
      const double change = factor_ * step_.change_[k];
      norm = std::max(norm, (std::fabs(change) - noise_[k]) * units[i] * task_.inverse_weights[k]);
      if (!std::isfinite(change)) return change;
      jet_.x[k] += change * units[i];
    }
    return norm;
  }
  bool may_end(int) const { return true; }

 private:
  IndexZeroStep& step_;
  const IterationTask& task_;
  const std::vector<double>& noise_;
  double factor_;
  Jet& jet_;
};

PointStatus IndexZeroStep::solve(const IterationTask& task, const Shared& shared, Jet& jet) {
  if (!prepare_matrix(task.c, shared)) return PointStatus::singular;
  Equations equations(*this, task, shared, jet);
  const PointStatus status =
      shared.chord.solve({.tolerance = task.tolerance, .least_rate = std::max(least_rate, deviation_)}, equations);
  if (status == PointStatus::ok) equations.set_slopes();
  return status;
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
