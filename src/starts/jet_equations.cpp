// The equations of a derivative array at a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/jet_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/rank_sequence.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

constexpr double infinity = std::numeric_limits<double>::infinity();
// Keeps quotients by norms that vanish finite.
constexpr double tiny = 1e-300;
// Residuals whose squares could overflow in a sum count as infinite.
constexpr double largest_residual = 1e150;
// y may change this much more easily than x: x was guessed, y has no better start than 0. Chosen, not measured.
constexpr double ease_of_y = 1e3;
// Likewise for unknowns whose derivatives are in no equation, if the others have to stay.
constexpr double ease_of_algebraic = 1e3;

double length(const double* v, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += v[i] * v[i];
  return std::sqrt(sum);
}

// [M | -N] with columns in the order x, y_1, ..., times `unit`.
Matrix scaled_array(const TaylorData& data, int level, const Vector& unit) {
  const Matrix array = taylor_array(data, level);
  const int n = data.n, last = (level + 1) * n;
  Matrix J(array.rows(), array.cols());
  for (int j = 0; j < array.cols(); ++j) {
    const int from = j < n ? last + j : j - n;
    const double factor = (j < n ? -1.0 : 1.0) * unit[index(j)];
    for (int i = 0; i < array.rows(); ++i) J(i, j) = factor * array(i, from);
  }
  return J;
}

}  // namespace

void JetEquations::linearize(const Jet& jet, int level, double time_scale) {
  level_ = level;
  NonlinearProblem::Scaling scaling;
  scaling.time_scale = time_scale;
  scaling.units = &units_;
  const CallbackError error = problem_.linearize(jet.t, jet.x.data(), {level, level, level}, scaling, data_);
  if (error.status != SFDAE_OK) error.raise();
  norm_ = length(data_.f(0), index(problem_.m()) * index(level + 1));
}

bool JetEquations::has_derivative_of(int j) const {
  for (int k = 0; k <= level_; ++k)
    if (max_abs(data_.E(k).column(j), data_.m) > 0.0) return true;
  return false;
}

double JetEquations::residual_norm(const Jet& jet) {
  const int m = problem_.m();
  residuals_.resize(index(m) * index(level_ + 1));
  const CallbackError error = problem_.residuals(jet.t, jet.x.data(), level_, residuals_.data());
  if (ends_everything(error.status) || error.status == SFDAE_ORDER_MISSING) error.raise();
  if (error.status != SFDAE_OK) return infinity;
  double power = 1.0;
  for (int k = 0; k <= level_; ++k) {
    power *= data_.time_scale;
    for (int i = 0; i < m; ++i) residuals_[index(k * m + i)] *= power * data_.row_scale[index(i)];
  }
  for (double& r : residuals_)
    if (!(std::fabs(r) < largest_residual)) return infinity;
  return length(residuals_.data(), residuals_.size());
}

JetEquations::Trial JetEquations::try_change(const Jet& jet, const Vector& change) {
  Trial trial;
  trial.jet = jet;
  trial.jet.add_scaled(change.data(), change.data() + jet.n, level_ + 1, data_.time_scale, units_);
  if (!all_finite(trial.jet.x.data(), trial.jet.x.size())) return trial;
  trial.norm = residual_norm(trial.jet);
  trial.valid = trial.norm < infinity;
  return trial;
}

// Pivots that vanish at consistent jets do not vanish here: values below the residuals count as noise.
double JetEquations::residual_noise() const {
  // Larger residuals would hide all pivots; chosen, not measured.
  constexpr double most = 1e-4;
  return std::min(most, norm_ / std::max(data_.norm(level_), tiny));
}

const RankSequence& JetEquations::eliminate_staged(NoiseModel model, double noise) {
  const Arena::Frame frame(arena_);
  data_.residual_noise = noise;
  // A stored elimination has no place for rows of errors that are carried along: ranks are found before.
  RankSequence known;
  Judge::Settings judging{0.0, false, model, nullptr};
  if (model == NoiseModel::carried) {
    known = find_ranks(data_, level_, judging, {arena_, form_}).list;
    judging = {0.0, false, NoiseModel::pivots, &known};
  }
  Judge judge(data_, level_, judging, nullptr);
  const Carried carried = eliminate(data_, level_, data_.f_stack(level_), 1, judge, arena_, &stored_);
  form_.resize(problem_.m(), problem_.n(), 0, carried.rows);
  if (keeps_differentiated()) form_.build(data_, carried, {}, LeadingTerm::identity, judge, arena_);
  else form_.build_constraints(data_, carried, {}, judge, arena_);
  data_.residual_noise = 0.0;
  ranks_ = judge.ranks();
  rank_E_ = carried.rank_E;
  kept_ = judge.kept_constraints() * judge.smallest_pivot();
  return ranks_;
}

// Change of x in scaled unknowns.
Vector JetEquations::change_of_kept() {
  const LeadingKernel kernel(data_.E(0), rank_E_);
  ChangeMeasure measure{sizes_, kernel.basis.cols() - form_.u, least_cosine(data_.n, kept_)};
  for (int i = 0; i < data_.n; ++i) measure.sizes[index(i)] /= units_[i];
  const Vector zero(index(data_.n), 0.0);
  Vector dx = least_change({form_.xp(), form_.T2()}, kernel, measure, zero.data());
  Vector moved = differentiated_part(kernel, measure.sizes, dx);
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] /= measure.sizes[i];
  moved_ = length(moved.data(), moved.size());
  return dx;
}

bool JetEquations::staged_change(bool keep, Vector& change) {
  const int n = problem_.n();
  change.assign(index(n) * index(level_ + 2), 0.0);
  if (keep && keeps_differentiated()) {
    const Vector dx = change_of_kept();
    std::copy(dx.begin(), dx.end(), change.begin());
  } else {
    std::copy_n(form_.xp(), n, change.data());
  }
  recover_derivatives(change);
  return all_finite(change.data(), change.size());
}

bool JetEquations::is_negligible(const Jet& jet, const Vector& change) const {
  // Relative to a size that counts as one, and to x: chosen, not measured.
  constexpr double little = 1e-3, rounding = 1e-9;
  if (!keeps_differentiated()) return true;
  Vector buffer(index(jet.n));
  const double* const x = units_.inward(jet.x.data(), buffer.data());
  for (int i = 0; i < jet.n; ++i) {
    const double size = std::fabs(change[index(i)]);
    if (size <= std::max(little * sizes_[index(i)] / units_[i], rounding * std::fabs(x[i]))) continue;
    if (!(size <= rounding * size_in_constraints({form_.xp(), form_.T2()}, i, x))) return false;
  }
  return true;
}

void JetEquations::recover_derivatives(Vector& change) {
  Vector transformed(index(data_.m) * index(level_ + 1) + 1);
  stored_.transform(data_.f(0), transformed.data(), arena_);
  stored_.recover(data_, {data_.f(0), transformed.data()}, change.data(), change.data() + data_.n, arena_);
}

Vector JetEquations::unit_changes(const Jet& jet) const {
  const int n = jet.n;
  Vector unit(index(n) * index(level_ + 2));
  for (int i = 0; i < n; ++i) {
    const double scale = units_[i];
    const double size = std::max(1.0, std::fabs(jet.column(0)[i]) / scale);
    const bool is_fixed = !fixed_.empty() && fixed_[index(i)] != 0;
    unit[index(i)] = is_fixed ? 0.0 : size;
    if (!is_fixed && keeps_differentiated() && !has_derivative_of(i)) unit[index(i)] *= ease_of_algebraic;
    for (int k = 1; k <= level_ + 1; ++k) unit[index(k * n + i)] = ease_of_y * size;
  }
  return unit;
}

bool JetEquations::damped_change(const Jet& jet, double damping, Vector& change) {
  // J J^T may be singular: rounding errors of its entries are below this, relative to the largest one.
  constexpr double least_damping = 1e-14;
  const Vector unit = unit_changes(jet);
  const Matrix J = scaled_array(data_, level_, unit);
  const int rows = J.rows();
  Matrix S(rows, rows);
  multiply(1.0, Op::plain, J, Op::transposed, J, 0.0, S);
  double largest = 0.0;
  for (int i = 0; i < rows; ++i) largest = std::max(largest, S(i, i));
  for (int i = 0; i < rows; ++i) S(i, i) += (damping + least_damping) * largest + tiny;
  std::vector<int> pivots(index(rows) + 1);
  if (!factor_lu(S, pivots.data())) return false;
  Vector q(data_.f(0), data_.f(0) + rows);
  solve_lu(S, pivots.data(), q.data());
  change.assign(index(J.cols()), 0.0);
  multiply(1.0, Op::transposed, J, q.data(), 0.0, change.data());
  for (std::size_t j = 0; j < change.size(); ++j) change[j] *= unit[j];
  return all_finite(change.data(), change.size());
}

bool JetEquations::dense_change(const Jet& jet, double most_dropped, Vector& change) const {
  // Singular values below are roundoff of the derivative array; those that the residuals may change are dropped with
  // some room. Both are chosen, not measured.
  constexpr double rounding = 1e-12, room = 10.0;
  const Vector unit = unit_changes(jet);
  const Matrix J = scaled_array(data_, level_, unit);
  const double size = max_abs(J);
  if (!std::isfinite(size)) return false;
  const double threshold = std::max(rounding, std::min(most_dropped, room * norm_ / std::max(size, tiny))) * size;
  change = least_squares(J, Vector(data_.f(0), data_.f(0) + J.rows()), threshold);
  for (std::size_t j = 0; j < change.size(); ++j) change[j] *= unit[j];
  return all_finite(change.data(), change.size());
}

bool JetEquations::is_converged(const Jet& jet, double tolerance) const {
  const int m = data_.m, n = data_.n;
  double power = 1.0;
  // Without such terms, constants cancel: their size is that of the coefficients, but not of those of other rows that
  // derivatives far off have made large.
  Vector size(index(m) * index(level_ + 1), 0.0), least(size.size(), data_.norm(0));
  const Vector zeros(index(m), 0.0);
  for (int k = 0; k <= level_ + 1; ++k) {
    const double to_scaled = k == 0 ? 1.0 : k * (power *= data_.time_scale);
    const double divisor = std::max(k, 1);
    for (int i = std::max(k - 1, 0); i <= level_; ++i) {
      const bool has_E = k > 0, has_A = i >= k;
      for (int j = 0; j < n; ++j) {
        const double y = std::fabs(to_scaled * jet.column(k)[j] / units_[j]);
        const double* E = has_E ? data_.E(i + 1 - k).column(j) : zeros.data();
        const double* A = has_A ? data_.A(i - k).column(j) : zeros.data();
        double *const to = size.data() + i * m, *const largest = least.data() + i * m;
        for (int row = 0; row < m; ++row) {
          const double entry = std::fabs(E[row]) + std::fabs(A[row]) / divisor;
          to[row] += entry * y;
          largest[row] = std::max(largest[row], entry);
        }
      }
    }
  }
  for (std::size_t i = 0; i < size.size(); ++i)
    if (std::fabs(data_.f(0)[i]) > tolerance * (size[i] + least[i])) return false;
  return true;
}

void JetEquations::give_up(const Jet& jet) const {
  constexpr int most_named = 4;
  // Larger figures are not informative.
  constexpr double largest_named = 1e6;
  const int m = problem_.m(), count = m * (level_ + 1);
  std::vector<int> order(index(count));
  for (int i = 0; i < count; ++i) order[index(i)] = i;
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::fabs(data_.f(0)[a]) > std::fabs(data_.f(0)[b]); });
  CallbackError place;
  place.t = jet.t;
  place.user_t = problem_.user_t();
  std::string text = "no consistent values were found near the guess at " + place.where() + "; what remains:";
  double factorial = 1.0;
  for (int q = 0; q < std::min(count, most_named); ++q) {
    const int k = order[index(q)] / m, i = order[index(q)] % m;
    factorial = 1.0;
    for (int j = 2; j <= k; ++j) factorial *= j;
    const double value = -data_.f(k)[i] / (data_.row_scale[index(i)] * std::pow(data_.time_scale, k + 1)) * factorial;
    if (value == 0.0) break;
    const std::string amount =
        std::fabs(value) <= largest_named ? format("%.3g", value) : format("more than %.0e", largest_named);
    text += (k == 0 ? " " : format(" derivative %d of ", k)) + problem_.equation_names().in_words(i) + " by " +
            amount + ",";
  }
  text.back() = '.';
  throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                text + " Give a better guess, fix fewer components, or check the equations.");
}

}  // namespace sfdae::core
