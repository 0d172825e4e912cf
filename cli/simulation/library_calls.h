// Calls of the library that progress can stop, with messages in the words of the model.
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

  // The status of a call of the mode's solver, failures included; message() then says why. Throws Failure if progress
  // stops it, or if what was asked for makes no sense to the library.
  int attempt(Mode& mode, const std::function<int()>& call);

  // The same, but throws Failure for all failures. where: what was done, for the message.
  int run(Mode& mode, Phase phase, const std::string& where, const std::function<int()>& call);

  const std::string& message() const { return message_; }

  // The mode of the last call; nullptr before.
  const std::shared_ptr<Mode>& last_mode() const { return last_mode_; }

  // Throws Failure if progress says so.
  void check_stop(double t, double h, int order) const;

  // A text of the library with names of unknowns in place of numbers; it has the lines of equations (Modes::recorded),
  // whose numbers are left out.
  std::string translated(const std::string& given) const;

  // The unknowns of the modes in use.
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
