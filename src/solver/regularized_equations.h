// Regularized equations of a solver, as a separate model: with continuous conditions (regularized_conditions.h) and
// regularizing terms (flat_equations.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "expression/flat_equations.h"
#include "expression/held_conditions.h"
#include "expression/regularized_conditions.h"
#include "expression/sliding_layers.h"
#include "expression/taylor_evaluator.h"
#include "linalg/archive.h"
#include "solver/formulated_model.h"

namespace sfdae::core {

// Changes of equations that are singular at some points, or whose conditions lead back and forth at others.
struct Regularization {
  std::vector<FlatEquation> terms;
  RegularizationRounds rounds;  // of conditions, in equations with these terms
  bool is_empty() const { return terms.empty() && rounds.empty(); }
  bool operator==(const Regularization&) const = default;
};
// Throws DamagedArchive if the data read are invalid.
void archive_regularization(Archive& archive, Regularization& regularization);

class RegularizedEquations {
 public:
  // given: with conditions, and the present parameter values. changed: see HeldConditions.
  RegularizedEquations(const TaylorEvaluator& given, Regularization its_parts, std::function<void()> changed);

  const Regularization& parts() const { return parts_; }
  SlidingLayers& layers() { return layers_; }
  FormulatedModel& model() { return *model_; }
  HeldConditions* conditions() { return conditions_.get(); }

 private:
  std::shared_ptr<const Record> regular(const TaylorEvaluator& given);

  Regularization parts_;
  SlidingLayers layers_;
  std::unique_ptr<FormulatedModel> model_;
  std::unique_ptr<HeldConditions> conditions_;
};

}  // namespace sfdae::core
