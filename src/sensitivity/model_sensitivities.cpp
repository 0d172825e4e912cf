// Creation of the systems for sensitivities of models. These members are defined here since models are below
// sensitivities: only this file knows both.
// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <utility>
#include <vector>

#include "array/nonlinear_model.h"
#include "extension/extension_model.h"
#include "linalg/format.h"
#include "problem/failure.h"
#include "sensitivity/extension_sensitivities.h"
#include "sensitivity/nonlinear_sensitivities.h"
#include "system/sensitivity_system.h"

namespace sfdae::core {

std::unique_ptr<SensitivitySystem> NonlinearModel::sensitivities(std::vector<int> parameters) {
  if (recorded_ == nullptr) return nullptr;
  if (!problem_->prescribed().empty())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  "there are no sensitivities of problems with prescribed components: write these as equations.");
  if (system_->undetermined() > 0)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("there are no sensitivities where components of the solution are free (u = %d).",
                         system_->undetermined()));
  return std::make_unique<NonlinearSensitivities>(*system_, *recorded_, std::move(parameters));
}

bool ExtensionModel::has_sensitivities() const {
  return ExtensionSensitivities::are_possible(system_->extension().structure());
}

std::unique_ptr<SensitivitySystem> ExtensionModel::sensitivities(std::vector<int> parameters) {
  if (!has_sensitivities()) return nullptr;
  return std::make_unique<ExtensionSensitivities>(*system_, std::move(parameters));
}

}  // namespace sfdae::core
