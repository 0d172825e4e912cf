// Times at which inputs of recorded equations have kinks: where their tables have.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Of tables whose argument is t, a linear function of t with coefficients that depend on parameters alone, such a function
// modulo a period, one of several of these as conditions on t choose, or a linear function of any of that.
class TimeBreakpoints {
 public:
  // Parameters are those that the evaluator has when it is asked; it lives as long as this.
  explicit TimeBreakpoints(const TaylorEvaluator& evaluator);

  // The next one after t in a direction, +1 or -1, farther away than rounding errors of t.
  std::optional<double> next(double t, double direction) const;
  // Whether t is one of those, to the last bit, and first derivatives may jump there: of tables of degree 1, where a
  // condition changes, and where a period ends.
  bool is_kink(double t) const;

 private:
  // Of t.
  struct Line {
    double offset, slope;
    double at(double t) const { return offset + slope * t; }
  };
  struct Search;

  std::optional<Line> line_of(int node) const;
  std::optional<Line> line_of_sum(const Node& node) const;
  std::optional<double> number_of(int node) const;
  void search(int node, const Line& outer, Search& search) const;
  void search_period(const Node& node, const Line& outer, Search& search) const;

  const TaylorEvaluator& evaluator_;
  const Record& record_;
  std::vector<int> tables_;  // nodes
};

}  // namespace sfdae::core
