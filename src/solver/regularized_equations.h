// The equations of a solver with conditions that are continuous (regularized_conditions.h), as a model of its own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "expression/held_conditions.h"
#include "expression/regularized_conditions.h"
#include "expression/sliding_layers.h"
#include "expression/taylor_evaluator.h"
#include "linalg/archive.h"
#include "solver/formulated_model.h"

namespace sfdae::core {

// Throws DamagedArchive where reading finds no such numbers.
void archive_rounds(Archive& archive, RegularizationRounds& rounds);

class RegularizedEquations {
 public:
  // given: with conditions, and the values that parameters have. changed: as HeldConditions has it.
  RegularizedEquations(const TaylorEvaluator& given, RegularizationRounds its_rounds, std::function<void()> changed);

  const RegularizationRounds& rounds() const { return rounds_; }
  SlidingLayers& layers() { return layers_; }
  FormulatedModel& model() { return *model_; }
  HeldConditions* conditions() { return conditions_.get(); }

 private:
  std::shared_ptr<const Record> with_rounds(const TaylorEvaluator& given);

  RegularizationRounds rounds_;
  SlidingLayers layers_;
  std::unique_ptr<FormulatedModel> model_;
  std::unique_ptr<HeldConditions> conditions_;
};

}  // namespace sfdae::core
