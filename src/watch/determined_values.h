// Event function values in a search, with the time at which they were determined last.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "watch/event_values.h"

namespace sfdae::core {

class DeterminedValues {
 public:
  explicit DeterminedValues(EventValues& values) : values_(values) {}
  EventValues& source() const { return values_; }
  EventValues* operator->() const { return &values_; }
  void determine(double t, bool may_improve, std::vector<double>& g) {
    last_.reset();
    values_.determine(t, may_improve, g.data());
    last_ = t;
  }
  bool is_at(double t) const { return last_ == t; }

 private:
  EventValues& values_;
  std::optional<double> last_;
};

}  // namespace sfdae::core
