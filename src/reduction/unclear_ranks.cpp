// Messages about problems whose ranks are not clear.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/unclear_ranks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Exponents of ten that are tried. Below 1e-17 only data with exact zeros have values.
constexpr int exponents[] = {-100, -75, -60, -50, -40, -33, -30, -26, -22, -19, -17, -16, -15,
                             -14,  -13, -12, -11, -10, -9,  -8,  -7,  -6,  -5,  -4,  -3,  -2};

// Neighboring exponents with the same values.
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

// Result of the analysis at the point of the decision if rank_tol made it.
CharacteristicValues values_with(const SearchTask& task, const RankDecision& decision, double rank_tol) {
  AnalysisSettings settings = task.settings;
  settings.rank_tol = rank_tol;
  settings.max_index = std::min(settings.max_index, decision.level + 1);
  return local_values({task.problem, settings, task.arena}, decision.t);
}

// " With rank 3 (rank_tol = 1.0e-09) ...".
std::string result_with(int rank, double rank_tol, const CharacteristicValues& values, int max_index) {
  if (values.mu < 0) return format(" With rank %d no level up to %d fulfils the hypothesis.", rank, max_index);
  return format(" With rank %d (rank_tol = %.1e) the characteristic values are ", rank, rank_tol) + describe(values) +
         ".";
}

// Used if a rank makes no difference: the values that other tolerances give, the two of them with the widest ranges.
std::string other_results(const SearchTask& task, const RankDecision& decision) {
  const std::vector<Range> ranges = ranges_of(task, decision.t);
  const auto longer = [](const Range* a, const Range* b) { return b == nullptr || a->length() > b->length(); };
  const Range *first = nullptr, *second = nullptr;
  for (const Range& range : ranges)
    if (longer(&range, first)) first = &range;
  for (const Range& range : ranges)
    if (first != nullptr && !(range.values == first->values) && longer(&range, second)) second = &range;
  if (second == nullptr) return {};
  const auto tell = [](const Range& range) {
    return format(" With rank_tol = %.1e the characteristic values are ", range.tolerance()) +
           describe(range.values) + ".";
  };
  return first->tolerance() < second->tolerance() ? tell(*first) + tell(*second) : tell(*second) + tell(*first);
}

// In the level judged last: the first unclear decision, or the one with the smallest gap.
const RankDecision& doubtful_decision(const std::vector<RankDecision>& log) {
  auto first = log.end();
  while (first != log.begin() && std::prev(first)->level == log.back().level && std::prev(first)->t == log.back().t)
    --first;
  const auto unclear =
      std::find_if(first, log.end(), [](const RankDecision& d) { return d.verdict == Verdict::unclear; });
  if (unclear != log.end()) return *unclear;
  return *std::min_element(first, log.end(),
                           [](const RankDecision& a, const RankDecision& b) { return a.gap < b.gap; });
}

}  // namespace

std::string rank_tolerances(const SearchTask& task, double t, const CharacteristicValues& certain) {
  const std::vector<Range> ranges = ranges_of(task, t);
  // Tolerances between values of one group give mixtures: the widest ranges separate them.
  const Range* keeping = nullptr;
  const Range* dropping = nullptr;
  for (const Range& range : ranges) {
    const bool keeps = range.values == certain;
    const Range*& widest = keeps ? keeping : dropping;
    if (widest == nullptr || range.length() > widest->length()) widest = &range;
    // Only tolerances above those that keep a value drop it.
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

// rank_tol for either answer: the geometric mean of the value and the next smaller one (two digits if unknown) keeps
// it, three times the value drops it. Above one half nothing would be kept.
std::string neighbouring_ranks(const SearchTask& task) {
  if (task.log == nullptr || task.log->empty()) return {};
  const RankDecision& decision = doubtful_decision(*task.log);
  // The value in doubt is the smallest one kept, or, if that is clear or there is none, the largest one dropped.
  const bool doubts_kept = decision.rank > 0 && (decision.gap < clear_gap || decision.dropped <= decision.noise);
  const double value = std::max(doubts_kept ? decision.kept : decision.dropped, decision.noise);
  const double below = doubts_kept ? std::max({decision.dropped, decision.noise, 1e-300}) : 1e-2 * value;
  const double keep_tol = std::min(std::sqrt(value * below), 0.5);
  const double drop_tol = std::min(3.0 * value, 0.5);
  const int rank = doubts_kept ? decision.rank : decision.rank + 1;
  const int max_index = std::min(task.settings.max_index, decision.level + 1);
  const CharacteristicValues keeping = values_with(task, decision, keep_tol);
  const CharacteristicValues dropping = values_with(task, decision, drop_tol);
  constexpr const char* advice = " Set rank_tol, or scale the equations.";
  if (!(keeping == dropping))
    return result_with(rank, keep_tol, keeping, max_index) + result_with(rank - 1, drop_tol, dropping, max_index) +
           advice;
  std::string same = keeping.mu < 0 ? format(" No level up to %d fulfils the hypothesis", max_index)
                                    : " The characteristic values are " + describe(keeping);
  same += format(" with rank %d (rank_tol = %.1e) and with rank %d (%.1e).", rank, keep_tol, rank - 1, drop_tol);
  return same + other_results(task, decision) + advice;
}

}  // namespace sfdae::core
