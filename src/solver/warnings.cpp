// Warnings of the calls that analyze and start.
// SPDX-License-Identifier: BSD-3-Clause
#include "solver/warnings.h"

#include <string>

namespace sfdae::core {

namespace {

CallResult warning_of_change(const ValueChange& change, double t) {
  if (!change.is_beyond_tolerances()) return {};
  const std::string what = change.is_part ? format("of x[%d] the part that is differentiated", change.component)
                                          : format("x[%d]", change.component);
  return {SFDAE_VALUES_CHANGED,
          format("the constraints at t = %.15g do not hold for the values given that are differentiated; most of all "
                 "%s changed from %.6g to %.6g (%.2g times its tolerance). Correct the values given, or accept those "
                 "returned.",
                 t, what.c_str(), change.from, change.to, change.in_tolerances)};
}

}  // namespace

CallResult warning_of(const DaeSystem& system) {
  const int u = system.undetermined();
  if (u == 0) return {};
  return {SFDAE_NOT_UNIQUE,
          format("the solution is not unique: %d component(s) are free (u = %d). The free part is held "
                 "constant; prescribe components to choose another solution.",
                 u, system.analysis().values.u)};
}

CallResult warning_of(const DaeSystem& system, const ConsistentPoint& point) {
  CallResult result;
  if (point.has_contradiction)
    result = {SFDAE_INCONSISTENCY_IGNORED, "redundant equations contradict each other; ignored as asked for."};
  for (const CallResult& next : {warning_of_change(point.value_change, point.t), warning_of(system)}) {
    if (next.status == SFDAE_OK) continue;
    if (result.status == SFDAE_OK) result.status = next.status;
    if (!result.message.empty()) result.message += ' ';
    result.message += next.message;
  }
  return result;
}

}  // namespace sfdae::core
