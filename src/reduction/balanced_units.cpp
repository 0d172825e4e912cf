// Units in which the entries of E x' = A x are near one.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/balanced_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "linalg/index.h"
#include "linalg/unit_fit.h"

namespace sfdae::core {

namespace {

using Suspicion = BalancedUnits::Suspicion;

using Vector = std::vector<double>;

// Units from 2^-300 to 2^300: products of three of them are finite.
constexpr double largest_exponent = 300.0;
// Entries that lie this many bits below the others may be rounding errors: a thousand of them at most, so that values
// down to 1e-12 are not affected (docs/design/scaling_and_units.md).
constexpr double suspicious_bits = 41.0;
// Entries below 1e-15 are rounding errors.
constexpr double rounding_bits = 49.8;
// Tolerance for the units in use compared with balanced ones: within a factor of 2^6.
constexpr double alike_bits = 6.0;
// Least squares follow outliers by their influence on the units, (m + n) / entries on average; small problems half of
// the way and more rarely less than a quarter. Entries above this are no outliers.
double inconspicuous_bits(std::size_t units, std::size_t entries) {
  const double followed = 2.0 * static_cast<double>(units) / static_cast<double>(std::max<std::size_t>(entries, 1));
  return suspicious_bits * std::max(0.25, 1.0 - followed);
}
// Well above chance ratios of entries of one size, well below ratios that hide values: by judgment.
constexpr double even_ratio = 0x1p16;

// The entries of E and A, and their suspicion in the usual units.
struct Entries {
  EntrySizes sizes;
  std::array<std::vector<Suspicion>, 2> suspicions;  // of E, A
  Suspicion& suspicion(std::size_t b, int i, int j) { return suspicions[b][index(i) + index(j) * index(sizes.m)]; }
  Suspicion suspicion(std::size_t b, int i, int j) const {
    return suspicions[b][index(i) + index(j) * index(sizes.m)];
  }
};

// block: E (0) or A (1).
struct EntryPlace {
  std::size_t block;
  int row, column;
};
using Suspects = std::vector<EntryPlace>;

template <class Of>
bool any_entry(const EntrySizes& sizes, Of of) {
  for (std::size_t b = 0; b < 2; ++b)
    for (int j = 0; j < sizes.n; ++j)
      for (int i = 0; i < sizes.m; ++i)
        if (sizes.blocks[b].counts(i, j) > 0.0 && of(b, i, j)) return true;
  return false;
}

template <class Do>
void for_entries(const EntrySizes& sizes, Do action) {
  any_entry(sizes, [&](std::size_t b, int i, int j) {
    action(b, i, j);
    return false;
  });
}

// Tests if entries lie a number of bits below the size suggested by the exponents.
class Deviations {
 public:
  Deviations(const EntrySizes& sizes, const UnitExponents& x) : sizes_(sizes), x_(x) {}
  bool lies_below(std::size_t b, int i, int j, double bits) const {
    const EntrySizes::Block& block = sizes_.blocks[b];
    return block.bits(i, j) + x_.sum_at(block, i, j) < -bits;
  }

 private:
  const EntrySizes& sizes_;
  const UnitExponents& x_;
};

// Removes the suspects from the entries that count.
Suspects take_suspects(Entries& entries) {
  EntrySizes& sizes = entries.sizes;
  UnitExponents x(sizes.m, sizes.n);
  fit_absolute_values(sizes, x);
  const Deviations deviations(sizes, x);
  Suspects suspects;
  for_entries(sizes, [&](std::size_t b, int i, int j) {
    if (entries.suspicion(b, i, j) == Suspicion::none && !deviations.lies_below(b, i, j, suspicious_bits)) return;
    suspects.push_back({b, i, j});
  });
  for (const auto& [b, i, j] : suspects) sizes.blocks[b].counts(i, j) = 0.0;
  return suspects;
}

// x: fitted to all other entries.
void mark(const Entries& entries, const Suspects& suspects, const UnitExponents& x, BalancedUnits& units) {
  const EntrySizes& sizes = entries.sizes;
  units.suspects_E.assign(index(sizes.m) * index(sizes.n), Suspicion::none);
  units.suspects_A = units.suspects_E;
  const Deviations deviations(sizes, x);
  for (const auto& [b, i, j] : suspects) {
    const bool is_rounding =
        entries.suspicion(b, i, j) == Suspicion::certain || deviations.lies_below(b, i, j, rounding_bits);
    units.has_suspects = units.has_suspects || !is_rounding;
    (b == 0 ? units.suspects_E : units.suspects_A)[index(i) + index(j) * index(sizes.m)] =
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
  // An entry that is small compared with only one of them has another unit.
  Suspicion suspicion_of(double size, int i, int j) const {
    const double limit = std::min(of_row[index(i)], of_column[index(j)]);
    return size < std::exp2(-rounding_bits) * limit     ? Suspicion::certain
           : size < std::exp2(-suspicious_bits) * limit ? Suspicion::maybe
                                                        : Suspicion::none;
  }
};

// data: in the usual units; the entries are those in units of one.
Entries entries_of(const TaylorData& data, const Units& usual) {
  const Largest largest(data);
  Entries entries{EntrySizes(data.m, data.n), {}};
  for (std::size_t b = 0; b < 2; ++b) {
    EntrySizes::Block& block = entries.sizes.blocks[b];
    const ConstView matrix = b == 0 ? data.E(0) : data.A(0);
    entries.suspicions[b].assign(index(data.m) * index(data.n), Suspicion::none);
    // A holds tau times A.
    const double unit_of_time = b == 0 ? 0.0 : std::log2(data.time_scale);
    for (int j = 0; j < data.n; ++j) {
      const double unit = unit_of_time + std::log2(usual[j]);
      for (int i = 0; i < data.m; ++i) {
        const double a = std::fabs(matrix(i, j));
        if (!(a > 0.0)) continue;
        block.bits(i, j) = std::log2(a) - unit;
        block.counts(i, j) = 1.0;
        entries.suspicion(b, i, j) = largest.suspicion_of(a, i, j);
      }
    }
  }
  return entries;
}

double unit_of(double exponent) {
  return std::ldexp(1.0, static_cast<int>(std::lround(std::clamp(exponent, -largest_exponent, largest_exponent))));
}

Units units_of(const UnitExponents& x) {
  std::vector<double> unknowns;
  for (double exponent : x.unknowns) unknowns.push_back(unit_of(exponent));
  return unknowns;
}

// Relations of units given by the entries: r_i + c_j = time s for each, that is differences of r_i and -c_j in trees.
class Ties {
 public:
  Ties(int m, int n) : m_(index(m)), trees_(m + n), parent_(index(m + n)), offset_(index(m + n), 0.0) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  void add(double time, int i, int j) {
    if (are_complete()) return;
    const auto [row, of_row] = root(index(i));
    const auto [column, of_column] = root(m_ + index(j));
    const double difference = time - of_row + of_column;
    if (row != column) {
      parent_[row] = column;
      offset_[row] = difference;
      --trees_;
    } else if (difference != 0.0) {
      fixes_time_ = true;
    }
  }
  // True if the size of an entry follows from the entries added.
  bool determine(double time, int i, int j) {
    if (are_complete()) return true;
    const auto [row, of_row] = root(index(i));
    const auto [column, of_column] = root(m_ + index(j));
    return row == column && (fixes_time_ || of_row - of_column == time);
  }

 private:
  // Root of a tree and the offset to it, a multiple of s. All nodes of the path are attached to the root: it would grow
  // with every column otherwise.
  // column else.
  std::pair<std::size_t, double> root(std::size_t node) {
    double offset = 0.0;
    std::size_t top = node;
    for (; parent_[top] != top; top = parent_[top]) offset += offset_[top];
    for (double left = offset; node != top;) {
      const std::size_t next = parent_[node];
      const double part = offset_[node];
      parent_[node] = top;
      offset_[node] = left;
      left -= part;
      node = next;
    }
    return {top, offset};
  }

  // They determine the size of every entry.
  bool are_complete() const { return fixes_time_ && trees_ == 1; }

  std::size_t m_;
  int trees_;
  std::vector<std::size_t> parent_;
  std::vector<double> offset_;
  bool fixes_time_ = false;
};

// True if the usual units can judge small entries: they are as good as balanced ones for all others, which determine
// the expected size of the small ones.
bool are_balanced_without_suspects(const Entries& all, const Units& usual, const TaylorData& data) {
  const auto is_suspect = [&](std::size_t b, int i, int j) { return all.suspicion(b, i, j) != Suspicion::none; };
  if (!any_entry(all.sizes, is_suspect)) return true;
  EntrySizes others = all.sizes;
  Ties ties(data.m, data.n);
  for_entries(all.sizes, [&](std::size_t b, int i, int j) {
    if (is_suspect(b, i, j)) others.blocks[b].counts(i, j) = 0.0;
    else ties.add(others.blocks[b].time, i, j);
  });
  if (any_entry(all.sizes, [&](std::size_t b, int i, int j) {
        return is_suspect(b, i, j) && !ties.determine(others.blocks[b].time, i, j);
      }))
    return false;
  UnitExponents x(data.m, data.n);
  fit_squares(others, x);
  BalancedUnits units;
  units.unknowns = units_of(x);
  units.time = unit_of(x.time);
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
  Entries entries = entries_of(data, usual);
  const EntrySizes& sizes = entries.sizes;
  if (!are_balanced_without_suspects(entries, usual, data))
    for (std::vector<Suspicion>& all : entries.suspicions) std::fill(all.begin(), all.end(), Suspicion::none);
  UnitExponents x(sizes.m, sizes.n);
  fit_squares(sizes, x);
  BalancedUnits units;
  const double inconspicuous = inconspicuous_bits(index(sizes.m) + index(sizes.n), sizes.count());
  const Deviations deviations(sizes, x);
  if (any_entry(sizes, [&](std::size_t b, int i, int j) {
        return entries.suspicion(b, i, j) != Suspicion::none || deviations.lies_below(b, i, j, inconspicuous);
      })) {
    const Suspects suspects = take_suspects(entries);
    if (!suspects.empty()) {
      x = UnitExponents(sizes.m, sizes.n);
      fit_squares(sizes, x);
      mark(entries, suspects, x, units);
    }
  }
  units.unknowns = units_of(x);
  units.time = unit_of(x.time);
  return units;
}

}  // namespace sfdae::core
