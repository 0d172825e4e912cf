// What survives between calls of DGELDA or SFNDAE beside its documented outputs, in places of IWORK and RWORK that
// have no documented use:
//
//   IWORK(16)  says that this is a state        RWORK(5)   T where the integration started
//   IWORK(17)  checksum                         RWORK(6)   T as it was returned
//   IWORK(18)  phase, kind of E and A, METHOD   RWORK(8)   length of the first interval, with the sign of the direction
//                                               RWORK(10)  number of doubles from RWORK(21) on
//   RWORK(21...)  INFO(5)=1: E and A; then the system (before the integration) or system and integration
//
// All of it are plain numbers: arrays may be copied between calls.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "f77/call_options.h"
#include "integrate/checkpoint.h"

namespace sfdae::f77 {

struct Progress {
  bool is_running = false;  // else the integration has not started yet
  bool is_constant = false;
  double t_start = 0.0;
  double t_returned = 0.0;
  double span = 1.0;  // of the first call, with the sign of the direction
  double direction() const { return span < 0.0 ? -1.0 : 1.0; }
};

class CallState {
 public:
  explicit CallState(const Arguments& arguments) : arguments_(arguments) {}

  void invalidate();
  // code::bad_info if there is no intact state, code::bad_method if it is that of another METHOD.
  int load(Progress& progress) const;
  // matrices: E and A if they are constant. integration: null before its start. False if the state does not fit;
  // there is none then.
  bool save(const Progress& progress, const double* matrices, core::DaeSystem& system,
            core::Integration* integration);

  // Of the state loaded. The two latter throw core::Failure SFDAE_ILLEGAL_ARGUMENT or core::DamagedArchive.
  const double* matrices() const { return &arguments_.rwork(first_real); }
  void restore_system(core::Model& model, const core::ModelOptions& options, const Progress& progress) const;
  std::unique_ptr<core::Integration> restore(core::Model& model, const core::ModelOptions& model_options,
                                             const core::IntegrationOptions& options, const Progress& progress) const;

 private:
  static constexpr int first_real = 21;
  static constexpr int word = 16, sum = 17, kind = 18;                      // in IWORK
  static constexpr int t_start = 5, t_returned = 6, span = 8, length = 10;  // in RWORK
  std::size_t size_of_matrices(bool is_constant) const;
  std::size_t saved_length() const;
  std::int64_t checksum(std::size_t reals) const;

  const Arguments& arguments_;
};

}  // namespace sfdae::f77
