// Interface for changes of the characteristic values during an integration.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "linalg/archive.h"
#include "reduction/index_analysis.h"
#include "system/singular_part.h"

namespace sfdae::core {

struct LocatedChange {
  double t_before = 0.0;  // the values known still hold here
  double t = 0.0;
  CharacteristicValues new_values;
  // Uncertainty of t, positive: a step that short around t has to confirm the change.
  double uncertainty = 0.0;
  SingularPart part = SingularPart::unknown;
};

// Result of a search of the points of a step. Not complete: some of them could not be evaluated, and a change may have
// been missed.
struct StepSearch {
  std::optional<LocatedChange> change;
  bool is_complete = true;
};

class ChangeWatch {
 public:
  virtual ~ChangeWatch() = default;
  // False: the characteristic values cannot change at any point.
  virtual bool may_find() const { return true; }
  // The current point of the system is the first one of an integration in the given direction.
  virtual void start(double direction) = 0;
  // Looks for a change between the point accepted last, t_last, and the current one, at every point that the step
  // went through.
  virtual StepSearch find(double t_last) = 0;
  // The current point of the system is accepted.
  virtual void accept() = 0;
  // Looks for the change between left, where the values known hold, and right, where others do.
  virtual std::optional<LocatedChange> locate(double left, double right) = 0;
  // After a step of size h that failed for lack of a solution: the change that it may have met.
  virtual std::optional<LocatedChange> find_ahead(double) { return std::nullopt; }
  // The change that makes every step from the point accepted last fail; none if there is none.
  virtual std::optional<LocatedChange> find_beyond() { return std::nullopt; }
  // For an integration in the given direction.
  virtual void archive(Archive& archive, double direction) = 0;
};

}  // namespace sfdae::core
