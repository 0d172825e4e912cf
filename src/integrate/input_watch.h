// Input watch: shortens steps that would miss changes of inputs within them, such as a pulse while nothing else
// happens. The error test uses only the points of a step and cannot detect them
// (docs/design/inputs_and_discontinuities.md). Missed changes within the tolerances of x are added up in an account
// over the whole run.
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
  // Importance of changes of inputs between the points of a step.
  enum class Importance { none, matters, unknown };

  void resize(const DaeSystem& system, TimeInputs& inputs);
  // span: the interval of interest.
  void open_account(double span);
  void take_account(const InputWatch& other) { account_ = other.account_; }
  // Size of the next step, at most h, short enough to detect relevant changes of inputs. Throws Failure.
  double noticing_step(Integrator& integrator, TimeInputs& inputs, double h);
  // Inputs switch at t.
  void note_switch(double t);
  // Allowed local error of a step of size h from t, as part of the tolerances: 1, unless inputs have shortened steps
  // recently.
  double allowed_error(double t, double h) const;
  // Such a step has been accepted; error: its local error in tolerances.
  void commit(double t, double h, double error);
  void archive(Archive& archive) { archive.real(fastest_); }
  void archive_account(Archive& archive);

 private:
  // In tolerances: allowed sum of missed changes over the interval of interest (design, 17.2).
  static constexpr double unimportant = 10.0;
  struct Account {
    double rate = 0.0;                   // per unit of t; 0: the run is unknown
    double balance = 0.0, charge = 0.0;  // saved so far; by the next step
    double busy = 0.0;                   // last time when inputs shortened a step
    bool is_busy = false;                // ever
  };

  void search(TimeInputs& inputs, std::span<const double> nodes, double h);
  std::size_t set_nodes(const Integrator& integrator, double h);
  bool is_important(double hidden, double shown, double h) const;
  bool is_busy(double t) const;
  bool drive_steps(Integrator& integrator, TimeInputs& inputs, double h);
  Importance of_unseen(Integrator& integrator, double h, std::span<const double> places);
  Importance of_peaks(Integrator& integrator, double h, std::span<const double> nodes);
  bool has_slope_at_start(Integrator& integrator);

  const InputSearch& found() const { return is_with_slopes_ ? with_slopes_ : of_values_; }

  InputSearch of_values_, with_slopes_;
  bool differentiates_ = false, is_with_slopes_ = false;  // the equations; the last search
  HeldSlopes slopes_;
  Account account_;
  double fastest_ = 0.0;  // shortest time of unexpected input changes; 0: none found
  std::array<double, InputSearch::most_nodes> nodes_{};
  bool has_slope_ = false;                        // at the start of the step
  std::vector<double> at_start_, change_, here_;  // (W x)' there, w held; its change up to the end; elsewhere
  std::vector<double> changes_;                   // up to each node
};

}  // namespace sfdae::core
