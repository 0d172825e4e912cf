// An iteration accelerated by its last changes.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/accelerated_iteration.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Differences that are nearly combinations of newer ones say nothing new. Of their size; chosen, not measured.
constexpr double independent = 1e-4;

double inner_product(const double* a, const double* b, std::size_t size) {
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) sum += a[i] * b[i];
  return sum;
}

void add(double factor, const double* from, std::size_t size, double* to) {
  for (std::size_t i = 0; i < size; ++i) to[i] += factor * from[i];
}

}  // namespace

void AcceleratedIteration::resize(std::size_t size) {
  const auto grow = [size](std::vector<double>& v) {
    if (v.size() < size) v.resize(size);
  };
  for (Difference& difference : differences_) grow(difference.f), grow(difference.u);
  for (std::vector<double>& q : q_) grow(q);
  grow(last_f_);
  grow(last_u_);
}

// From R g = Q^T f for the orthogonalized differences, as many as there are.
void AcceleratedIteration::accelerate(std::size_t size, double* change) {
  if (has_last_) {
    std::rotate(differences_.begin(), differences_.end() - 1, differences_.end());
    for (std::size_t i = 0; i < size; ++i) differences_[0].f[i] = change[i] - last_f_[i];
    std::copy_n(last_u_.data(), size, differences_[0].u.data());
    count_ = std::min(count_ + 1, depth);
  }
  std::copy_n(change, size, last_f_.data());
  has_last_ = true;
  double R[depth][depth] = {}, g[depth] = {};
  int rank = 0;
  for (; rank < count_; ++rank) {
    double* q = q_[index(rank)].data();
    std::copy_n(differences_[index(rank)].f.data(), size, q);
    const double full = inner_product(q, q, size);
    for (int j = 0; j < rank; ++j) {
      R[j][rank] = inner_product(q_[index(j)].data(), q, size);
      add(-R[j][rank], q_[index(j)].data(), size, q);
    }
    const double rest = inner_product(q, q, size);
    if (!(rest > independent * independent * full)) break;
    R[rank][rank] = std::sqrt(rest);
    for (std::size_t i = 0; i < size; ++i) q[i] /= R[rank][rank];
  }
  for (int j = 0; j < rank; ++j) g[j] = inner_product(q_[index(j)].data(), last_f_.data(), size);
  for (int j = rank - 1; j >= 0; --j) {
    for (int k = j + 1; k < rank; ++k) g[j] -= R[j][k] * g[k];
    g[j] /= R[j][j];
  }
  for (int j = 0; j < rank; ++j) {
    add(-g[j], differences_[index(j)].u.data(), size, change);
    add(-g[j], differences_[index(j)].f.data(), size, change);
  }
  std::copy_n(change, size, last_u_.data());
}

}  // namespace sfdae::core
