// A mechanical system given by recorded formulas at several points in one pass of their tapes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/lane_evaluator.h"
#include "multibody/multibody_lane_terms.h"
#include "multibody/multibody_recorded_terms.h"

namespace sfdae::core {

class RecordedLanes {
 public:
  // The formulas to evaluate: M and f; g, null if there is none.
  struct Formulas {
    const RecordedTerms& terms;
    const TaylorEvaluator* constraints;
    int positions;
    bool is_rheonomic;
  };

  // Sets sizes, places, and constant entries.
  void prepare(const Formulas& formulas, MultibodyLaneTerms& terms);
  // Evaluates at (t, q, v); false if anything is not finite.
  bool evaluate(const Formulas& formulas, const LaneBlock* t, const LaneBlock* qv, MultibodyLaneTerms& terms);

 private:
  // A value of the formulas, and the entry that it belongs to.
  struct Target {
    int value;
    std::size_t entry;
  };

  bool evaluate_constraints(const Formulas& formulas, const LaneBlock* t, const LaneBlock* qv,
                            MultibodyLaneTerms& terms);

  LaneEvaluator values_, constraints_;
  std::vector<Target> masses_, forces_;
  LaneArray zeros_;
};

}  // namespace sfdae::core
