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
  // Parameters are those that the evaluators have when they are asked; they live as long as this.
  explicit TimeBreakpoints(const std::vector<const TaylorEvaluator*>& evaluators);

  // Where a step has to end: the next one after t in a direction, +1 or -1, farther away than rounding errors of t. In
  // place of a kink, where values or first derivatives may jump (of tables of degree 1, where a condition changes, where a
  // period ends), both ends of its gap.
  std::optional<double> next(double t, double direction) const;
  // Times about a kink within which rounding errors decide on which side of it functions are evaluated.
  struct Gap {
    double start, end;
    bool ends_at(double t) const;
  };
  // That holds t; its ends belong to it.
  std::optional<Gap> gap_at(double t) const;

 private:
  // Of t.
  struct Line {
    double offset, slope;
    double at(double t) const { return offset + slope * t; }
  };
  struct Table {
    int node;
    std::vector<char> has_kink;  // at each of its breakpoints
    double size;                 // of its arguments
  };
  struct Search;

  // The tables of one evaluator.
  class Inputs {
   public:
    explicit Inputs(const TaylorEvaluator& evaluator);
    void search(Search& search) const;

   private:
    std::optional<Line> line_of(int node) const;
    std::optional<Line> line_of_sum(const Node& node) const;
    std::optional<double> number_of(int node) const;
    void search(int node, const Line& outer, Search& search) const;
    void search_choice(const Node& node, const Line& outer, Search& search) const;
    void search_period(const Node& node, const Line& outer, Search& search) const;

    const TaylorEvaluator& evaluator_;
    const Record& record_;
    std::vector<Table> tables_;
  };
  std::vector<Inputs> inputs_;
};

}  // namespace sfdae::core
