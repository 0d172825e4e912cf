// Surfaces that two modes of a hybrid system lead to, and the mode of the motion along each of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "problem/parameter_derivatives.h"
#include "sfdae/hybrid.h"
#include "solver/solver.h"

namespace sfdae::core {

// Does not move: transitions point to it.
class Switch {
 public:
  struct Modes {
    int below, above, sliding;
  };
  // Throws Failure for modes that cannot be combined.
  Switch(const Modes& its_modes, Solver& below, Solver& above, std::shared_ptr<const Record> surface);

  const Modes& modes() const { return modes_; }
  Solver* solver() const { return solver_.get(); }  // of the sliding mode
  // For those that need it although it may be replaced.
  const std::shared_ptr<Solver>& shared_solver() const { return solver_; }
  // Names of parameters by which derivatives are wanted; "" and names that there are not count for nothing.
  using Names = std::vector<std::string>;
  // The modes have other values of parameters than its equations, or these have not the parameters that are wanted.
  bool is_outdated(const Names& wanted) const;
  // Makes them anew, with a new solver. Throws Failure, and nothing has changed then.
  void update(const Names& wanted);
  // Tells formulas g apart, with the values that their parameters have now.
  double hash_of_surface() const;
  // Options and breakpoints become those that the solvers of the modes have now.
  void take_options();

  // g and its rate at a point; xdot may be null, then g alone. False: it cannot be evaluated there.
  bool evaluate(double t, const double* x, const double* xdot, double* values);
  // Of the record of the surface, whatever the modes have.
  bool has_parameter(const std::string& name) const;
  // Derivatives of the function of one of the four transitions by parameters, t and x staying as they are. Throws
  // Failure.
  std::vector<double> change_by(const Names& parameters, sfdae_event_function function, double t, const double* x);
  // Of the four transitions: beyond the surface from below, from above; the part of the mode above below 0, above 1.
  static sfdae_event_function condition(int k);

 private:
  static int leaves_below(double t, const double* x, const double*, double* g, void* user);
  static int leaves_above(double t, const double* x, const double*, double* g, void* user);
  static int part_is_negative(double, const double* x, const double*, double* g, void* user);
  static int part_exceeds_one(double, const double* x, const double*, double* g, void* user);
  int n() const { return given_->n(); }
  std::vector<double> values_of_parameters() const;

  Modes modes_;
  Solver &below_, &above_;
  std::shared_ptr<const Record> given_;  // the surface, with parameters
  std::vector<double> parameters_;       // of both modes, as the solver has them
  Names names_;                          // that were wanted
  std::unique_ptr<TaylorEvaluator> surface_;
  std::unique_ptr<ParameterDerivatives> surface_by_parameters_;
  std::shared_ptr<Solver> solver_;
  std::vector<double> jet_;
};

}  // namespace sfdae::core
