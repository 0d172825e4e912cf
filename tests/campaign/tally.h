// Counts of right answers, named errors and wrong answers of a family of problems.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "integration.h"

namespace campaign {

class Tally {
 public:
  explicit Tally(std::string family) : family_(std::move(family)) {}

  void add_right() { ++right_; }
  // status < 0, or a warning that goes with an answer that is not right.
  void add_named(int number, int status, const std::string& message);
  void add_wrong(int number, const std::string& what);
  // An analysis of a problem with these values.
  void add(int number, const LinearProblem& problem, const Answer& answer);
  // An integration; fits: the error is one that the tolerances allow.
  void add(int number, const LinearProblem& problem, const IntegrationOutcome& outcome, bool fits);

  int total() const { return right_ + named() + wrong(); }
  int named() const;
  int wrong() const { return static_cast<int>(wrong_.size()); }
  double named_share() const { return total() == 0 ? 0.0 : static_cast<double>(named()) / total(); }
  // Counts, statuses, the first wrong answers and the first named errors, as text.
  std::string summary() const;

  // 0 wrong, at most that share of named errors; prints the summary. A few hundred problems are too few for a share
  // of a thousandth: what is allowed is the mean and three standard deviations.
  void expect_at_most(double share) const;

 private:
  std::string family_;
  int right_ = 0;
  std::map<int, int> statuses_;
  std::vector<std::string> wrong_, examples_;
};

std::string text_of(const CharacteristicValues& values);

}  // namespace campaign
