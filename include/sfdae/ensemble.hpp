// SPDX-License-Identifier: BSD-3-Clause

// Ensembles for C++17 and later: input and results of Solver::solve_ensemble; see sfdae_solve_ensemble for their
// meaning. Included by sfdae.hpp.
#ifndef SFDAE_ENSEMBLE_HPP
#define SFDAE_ENSEMBLE_HPP

#include <sfdae/sfdae.h>
#include <sfdae/problem.hpp>
#include <sfdae/results.hpp>

#include <cstddef>
#include <exception>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace sfdae {

using EnsembleProgress = sfdae_ensemble_progress;

/// Called when an instance has ended, by any of the threads but never by two at a time; true stops all. An exception
/// stops all, too, and is passed on.
using EnsembleMonitor = std::function<bool(const EnsembleProgress&)>;

/// N instances of a problem with n unknowns, see sfdae_ensemble.
struct Ensemble {
  std::vector<std::string> parameter_names;  ///< those that differ between instances
  Matrix parameters;                         ///< one row for each name, N columns
  double t0 = 0;
  Matrix x0;                  ///< n x N start values
  Matrix xdot0;               ///< empty, or n x N guesses of x', for the option xdot_is_guess
  std::vector<double> times;  ///< of the outputs
  bool wants_xdot = false;    ///< x' at the outputs, too
  int threads = 0;            ///< 0: as many as there are processors
  EnsembleMonitor monitor;
};

/// The outputs of an ensemble and how its instances have ended.
class EnsembleSolution {
 public:
  EnsembleSolution(int unknowns, int outputs, int instances, bool has_xdot)
      : statuses(count(instances)),
        num_outputs(count(instances)),
        messages(count(instances)),
        unknowns_(unknowns),
        outputs_(outputs),
        x_(count(unknowns) * count(outputs) * count(instances), std::numeric_limits<double>::quiet_NaN()),
        xdot_(has_xdot ? x_.size() : 0, std::numeric_limits<double>::quiet_NaN()) {}

  /// n values at an output of an instance, both from 0; NaN where it was not reached.
  ConstVectorRef x(int instance, int output) const { return {x_.data() + place(instance, output), unknowns_}; }
  /// The same for x', which must have been requested.
  ConstVectorRef xdot(int instance, int output) const { return {xdot_.data() + place(instance, output), unknowns_}; }
  /// All of them, n x outputs x instances.
  std::vector<double>& x() noexcept { return x_; }
  std::vector<double>& xdot() noexcept { return xdot_; }

  int status = SFDAE_OK;              ///< SFDAE_OK, SFDAE_INSTANCES_FAILED or SFDAE_STOPPED
  std::vector<int> statuses;          ///< of the instances
  std::vector<int> num_outputs;       ///< that they have reached
  std::vector<std::string> messages;  ///< about their statuses
  int num_failed = 0, num_analyses = 0, num_threads = 0;

 private:
  static std::size_t count(int number) noexcept { return static_cast<std::size_t>(number < 0 ? 0 : number); }
  std::size_t place(int instance, int output) const noexcept {
    return (count(instance) * count(outputs_) + count(output)) * count(unknowns_);
  }

  int unknowns_, outputs_;
  std::vector<double> x_, xdot_;
};

namespace detail {

/// The `user` object of the monitor in C.
struct EnsembleMonitorState {
  const EnsembleMonitor& monitor;
  std::exception_ptr exception;
};

inline int call_ensemble_monitor(const sfdae_ensemble_progress* progress, void* user) noexcept {
  EnsembleMonitorState& state = *static_cast<EnsembleMonitorState*>(user);
  try {
    return state.monitor(*progress) ? 1 : 0;
  } catch (...) {
    state.exception = std::current_exception();
    return 1;
  }
}

}  // namespace detail

}  // namespace sfdae

#endif
