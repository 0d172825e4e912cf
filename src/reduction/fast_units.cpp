// Units of the unknowns that fit a unit of time: for nonlinear problems (docs/design/scaling_and_units.md).
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/fast_units.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "linalg/index.h"
#include "reduction/usual_units.h"

namespace sfdae::core {

namespace {

struct LogEntry {
  std::size_t row, column;
  double size;  // log2
};

// Entries of a row that are this small relative to its largest one may be rounding errors, a hundred of them; those of
// A count without the unit of time.
constexpr double negligible_entry = 1e-14;
// The sweeps converge linearly, and exponents are finally rounded to integers; by judgment.
constexpr int sweeps = 100;
// Units from 2^-300 to 2^300: products of three of them are finite.
constexpr double largest_fast_exponent = 300.0;

// Each unknown of a group in turn is shifted by its mean deviation (Gauss-Seidel on the normal equations).
template <class IndexOf>
void relax(std::vector<double>& unknowns, const std::vector<double>& r, const std::vector<double>& c,
           const std::vector<LogEntry>& entries, IndexOf index_of) {
  std::vector<double> sum(unknowns.size(), 0.0), count(unknowns.size(), 0.0);
  for (const LogEntry& e : entries) {
    sum[index_of(e)] += e.size + r[e.row] + c[e.column];
    count[index_of(e)] += 1.0;
  }
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    if (count[k] > 0.0) unknowns[k] -= sum[k] / count[k];
}

// Unknowns that no differential equation contains: as large as the others in the equation where they are largest. An
// equation determines this once one of its unknowns has a unit; unknowns that no equation connects to others keep
// theirs.
void scale_others(const TaylorData& data, const std::vector<char>& is_differential, std::vector<char> is_scaled,
                  std::vector<double>& c) {
  const ConstView A = data.A(0);
  const double threshold = negligible_entry * data.time_scale, none = -std::numeric_limits<double>::infinity();
  const auto size = [&](int i, int j) {
    const double a = std::fabs(A(i, j));
    return a > threshold ? std::log2(a) + c[index(j)] : none;
  };
  for (bool has_found = true; has_found;) {
    has_found = false;
    std::vector<double> largest(index(A.rows), none);
    for (int j = 0; j < A.cols; ++j)
      for (int i = 0; i < A.rows && is_scaled[index(j)] != 0; ++i)
        largest[index(i)] = std::max(largest[index(i)], size(i, j));
    for (int j = 0; j < A.cols; ++j) {
      if (is_scaled[index(j)] != 0) continue;
      double ratio = none;
      for (int i = 0; i < A.rows; ++i)
        if (is_differential[index(i)] == 0 && largest[index(i)] > none)
          ratio = std::max(ratio, size(i, j) - largest[index(i)]);
      if (!(ratio > none)) continue;
      c[index(j)] -= ratio;
      is_scaled[index(j)] = 1;
      has_found = true;
    }
  }
}

}  // namespace

Units fast_units(CoefficientSource& source, double t, double tau) {
  const TaylorData data = data_in_units(source, t, {}, tau);
  std::vector<char> is_differential(index(data.m), 0), is_scaled(index(data.n), 0);
  for (int j = 0; j < data.n; ++j)
    for (int i = 0; i < data.m; ++i)
      if (std::fabs(data.E(0)(i, j)) > negligible_entry) is_differential[index(i)] = 1;
  std::vector<LogEntry> entries;
  for (bool is_E : {true, false}) {
    const ConstView matrix = is_E ? data.E(0) : data.A(0);
    const double threshold = is_E ? negligible_entry : negligible_entry * data.time_scale;
    for (int j = 0; j < data.n; ++j)
      for (int i = 0; i < data.m; ++i) {
        const std::size_t row = index(i), column = index(j);
        const double a = std::fabs(matrix(i, j));
        if (is_differential[row] == 0 || a <= threshold) continue;
        entries.push_back({row, column, std::log2(a)});
        is_scaled[column] = 1;
      }
  }
  std::vector<double> r(index(data.m), 0.0), c(index(data.n), 0.0);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    relax(r, r, c, entries, [](const LogEntry& e) { return e.row; });
    relax(c, r, c, entries, [](const LogEntry& e) { return e.column; });
  }
  scale_others(data, is_differential, is_scaled, c);
  for (double& exponent : c)
    exponent = std::ldexp(1.0, static_cast<int>(std::clamp(exponent, -largest_fast_exponent, largest_fast_exponent)));
  return c;
}

}  // namespace sfdae::core
