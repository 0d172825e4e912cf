// Steps that would not notice what inputs do within them, such as a pulse while nothing else happens: the error test,
// which knows the points of a step alone, does not ask for shorter ones (docs/decisions/87-inputs-between-points.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "integrate/held_slopes.h"
#include "integrate/integrator.h"
#include "linalg/archive.h"
#include "watch/input_search.h"

namespace sfdae::core {

class InputWatch {
 public:
  // The importance of what inputs do between the points of a step.
  enum class Importance { none, matters, unknown };

  void resize(const DaeSystem& system, int inputs);
  // The next step, of size h at first, as short as it has to be to notice what inputs do, where that matters. Throws
  // Failure.
  double noticing_step(Integrator& integrator, TimeInputs& inputs, double h);
  void archive(Archive& archive) { archive.real(fastest_); }

 private:
  std::size_t set_nodes(const Integrator& integrator, double h);
  Importance of_unseen(Integrator& integrator, double h, std::span<const double> places);
  Importance of_peaks(Integrator& integrator, double h, std::span<const double> nodes);
  bool has_slope_at_start(Integrator& integrator);

  InputSearch search_;
  HeldSlopes slopes_;
  double fastest_ = 0.0;  // in which time inputs have been found to change unnoticed; 0: none have
  std::array<double, InputSearch::most_nodes> nodes_{};
  bool has_slope_ = false;                        // at the start of the step
  std::vector<double> at_start_, change_, here_;  // (W x)' there, w held; its change up to the end; and elsewhere
  std::vector<double> changes_;                   // up to each node
};

}  // namespace sfdae::core
