// SPDX-License-Identifier: BSD-3-Clause
#include "tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace campaign {

namespace {

constexpr double named_of_all = 0.02, named_of_law = 0.05, without_reference = 0.01;
constexpr std::array<const char*, 3> method_names = {"BDF", "Radau", "automatic"};
constexpr std::array<const char*, num_additions> addition_names = {"none", "y = x", "y = x, z = y'",
                                                                   "y = x, z = y', w = z'", "path"};

template <class Names>
std::string name(const Names& names, int index) {
  return names[static_cast<std::size_t>(index)];
}

// Small samples: the mean and three standard deviations.
bool is_within(int count, double share, int total) {
  const double expected = share * total;
  return count <= expected + (total < 2000 ? 3.0 * std::sqrt(expected) : 0.0);
}

}  // namespace

void Count::add(const RunResult& result) {
  ++runs;
  if (result.verdict == Verdict::no_reference) ++no_reference;
  if (result.verdict == Verdict::named) ++named;
  if (result.verdict == Verdict::right) ++right;
  if (result.verdict == Verdict::wrong) ++wrong;
  if (result.verdict == Verdict::right || result.verdict == Verdict::wrong)
    worst_error = std::max(worst_error, result.error);
}

void Tables::add_to(const std::string& table, const std::string& row, const RunResult& result) {
  tables_[table][row].add(result);
}

void Tables::add(int number, const Case& problem, const Variant& variant, const RunResult& result) {
  const std::string law = name(law_names, static_cast<int>(problem.law.law));
  const std::string family = name(family_names, static_cast<int>(problem.family));
  const std::string gain = name(gain_names, static_cast<int>(problem.gain));
  const std::string method = name(method_names, variant.method);
  all_.add(result);
  seconds_ += result.seconds;
  add_to("law, family", law + ", " + family, result);
  add_to("law", law, result);
  add_to("family", family, result);
  add_to("gain", gain, result);
  add_to("addition", problem.on_line ? "line" : name(addition_names, static_cast<int>(problem.addition)), result);
  add_to("method", method, result);
  add_to("formulation", name(formulation_names, static_cast<int>(variant.formulation)), result);
  add_to("copies", std::to_string(problem.num_copies), result);
  char text[500];
  std::snprintf(text, sizeof text, "%d: %s, %s, gain %s (%.2g), width %.1e, + %s, %d copies, %s, %s, rtol %.0e, %s",
                number, family.c_str(), law.c_str(), gain.c_str(), problem.largest_gain_exponent,
                problem.smallest_width, name(addition_names, static_cast<int>(problem.addition)).c_str(),
                problem.num_copies, method.c_str(),
                name(formulation_names, static_cast<int>(variant.formulation)).c_str(), variant.tolerance,
                sfdae_status_name(result.status));
  char rest[400];
  std::snprintf(rest, sizeof rest, ", error %.2g (%.2g) of unknown %d at t = %.4g, %.1f s: %s", result.error,
                result.plain_error, result.unknown, result.t, result.seconds, result.message);
  if (result.verdict == Verdict::wrong) wrong_.push_back(text + std::string(rest));
  if (result.verdict == Verdict::named) named_.push_back(text + std::string(rest));
}

void Tables::add_lost(int number, const Case& problem, const std::string& reason) {
  RunResult result;
  result.verdict = Verdict::wrong;
  result.error = HUGE_VAL;
  all_.add(result);
  add_to("law", name(law_names, static_cast<int>(problem.law.law)), result);
  add_to("family", name(family_names, static_cast<int>(problem.family)), result);
  wrong_.push_back(std::to_string(number) + ": " + reason);
}

void Tables::print() const {
  for (const auto& [table, rows] : tables_) {
    std::printf("\n%-42s %8s %8s %8s %8s %8s %10s\n", table.c_str(), "runs", "right", "wrong", "named", "no ref.",
                "worst");
    for (const auto& [row, count] : rows)
      std::printf("%-42s %8d %8d %8d %8d %8d %10.2e\n", row.c_str(), count.runs, count.right, count.wrong,
                  count.named, count.no_reference, count.worst_error);
  }
  for (const std::string& line : wrong_) std::printf("wrong %s\n", line.c_str());
  for (const std::string& line : named_) std::printf("named %s\n", line.c_str());
  std::printf(
      "%d runs, %d right, %d wrong, %d named errors, %d without a reference, worst error %.3g tolerances; "
      "%.0f s in the library\n",
      all_.runs, all_.right, all_.wrong, all_.named, all_.no_reference, all_.worst_error, seconds_);
}

bool Tables::are_good() const {
  bool good = all_.wrong == 0 && is_within(all_.named, named_of_all, all_.judged()) &&
              is_within(all_.no_reference, without_reference, all_.runs);
  const auto laws = tables_.find("law");
  if (laws == tables_.end()) return false;
  for (const auto& [law, count] : laws->second) good = good && is_within(count.named, named_of_law, count.judged());
  return good;
}

}  // namespace campaign
