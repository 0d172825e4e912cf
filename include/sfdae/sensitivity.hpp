// SPDX-License-Identifier: BSD-3-Clause

// Sensitivities for C++17 and later: input and results of Solver::set_sensitivities; see sensitivity.h for their
// meaning. Included by sfdae.hpp.
#ifndef SFDAE_SENSITIVITY_HPP
#define SFDAE_SENSITIVITY_HPP

#include <sfdae/sfdae.h>
#include <sfdae/results.hpp>

#include <string>
#include <vector>

namespace sfdae {

using SensitivityStatistics = sfdae_sensitivity_statistics;

/// The requested derivatives of the solution, see sfdae_set_sensitivities.
struct Sensitivities {
  std::vector<std::string> parameters;  ///< one for each column; "": in initial values alone
  Matrix directions;                    ///< empty, or n x parameters.size(): derivatives of the guess of x
  bool error_test = false;
  std::vector<double> scales;  ///< empty, or one for each parameter
  bool adjoint = false;        ///< steps are stored for Solver::gradient instead
  long max_kept_steps = 0;  ///< with the adjoint: at most so many at a time, earlier ones are computed again; 0: all
};

/// S = dx/dp and S' at a point: n rows, one column for each parameter.
struct SensitivityValues {
  Matrix S, Sdot;
};

}  // namespace sfdae

#endif
