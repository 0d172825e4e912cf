// The matrix of steps of sensitivities along the minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/sensitivity_step_matrix.h"

#include "linalg/index.h"

namespace sfdae::core {

void SensitivityStepMatrix::set(const StateChoice& choice, const SensitivitySlots& slots,
                                const std::vector<int>& varying, double accepted) {
  version_ = -1;
  systems_.analyze(choice.pattern(false), accepted);
  for (auto* list : {&all_values_, &all_mixed_, &varying_values_, &varying_mixed_}) list->clear();
  places_.clear();
  const std::vector<int>& place_of_entry = choice.places();
  std::vector<char> is_slope(place_of_entry.size(), 0), varies(is_slope);
  std::vector<int> sum_of_place(choice.pattern(false).row.size(), -1);
  for (int entry : varying) varies[index(entry)] = 1;
  for (const SensitivitySlots::Entry& slope : slots.slopes()) {
    is_slope[slope.entry] = 1;
    const int place = place_of_entry[slope.entry];
    sum_of_place[index(place)] = static_cast<int>(places_.size());
    places_.push_back(place);
  }
  for (std::size_t e = 0; e < place_of_entry.size(); ++e) {
    const int place = place_of_entry[e], sum = sum_of_place[index(place)];
    const Copy copy{static_cast<int>(e), sum < 0 ? place : 2 * sum + is_slope[e]};
    (sum < 0 ? all_values_ : all_mixed_).push_back(copy);
    if (varies[e] != 0) (sum < 0 ? varying_values_ : varying_mixed_).push_back(copy);
  }
  values_.assign(sum_of_place.size(), 0.0);
  mixed_.assign(2 * places_.size(), 0.0);
}

void SensitivityStepMatrix::assemble(const SensitivityRows& rows, double c) {
  const bool are_known = rows.version >= 0 && rows.version == version_;
  const double* const from = rows.values.data();
  double *const values = values_.data(), *const mixed = mixed_.data();
  for (const Copy& copy : are_known ? varying_values_ : all_values_) values[copy.to] = from[copy.entry];
  for (const Copy& copy : are_known ? varying_mixed_ : all_mixed_) mixed[copy.to] = from[copy.entry];
  const double* next = mixed;
  for (int place : places_) {
    values[place] = next[0] + c * next[1];
    next += 2;
  }
  version_ = rows.version;
}

}  // namespace sfdae::core
