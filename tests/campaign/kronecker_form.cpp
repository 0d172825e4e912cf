// SPDX-License-Identifier: BSD-3-Clause
#include "kronecker_form.h"

#include <algorithm>
#include <cmath>

namespace campaign {

int KroneckerSizes::equations() const {
  int count = differential;
  for (int k : nilpotent) count += k;
  for (int e : L) count += e;
  for (int e : L_transposed) count += e + 1;
  return count;
}

int KroneckerSizes::unknowns() const {
  int count = differential;
  for (int k : nilpotent) count += k;
  for (int e : L) count += e + 1;
  for (int e : L_transposed) count += e;
  return count;
}

CharacteristicValues KroneckerSizes::values() const {
  CharacteristicValues result;
  result.d = differential;
  for (int k : nilpotent) {
    result.a += k;
    result.mu = std::max(result.mu, k - 1);
  }
  for (int e : L) {
    result.d += e;
    result.u += 1;
  }
  for (int e : L_transposed) {
    result.a += e;
    result.v += 1;
    result.mu = std::max(result.mu, e);
  }
  return result;
}

namespace {

// y' = J y, J upper triangular with eigenvalues between 0.3 and the stiffness in size.
void write_differential_block(const KroneckerSizes& sizes, const KroneckerEntries& entries, KroneckerForm& form,
                              RandomNumbers& random) {
  const int stiff = sizes.differential == 0 ? 0 : random.integer(0, sizes.differential - 1);
  for (int i = 0; i < sizes.differential; ++i) {
    form.N(i, i) = 1.0;
    const double size = i == stiff ? entries.stiffness : random.log_uniform(0.3, std::max(entries.stiffness, 1.0));
    const double eigenvalue = random.sign() * size;
    form.M(i, i) = entries.integers ? std::round(eigenvalue) : eigenvalue;
    for (int j = i + 1; j < sizes.differential; ++j)
      if (random.chance(0.3)) form.M(i, j) = entries.integers ? random.integer(-2, 2) : random.uniform(-1.0, 1.0);
  }
}

// N y' = y: nonzero entries beside the diagonal, and whatever above them, leave it one chain.
void write_chain(int first, int length, bool integers, KroneckerForm& form, RandomNumbers& random) {
  for (int i = 0; i < length; ++i) {
    form.M(first + i, first + i) = 1.0;
    for (int j = i + 1; j < length; ++j) {
      double& entry = form.N(first + i, first + j);
      if (j == i + 1) {
        entry = integers ? 1.0 : random.sign() * random.uniform(0.5, 2.0);
      } else if (random.chance(0.2)) {
        entry = integers ? random.integer(-1, 1) : random.uniform(-1.0, 1.0);
      }
    }
  }
}

}  // namespace

KroneckerForm kronecker_form(const KroneckerSizes& sizes, const KroneckerEntries& entries, RandomNumbers& random) {
  const int m = sizes.equations(), n = sizes.unknowns();
  KroneckerForm form{DenseMatrix(m, n), DenseMatrix(m, n)};
  write_differential_block(sizes, entries, form, random);
  int row = sizes.differential, column = sizes.differential;
  for (int k : sizes.nilpotent) {
    write_chain(row, k, entries.integers, form, random);  // row == column so far
    row += k;
    column += k;
  }
  for (int e : sizes.L) {
    for (int i = 0; i < e; ++i) {
      form.N(row + i, column + i) = 1.0;
      form.M(row + i, column + i + 1) = 1.0;
    }
    row += e;
    column += e + 1;
  }
  for (int e : sizes.L_transposed) {
    for (int i = 0; i < e; ++i) {
      form.N(row + i, column + i) = 1.0;
      form.M(row + i + 1, column + i) = 1.0;
    }
    row += e + 1;
    column += e;
  }
  return form;
}

KroneckerSizes random_sizes(int max_unknowns, int max_index, RandomNumbers& random) {
  KroneckerSizes sizes;
  const int limit = random.integer(2, max_unknowns);
  const bool rectangular = random.chance(0.5);
  sizes.differential = random.integer(0, limit / 2);
  for (int attempt = random.integer(1, 6); attempt > 0; --attempt) {
    KroneckerSizes larger = sizes;
    const int kind = rectangular ? random.integer(0, 3) : random.integer(0, 1);
    if (kind <= 1) larger.nilpotent.push_back(random.integer(1, max_index + 1));
    if (kind == 2) larger.L.push_back(random.integer(0, 4));
    if (kind == 3) larger.L_transposed.push_back(random.integer(0, max_index));
    if (larger.equations() <= limit && larger.unknowns() <= limit) sizes = larger;
  }
  // Something has to be there.
  if (sizes.equations() == 0 || sizes.unknowns() == 0) sizes.nilpotent.push_back(random.integer(1, 2));
  return sizes;
}

}  // namespace campaign
