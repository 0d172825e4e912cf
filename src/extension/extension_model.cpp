// Recorded equations with the system of their minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_model.h"

#include <algorithm>
#include <utility>

#include "extension/consistent_extension.h"
#include "extension/extension_change_watch.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "structure/replacement.h"

namespace sfdae::core {

// If the structural analysis fails, equations are replaced if that helps.
MinimalExtension ExtensionModel::extension_near(const PointOfInterest& point, const std::vector<double>& sizes) {
  const std::shared_ptr<const Structure>& recorded = problem_.shared_structure();
  if (problem_.source() != nullptr && problem_.source()->has_differences()) return {problem_, recorded};
  ReplacedStructure replaced =
      structure_with_replacements(*recorded, problem_.evaluator(), {point.t, point.x, sizes});
  if (replaced.structure) return {problem_, std::move(replaced.structure)};
  return {problem_, recorded, std::move(replaced.ordered)};
}

// Without a known x zeros are taken: linear equations have the same derivatives everywhere.
void ExtensionModel::analyze(const PointOfInterest& point, const ModelOptions& options,
                             std::vector<RankDecision>& decisions) {
  forget_system();
  problem_.forget_source();
  const std::vector<double> zeros(index(n()), 0.0);
  PointOfInterest start = point;
  if (start.x == nullptr) start.x = zeros.data();
  // The values are to be chosen later.
  ConsistencyRequest request = options.request_at(start.x);
  request.kind = InitialValues::nearest;
  MinimalExtension extension = extension_near(start, request.sizes());
  const Jet jet = ConsistentExtension(extension, request).find(start);
  system_ = std::make_unique<ExtensionSystem>(std::move(extension), base_, options.analysis, request.sizes(), jet);
  std::vector<RankDecision> made = system_->structure().take_certificate().blocks;
  if (decisions.empty()) decisions = std::move(made);
  else decisions.insert(decisions.end(), made.begin(), made.end());
  guess_.assign(start.x, start.x + n());
}

std::optional<Model::Extension> ExtensionModel::extension() {
  if (!system_) return std::nullopt;
  const MinimalExtension& extension = system_->extension();
  const ExtensionLinearization& linearization = system_->linearization();
  return Extension{.structure = &extension.structure(),
                   .rows = extension.num_rows(),
                   .columns = extension.num_columns(),
                   .entries = extension.column().size(),
                   .fill = linearization.fill(),
                   .states = linearization.choice().states()};
}

std::unique_ptr<ChangeWatch> ExtensionModel::change_watch() {
  return std::make_unique<ExtensionChangeWatch>(*system_);
}

Jet ExtensionModel::accepted_point() const {
  Jet jet = system_->accepted_jet();
  jet.set_order(0);
  return jet;
}

std::unique_ptr<ExtensionSystem> ExtensionModel::copy_of_system() {
  return std::make_unique<ExtensionSystem>(MinimalExtension(problem_, system_->extension().shared_structure()), base_,
                                           system_->settings(), system_->scales(), system_->jet());
}

std::unique_ptr<ExtensionSystem> ExtensionModel::archived_system(const ModelOptions& options, Archive& archive) {
  return std::make_unique<ExtensionSystem>(problem_, base_, options.analysis, archive);
}

ConsistentPoint ExtensionModel::make_consistent(ExtensionSystem& system, const PointOfInterest& point,
                                                const ModelOptions& options) {
  ConsistentPoint result;
  result.t = point.t;
  result.x.assign(point.x, point.x + n());
  const ConsistencyRequest request = options.request_at(point.x);
  ConsistentExtension search(system.extension(), request);
  const Jet& known = system.jet();
  const bool is_known = known.t == point.t && point.xdot == nullptr;
  const bool is_analyzed = is_known && request.differentiated_stay() && request.kind == InitialValues::nearest &&
                           std::equal(guess_.begin(), guess_.end(), point.x, point.x + n());
  const bool is_there = is_known && std::equal(point.x, point.x + n(), known.x.data());
  const Jet found = is_analyzed || is_there ? known : search.find(point);
  search.report(point, found, result);
  demand_point(system, system.set_point(found), point.t, "Analyze the problem there.");
  if (request.kind != InitialValues::accept) result.x.assign(system.jet().x.data(), system.jet().x.data() + n());
  add_derivative(system, point.direction(), result);
  return result;
}

}  // namespace sfdae::core
