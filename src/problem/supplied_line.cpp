// Comparison of a function and its supplied derivative along a line through a point.
//
// Numbers in this file: docs/design/finite_differences.md.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/supplied_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Rounding errors of values, and of arguments such as omega t, in units of the last place.
constexpr double roundings = 16.0;
// Larger values are left out, as their differences may overflow. So are lines that are too short for the smallest
// scale.
constexpr double largest_value = 1e150, shortest_reach = 1e-100;

// Fractions of the reach, none of them simple, as that may be the one of a period.
constexpr std::array<double, 3> quick_scales{1.1e-3, 3.7e-6, 1.3e-8};
// A derivative is resolved if it changes by less than this between the points, relative to its size.
constexpr double visible = 0.02;

// Offsets are at least so many rounding errors of the origin.
constexpr double least_ulps = 100.0;

constexpr double widest_scale = 0.053, scale_ratio = 7.3;
constexpr int scales = 15;  // down to 4e-14 of the reach
// The point itself is excluded, as functions may jump there.
constexpr std::array<double, 6> positions{0.08, 0.21, 0.39, 0.62, 0.81, 1.0};
// A contradiction exceeds its uncertainty by this factor; an agreement that refutes it is more certain by these.
constexpr double beyond_doubt = 10.0, acquitting_gap = 0.5, acquitting_bound = 0.25;
// Smaller scales on which a contradiction may go unseen.
constexpr int unexplained_scales = 2;
// Contradictions on different scales count as the same within this fraction.
constexpr double same = 0.2;
// Errors of a derivative that passes through zero, relative to the largest derivative nearby.
constexpr double negligible = 1e-4;

// Comparisons that are quiet for NaN.
bool usable(double value) { return std::isless(std::fabs(value), largest_value); }

bool usable(const SuppliedLine& line, const std::vector<double>& values, int entry) {
  return usable(values[index(entry)]) && usable(values[index(entry + line.shift)]);
}

// The offset that the function sees, 0 if roundoff dominates it.
double seen_offset(const SuppliedLine& line, double offset) { return (line.origin + offset) - line.origin; }

bool evaluate(const SuppliedLine& line, double offset, std::vector<double>& values) {
  const CallbackError error = line.evaluate(offset, values.data());
  if (error.status == SFDAE_CALLBACK_STOPPED || error.status == SFDAE_STOPPED) error.raise();
  return error.status == SFDAE_OK;
}

// unseen: it changes too much between the points; little: it fits, but so would many others, because of rounding
// errors, or of a size that is negligible within the reach.
enum class Evidence { confirms, unseen, little, against };

// Rounding errors of values of an entry with values and derivatives of this size.
double rounding_of(const SuppliedLine& line, int entry, double value, double slope) {
  const double size = line.terms.empty() ? value : std::max(value, line.terms[index(entry)]);
  return roundings * unit_roundoff * (size + std::fabs(line.origin) * slope);
}

// values: at the end of an interval h from the base.
Evidence judge(const SuppliedLine& line, int entry, double h, const std::vector<double>& values) {
  struct {
    double F0, Fh, S0, Sh;
  } const at{line.base[index(entry)], values[index(entry)], line.base[index(entry + line.shift)],
             values[index(entry + line.shift)]};
  const double change = at.Fh - at.F0, first = at.S0 * h, last = at.Sh * h;
  if (change == 0.0 && first == 0.0 && last == 0.0) return Evidence::confirms;
  const double low = std::min(first, last), high = std::max(first, last), spread = high - low;
  const double value = std::max(std::fabs(at.F0), std::fabs(at.Fh));
  const double slope = std::max(std::fabs(at.S0), std::fabs(at.Sh));
  const double noise = rounding_of(line, entry, value, slope);
  if (std::max(low - change, change - high) > spread + noise) return Evidence::against;
  // The trapezoidal rule is sharper than the mean value theorem where the derivative passes through zero.
  const double missed = std::fabs(change - 0.5 * (first + last)),
               largest = std::max(std::fabs(first), std::fabs(last));
  if (missed + noise <= visible * largest) return Evidence::confirms;
  const double own_size = std::max(std::fabs(change), slope * std::fabs(h));
  const double size = std::max(own_size, value * std::fabs(h / line.reach));
  if (spread > std::max(visible * size, noise)) return Evidence::unseen;
  return spread + noise > visible * own_size ? Evidence::little : Evidence::confirms;
}

// Margins of entries first, ..., first + count - 1: nonnegative if judge() would confirm the entry for the most
// frequent reason. One loop without branches; all numbers are usable, and no terms are given.
void find_margins(const SuppliedLine& line, int first, int count, double h, const std::vector<double>& values,
                  double* margins) {
  const double *F0 = line.base.data() + first, *Fh = values.data() + first;
  const double *S0 = F0 + line.shift, *Sh = Fh + line.shift;
  const double unit = roundings * unit_roundoff, origin = std::fabs(line.origin);
  for (int e = 0; e < count; ++e) {
    const double change = Fh[e] - F0[e], at_first = S0[e] * h, at_last = Sh[e] * h;
    const double low = std::min(at_first, at_last), high = std::max(at_first, at_last);
    const double value = std::max(std::fabs(F0[e]), std::fabs(Fh[e]));
    const double slope = std::max(std::fabs(S0[e]), std::fabs(Sh[e]));
    const double noise = unit * (value + origin * slope);
    const double beyond = std::max(low - change, change - high);
    const double missed = std::fabs(change - 0.5 * (at_first + at_last));
    const double largest = std::max(std::fabs(at_first), std::fabs(at_last));
    margins[e] = std::min(high - low + noise - beyond, visible * largest - (missed + noise));
  }
}

bool are_usable(const double* values, int count) {
  return all_finite(values, index(count)) && max_abs(values, count) < largest_value;
}

bool are_usable(const SuppliedLine& line, const std::vector<double>& values, int first, int count) {
  return are_usable(values.data() + first, count) && are_usable(values.data() + first + line.shift, count);
}

// Entries that the first test does not confirm.
std::vector<int> doubtful_entries(const SuppliedLine& line, double h, const std::vector<double>& values) {
  constexpr int block = 512;
  std::array<double, block> margins;
  std::vector<int> doubtful;
  for (int first = 0; first < line.count; first += block) {
    const int count = std::min(block, line.count - first);
    const bool is_plain =
        line.terms.empty() && are_usable(line, line.base, first, count) && are_usable(line, values, first, count);
    if (is_plain) find_margins(line, first, count, h, values, margins.data());
    else margins.fill(-1.0);
    for (int e = 0; e < count; ++e)
      if (margins[index(e)] < 0.0) doubtful.push_back(first + e);
  }
  return doubtful;
}

// Result of the points of one scale for one entry: slopes, and their uncertainty.
struct Finding {
  double h, quotient, supplied, rounding;
  double own_bound, bound;  // from this scale alone, and with what larger ones have shown
  double residual;          // of the function, absolute
  double gap() const { return std::fabs(quotient - supplied); }
};

// The line of least squares through the points, relative to the first one.
using Samples = std::array<double, positions.size()>;

// coarse: the residual on larger scales. A value that is rounded coarsely, to single precision for example, is constant
// on small scales, and shows its steps on larger ones only.
struct Noise {
  const SuppliedLine& line;
  int entry;
  double coarse;
};

Finding fit(const Samples& F, const Samples& S, double h, const Noise& given) {
  constexpr double count = static_cast<double>(positions.size());
  double mean_p = 0.0, mean_F = 0.0, mean_S = 0.0, size_F = 0.0, size_S = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    mean_p += positions[i] / count;
    mean_F += (F[i] - F[0]) / count;
    mean_S += S[i] / count;
    size_F = std::max(size_F, std::fabs(F[i]));
    size_S = std::max(size_S, std::fabs(S[i]));
  }
  double product = 0.0, square = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    product += (positions[i] - mean_p) * (F[i] - F[0]);
    square += (positions[i] - mean_p) * (positions[i] - mean_p);
  }
  const double change = product / square;
  double residual = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    residual = std::max(residual, std::fabs(F[i] - F[0] - mean_F - change * (positions[i] - mean_p)));
    spread = std::max(spread, std::fabs(S[i] - mean_S));
  }
  const double noise = rounding_of(given.line, given.entry, size_F, size_S);
  const double own = 2.0 * spread + (2.0 * residual + noise) / std::fabs(h);
  return {h,       change / h,
          mean_S,  noise / std::fabs(h),
          own,     own + 2.0 * std::max(given.coarse - residual, 0.0) / std::fabs(h),
          residual};
}

// Results of all scales for one entry.
struct ComparedEntry {
  std::vector<Finding> findings;
  double largest_slope = 0.0;
  double residual = 0.0;  // of the last scale that had one
};

bool contradicts(const Finding& f, const ComparedEntry& record, double least_gap) {
  return f.gap() > beyond_doubt * f.bound && f.gap() > negligible * record.largest_slope &&
         f.gap() > least_gap * std::max(std::fabs(f.quotient), std::fabs(f.supplied));
}

bool is_the_same(const Finding& a, const Finding& b) {
  const double gap = std::min(a.gap(), b.gap());
  return std::fabs(a.quotient - b.quotient) <= same * gap && std::fabs(a.supplied - b.supplied) <= same * gap;
}

// Function and derivative agree, to much less than a gap. On larger scales than those of the gap both may have
// vanished, so only values of the size of the gap count there.
bool agrees(const Finding& f, double gap, double scale_of_gap) {
  if (f.gap() > acquitting_gap * gap || f.own_bound > acquitting_bound * gap) return false;
  const double size = std::max(std::fabs(f.quotient), std::fabs(f.supplied));
  return std::fabs(f.h) < scale_of_gap || size >= acquitting_gap * gap;
}

// The contradiction on the smallest scale that a much larger one repeats; null if there is none, or doubt remains.
const Finding* verdict(const ComparedEntry& record, double least_gap) {
  constexpr double apart = 0.9 * scale_ratio * scale_ratio;
  const Finding* found = nullptr;
  double gap = 0.0;
  for (const Finding& small : record.findings) {
    if (!contradicts(small, record, least_gap)) continue;
    if (gap == 0.0 || small.gap() < gap) gap = small.gap();
    for (const Finding& large : record.findings)
      if (contradicts(large, record, least_gap) && std::fabs(large.h) >= apart * std::fabs(small.h) &&
          is_the_same(small, large))
        found = &small;
  }
  if (found == nullptr) return nullptr;
  // Starts at the largest scale. A contradiction has to persist on the smallest scales that rounding errors allow, else
  // it has another cause.
  int smaller = 0;
  for (const Finding& f : record.findings)
    if (std::fabs(f.h) < std::fabs(found->h) && beyond_doubt * f.rounding < acquitting_gap * gap) ++smaller;
  if (smaller > unexplained_scales) return nullptr;
  for (const Finding& f : record.findings)
    if (agrees(f, gap, std::fabs(found->h))) return nullptr;
  return found;
}

// Adds the samples of one scale to the records of the entries; nothing if a point cannot be evaluated.
void add_scale(const SuppliedLine& line, double offset, const std::vector<int>& entries,
               std::vector<ComparedEntry>& records) {
  std::vector<double> values(line.base.size());
  std::vector<Samples> F(entries.size()), S(entries.size());
  std::vector<char> is_usable(entries.size(), 1);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!evaluate(line, seen_offset(line, positions[i] * offset), values)) return;
    for (std::size_t e = 0; e < entries.size(); ++e) {
      if (!usable(line, values, entries[e])) is_usable[e] = 0;
      F[e][i] = values[index(entries[e])];
      S[e][i] = values[index(entries[e] + line.shift)];
    }
  }
  for (std::size_t e = 0; e < entries.size(); ++e) {
    if (is_usable[e] == 0) continue;
    ComparedEntry& record = records[e];
    record.findings.push_back(fit(F[e], S[e], offset, {line, entries[e], record.residual}));
    if (record.findings.back().residual > 0.0) record.residual = record.findings.back().residual;
    for (const double slope : S[e]) record.largest_slope = std::max(record.largest_slope, std::fabs(slope));
  }
}

bool is_usable(const SuppliedLine& line) {
  return std::fabs(line.reach) > shortest_reach && std::fabs(line.reach) < largest_value;
}

}  // namespace

std::vector<int> unconfirmed_entries(const SuppliedLine& line) {
  // Entries are open until confirmed; suspects have had evidence against them.
  std::vector<int> open, suspects;
  if (!is_usable(line)) return suspects;
  std::vector<char> is_suspect(index(line.count), 0);
  bool is_first = true;
  std::vector<double> values(line.base.size());
  for (const double scale : quick_scales) {
    const double h = seen_offset(line, scale * line.reach);
    if (h == 0.0 || (!is_first && open.empty())) break;
    if (!evaluate(line, h, values)) continue;
    std::vector<int> left;
    for (const int e : is_first ? doubtful_entries(line, h, values) : std::exchange(open, {})) {
      if (!usable(line, line.base, e)) continue;
      if (!usable(line, values, e)) {
        left.push_back(e);
        continue;
      }
      const Evidence evidence = judge(line, e, h, values);
      if (evidence == Evidence::against) is_suspect[index(e)] = 1;
      const bool is_done =
          evidence == Evidence::confirms || (evidence == Evidence::little && is_suspect[index(e)] == 0);
      if (!is_done) left.push_back(e);
    }
    open = std::move(left);
    is_first = false;
  }
  for (const int e : open)
    if (is_suspect[index(e)] != 0) suspects.push_back(e);
  return suspects;
}

std::vector<LineContradiction> contradictions(const SuppliedLine& line, const std::vector<int>& entries,
                                              double least_gap) {
  std::vector<LineContradiction> result;
  if (entries.empty() || !is_usable(line)) return result;
  std::vector<ComparedEntry> records(entries.size());
  double offset = widest_scale * line.reach;
  for (int attempt = 0; attempt < scales; ++attempt, offset /= scale_ratio)
    if (std::fabs(offset) > least_ulps * unit_roundoff * std::fabs(line.origin))
      add_scale(line, offset, entries, records);
  for (std::size_t e = 0; e < entries.size(); ++e)
    if (const Finding* found = verdict(records[e], least_gap))
      result.push_back({entries[e], found->supplied, found->quotient, found->gap() / std::max(found->bound, 1e-300),
                        found->bound});
  return result;
}

WrongDerivative::WrongDerivative(const DerivativeMismatch& wrong, double t, const EquationNames& names)
    : Failure(SFDAE_WRONG_DERIVATIVES,
              format("%s contradicts differences in %s, column %d at t = %.15g: %.10g supplied, %.10g by "
                     "differences. Is it the derivative of the order asked for? The functions sfdae_check_..."
                     "derivatives look closer; the option check_derivatives = 0 goes on as it is.",
                     name_of(wrong).c_str(), names.row(wrong.row).c_str(), wrong.column, t, wrong.supplied,
                     wrong.difference)),
      mismatch_(wrong) {}

}  // namespace sfdae::core
