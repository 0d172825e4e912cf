// From the public structs of problems to models of the core.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "array/nonlinear_model.h"
#include "linear/linear_model.h"
#include "multibody/structured_multibody.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// A model, and what it is: one of the pointers is set.
struct AnyModel {
  std::unique_ptr<Model> model;
  LinearModel* linear = nullptr;
  NonlinearModel* nonlinear = nullptr;
  StructuredMultibody* multibody = nullptr;
};

// The problems have been checked. Failure, with a public status, for mistakes in recording.
AnyModel make_model(const sfdae_linear_problem& problem);
// Recorded equations that are linear become a linear model.
AnyModel make_model(const sfdae_nonlinear_problem& problem);
AnyModel make_model(const sfdae_multibody_problem& problem);
AnyModel make_model(std::shared_ptr<const Record> record);

// Another model of the same recorded equations, with the values that parameters have now; the recording is shared. Null
// for problems given by functions.
AnyModel clone_of(const AnyModel& model);

LinearFunctions functions_of(const sfdae_linear_problem& problem);

}  // namespace sfdae::core
