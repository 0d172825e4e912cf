// Singular configurations of mechanical systems: seen at the end of steps.
//
// q and v are known at points of the integration only, so that a change is located by its steps becoming short.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_system.h"
#include "system/change_detector.h"

namespace sfdae::core {

class MultibodyChanges final : public ChangeDetector {
 public:
  explicit MultibodyChanges(MultibodySystem& system) : system_(system) {}
  void start(double) override {}
  std::optional<LocatedChange> find(double) override { return std::nullopt; }
  void accept() override {}
  std::optional<LocatedChange> locate(double, double) override { return std::nullopt; }
  // Where the change was met last, whatever t is.
  CharacteristicValues values_at(double) override {
    return characteristic_values(system_.sizes(), system_.changed_ranks());
  }
  void archive(Archive&) override {}

 private:
  MultibodySystem& system_;
};

}  // namespace sfdae::core
