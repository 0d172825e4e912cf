// Solvers of the modes of a system: while switches and discrete variables keep their values, its equations are a DAE
// of their own, with an index of its own.
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

// One mode, recorded. Discrete variables of types Real and Integer, and what is rounded of them, are parameters of the
// recording.
struct Mode : std::enable_shared_from_this<Mode> {
  Mode(sfdae::NonlinearProblem problem, const sfdae::Options& options_given)
      : solver(std::move(problem), options_given), options(options_given) {}

  sfdae::Solver solver;
  sfdae::Options options;          // in use
  std::vector<double> parameters;  // values in use
  bool has_dummy = false;          // the only unknown is none of the system, which has none

  // Makes the point consistent, components with a flag stay. What LibraryCalls::attempt expects.
  int make_consistent(sfdae::Point& point, const std::vector<int>& fixed);
};

class Modes {
 public:
  // options: tolerances and method. has_free: free parameters are unknowns after the others, constant ones.
  Modes(const System& system, const sfdae::Options& options, bool has_free);

  // The mode that the values say; its parameters are set.
  std::shared_ptr<Mode> at_values(const Values& values);

  int num_unknowns() const { return static_cast<int>(unknowns_.size()); }
  const std::vector<int>& unknowns() const { return unknowns_; }  // variables of the model; -1 for the dummy

  // Two sets of values that agree in this have the same equations.
  std::vector<double> equations_key(const Values& values);

  // Between the unknowns of the library and values.
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
  // Leaves: what is discrete and not recorded with its operands.
  std::vector<Formula> key_;         // those that decide which equations hold
  std::vector<Formula> parameters_;  // those that become parameters
  Tape leaves_;                      // key_, then parameters_
  std::map<std::vector<double>, std::shared_ptr<Mode>> modes_;
};

}  // namespace sfdae::cli
