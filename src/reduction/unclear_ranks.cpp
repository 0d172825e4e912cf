// What is said where the ranks of a problem are not clear.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/unclear_ranks.h"

#include <cmath>
#include <vector>

#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Exponents of ten that are tried. Below 1e-17 only data with exact zeros have values.
constexpr int exponents[] = {-100, -75, -60, -50, -40, -33, -30, -26, -22, -19, -17, -16, -15,
                             -14,  -13, -12, -11, -10, -9,  -8,  -7,  -6,  -5,  -4,  -3,  -2};

// Neighbouring exponents with the same values.
struct Range {
  CharacteristicValues values;
  std::vector<int> tried;
  // One that was tried.
  double tolerance() const { return std::pow(10.0, tried[tried.size() / 2]); }
  int length() const { return tried.back() - tried.front(); }
};

std::vector<Range> ranges_of(const SearchTask& task, double t) {
  std::vector<Range> ranges;
  AnalysisSettings settings = task.settings;
  SearchTask by_tolerance{task.problem, settings, task.arena, nullptr, task.units};
  by_tolerance.certified = task.units != nullptr;
  for (int exponent : exponents) {
    settings.rank_tol = std::pow(10.0, exponent);
    const CharacteristicValues values = local_values(by_tolerance, t);
    if (values.mu < 0) continue;
    if (!ranges.empty() && ranges.back().values == values) ranges.back().tried.push_back(exponent);
    else ranges.push_back({values, {exponent}});
  }
  return ranges;
}

}  // namespace

CharacteristicValues local_values(const SearchTask& task, double t) {
  try {
    IndexSearch upward(task, t);
    const SearchResult found = upward.search(task.settings.max_index);
    return found.is_clear ? found.values : CharacteristicValues{};
  } catch (const Failure& failure) {
    if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
    return {};
  }
}

std::string rank_tolerances(const SearchTask& task, double t, const CharacteristicValues& certain) {
  const std::vector<Range> ranges = ranges_of(task, t);
  // Tolerances between values that belong together give mixtures: the widest ranges separate them.
  const Range* keeping = nullptr;
  const Range* dropping = nullptr;
  for (const Range& range : ranges) {
    const bool keeps = range.values == certain;
    const Range*& widest = keeps ? keeping : dropping;
    if (widest == nullptr || range.length() > widest->length()) widest = &range;
    // What is dropped is so by larger tolerances.
    if (keeps && keeping == &range) dropping = nullptr;
  }
  const auto tell = [](const Range* range, const char* what) {
    return range == nullptr
               ? "no rank_tol " + std::string(what)
               : format("rank_tol = %.1e ", range->tolerance()) + what + " (" + describe(range->values) + ")";
  };
  if (certain.mu < 0 || keeping == nullptr) {
    std::string text;
    for (const Range& range : ranges) text += (text.empty() ? "" : ", ") + tell(&range, "gives the other result");
    return text.empty() ? "no rank_tol gives a result" : text;
  }
  return tell(keeping, "keeps it") + ", " + tell(dropping, "drops it");
}

}  // namespace sfdae::core
