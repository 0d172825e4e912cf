// SPDX-License-Identifier: BSD-3-Clause
// Mechanical systems solved through the C API: as multibody systems, recorded or by callbacks, and as general
// problems.
#ifndef SFDAE_TESTS_MULTIBODY_RUN_H
#define SFDAE_TESTS_MULTIBODY_RUN_H

#include <algorithm>
#include <string>
#include <vector>

#include "callbacks.h"
#include "linear_family.h"
#include "recorded.h"
#include "sfdae/sfdae.h"

namespace sfdae_test {

// general: the whole derivative array of F(t, x, x') = 0; extended: only what has to be differentiated of it.
enum class MultibodyForm { recorded, callbacks, general, extended };

inline sfdae_options multibody_options(double tolerance, int method) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tolerance;
  options.method = method;
  options.max_steps = 1000000;
  return options;
}

// A solver of one system with the point that it has reached. The system has to live as long.
template <class System>
class MultibodyRun {
 public:
  MultibodyRun(const System& system, MultibodyForm form, const sfdae_options& options,
               int coordinates = SFDAE_COORDINATES_ORTHOGONAL) {
    const bool is_general = form == MultibodyForm::general || form == MultibodyForm::extended;
    created = is_general ? create_general(system, form, options) : create(system, form, options, coordinates);
    x.resize(static_cast<std::size_t>(system.sizes.unknowns()));
    xdot.resize(x.size());
  }
  ~MultibodyRun() { sfdae_destroy(&solver_); }
  MultibodyRun(const MultibodyRun&) = delete;
  MultibodyRun& operator=(const MultibodyRun&) = delete;

  // Multipliers that are not in the guess are zero.
  int start(double t0, double toward, const std::vector<double>& guess) {
    t = t0;
    std::fill(x.begin(), x.end(), 0.0);
    std::copy_n(guess.begin(), std::min(guess.size(), x.size()), x.begin());
    return sfdae_start(solver_, t, toward, x.data(), xdot.data());
  }
  int advance(double tout) { return sfdae_advance(solver_, tout, &t, x.data(), xdot.data()); }
  int integrate(double t0, double tf, const std::vector<double>& guess) {
    const int status = start(t0, tf, guess);
    return status < 0 ? status : advance(tf);
  }

  CharacteristicValues values() const {
    sfdae_characteristics c;
    sfdae_characteristics_init(&c, sizeof c);
    if (sfdae_get_characteristics(solver_, &c) < 0) return {-1, -1, -1, -1, -1};
    return {c.strangeness_index, c.differential, c.algebraic, c.undetermined, c.redundant};
  }
  sfdae_statistics statistics() const {
    sfdae_statistics statistics;
    sfdae_statistics_init(&statistics, sizeof statistics);
    sfdae_get_statistics(solver_, &statistics);
    return statistics;
  }
  sfdae_multibody_report report() const {
    sfdae_multibody_report report;
    sfdae_multibody_report_init(&report, sizeof report);
    sfdae_get_multibody_report(solver_, &report);
    return report;
  }
  std::string text(int status) const {
    return std::string(sfdae_status_name(status)) + ": " + sfdae_message(solver_);
  }
  sfdae_solver* solver() { return solver_; }

  int created = 0;
  double t = 0.0;
  std::vector<double> x, xdot;

 private:
  int create(const System& system, MultibodyForm form, const sfdae_options& options, int coordinates) {
    sfdae_multibody_problem problem;
    sfdae_multibody_problem_init(&problem, sizeof problem);
    problem.num_positions = system.sizes.positions;
    problem.num_constraints = system.sizes.holonomic;
    problem.num_nonholonomic = system.sizes.nonholonomic;
    problem.coordinates = coordinates;
    if (form == MultibodyForm::recorded) problem.equations = &RecordedMultibody<System>::multibody;
    else MultibodyCallbacks<System>::fill(system, problem);
    problem.user = const_cast<System*>(&system);
    return sfdae_create_multibody(&solver_, &problem, &options);
  }
  int create_general(const System& system, MultibodyForm form, const sfdae_options& options) {
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = system.sizes.unknowns();
    problem.equations = &RecordedMultibody<System>::general;
    const std::vector<int> counts = differentiations(system.sizes);
    if (form == MultibodyForm::extended) problem.differentiations = counts.data();
    problem.user = const_cast<System*>(&system);
    return sfdae_create_nonlinear(&solver_, &problem, &options);
  }

  sfdae_solver* solver_ = nullptr;
};

}  // namespace sfdae_test

#endif
