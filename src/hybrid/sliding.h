// Switches of a hybrid system: surfaces to which two modes lead, and the mode of motion along each of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "problem/parameter_derivatives.h"
#include "sfdae/hybrid.h"
#include "solver/solver.h"

namespace sfdae::core {

// Never moved: transitions point to it.
class Switch {
 public:
  struct Modes {
    int below, above, sliding;
  };
  // Throws Failure for modes that cannot be combined.
  Switch(const Modes& its_modes, Solver& below, Solver& above, std::shared_ptr<const Record> surface);

  const Modes& modes() const { return modes_; }
  Solver* solver() const { return solver_.get(); }  // of the sliding mode
  // For owners that need it even if it is replaced.
  const std::shared_ptr<Solver>& shared_solver() const { return solver_; }
  // Parameters by which derivatives are requested; "" and unknown names are ignored.
  using Names = std::vector<std::string>;
  // True if parameters of the modes have changed, or other derivatives are requested, since update().
  bool is_outdated(const Names& wanted) const;
  // Rebuilds the equations with a new solver. Throws Failure and then changes nothing.
  void update(const Names& wanted);
  // Identifies the formula g, including the present values of its parameters.
  double hash_of_surface() const;
  // Takes the present options and breakpoints of the solvers of the modes.
  void take_options();

  // g and its rate at a point; only g if xdot is null. False: it cannot be evaluated there.
  bool evaluate(double t, const double* x, const double* xdot, double* values);
  // True if the recorded surface itself has the parameter.
  bool has_parameter(const std::string& name) const;
  // Derivatives of the function of one of the four transitions by parameters, at constant t and x. Throws Failure.
  std::vector<double> change_by(const Names& parameters, sfdae_event_function function, double t, const double* x);
  // The four transitions: beyond the surface from below, from above; part of the mode above < 0, > 1.
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
  std::vector<double> parameters_;       // of both modes, as in the solver
  Names names_;                          // requested at the last update()
  std::unique_ptr<TaylorEvaluator> surface_;
  std::unique_ptr<ParameterDerivatives> surface_by_parameters_;
  std::shared_ptr<Solver> solver_;
  std::vector<double> jet_;
};

}  // namespace sfdae::core
