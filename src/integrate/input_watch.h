// Steps that would not notice what inputs do within them, such as a pulse while nothing else happens: the error test,
// which knows the points of a step alone, does not ask for shorter ones (docs/design/inputs_and_discontinuities.md).
// Changes that steps do not notice, since x bears them, are added up in an account over the whole run.
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

  void resize(const DaeSystem& system, TimeInputs& inputs);
  // span: the interval of interest.
  void open_account(double span);
  void take_account(const InputWatch& other) { account_ = other.account_; }
  // The next step, of size h at first, as short as it has to be to notice what inputs do, where that matters. Throws
  // Failure.
  double noticing_step(Integrator& integrator, TimeInputs& inputs, double h);
  // Inputs switch at t.
  void note_switch(double t);
  // The part of the tolerances that the local error of a step of size h from t may have: 1, unless inputs have kept
  // steps short lately.
  double allowed_error(double t, double h) const;
  // Such a step has been accepted, with that error in tolerances.
  void commit(double t, double h, double error);
  void archive(Archive& archive) { archive.real(fastest_); }
  void archive_account(Archive& archive);

 private:
  // In tolerances: what a step does not notice may add up to as much over the interval of interest (design, 17.2).
  static constexpr double unimportant = 10.0;
  struct Account {
    double rate = 0.0;                   // per unit of t; 0: nothing is known of the run
    double balance = 0.0, charge = 0.0;  // saved so far; by the step to come
    double busy = 0.0;                   // when inputs have kept a step short last
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
  double fastest_ = 0.0;  // in which time inputs have been found to change unnoticed; 0: none have
  std::array<double, InputSearch::most_nodes> nodes_{};
  bool has_slope_ = false;                        // at the start of the step
  std::vector<double> at_start_, change_, here_;  // (W x)' there, w held; its change up to the end; and elsewhere
  std::vector<double> changes_;                   // up to each node
};

}  // namespace sfdae::core
