// Counts of runs by law, family and other properties, and what they are allowed to be.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "run.h"

namespace campaign {

struct Count {
  int runs = 0, right = 0, wrong = 0, named = 0, no_reference = 0;
  double worst_error = 0.0;

  void add(const RunResult& result);
  int judged() const { return right + wrong + named; }
};

class Tables {
 public:
  void add(int number, const Case& problem, const Variant& variant, const RunResult& result);
  // Runs of which nothing is known, since the process ended.
  void add_lost(int number, const Case& problem, const std::string& reason);
  void print() const;
  bool are_good() const;

 private:
  void add_to(const std::string& table, const std::string& row, const RunResult& result);

  std::map<std::string, std::map<std::string, Count>> tables_;
  Count all_;
  std::vector<std::string> wrong_, named_;
  double seconds_ = 0.0;
};

}  // namespace campaign
