// The constraints of a nonlinear problem, linearized at a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/linearized_constraints.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "reduction/rank_sequence.h"

namespace sfdae::core {

using Vector = std::vector<double>;

void LinearizedConstraints::linearize(const Jet& jet) {
  const int mu = analysis_.values.mu;
  const NonlinearProblem::Scaling scaling{analysis_.time_scale, analysis_.rows, nullptr, &units_};
  const CallbackError error = problem_.linearize(jet.t, jet.x.data(), {mu, mu, mu}, scaling, data_);
  if (error.status != SFDAE_OK) error.raise();
  StoredReduction reduction{elimination_, true};
  has_known_ranks_ = reduce_with_known_values(data_, mu, analysis_, rank_tol_, {arena_, form_}, reduction);
  rank_E_ = reduction.rank_E;
  kept_ = reduction.kept;
}

double LinearizedConstraints::move(const ConsistencyRequest& request, const Vector& target, Jet& jet) {
  Vector missing(index(jet.n));
  for (int i = 0; i < jet.n; ++i) missing[index(i)] = target[index(i)] - jet.x[index(i)];
  ConsistencyRequest relative = request;
  relative.least_size = size_of(jet);
  return move_by(consistent_point(point(), relative, missing), jet);
}

double LinearizedConstraints::move_by(Vector dx, Jet& jet) {
  const int n = problem_.n(), mu = analysis_.values.mu;
  const double size = size_of(jet);
  double largest = 0.0;
  for (int i = 0; i < n; ++i) {
    dx[index(i)] /= units_[i];
    largest = std::max(largest, std::fabs(dx[index(i)]));
  }
  Vector transformed(index(problem_.m() * (mu + 1)) + 1), dy(index(n * (mu + 1)));
  elimination_.transform(data_.f(0), transformed.data(), arena_);
  elimination_.recover(data_, {data_.f(0), transformed.data()}, dx.data(), dy.data(), arena_);
  jet.add_scaled(dx.data(), dy.data(), mu + 1, data_.time_scale, units_);
  return size > 0.0 ? largest / size : largest;
}

bool LinearizedConstraints::find_particular(ConstView f, const double* sizes, View dx) {
  // Relative to f; far above rounding errors. (Chosen.)
  constexpr double contradiction = 1e-7;
  Vector transformed(index(f.rows) + 1);
  bool agree = true;
  for (int j = 0; j < f.cols; ++j) {
    for (int k = 0; k <= data_.orders.f; ++k)
      std::copy_n(f.column(j) + index(k) * index(data_.m), data_.m, data_.f(k));
    data_.least_norm_f = data_.norm(data_.orders.f) * sizes[j];
    elimination_.transform(f.column(j), transformed.data(), arena_);
    form_.replace_rhs(data_, transformed.data(), {}, arena_, RightHandSides::constraints);
    agree = agree && form_.inconsistency() <= contradiction;
    std::copy_n(form_.xp(), form_.n, dx.column(j));
  }
  data_.least_norm_f = 0.0;
  return agree;
}

Vector LinearizedConstraints::violation() const {
  Vector change(form_.xp(), form_.xp() + form_.n);
  units_.outward(change.data());
  return change;
}

double LinearizedConstraints::size_beside(int i, const Jet& jet) const {
  Vector buffer(index(jet.n));
  return units_[i] * size_in_constraints({form_.xp(), form_.T2()}, i, units_.inward(jet.x.data(), buffer.data()));
}

double LinearizedConstraints::size_of(const Jet& jet) const { return units_.largest(jet.x.data(), jet.n); }

Vector with_inputs(NonlinearProblem& problem, double t, const Vector& given) {
  Vector target(given), values(problem.prescribed().size() + 1);
  const CallbackError error = problem.evaluate_prescribed(t, values.data());
  if (error.status != SFDAE_OK) error.raise();
  for (std::size_t k = 0; k < problem.prescribed().size(); ++k) target[index(problem.prescribed()[k])] = values[k];
  return target;
}

}  // namespace sfdae::core
