// Units in which the entries of E x' = A x are near one.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/balanced_units.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

using Suspicion = BalancedUnits::Suspicion;

// One nonzero entry: what is to be made zero is size + r_row + c_column - time s.
struct LogEntry {
  std::size_t row, column;
  double time;  // 1 for E, 0 for A
  double size;  // log2
  double weight;
  Suspicion suspicion;  // by the usual units
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
constexpr double converged = 1e-3;
// Entries that lie this many bits below the others may be rounding errors: a thousand of them at most, so that values
// down to 1e-12 are left alone (docs/decisions/32-certificates.md).
constexpr double suspicious_bits = 41.0;
// And those below 1e-15 are.
constexpr double rounding_bits = 49.8;
// Units in use that are as good as balanced ones: within a factor of 2^6.
constexpr double alike_bits = 6.0;
// Mean squares follow outliers by what they determine of the units, (m + n) / entries of it on the average; small
// problems half of the way and more rarely less than a quarter. Entries above this are no outliers.
double inconspicuous_bits(std::size_t units, std::size_t entries) {
  const double followed = 2.0 * static_cast<double>(units) / static_cast<double>(std::max<std::size_t>(entries, 1));
  return suspicious_bits * std::max(0.25, 1.0 - followed);
}
// Well above what accidents make of entries of one size, well below what hides values: by judgement.
constexpr double even_ratio = 0x1p16;
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

// Conjugate gradients on the normal equations, from x on: directions that change nothing stay as they are. False if x
// was right.
bool fit(const std::vector<LogEntry>& entries, Exponents& x) {
  Vector residuals(entries.size()), change(entries.size());
  for (std::size_t k = 0; k < entries.size(); ++k) residuals[k] = -(entries[k].size + x.sum_at(entries[k]));
  Exponents gradient(x.m, x.n), direction(x.m, x.n);
  descend(entries, residuals, gradient);
  direction = gradient;
  double size = square(gradient.values);
  if (!(size > converged)) return false;
  const std::size_t most_steps = 4 * x.values.size();
  for (std::size_t step = 0; step < most_steps && size > converged; ++step) {
    double curvature = 0.0;
    for (std::size_t k = 0; k < entries.size(); ++k) {
      change[k] = direction.sum_at(entries[k]);
      curvature += entries[k].weight * change[k] * change[k];
    }
    if (!(curvature > 0.0)) return step > 0;
    const double length = size / curvature;
    for (std::size_t i = 0; i < x.values.size(); ++i) x.values[i] += length * direction.values[i];
    for (std::size_t k = 0; k < entries.size(); ++k) residuals[k] -= length * change[k];
    descend(entries, residuals, gradient);
    const double next = square(gradient.values);
    for (std::size_t i = 0; i < x.values.size(); ++i)
      direction.values[i] = gradient.values[i] + next / size * direction.values[i];
    size = next;
  }
  return true;
}

bool lies_below(const LogEntry& e, const Exponents& x, double bits) { return e.size + x.sum_at(e) < -bits; }

// Takes the suspects out of the entries. Least absolute values pass by outliers.
std::vector<LogEntry> take_suspects(std::vector<LogEntry>& entries, Exponents x) {
  for (int pass = 0; pass < reweightings; ++pass) {
    for (LogEntry& e : entries) e.weight = 1.0 / std::max(1.0, std::fabs(e.size + x.sum_at(e)));
    if (!fit(entries, x)) break;  // all that follows would be the same
  }
  for (LogEntry& e : entries) e.weight = 1.0;
  const auto is_suspect = [&](const LogEntry& e) {
    return e.suspicion != Suspicion::none || lies_below(e, x, suspicious_bits);
  };
  const auto first = std::stable_partition(entries.begin(), entries.end(), std::not_fn(is_suspect));
  std::vector<LogEntry> suspects(first, entries.end());
  entries.erase(first, entries.end());
  return suspects;
}

// x: fits all the others.
void mark(const std::vector<LogEntry>& suspects, const Exponents& x, BalancedUnits& units) {
  units.suspects_E.assign(x.m * x.n, Suspicion::none);
  units.suspects_A = units.suspects_E;
  for (const LogEntry& e : suspects) {
    const bool is_rounding = e.suspicion == Suspicion::certain || lies_below(e, x, rounding_bits);
    units.has_suspects = units.has_suspects || !is_rounding;
    (e.time > 0.0 ? units.suspects_E : units.suspects_A)[e.row + e.column * x.m] =
        is_rounding ? Suspicion::certain : Suspicion::maybe;
  }
}

// The largest entries of rows and columns of [E tau A].
struct Largest {
  Vector of_row, of_column;
  explicit Largest(const TaylorData& data) : of_row(index(data.m), 0.0), of_column(index(data.n), 0.0) {
    for (ConstView matrix : {data.E(0), data.A(0)})
      for (int j = 0; j < data.n; ++j)
        for (int i = 0; i < data.m; ++i) {
          const double size = std::fabs(matrix(i, j));
          of_row[index(i)] = std::max(of_row[index(i)], size);
          of_column[index(j)] = std::max(of_column[index(j)], size);
        }
  }
  // What is small against only one of them has another unit.
  Suspicion suspicion_of(double size, int i, int j) const {
    const double limit = std::min(of_row[index(i)], of_column[index(j)]);
    return size < std::exp2(-rounding_bits) * limit     ? Suspicion::certain
           : size < std::exp2(-suspicious_bits) * limit ? Suspicion::maybe
                                                        : Suspicion::none;
  }
};

// data: in the usual units; the entries are those in units of one.
std::vector<LogEntry> entries_of(const TaylorData& data, const Units& usual) {
  const Largest largest(data);
  std::vector<LogEntry> entries;
  entries.reserve(2 * index(data.m) * index(data.n));
  for (bool is_E : {true, false}) {
    const ConstView matrix = is_E ? data.E(0) : data.A(0);
    // A holds tau times A.
    const double unit_of_time = is_E ? 0.0 : std::log2(data.time_scale);
    for (int j = 0; j < data.n; ++j) {
      const double unit = unit_of_time + std::log2(usual[j]);
      for (int i = 0; i < data.m; ++i)
        if (const double a = std::fabs(matrix(i, j)); a > 0.0)
          entries.push_back(
              {index(i), index(j), is_E ? 1.0 : 0.0, std::log2(a) - unit, 1.0, largest.suspicion_of(a, i, j)});
    }
  }
  return entries;
}

double unit_of(double exponent) {
  return std::ldexp(1.0, static_cast<int>(std::lround(std::clamp(exponent, -largest_exponent, largest_exponent))));
}

Units units_of(const Exponents& x) {
  std::vector<double> unknowns;
  for (std::size_t j = 0; j < x.n; ++j) unknowns.push_back(unit_of(x.values[x.m + j]));
  return unknowns;
}

// Which units the entries tie together: r_i + c_j = time s for each, that is differences of r_i and -c_j in trees.
class Ties {
 public:
  Ties(std::size_t m, std::size_t n) : m_(m), parent_(m + n), offset_(m + n, 0.0) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  void add(const LogEntry& e) {
    const auto [row, of_row] = root(e.row);
    const auto [column, of_column] = root(m_ + e.column);
    const double difference = e.time - of_row + of_column;
    if (row != column) {
      parent_[row] = column;
      offset_[row] = difference;
    } else if (difference != 0.0) {
      fixes_time_ = true;
    }
  }
  // Whether the size of an entry follows from those that were added.
  bool determine(const LogEntry& e) const {
    const auto [row, of_row] = root(e.row);
    const auto [column, of_column] = root(m_ + e.column);
    return row == column && (fixes_time_ || of_row - of_column == e.time);
  }

 private:
  // With the multiple of s that lies between.
  std::pair<std::size_t, double> root(std::size_t node) const {
    double offset = 0.0;
    for (; parent_[node] != node; node = parent_[node]) offset += offset_[node];
    return {node, offset};
  }

  std::size_t m_;
  std::vector<std::size_t> parent_;
  std::vector<double> offset_;
  bool fixes_time_ = false;
};

// Whether the usual units say something about small entries: they are as good as balanced ones for all others, which
// determine what size these ought to have.
bool are_balanced_without_suspects(const std::vector<LogEntry>& all, const Units& usual, const TaylorData& data) {
  const auto is_usual = [](const LogEntry& e) { return e.suspicion == Suspicion::none; };
  if (std::all_of(all.begin(), all.end(), is_usual)) return true;
  std::vector<LogEntry> entries = all;
  const auto first = std::stable_partition(entries.begin(), entries.end(), is_usual);
  Ties ties(index(data.m), index(data.n));
  std::for_each(entries.begin(), first, [&](const LogEntry& e) { ties.add(e); });
  if (!std::all_of(first, entries.end(), [&](const LogEntry& e) { return ties.determine(e); })) return false;
  entries.erase(first, entries.end());
  Exponents x(index(data.m), index(data.n));
  fit(entries, x);
  BalancedUnits units;
  units.unknowns = units_of(x);
  units.time = unit_of(x.of_time());
  return are_balanced(usual, data.time_scale, units);
}

}  // namespace

bool has_even_entries(const TaylorData& data) {
  double smallest = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (ConstView matrix : {data.E(0), data.A(0)})
    for (int j = 0; j < data.n; ++j)
      for (int i = 0; i < data.m; ++i) {
        const double size = std::fabs(matrix(i, j));
        largest = std::max(largest, size);
        if (size > 0.0) smallest = std::min(smallest, size);
      }
  return largest <= even_ratio * smallest;
}

bool are_balanced(const Units& used, double time, const BalancedUnits& balanced) {
  if (std::fabs(std::log2(time / balanced.time)) > alike_bits) return false;
  double smallest = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (std::size_t j = 0; j < balanced.unknowns.values().size(); ++j) {
    const double ratio = balanced.unknowns[j] / used[j];
    smallest = std::min(smallest, ratio);
    largest = std::max(largest, ratio);
  }
  return std::log2(largest / smallest) <= alike_bits;
}

BalancedUnits balanced_units(const TaylorData& data, const Units& usual) {
  std::vector<LogEntry> entries = entries_of(data, usual);
  if (!are_balanced_without_suspects(entries, usual, data))
    for (LogEntry& e : entries) e.suspicion = Suspicion::none;
  Exponents x(index(data.m), index(data.n));
  fit(entries, x);
  BalancedUnits units;
  const double inconspicuous = inconspicuous_bits(x.m + x.n, entries.size());
  const auto is_conspicuous = [&](const LogEntry& e) {
    return e.suspicion != Suspicion::none || lies_below(e, x, inconspicuous);
  };
  if (std::any_of(entries.begin(), entries.end(), is_conspicuous)) {
    const std::vector<LogEntry> suspects = take_suspects(entries, Exponents(x.m, x.n));
    if (!suspects.empty()) {
      x = Exponents(x.m, x.n);
      fit(entries, x);
      mark(suspects, x, units);
    }
  }
  units.unknowns = units_of(x);
  units.time = unit_of(x.of_time());
  return units;
}

}  // namespace sfdae::core
