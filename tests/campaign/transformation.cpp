// SPDX-License-Identifier: BSD-3-Clause
#include "transformation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace campaign {

namespace {

// Times at which problems are looked at are at most this large, in the problem's own unit.
constexpr double largest_time = 1.5;

// The norm b that [I B; 0 I] may have to be of condition c: its largest singular value is (b + sqrt(b^2 + 4)) / 2 and
// the smallest one over that.
double largest_shear(double c) { return std::sqrt(c) - 1.0 / std::sqrt(c); }

// Random order of 0, ..., n-1.
std::vector<int> permutation(int n, RandomNumbers& random) {
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (int i = n - 1; i > 0; --i)
    std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(random.integer(0, i))]);
  return order;
}

// |B|_2 <= sqrt(|B|_1 |B|_inf).
double norm_bound(const DenseMatrix& sizes) {
  double largest_row = 0.0, largest_column = 0.0;
  for (int i = 0; i < sizes.rows; ++i) {
    double row = 0.0, column = 0.0;
    for (int j = 0; j < sizes.columns; ++j) {
      row += sizes(i, j);
      column += sizes(j, i);
    }
    largest_row = std::max(largest_row, row);
    largest_column = std::max(largest_column, column);
  }
  return std::sqrt(largest_row * largest_column);
}

}  // namespace

Transformation::Transformation(TransformationKind kind, int n, double condition, RandomNumbers& random) : n_(n) {
  switch (kind) {
    case TransformationKind::dense: start_dense(condition, random); break;
    case TransformationKind::integer:
      start_permuted(random);
      add_shears(std::sqrt(condition), 0, true, random);
      add_shears(std::sqrt(condition), 0, true, random);
      break;
    case TransformationKind::sparse:
      start_permuted(random);
      add_rotations(random.integer(1, n), false, random);
      add_shears(condition, 0, false, random);
      break;
    case TransformationKind::rotating:
      if (random.chance(0.5)) {
        start_dense(condition, random);
      } else {
        start_permuted(random);
        add_shears(condition, 0, false, random);
      }
      add_rotations(random.integer(1, n), true, random);
      break;
    case TransformationKind::polynomial:
    case TransformationKind::exact_polynomial:
      start_permuted(random);
      add_shears(condition, random.integer(1, 3), kind == TransformationKind::exact_polynomial, random);
      break;
    case TransformationKind::mixed:
      if (random.chance(0.5)) {
        start_dense(std::sqrt(condition), random);
      } else {
        start_permuted(random);
        add_shears(std::sqrt(condition), 0, false, random);
      }
      add_rotations(random.integer(1, n), true, random);
      add_shears(std::sqrt(condition), random.integer(1, 3), false, random);
      add_rotations(random.integer(0, n), true, random);
      break;
  }
}

void Transformation::start_dense(double condition, RandomNumbers& random) {
  exact_ = false;
  start_ = random_orthogonal(n_, random);
  if (condition <= 1.0) return;
  for (int i = 0; i < n_; ++i) {
    double sigma = std::pow(condition, -random.uniform());
    if (i == 0) sigma = 1.0;
    if (i == n_ - 1) sigma = 1.0 / condition;
    for (int j = 0; j < n_; ++j) start_(i, j) *= sigma;
  }
  start_ = product(random_orthogonal(n_, random), start_);
}

void Transformation::start_permuted(RandomNumbers& random) {
  const std::vector<int> order = permutation(n_, random);
  start_ = DenseMatrix(n_, n_);
  for (int i = 0; i < n_; ++i) start_(i, order[static_cast<std::size_t>(i)]) = random.sign();
}

void Transformation::add_rotations(int count, bool vary, RandomNumbers& random) {
  if (n_ < 2) return;
  exact_ = false;
  if (vary) constant_ = false;
  for (; count > 0; --count) {
    const int i = random.integer(0, n_ - 1);
    const int j = (i + random.integer(1, n_ - 1)) % n_;
    const double frequency = vary ? random.sign() * random.log_uniform(0.2, 3.0) : 0.0;
    operations_.push_back({true, {i, j, frequency, random.uniform(0.0, 6.28)}, {}});
  }
}

// Some rows get combinations of the others, [I B(s); 0 I] of at most that condition.
void Transformation::add_shears(double condition, int degree, bool integers, RandomNumbers& random) {
  if (n_ < 2 || condition <= 1.0) return;
  const std::vector<int> order = permutation(n_, random);
  const int split = random.integer(1, n_ - 1);
  const double bound = largest_shear(condition);
  DenseMatrix sizes(n_, n_);  // of the entries of B
  const std::size_t first = operations_.size();
  for (int count = random.integer(1, std::min(3 * n_, split * (n_ - split))); count > 0; --count) {
    Shear shear{order[static_cast<std::size_t>(random.integer(0, split - 1))],
                order[static_cast<std::size_t>(random.integer(split, n_ - 1))],
                {}};
    double size = 0.0, power = 1.0;
    for (int k = 0; k <= degree; ++k) {
      double& c = shear.p[static_cast<std::size_t>(k)];
      c = integers ? random.integer(-2, 2) : random.uniform(-1.0, 1.0);
      size += std::abs(c) * power;
      power *= largest_time;
    }
    sizes(shear.i, shear.j) += size;
    if (integers && norm_bound(sizes) > bound) {
      sizes(shear.i, shear.j) -= size;
    } else {
      operations_.push_back({false, {}, shear});
    }
  }
  if (operations_.size() == first) return;
  if (degree > 0) constant_ = false;
  if (integers) return;
  exact_ = false;
  const double factor = std::pow(random.uniform(), 0.25) * bound / norm_bound(sizes);
  for (std::size_t k = first; k < operations_.size(); ++k)
    for (double& c : operations_[k].shear.p) c *= factor;
}

TaylorMatrix Transformation::series(double s, int order) const {
  TaylorMatrix result(n_, n_);
  for (int j = 0; j < n_; ++j)
    for (int i = 0; i < n_; ++i) coefficient(result(i, j), 0) = start_(i, j);
  for (const Operation& operation : operations_) {
    if (operation.rotates) {
      const Rotation& rotation = operation.rotation;
      const TaylorSeries sin = sine(1.0, rotation.frequency, rotation.phase, s);
      const TaylorSeries cos = sine(1.0, rotation.frequency, rotation.phase + 0.5 * std::numbers::pi, s);
      for (int column = 0; column < n_; ++column) {
        TaylorSeries first{}, second{}, minus_first = result(rotation.i, column);
        add_product(first, cos, result(rotation.i, column), order);
        add_product(first, sin, result(rotation.j, column), order);
        for (double& c : minus_first) c = -c;
        add_product(second, sin, minus_first, order);
        add_product(second, cos, result(rotation.j, column), order);
        result(rotation.i, column) = first;
        result(rotation.j, column) = second;
      }
    } else {
      const TaylorSeries p = polynomial(operation.shear.p, s);
      for (int column = 0; column < n_; ++column)
        add_product(result(operation.shear.i, column), p, result(operation.shear.j, column), order);
    }
  }
  return result;
}

}  // namespace campaign
