// Exponents of units that bring the entries of E x' = A x near one.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/unit_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "linalg/dense.h"

namespace sfdae::core {

namespace {

using Exponents = std::vector<double>;

// Squares of smaller gradients belong to exponents that are right to a fraction of a bit.
constexpr double converged = 1e-3;
// By judgment.
constexpr int reweightings = 25;

// (r, c, s) in one vector.
struct Layout {
  int m, n;
  std::size_t size() const { return index(m) + index(n) + 1; }
  double* columns(Exponents& v) const { return v.data() + m; }
  const double* columns(const Exponents& v) const { return v.data() + m; }
};

double scalar_product(const Exponents& a, const Exponents& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// The normal equations of the sum of w (bits + r_i + c_j - time s)^2.
class NormalEquations {
 public:
  explicit NormalEquations(const EntrySizes& sizes)
      : of_{sizes.m, sizes.n},
        sizes_(sizes),
        weights_(sizes.m, sizes.n),
        weights_of_E_(sizes.m, sizes.n),
        diagonal_(of_.size()),
        beside_time_(of_.size()),
        ones_(index(std::max(sizes.m, sizes.n)), 1.0) {}

  // Weight of each entry: 1, or 1 / max(1, |deviation at x|).
  enum class Weighting { even, by_size };
  void weigh(const UnitExponents& x, Weighting weighting);
  // Half the gradient at the x weighed last, downward.
  const Exponents& descent() const { return descent_; }
  // q := (half the matrix of second derivatives) d
  void apply(const Exponents& d, Exponents& q) const;

 private:
  double add_sums(ConstView entries, double factor, Exponents& to) const;

  Layout of_;
  const EntrySizes& sizes_;
  Matrix weights_, weights_of_E_;
  // Rows and columns of the matrix: the weights are off the diagonal of rows and unknowns, those of E are summed in the
  // row of time.
  Exponents diagonal_, beside_time_, descent_, ones_;
};

// to += factor (row sums, column sums, 0); returns the sum of all entries.
double NormalEquations::add_sums(ConstView entries, double factor, Exponents& to) const {
  Exponents sums(index(entries.rows));
  multiply(1.0, Op::plain, entries, ones_.data(), 0.0, sums.data());
  for (std::size_t i = 0; i < sums.size(); ++i) to[i] += factor * sums[i];
  multiply(factor, Op::transposed, entries, ones_.data(), 1.0, of_.columns(to));
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

void NormalEquations::weigh(const UnitExponents& x, Weighting weighting) {
  const auto [m, n] = of_;
  fill(weights_, 0.0);
  descent_.assign(of_.size(), 0.0);
  Matrix parts(m, n);
  for (const EntrySizes::Block& block : sizes_.blocks) {
    const bool is_E = block.time > 0.0;
    for (int j = 0; j < n; ++j) {
      const double of_column = x.unknowns[index(j)] - block.time * x.time;
      const double *bits = block.bits.view().column(j), *counts = block.counts.view().column(j);
      double *w = weights_.view().column(j), *w_E = weights_of_E_.view().column(j), *part = parts.view().column(j);
      for (int i = 0; i < m; ++i) {
        const double left = bits[i] + x.rows[index(i)] + of_column;
        const double size = std::fabs(left);
        const double weight = weighting == Weighting::even ? counts[i] : counts[i] / (size > 1.0 ? size : 1.0);
        w[i] += weight;
        if (is_E) w_E[i] = weight;
        part[i] = -weight * left;
      }
    }
    descent_.back() -= block.time * add_sums(parts, 1.0, descent_);
  }
  diagonal_.assign(of_.size(), 0.0);
  beside_time_.assign(of_.size(), 0.0);
  add_sums(weights_, 1.0, diagonal_);
  diagonal_.back() = add_sums(weights_of_E_, -1.0, beside_time_);
}

void NormalEquations::apply(const Exponents& d, Exponents& q) const {
  const double s = d.back();
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = diagonal_[i] * d[i] + s * beside_time_[i];
  q.back() += scalar_product(beside_time_, d);
  multiply(1.0, Op::plain, weights_, of_.columns(d), 1.0, q.data());
  multiply(1.0, Op::transposed, weights_, d.data(), 1.0, of_.columns(q));
}

void add(double length, const Exponents& d, UnitExponents& x) {
  const std::size_t m = x.rows.size();
  for (std::size_t i = 0; i < m; ++i) x.rows[i] += length * d[i];
  for (std::size_t j = 0; j < x.unknowns.size(); ++j) x.unknowns[j] += length * d[m + j];
  x.time += length * d.back();
}

// Conjugate gradients. False if x was right.
bool descend(const NormalEquations& equations, UnitExponents& x) {
  Exponents gradient = equations.descent(), direction = gradient, change(gradient.size());
  double size = scalar_product(gradient, gradient);
  if (!(size > converged)) return false;
  const std::size_t most_steps = 4 * gradient.size();
  for (std::size_t step = 0; step < most_steps && size > converged; ++step) {
    equations.apply(direction, change);
    const double curvature = scalar_product(direction, change);
    if (!(curvature > 0.0)) return step > 0;
    const double length = size / curvature;
    add(length, direction, x);
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] -= length * change[i];
    const double next = scalar_product(gradient, gradient);
    for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = gradient[i] + next / size * direction[i];
    size = next;
  }
  return true;
}

}  // namespace

EntrySizes::EntrySizes(int rows, int columns)
    : m(rows), n(columns), blocks{Block{1.0, Matrix(m, n), Matrix(m, n)}, Block{0.0, Matrix(m, n), Matrix(m, n)}} {}

std::size_t EntrySizes::count() const {
  std::size_t count = 0;
  for (const Block& block : blocks) {
    const double* counts = block.counts.data();
    count += static_cast<std::size_t>(std::count(counts, counts + index(m) * index(n), 1.0));
  }
  return count;
}

UnitExponents::UnitExponents(int m, int n) : rows(index(m), 0.0), unknowns(index(n), 0.0) {}

void fit_squares(const EntrySizes& sizes, UnitExponents& x) {
  NormalEquations equations(sizes);
  equations.weigh(x, NormalEquations::Weighting::even);
  descend(equations, x);
}

void fit_absolute_values(const EntrySizes& sizes, UnitExponents& x) {
  NormalEquations equations(sizes);
  for (int pass = 0; pass < reweightings; ++pass) {
    equations.weigh(x, NormalEquations::Weighting::by_size);
    if (!descend(equations, x)) break;  // all further steps would be the same
  }
}

}  // namespace sfdae::core
