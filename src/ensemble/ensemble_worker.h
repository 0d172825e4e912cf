// Worker of an ensemble: solves instances one after the other with its own solver on the shared recording.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sfdae/ensemble.h"
#include "solver/solver.h"

namespace sfdae::core {

// Ensemble task after all checks: the public structs in their current version.
struct EnsembleTask {
  const sfdae_ensemble& ensemble;
  const sfdae_ensemble_results& results;
  std::vector<int> parameters;  // indices of the parameters that differ
};

struct InstanceOutcome {
  int status = SFDAE_OK;
  int outputs = 0;
  int analyses = 0;  // complete analyses, without a precedent
  char message[1536] = "";
};

class EnsembleWorker {
 public:
  // The prototype only provides equations, options, parameters and stop requests. Throws std::bad_alloc.
  EnsembleWorker(Solver& prototype, const EnsembleTask& task);

  // Writes the outputs of the instance. Instances solved before have no influence.
  InstanceOutcome solve(int instance, const Precedent& precedent) noexcept;
  // Analysis of the instance as a precedent; mu = -1 if the analysis fails.
  Precedent analyze(int instance) noexcept;

 private:
  // False, with an outcome, if values are not finite.
  bool set_parameters(int instance, InstanceOutcome& outcome);
  void solve_once(int instance, InstanceOutcome& outcome);
  // True if the present analysis is based on the precedent.
  bool is_precedented() const { return solver_.system() != nullptr && solver_.system()->analysis().by_precedent; }
  void write_outputs(int instance, int count) const;
  // Runs a call of the solver and stores its message in the outcome; true if the instance continues.
  template <class Body>
  bool goes_on_after(Body body, InstanceOutcome& outcome);

  const EnsembleTask& task_;
  Solver solver_;
  std::vector<double> x_, xdot_;
  std::vector<double> outputs_, slopes_;  // n x K: outputs of one instance until they are final
};

}  // namespace sfdae::core
