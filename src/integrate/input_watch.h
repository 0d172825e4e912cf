// Steps that would not notice what inputs do within them, such as a pulse while nothing else happens: the error test, which knows the
// points of a step alone, does not ask for shorter ones (docs/decisions/87-inputs-between-points.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "integrate/input_samples.h"
#include "integrate/integrator.h"
#include "linalg/archive.h"

namespace sfdae::core {

class InputWatch {
 public:
  void resize(const DaeSystem& system, int inputs);
  // The next step, of size h at first, as short as it has to be to notice what inputs do, where that matters. Throws Failure.
  double noticing_step(Integrator& integrator, TimeInputs& inputs, double h);
  void archive(Archive& archive) { archive.real(fastest_); }

 private:
  std::size_t set_nodes(const Integrator& integrator, double h);
  std::optional<bool> do_matter(Integrator& integrator, double h, std::span<const double> places);
  std::optional<bool> do_crests_matter(Integrator& integrator, double h, std::span<const double> nodes);
  bool has_slope_at_start(Integrator& integrator);
  bool find_slope(Integrator& integrator, double t, std::vector<double>& wdot);
  bool follow(Integrator& integrator, double t);
  bool restore(Integrator& integrator, double t);
  double size_of_change(Integrator& integrator, double h, const std::vector<double>& slope);

  InputSamples samples_;
  double fastest_ = 0.0;  // in which time inputs have been found to change unnoticed; 0: none have
  std::array<double, InputSamples::most_nodes> nodes_{};
  bool has_slope_ = false;                        // at the start of the step
  std::vector<double> at_start_, change_, here_;  // (W x)' there, w held; its change up to the end; and elsewhere
  std::vector<double> changes_;                   // up to each node
  std::vector<double> w_, x_, from_, xdot_, taylor_, taylor_before_;
};

}  // namespace sfdae::core
