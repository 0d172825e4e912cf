// Changes of the characteristic values of a nonlinear problem: seen where linearizations are renewed.
//
// x is known at points of the integration only, so that a change is located by its steps becoming short.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "system/change_detector.h"
#include "system/nonlinear_system.h"

namespace sfdae::core {

class NonlinearChanges final : public ChangeDetector {
 public:
  explicit NonlinearChanges(NonlinearSystem& system) : system_(system) {}
  void start(double) override {}
  std::optional<LocatedChange> find(double) override { return std::nullopt; }
  void accept() override {}
  std::optional<LocatedChange> locate(double, double) override { return std::nullopt; }
  // At the current jet, whatever t is.
  CharacteristicValues values_at(double) override {
    ConsistentJets jets(system_.problem(), system_.jet().t, system_.jet().x.data(), {});
    Arena arena;
    return find_local_values(jets, system_.jet().t, system_.settings(), arena);
  }
  void archive(Archive&) override {}

 private:
  NonlinearSystem& system_;
};

}  // namespace sfdae::core
