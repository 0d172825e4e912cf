// Arguments of exponentials in recorded equations. Where the tolerances of unknowns let an argument change by more
// than one, as those of a diode at mains voltage (a tolerance of 0.3 V, 26 mV for a factor of e), an iteration that
// ends within the tolerances ends anywhere: currents are wrong by orders of magnitude there
// (docs/decisions/95-arguments-of-exponentials.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/tape.h"
#include "expression/taylor_evaluator.h"
#include "expression/values_of_time.h"

namespace sfdae::core {

class SteepArguments {
 public:
  // Those that are sums, products and quotients of unknowns and of what does not depend on them. Parameters are those
  // that the evaluators have when they are asked; they live as long as this.
  explicit SteepArguments(const std::vector<const TaylorEvaluator*>& evaluators);

  bool empty() const { return parts_.empty(); }
  // inverse_weights: 1 / tolerances of the unknowns. Those of unknowns that arguments depend on are made as large as
  // it takes for these to be known to a hundredth, all of them by one factor, whatever their part in it is. Nothing
  // is allocated.
  void sharpen(double t, const double* x, double* inverse_weights);
  struct Place {
    double t;
    const double* x;
  };
  // Whether an argument is smaller at the second place by so much that the derivative of its exponential at the first
  // one is too large by an order of magnitude. Nothing is allocated.
  bool have_fallen(const Place& from, const Place& to);

 private:
  struct Part {
    explicit Part(const TaylorEvaluator& evaluator);

    ValuesOfTime values;
    std::vector<int> arguments;             // slots
    std::vector<char> is_of_both_signs;     // of sinh and cosh, which are large on either side
    std::vector<Instruction> instructions;  // what they are made of
    InstructionList list;                   // the same
    std::vector<Tape::Leaf> leaves;         // unknowns among that
    std::vector<double> change;             // of slots, by the tolerances of unknowns
    std::vector<double> of_arguments;       // changes of these
  };
  static const double* evaluate(Part& part, double t, const double* x);
  static void propagate(Part& part, const double* value, const double* inverse_weights);
  static bool hand_back(Part& part);
  static void clear(Part& part);

  std::vector<Part> parts_;
};

}  // namespace sfdae::core
