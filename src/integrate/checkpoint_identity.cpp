// Identity of a checkpoint: properties that the restoring solver must share with it.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/checkpoint_identity.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "linalg/format.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

constexpr double mark = 5.0e7 + 6151.0;  // improbable as the first number of anything else

// Names of option values that are codes.
struct Codes {
  const char* option;
  std::array<const char*, 4> names;  // for 0, 1, ...
};

constexpr Codes all_codes[] = {
    {"method", {"SFDAE_METHOD_BDF", "SFDAE_METHOD_RADAU", "SFDAE_METHOD_AUTOMATIC", nullptr}},
    {"structure", {"SFDAE_STRUCTURE_OFF", "SFDAE_STRUCTURE_AUTOMATIC", "SFDAE_STRUCTURE_REQUIRED", nullptr}},
    {"reduction", {"SFDAE_REDUCTION_STAGED", "SFDAE_REDUCTION_SVD", nullptr, nullptr}},
    {"leading_term",
     {"SFDAE_LEADING_AUTOMATIC", "SFDAE_LEADING_PROJECTOR", "SFDAE_LEADING_MATRIX", "SFDAE_LEADING_IDENTITY"}}};

std::string text_of(const char* option, double value) {
  for (const Codes& codes : all_codes)
    for (std::size_t i = 0; i < codes.names.size(); ++i)
      if (std::strcmp(codes.option, option) == 0 && value == static_cast<double>(i) && codes.names[i] != nullptr)
        return codes.names[i];
  return format("%.15g", value);
}

[[noreturn]] void refuse(const std::string& difference) {
  throw Failure(SFDAE_ILLEGAL_ARGUMENT, "the checkpoint was made with " + difference);
}

void write_values(const std::vector<CheckpointIdentity::Value>& values, Archive& archive) {
  for (const CheckpointIdentity::Value& each : values) {
    double value = each.value;
    archive.real(value);
  }
}

// The first value that differs from the one read, bitwise, with the one read; null if there is none.
std::pair<const CheckpointIdentity::Value*, double> first_difference(
    const std::vector<CheckpointIdentity::Value>& values, Archive& archive) {
  std::pair<const CheckpointIdentity::Value*, double> found{nullptr, 0.0};
  for (const CheckpointIdentity::Value& each : values) {
    double saved = 0.0;
    archive.real(saved);
    const bool agrees = std::bit_cast<std::uint64_t>(saved) == std::bit_cast<std::uint64_t>(each.value);
    if (found.first == nullptr && !agrees) found = {&each, saved};
  }
  return found;
}

}  // namespace

void CheckpointIdentity::write(Archive& archive) const {
  double first = mark, equations = equations_;
  archive.real(first);
  archive.real(equations);
  write_values(options_, archive);
  write_values(parameters_, archive);
}

void CheckpointIdentity::demand_same(Archive& archive) const {
  double first = 0.0, equations = 0.0;
  archive.real(first);
  if (first != mark) throw DamagedArchive();
  archive.real(equations);
  if (equations != equations_)
    refuse(
        "other equations than those of this solver: create it with the problem that the checkpoint was made with.");
  if (const auto [option, saved] = first_difference(options_, archive); option != nullptr)
    refuse(format("%s = %s, but this solver has %s: set the option as it was.", option->name,
                  text_of(option->name, saved).c_str(), text_of(option->name, option->value).c_str()));
  if (const auto [parameter, saved] = first_difference(parameters_, archive); parameter != nullptr)
    refuse(
        format("%s = %.15g, but the parameter is %.15g now: set it as it was before, and change it after restoring.",
               parameter->name, saved, parameter->value));
}

CheckpointIdentity identity_of(Model& model, const ModelOptions& options, Method method) {
  WordHash hash;
  model.add_equations(hash);
  std::vector<CheckpointIdentity::Value> parameters;
  if (const TaylorEvaluator* recorded = model.evaluator())
    for (int i = 0; i < recorded->record().num_user_parameters(); ++i)
      parameters.push_back({recorded->record().parameters()[index(i)].name.c_str(), recorded->parameter(i)});
  const AnalysisSettings& analysis = options.analysis;
  const auto number = [](auto value) { return static_cast<double>(value); };
  return {hash.value_as_real(),
          std::move(parameters),
          {{"method", number(method)},
           {"structure", number(options.structure)},
           {"max_index", number(analysis.max_index)},
           {"reduction", analysis.by_svd ? 1.0 : 0.0},
           {"rank_tol", analysis.rank_tol},
           {"time_scale", analysis.time_scale},
           {"difference_derivatives", options.differences.allowed ? 1.0 : 0.0},
           {"difference_step", options.differences.step},
           {"leading_term", number(options.leading)}}};
}

}  // namespace sfdae::core
