// SPDX-License-Identifier: BSD-3-Clause
// The blocks and what they contribute. For a constant pencil look at level l of the derivative array:
//   a_l     constraints on x alone that follow from l differentiations, independent ones
//   vhat_l  combinations of the array that vanish identically;  v_l = vhat_l - vhat_{l-1},  vhat_{-1} = 0
//   r_l     rank(E T2), T2 the kernel of those constraints
//   d_l     m - a_l - v_l
// The hypothesis holds at l if r_l = d_l. All four numbers add up over the blocks of a direct sum. In every block
// below r_l <= d_l, and once equality holds it stays; so the sum has mu = the largest mu of its blocks and a, v, d
// are the sums of the final values.
//
//   dynamics, k x k: E = I. M_l is nonsingular: a = v = 0, r_l = d_l = k. mu = 0, d = k.
//   nilpotent, s x s: E = superdiagonal of ones, A = I: x_i = x_{i+1}' - f_i, 0 = x_s + f_s. Level l reveals
//     x_s, ..., x_{s-l}: a_l = min(l+1, s), v_l = 0. T2 = span(e_1..e_{s-l-1}), E e_1 = 0, E e_i = e_{i-1}:
//     r_l = s-l-2 < d_l = s-l-1 for l <= s-2, and r = d = 0 from l = s-1 on. mu = s-1, a = s.
//     s = 1 is an algebraic equation.
//   wide, k x (k+1): E = [I 0], A = [0 I] (L_k of Kronecker): x_i' = x_{i+1} + f_i. E has full row rank, hence so
//     has M_l: a_l = v_l = 0, T2 = I, r_l = k = d_l. mu = 0, d = k, u = 1. k = 0 is a zero column.
//   tall, (k+1) x k: E = [I; 0], A = [0; I] (L_k^T): x_1' = f_1, x_{i+1}' = x_i + f_{i+1}, 0 = x_k + f_{k+1}.
//     Level l reveals x_k, ..., x_{k-l}: a_l = min(l+1, k). At l = k-1 all x are known, but not yet that x_1'
//     contradicts nothing; each level from k on adds one identity: vhat_l = max(0, l+1-k), v_l = 1 for l >= k,
//     else 0. T2 = span(e_1..e_{k-l-1}): r_l = max(k-l-1, 0). d_l = k-l > r_l for l < k, and r = d = 0 from
//     l = k on. mu = k, a = k, v = 1. k = 0 is a zero row: vhat_l = l+1, v_l = 1, mu = 0.
// The definitions are those of
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations. EMS, 2006, sections 3.1 and 3.2.
#include "random_family.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "transformed_pencil.h"

namespace sfdae_test {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

struct Entry {
  int i, j;
  double value;
};

// A direct sum that grows block by block within max_rows x max_columns.
class BlockSum {
 public:
  BlockSum(int max_rows, int max_columns) : max_rows_(max_rows), max_columns_(max_columns) {}

  int rows() const { return rows_; }
  int free_rows() const { return max_rows_ - rows_; }
  int free_columns() const { return max_columns_ - columns_; }
  const std::vector<int>& zero_rows() const { return zero_rows_; }

  void add_real_eigenvalue(double lambda) {
    E_.push_back({rows_, columns_, 1.0});
    A_.push_back({rows_, columns_, lambda});
    close(1, 1, {0, 1, 0, 0, 0});
  }
  void add_complex_pair(double re, double im) {
    for (int i = 0; i < 2; ++i) {
      E_.push_back({rows_ + i, columns_ + i, 1.0});
      A_.push_back({rows_ + i, columns_ + i, re});
      A_.push_back({rows_ + i, columns_ + 1 - i, i == 0 ? im : -im});
    }
    close(2, 2, {0, 2, 0, 0, 0});
  }
  void add_nilpotent(int s) {
    for (int i = 0; i < s; ++i) A_.push_back({rows_ + i, columns_ + i, 1.0});
    for (int i = 0; i + 1 < s; ++i) E_.push_back({rows_ + i, columns_ + i + 1, 1.0});
    close(s, s, {s - 1, 0, s, 0, 0});
  }
  void add_wide(int k) {
    for (int i = 0; i < k; ++i) {
      E_.push_back({rows_ + i, columns_ + i, 1.0});
      A_.push_back({rows_ + i, columns_ + i + 1, 1.0});
    }
    close(k, k + 1, {0, k, 0, 1, 0});
  }
  void add_tall(int k) {
    if (k == 0) zero_rows_.push_back(rows_);
    for (int i = 0; i < k; ++i) {
      E_.push_back({rows_ + i, columns_ + i, 1.0});
      A_.push_back({rows_ + i + 1, columns_ + i, 1.0});
    }
    close(k + 1, k, {k, 0, k, 0, 1});
  }

  CanonicalPencil pencil() const {
    const auto dense = [&](const std::vector<Entry>& entries) {
      std::vector<double> M(index(rows_ * columns_));
      for (const Entry& e : entries) M[index(e.i + e.j * rows_)] = e.value;
      return M;
    };
    return {values_, dense(E_), dense(A_)};
  }

 private:
  void close(int rows, int columns, CharacteristicValues block) {
    rows_ += rows;
    columns_ += columns;
    values_ = {std::max(values_.mu, block.mu), values_.d + block.d, values_.a + block.a, values_.u + block.u,
               values_.v + block.v};
  }

  int max_rows_, max_columns_;
  int rows_ = 0, columns_ = 0;
  std::vector<Entry> E_, A_;
  std::vector<int> zero_rows_;
  CharacteristicValues values_{0, 0, 0, 0, 0};
};

void add_dynamics(BlockSum& sum, RandomNumbers& random, double sigma) {
  const double re = -sigma * random.uniform(0.2, 1.0);
  if (std::min(sum.free_rows(), sum.free_columns()) >= 2 && random.integer(0, 1) == 1)
    sum.add_complex_pair(re, sigma * random.uniform(0.5, 2.0));
  else sum.add_real_eigenvalue(re);
}

BlockSum random_blocks(RandomNumbers& random, const RandomOptions& options) {
  const int mu = options.mu >= 0 ? options.mu : random.integer(0, std::min(options.max_mu, options.max_size - 1));
  if (mu + 1 > options.max_size) throw std::invalid_argument("random_family: mu < max_size is necessary");
  BlockSum sum(options.max_size, random.integer(mu + 1, options.max_size));

  // One block that makes mu what it is; it also makes sure that there is an equation and an unknown.
  const bool tall_allowed = options.singular_blocks && options.max_redundant > 0 && mu > 0;
  const bool first_tall = tall_allowed && random.integer(0, 3) == 0;
  if (first_tall) sum.add_tall(mu);
  else if (mu > 0 || random.integer(0, 1) == 0) sum.add_nilpotent(mu + 1);
  else add_dynamics(sum, random, options.sigma);

  for (int u = random.integer(0, options.max_undetermined); u > 0; --u) {
    const int k = options.singular_blocks ? random.integer(0, 3) : 0;
    if (k <= sum.free_rows() && k + 1 <= sum.free_columns()) sum.add_wide(k);
  }
  for (int v = random.integer(0, options.max_redundant) - (first_tall ? 1 : 0); v > 0; --v) {
    const int k = options.singular_blocks ? random.integer(0, mu) : 0;
    if (k + 1 <= sum.free_rows() && k <= sum.free_columns()) sum.add_tall(k);
  }
  while (sum.free_rows() > 0 && sum.free_columns() > 0) {
    const int room = std::min(sum.free_rows(), sum.free_columns());
    if (random.integer(0, 1) == 0) add_dynamics(sum, random, options.sigma);
    else sum.add_nilpotent(random.integer(1, std::min(mu + 1, room)));
  }
  return sum;
}

// 2 size rotations of random planes.
SmoothTransformation random_transformation(RandomNumbers& random, int size, const RandomOptions& options) {
  constexpr double pi = std::numbers::pi;
  SmoothTransformation T;
  for (int l = 0; size > 1 && l < 2 * size; ++l) {
    const int i = random.integer(0, size - 1);
    const int j = (i + random.integer(1, size - 1)) % size;
    const double phase = random.uniform(-pi, pi);
    T.rotations.push_back({i, j, phase, options.w * random.uniform(-1.0, 1.0)});
  }
  for (int i = 0; options.scalings && i < size; ++i) T.scalings.push_back({0.3, random.uniform(-pi, pi), options.w});
  return T;
}

}  // namespace

std::uint64_t RandomNumbers::next() {
  state_ += 0x9e3779b97f4a7c15u;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

double RandomNumbers::uniform(double low, double high) {
  return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
}

int RandomNumbers::integer(int low, int high) {
  return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
}

std::unique_ptr<LinearFamily> random_family(std::uint64_t seed, const RandomOptions& options) {
  RandomNumbers random(seed);
  const BlockSum sum = random_blocks(random, options);
  CanonicalPencil pencil = sum.pencil();
  const int m = pencil.m(), n = pencil.n();
  SmoothTransformation P = random_transformation(random, m, options);
  SmoothTransformation Q = random_transformation(random, n, options);

  std::vector<double> row_scale(index(m)), contradiction(index(m), 0.0);
  for (double& scale : row_scale) scale = std::pow(10.0, random.integer(-options.row_decades, options.row_decades));
  for (int i : sum.zero_rows()) contradiction[index(i)] = options.rho;

  const CharacteristicValues c = pencil.values;
  std::string name = "random_family(" + std::to_string(seed) + "): mu, d, a, u, v =";
  for (int value : {c.mu, c.d, c.a, c.u, c.v}) name += ' ' + std::to_string(value);
  return std::make_unique<TransformedPencil>(std::move(name), std::move(pencil), std::move(P), std::move(Q),
                                             std::move(row_scale), std::move(contradiction));
}

}  // namespace sfdae_test
