// Solvers for the modes of a system: for fixed values of switches and discrete variables, its equations are a DAE with
// an index of its own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "simulation/simulation.h"
#include "simulation/tape.h"

namespace sfdae::cli {

// One mode, recorded. Discrete variables of types Real and Integer, and integer parts of them, are parameters of the
// recording.
struct Mode : std::enable_shared_from_this<Mode> {
  Mode(sfdae::NonlinearProblem problem, const sfdae::Options& options_given)
      : solver(std::move(problem), options_given), options(options_given) {}

  sfdae::Solver solver;
  sfdae::Options options;          // in use
  std::vector<double> parameters;  // values in use
  bool has_dummy = false;          // the system has no unknowns; a dummy is the only one

  // Makes the point consistent; flagged components are fixed. A call for LibraryCalls::attempt.
  int make_consistent(sfdae::Point& point, const std::vector<int>& fixed);
};

class Modes {
 public:
  // options: tolerances and method. has_free: free parameters become constant unknowns, after the others.
  Modes(const System& system, const sfdae::Options& options, bool has_free);

  // The mode that belongs to the values, with its parameters set.
  std::shared_ptr<Mode> at_values(const Values& values);

  int num_unknowns() const { return static_cast<int>(unknowns_.size()); }
  const std::vector<int>& unknowns() const { return unknowns_; }  // variables of the model; -1 for the dummy

  // Key of the equations: values with equal keys have the same equations.
  std::vector<double> equations_key(const Values& values);

  // Conversion between the unknowns of the library and values.
  void to_values(const sfdae::Point& point, Values& values) const;
  void to_point(const Values& values, sfdae::Point& point) const;

 private:
  std::shared_ptr<Mode> recorded(const Values& values, const std::vector<double>& leaves) const;
  bool is_parameter(Formula formula, bool is_calculated_with, bool is_whole) const;
  std::string parameter_name(Formula formula) const;

  const System& system_;
  sfdae::Options options_;
  bool has_free_;
  std::vector<int> unknowns_;
  // Leaves: discrete formulas that are not recorded with their operands.
  std::vector<Formula> key_;         // leaves that decide which equations hold
  std::vector<Formula> parameters_;  // leaves that become parameters
  Tape leaves_;                      // key_, then parameters_
  std::map<std::vector<double>, std::shared_ptr<Mode>> modes_;
};

}  // namespace sfdae::cli
