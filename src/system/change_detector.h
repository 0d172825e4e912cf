// Changes of the characteristic values along the way: what the driver asks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "linalg/archive.h"
#include "reduction/index_analysis.h"

namespace sfdae::core {

struct LocatedChange {
  double t_before = 0.0;  // the values known still hold here
  double t = 0.0;
  CharacteristicValues new_values;
};

class ChangeDetector {
 public:
  virtual ~ChangeDetector() = default;
  // The current point of the system is the first one of an integration in the given direction.
  virtual void start(double direction) = 0;
  // Looks for a change between the point accepted last, t_last, and the current one, at every point that the step went
  // through.
  virtual std::optional<LocatedChange> find(double t_last) = 0;
  // The current point of the system is accepted.
  virtual void accept() = 0;
  // Looks for the change between left, where the values known hold, and right, where others do.
  virtual std::optional<LocatedChange> locate(double left, double right) = 0;
  // Those that hold at t.
  virtual CharacteristicValues values_at(double t) = 0;
  virtual void archive(Archive& archive) = 0;
};

}  // namespace sfdae::core
