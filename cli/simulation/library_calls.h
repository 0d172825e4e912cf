// Calls of the library that can be stopped by the progress callback, with messages in terms of the model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "simulation/failure.h"
#include "simulation/modes.h"

namespace sfdae::cli {

enum class Phase { analysis, initialization, integration };

class LibraryCalls {
 public:
  LibraryCalls(const System& system, const Settings& settings) : system_(system), settings_(settings) {}

  // Returns the status of a call of the mode's solver, including failures; message() explains it. Throws Failure if the
  // progress callback stops it, or if the library rejects the arguments.
  int attempt(Mode& mode, const std::function<int()>& call);

  // The same, but throws Failure for all failures. where: description of the action, for the message.
  int run(Mode& mode, Phase phase, const std::string& where, const std::function<int()>& call);

  const std::string& message() const { return message_; }

  // The mode of the last call; nullptr before.
  const std::shared_ptr<Mode>& last_mode() const { return last_mode_; }

  // Throws Failure if the progress callback requests a stop.
  void check_stop(double t, double h, int order) const;

  // A text of the library with names of unknowns in place of numbers. Equation numbers are omitted; equations are
  // identified by their lines in the file (Modes::recorded).
  std::string translated(const std::string& given) const;

  // Sets the unknowns of the modes in use.
  void set_unknowns(const std::vector<int>& unknowns) { unknowns_ = unknowns; }

 private:
  std::string with_relations(const std::string& text) const;
  int run_while_polling(Mode& mode, const std::function<int()>& call);

  const System& system_;
  const Settings& settings_;
  std::vector<int> unknowns_;
  std::string message_;
  std::shared_ptr<Mode> last_mode_;
};

Outcome outcome_of(int status, Phase phase);

}  // namespace sfdae::cli
