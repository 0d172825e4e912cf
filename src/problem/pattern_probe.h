// Test for entries that patterns lack: groups of unknowns are moved, and equations that contain none of them must not
// change.
//
// Moves are finite, so that x_j^2 is noticed at x_j = 0, and nothing has to be differentiated: an equation that does
// not depend on an unknown gives the same number.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "expression/opaque_record.h"
#include "problem/colored_differences.h"

namespace sfdae::core {

class PatternProbe {
 public:
  PatternProbe(const JacobianPatterns& patterns, int num_equations);

  struct Missing {
    int level;  // 0: of F_x, 1: of F_x'
    int row, column;
    double value;  // a difference quotient
  };
  // F and the sums of the absolute values of its terms, by which rounding errors are excluded.
  struct Equations {
    const std::vector<double>& F;
    const std::vector<double>& terms;
  };
  // Tests all groups at the first few points, then one at a time, always new ones. True: an entry is missing. Points
  // where F cannot be evaluated are left out, unless `error` ends the integration.
  bool finds(const FunctionOfJet& evaluate, std::vector<double> derivatives, const Equations& equations,
             Missing& missing, CallbackError& error);
  long evaluations() const { return evaluations_; }

 private:
  struct Level {
    ColumnPattern pattern;
    std::size_t number_of_groups;
    ChangeSizes sizes;
  };
  void divide();
  bool probe(int level, const std::vector<int>& group, Missing& missing);
  bool moves(int level, const std::vector<int>& group, int row, double& change);
  bool evaluate_moved(int level, const std::vector<int>& group, double side);
  void narrow(int level, std::vector<int> group, Missing& missing);

  int m_, n_;
  Level levels_[2];
  int passed_ = 0;
  unsigned seed_ = 1;
  struct Group {
    int level;
    std::vector<int> unknowns;
  };
  std::vector<Group> groups_;  // that are still to be moved, the last one first
  long evaluations_ = 0;
  // State of the present call.
  const FunctionOfJet* evaluate_ = nullptr;
  std::vector<double> derivatives_, moved_, noise_;
  const std::vector<double>* F_ = nullptr;
  CallbackError error_;
  std::vector<char> contains_;
};

}  // namespace sfdae::core
