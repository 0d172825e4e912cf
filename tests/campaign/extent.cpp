// SPDX-License-Identifier: BSD-3-Clause
#include "extent.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace campaign {

namespace {

// What keeps the whole in continuous integration below half a minute.
constexpr double default_share = 0.02;

double number_in_environment(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtod(text, nullptr);
}

}  // namespace

bool single_problem() { return std::getenv("SFDAE_CAMPAIGN_NUMBER") != nullptr; }

std::vector<int> problem_numbers(int full, int least) {
  if (single_problem()) return {static_cast<int>(number_in_environment("SFDAE_CAMPAIGN_NUMBER", 0.0))};
  const double share = number_in_environment("SFDAE_CAMPAIGN_SHARE", default_share) *
                       std::min(1.0, number_in_environment("SFDAE_TEST_SCALE", 1.0));
  std::vector<int> numbers(static_cast<std::size_t>(std::max(static_cast<double>(least), std::round(full * share))));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

}  // namespace campaign
