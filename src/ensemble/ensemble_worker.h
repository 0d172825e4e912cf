// One of those who solve the instances of an ensemble, one after the other: a solver of its own on the shared
// recording.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sfdae/ensemble.h"
#include "solver/solver.h"

namespace sfdae::core {

// An ensemble after all checks: the public structs as they are now.
struct EnsembleTask {
  const sfdae_ensemble& ensemble;
  const sfdae_ensemble_results& results;
  std::vector<int> parameters;  // indices of those that differ
};

struct InstanceOutcome {
  int status = SFDAE_OK;
  int outputs = 0;
  int analyses = 0;  // made from the beginning
  char message[1536] = "";
};

class EnsembleWorker {
 public:
  // The prototype only lends its equations, options and parameters, and its requests to stop. Throws std::bad_alloc.
  EnsembleWorker(Solver& prototype, const EnsembleTask& task);

  // Writes the outputs of the instance. What it did before does not matter.
  InstanceOutcome solve(int instance, const Precedent& precedent) noexcept;
  // Of the instance; mu = -1 if its analysis fails.
  Precedent analyze(int instance) noexcept;

 private:
  // False, with an outcome, if values are not finite.
  bool set_parameters(int instance, InstanceOutcome& outcome);
  void solve_once(int instance, InstanceOutcome& outcome);
  // Whether the analysis in use is one by precedent.
  bool is_precedented() const { return solver_.system() != nullptr && solver_.system()->analysis().by_precedent; }
  void write_outputs(int instance, int count) const;
  // Runs a call of the solver. What it says goes into the outcome; true if the instance goes on.
  template <class Body>
  bool goes_on_after(Body body, InstanceOutcome& outcome);

  const EnsembleTask& task_;
  Solver solver_;
  std::vector<double> x_, xdot_;
  std::vector<double> outputs_, slopes_;  // n x K: of an instance, until it is known that they stay
};

}  // namespace sfdae::core
