// A model of any kind, and what it is made of: recorded equations or functions, by structure where that is of use.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "array/nonlinear_model.h"
#include "linear/linear_model.h"
#include "multibody/structured_multibody.h"

namespace sfdae::core {

// A model, and what it is: one of the pointers is set.
struct AnyModel {
  std::unique_ptr<Model> model;
  LinearModel* linear = nullptr;
  NonlinearModel* nonlinear = nullptr;
  StructuredMultibody* multibody = nullptr;
};

AnyModel any(std::unique_ptr<LinearModel> model);
AnyModel any(std::unique_ptr<NonlinearModel> model);
AnyModel any(std::unique_ptr<StructuredMultibody> model);

// Recorded equations, as many as unknowns, all of which may be differentiated and none of the unknowns of which are
// prescribed, are solved by their structure where that is of use.
AnyModel with_structure(AnyModel any);
// Functions with patterns, the same way.
AnyModel with_patterns(AnyModel any);

// Recorded equations that are linear become a linear model.
AnyModel make_model(std::shared_ptr<const Record> record);

// Another model of the same recorded equations, with the values that parameters have now; the recording is shared. Null
// for problems given by functions.
AnyModel clone_of(const AnyModel& model);

// The structure of such a model has to be followed, and there is none: throws Failure.
void demand_structure(const Model& model, StructureUse wanted);

}  // namespace sfdae::core
