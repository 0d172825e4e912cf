// Singular points between steps of the extension: the determinant of a block of the system Jacobian changes its sign,
// or touches zero, between accepted points. There are fewer free values there than structural analysis predicts.
//
// A suspicion in a long step is confirmed by shorter ones, as x in between is interpolated. Determinants that jump,
// because of conditions in formulas, do not become small with the step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "extension/extension_system.h"
#include "structure/block_determinants.h"
#include "system/change_watch.h"

namespace sfdae::core {

class ExtensionChangeWatch final : public ChangeWatch {
 public:
  explicit ExtensionChangeWatch(ExtensionSystem& system);
  bool may_find() const override { return determinants_.count() > 0; }
  void start(double direction) override;
  StepSearch find(double t_last) override;
  void accept() override;
  // Shortened steps locate it.
  std::optional<LocatedChange> locate(double, double) override { return std::nullopt; }
  std::optional<LocatedChange> find_beyond() override;
  void archive(Archive& archive, double direction) override;

 private:
  // Determinants of the blocks at a point with its x and x'.
  struct Sample {
    Jet jet;
    std::vector<BlockDeterminants::Value> values;
    double t() const { return jet.t; }
  };
  // The singular point found first, the step in which it was found, and log2 of the determinant about it.
  struct Suspect {
    double t, step, log2;
    int block;
  };

  bool measure(const Jet& jet, Sample& sample);
  bool has_sample();
  bool measure_between(double part);
  std::optional<int> turned_block(const Sample& now) const;
  std::optional<int> dipping_block() const;
  double find_turn(int block);
  StepSearch find_dip(int block);
  std::optional<LocatedChange> change_at(double t, int block);

  ExtensionSystem& system_;
  BlockDeterminants determinants_;
  double direction_ = 1.0;
  Sample older_, last_, now_, between_;
  int samples_ = 0;       // number of accepted ones, up to two
  bool has_now_ = false;  // of the step that is tried
  std::optional<Suspect> suspect_;
  std::vector<double> highest_;  // largest log2 of the determinants since the start
};

}  // namespace sfdae::core
