// Many runs of a model with different values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "program/names.h"

namespace sfdae::cli {

// All combinations of values; the last assignment varies fastest.
class Grid {
 public:
  // Throws ProgramError if there are too many combinations.
  explicit Grid(std::vector<ParameterChoice> assignments);
  std::size_t count() const { return count_; }
  const std::vector<ParameterChoice>& assignments() const { return assignments_; }
  // Values of one combination, in the order of the assignments.
  std::vector<double> values(std::size_t instance) const;

 private:
  std::vector<ParameterChoice> assignments_;
  std::size_t count_ = 1;
};

// The instances that one of several processes computes: every size-th, from rank on.
struct Share {
  std::size_t rank = 0, size = 1;
};

// The share from the environment that mpirun (Open MPI, MPICH) or srun sets; else all instances.
Share share_of_process();

struct Instance {
  std::size_t number = 0;  // counts from 0
  std::vector<double> given;
  Outcome outcome = Outcome::stopped;
  int status = 0;
  std::string message;
  std::vector<std::string> warnings;
  long steps = 0;
  Trajectory trajectory;  // only the selected variables
};

using SolveInstance = std::function<Instance(std::size_t number)>;

// The instances of the share, ordered by number. Threads take them one by one; each result depends on its number only.
// `finished` is called with the number of completed instances, by one thread at a time. After an interruption,
// instances that have not been started are left out.
std::vector<Instance> run_sweep(std::size_t count, Share share, int jobs, const SolveInstance& solve_instance,
                                const std::function<void(std::size_t)>& finished);

}  // namespace sfdae::cli
