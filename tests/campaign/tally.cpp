// SPDX-License-Identifier: BSD-3-Clause
#include "tally.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace campaign {

std::string text_of(const CharacteristicValues& values) {
  char text[80];
  std::snprintf(text, sizeof text, "(mu %d; d %d, a %d, u %d, v %d)", values.mu, values.d, values.a, values.u,
                values.v);
  return text;
}

void Tally::add_named(int number, int status, const std::string& message) {
  ++statuses_[status];
  constexpr std::size_t shown = 3, length = 300;
  if (examples_.size() >= shown) return;
  examples_.push_back("number " + std::to_string(number) + ": " + message.substr(0, length));
}

void Tally::add_wrong(int number, const std::string& what) {
  wrong_.push_back("number " + std::to_string(number) + ": " + what);
}

void Tally::add(int number, const LinearProblem& problem, const Answer& answer) {
  if (answer.status < 0) {
    add_named(number, answer.status, answer.message);
  } else if (answer.values == problem.values) {
    add_right();
  } else {
    add_wrong(number, std::to_string(problem.m) + " x " + std::to_string(problem.n) + ", " + text_of(answer.values) +
                          " instead of " + text_of(problem.values));
  }
}

void Tally::add(int number, const LinearProblem& problem, const IntegrationOutcome& outcome, bool fits) {
  if (outcome.answer.status < 0 || outcome.answer.values != problem.values || fits) {
    add(number, problem, outcome.answer);
    return;
  }
  char text[100];
  std::snprintf(text, sizeof text, "n = %d, mu = %d, error %.1e of the size", problem.n, problem.values.mu,
                outcome.error);
  if (outcome.answer.status > 0) {
    add_named(number, outcome.answer.status, text);
  } else {
    add_wrong(number, text);
  }
}

int Tally::named() const {
  int sum = 0;
  for (const auto& [status, count] : statuses_) sum += count;
  return sum;
}

std::string Tally::summary() const {
  std::string text = family_ + ": " + std::to_string(total()) + " problems, " + std::to_string(right_) + " right, " +
                     std::to_string(named()) + " named errors, " + std::to_string(wrong()) + " wrong\n";
  for (const auto& [status, count] : statuses_)
    text += std::string("    ") + sfdae_status_name(status) + " " + std::to_string(count) + "\n";
  constexpr std::size_t shown = 10;
  for (std::size_t k = 0; k < wrong_.size() && k < shown; ++k) text += "    wrong " + wrong_[k] + "\n";
  for (const std::string& example : examples_) text += "    named " + example + "\n";
  return text;
}

void Tally::expect_at_most(double share) const {
  std::fputs(summary().c_str(), stdout);
  std::fflush(stdout);
  EXPECT_EQ(wrong(), 0) << summary();
  const double expected = share * total();
  EXPECT_LE(named(), expected + 3.0 * std::sqrt(expected)) << summary();
}

}  // namespace campaign
