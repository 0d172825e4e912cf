// SPDX-License-Identifier: BSD-3-Clause
#include "sparse_matrices.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <tuple>

#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae_test {

using sfdae::core::index;
using sfdae::core::symmetric_random;

SparseMatrix sparse_matrix(int size, std::vector<Triplet> entries) {
  std::stable_sort(entries.begin(), entries.end(), [](const Triplet& a, const Triplet& b) {
    return std::tie(a.column, a.row) < std::tie(b.column, b.row);
  });
  SparseMatrix matrix;
  matrix.pattern.size = size;
  matrix.pattern.first.assign(index(size) + 1, 0);
  int last_column = -1, last_row = -1;
  for (const Triplet& entry : entries) {
    if (entry.column == last_column && entry.row == last_row) {
      matrix.values.back() += entry.value;
      continue;
    }
    matrix.pattern.row.push_back(entry.row);
    matrix.values.push_back(entry.value);
    ++matrix.pattern.first[index(entry.column) + 1];
    last_column = entry.column;
    last_row = entry.row;
  }
  std::partial_sum(matrix.pattern.first.begin(), matrix.pattern.first.end(), matrix.pattern.first.begin());
  return matrix;
}

SparseMatrix permuted(const SparseMatrix& matrix, const std::vector<int>& row, const std::vector<int>& column) {
  std::vector<Triplet> entries;
  for (int j = 0; j < matrix.pattern.size; ++j)
    for (std::size_t k = index(matrix.pattern.first[index(j)]); k < index(matrix.pattern.first[index(j) + 1]); ++k)
      entries.push_back({row[index(matrix.pattern.row[k])], column[index(j)], matrix.values[k]});
  return sparse_matrix(matrix.pattern.size, std::move(entries));
}

SparseMatrix reaction_diffusion(int cells) {
  const double h = 0.01, diffusion = 0.02 * (cells + 1.0) * (cells + 1.0);
  std::vector<Triplet> entries;
  for (int cell = 0; cell < cells; ++cell) {
    const int u = 2 * cell, v = u + 1;
    const double a = 1.0 + 0.5 * (cell % 7), b = 3.0 - 0.2 * (cell % 5);  // values of u and v
    entries.push_back({u, u, 1.0 - h * (2.0 * a * b - 4.0 - 2.0 * diffusion)});
    entries.push_back({u, v, -h * a * a});
    entries.push_back({v, u, -h * (3.0 - 2.0 * a * b)});
    entries.push_back({v, v, 1.0 + h * (a * a + 2.0 * diffusion)});
    for (const int neighbour : {cell - 1, cell + 1})
      if (neighbour >= 0 && neighbour < cells)
        for (int species = 0; species < 2; ++species)
          entries.push_back({2 * cell + species, 2 * neighbour + species, -h * diffusion});
  }
  return sparse_matrix(2 * cells, std::move(entries));
}

SparseMatrix laplacian(int width, int height) {
  std::vector<Triplet> entries;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int place = x + width * y;
      entries.push_back({place, place, 4.0});
      if (x > 0) entries.push_back({place, place - 1, -1.0});
      if (x + 1 < width) entries.push_back({place, place + 1, -1.0});
      if (y > 0) entries.push_back({place, place - width, -1.0});
      if (y + 1 < height) entries.push_back({place, place + width, -1.0});
    }
  return sparse_matrix(width * height, std::move(entries));
}

SparseMatrix flow(int cells) {
  const int walls = cells - 1;  // between neighbours of a line of cells; those around the square have no velocity
  const int velocities = cells * walls;
  std::vector<Triplet> entries;
  const auto pressure = [&](int x, int y) { return 2 * velocities + x + cells * y; };
  for (int direction = 0; direction < 2; ++direction)
    for (int along = 0; along < walls; ++along)
      for (int across = 0; across < cells; ++across) {
        const auto place = [&](int i, int j) { return direction * velocities + i + walls * j; };
        const int u = place(along, across);
        entries.push_back({u, u, 4.0});
        if (along > 0) entries.push_back({u, place(along - 1, across), -1.0});
        if (along + 1 < walls) entries.push_back({u, place(along + 1, across), -1.0});
        if (across > 0) entries.push_back({u, place(along, across - 1), -1.0});
        if (across + 1 < cells) entries.push_back({u, place(along, across + 1), -1.0});
        for (int side = 0; side < 2; ++side) {
          const int p = direction == 0 ? pressure(along + side, across) : pressure(across, along + side);
          const double sign = side == 0 ? -1.0 : 1.0;
          entries.push_back({u, p, sign});
          entries.push_back({p, u, sign});
        }
      }
  // The sum of the pressure's equations is 0: one of them fixes the pressure instead.
  std::erase_if(entries, [&](const Triplet& entry) { return entry.row == pressure(0, 0); });
  entries.push_back({pressure(0, 0), pressure(0, 0), 1.0});
  return sparse_matrix(2 * velocities + cells * cells, std::move(entries));
}

SparseMatrix arrow(int size, int full) {
  std::minstd_rand generator(7);
  std::vector<Triplet> entries;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      if (i == j || i >= size - full || j >= size - full)
        entries.push_back({i, j, symmetric_random(generator) + (i == j ? 4.0 : 0.0)});
  return sparse_matrix(size, std::move(entries));
}

SparseMatrix random_band(int size, int lower, int upper, double dominance, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<Triplet> entries;
  for (int j = 0; j < size; ++j)
    for (int i = std::max(0, j - upper); i <= std::min(size - 1, j + lower); ++i)
      entries.push_back({i, j, symmetric_random(generator) + (i == j ? dominance : 0.0)});
  return sparse_matrix(size, std::move(entries));
}

SparseMatrix random_sparse(int size, int per_column, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<int> transversal(index(size));
  std::iota(transversal.begin(), transversal.end(), 0);
  std::shuffle(transversal.begin(), transversal.end(), generator);
  std::vector<Triplet> entries;
  for (int j = 0; j < size; ++j) {
    entries.push_back({transversal[index(j)], j, 2.0 + symmetric_random(generator)});
    for (int k = 0; k < per_column; ++k)
      entries.push_back(
          {static_cast<int>(generator() % static_cast<unsigned>(size)), j, symmetric_random(generator)});
  }
  return sparse_matrix(size, std::move(entries));
}

}  // namespace sfdae_test
