// Units in which the entries of E x' = A x are near one.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/balanced_units.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// One nonzero entry: what is to be made zero is size + r_row + c_column - time s.
struct LogEntry {
  std::size_t row, column;
  double time;  // 1 for E, 0 for A
  double size;  // log2
  double weight;
};

using Vector = std::vector<double>;

// Exponents of all units: r, c and, last, s.
struct Exponents {
  std::size_t m, n;
  Vector values;
  Exponents(std::size_t rows, std::size_t columns) : m(rows), n(columns), values(rows + columns + 1, 0.0) {}
  double& of_row(const LogEntry& e) { return values[e.row]; }
  double& of_column(const LogEntry& e) { return values[m + e.column]; }
  double& of_time() { return values.back(); }
  double sum_at(const LogEntry& e) const { return values[e.row] + values[m + e.column] - e.time * values.back(); }
};

// Units from 2^-300 to 2^300: products of three of them are finite.
constexpr double largest_exponent = 300.0;
// Squares of gradients below this are those of exponents that are right to a fraction of a bit.
constexpr double converged = 1e-10;
// Entries that lie this many bits below the others may be rounding errors: a thousand of them at most, so that values
// down to 1e-13 are left alone (docs/decisions/32-certificates.md).
constexpr double suspicious_bits = 43.0;
// Mean squares follow outliers half of the way and more rarely less than a quarter: entries above this are none.
constexpr double inconspicuous_bits = suspicious_bits / 4.0;
// Reweighted mean squares approach least absolute values; by judgement.
constexpr int reweightings = 25;

// Gradient of half the sum of weighted squares, downward.
void descend(const std::vector<LogEntry>& entries, const Vector& residuals, Exponents& to) {
  std::fill(to.values.begin(), to.values.end(), 0.0);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const LogEntry& e = entries[k];
    const double part = e.weight * residuals[k];
    to.of_row(e) += part;
    to.of_column(e) += part;
    to.of_time() -= e.time * part;
  }
}

double square(const Vector& v) { return std::inner_product(v.begin(), v.end(), v.begin(), 0.0); }

// Conjugate gradients on the normal equations, from x on: directions that change nothing stay as they are.
void fit(const std::vector<LogEntry>& entries, Exponents& x) {
  Vector residuals(entries.size()), change(entries.size());
  for (std::size_t k = 0; k < entries.size(); ++k) residuals[k] = -(entries[k].size + x.sum_at(entries[k]));
  Exponents gradient(x.m, x.n), direction(x.m, x.n);
  descend(entries, residuals, gradient);
  direction = gradient;
  double size = square(gradient.values);
  const std::size_t most_steps = 4 * x.values.size();
  for (std::size_t step = 0; step < most_steps && size > converged; ++step) {
    double curvature = 0.0;
    for (std::size_t k = 0; k < entries.size(); ++k) {
      change[k] = direction.sum_at(entries[k]);
      curvature += entries[k].weight * change[k] * change[k];
    }
    if (!(curvature > 0.0)) return;
    const double length = size / curvature;
    for (std::size_t i = 0; i < x.values.size(); ++i) x.values[i] += length * direction.values[i];
    for (std::size_t k = 0; k < entries.size(); ++k) residuals[k] -= length * change[k];
    descend(entries, residuals, gradient);
    const double next = square(gradient.values);
    for (std::size_t i = 0; i < x.values.size(); ++i)
      direction.values[i] = gradient.values[i] + next / size * direction.values[i];
    size = next;
  }
}

bool lies_below(const LogEntry& e, const Exponents& x, double bits) { return e.size + x.sum_at(e) < -bits; }

// Moves the suspects to the end; returns how many entries are none.
std::size_t separate_suspects(std::vector<LogEntry>& entries, const Exponents& mean_squares) {
  const auto is_conspicuous = [&](const LogEntry& e) { return lies_below(e, mean_squares, inconspicuous_bits); };
  if (std::none_of(entries.begin(), entries.end(), is_conspicuous)) return entries.size();
  // Least absolute values pass by outliers.
  Exponents x(mean_squares.m, mean_squares.n);
  for (int pass = 0; pass < reweightings; ++pass) {
    for (LogEntry& e : entries) e.weight = 1.0 / std::max(1.0, std::fabs(e.size + x.sum_at(e)));
    fit(entries, x);
  }
  for (LogEntry& e : entries) e.weight = 1.0;
  const auto first_suspect = std::stable_partition(
      entries.begin(), entries.end(), [&](const LogEntry& e) { return !lies_below(e, x, suspicious_bits); });
  return static_cast<std::size_t>(first_suspect - entries.begin());
}

std::vector<LogEntry> entries_of(const TaylorData& data) {
  std::vector<LogEntry> entries;
  for (bool is_E : {true, false}) {
    const ConstView matrix = is_E ? data.E(0) : data.A(0);
    // A holds tau times A.
    const double unit = is_E ? 0.0 : std::log2(data.time_scale);
    for (int j = 0; j < data.n; ++j)
      for (int i = 0; i < data.m; ++i)
        if (const double a = std::fabs(matrix(i, j)); a > 0.0)
          entries.push_back({index(i), index(j), is_E ? 1.0 : 0.0, std::log2(a) - unit, 1.0});
  }
  return entries;
}

double unit_of(double exponent) {
  return std::ldexp(1.0, static_cast<int>(std::lround(std::clamp(exponent, -largest_exponent, largest_exponent))));
}

}  // namespace

BalancedUnits balanced_units(CoefficientSource& source, double t) {
  source.set_units({});
  TaylorData data;
  const CallbackError error = source.evaluate(t, {0, 0, -1}, 1.0, data);
  if (error.status != SFDAE_OK) error.raise();
  std::vector<LogEntry> entries = entries_of(data);
  Exponents x(index(data.m), index(data.n));
  fit(entries, x);
  BalancedUnits units;
  const std::size_t count = separate_suspects(entries, x);
  if (count < entries.size()) {
    units.has_suspects = true;
    units.suspects_E.assign(index(data.m) * index(data.n), 0);
    units.suspects_A = units.suspects_E;
    for (std::size_t k = count; k < entries.size(); ++k) {
      const LogEntry& e = entries[k];
      (e.time > 0.0 ? units.suspects_E : units.suspects_A)[e.row + e.column * index(data.m)] = 1;
    }
    entries.resize(count);
    x = Exponents(x.m, x.n);
    fit(entries, x);
  }
  std::vector<double> unknowns;
  for (std::size_t j = 0; j < x.n; ++j) unknowns.push_back(unit_of(x.values[x.m + j]));
  units.unknowns = std::move(unknowns);
  units.time = unit_of(x.of_time());
  return units;
}

}  // namespace sfdae::core
