// Changes of the characteristic values along the way, as an integration asks for them.
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
  // Of t; more than nothing: a step that is so short about t has to confirm it.
  double uncertainty = 0.0;
  SingularPart part = SingularPart::unknown;
};

// What a search of the points of a step has come to. Not complete: some of them could not be evaluated, and a change
// may have been missed.
struct StepSearch {
  std::optional<LocatedChange> change;
  bool is_complete = true;
};

class ChangeWatch {
 public:
  virtual ~ChangeWatch() = default;
  // False: nothing can change, whatever the point.
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
  // After a step of size h that failed for want of a solution: what it may have met.
  virtual std::optional<LocatedChange> find_ahead(double) { return std::nullopt; }
  // Whether no step from the point accepted last succeeds because a change is met there.
  virtual std::optional<LocatedChange> find_beyond() { return std::nullopt; }
  // Of an integration in the given direction.
  virtual void archive(Archive& archive, double direction) = 0;
};

}  // namespace sfdae::core
