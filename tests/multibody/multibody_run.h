// A multibody system through the C API, for tests: create, start, advance, with what goes wrong as words.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sfdae/sfdae.h"

namespace sfdae::test {

inline sfdae_multibody_problem multibody_problem_of(int positions, int constraints) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = positions;
  problem.num_constraints = constraints;
  return problem;
}

inline sfdae_options options_of(int method, double tol) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.method = method;
  options.rtol = options.atol = tol;
  return options;
}

class MultibodyRun {
 public:
  MultibodyRun(const sfdae_multibody_problem& problem, const sfdae_options& options) {
    sfdae_solver* created = nullptr;
    status = sfdae_create_multibody(&created, &problem, &options);
    solver.reset(created);
    const int nv = problem.num_velocities > 0 ? problem.num_velocities : problem.num_positions;
    const std::size_t n =
        static_cast<std::size_t>(problem.num_positions + nv + problem.num_constraints + problem.num_nonholonomic);
    x.assign(n, 0.0);
    xdot.assign(n, 0.0);
  }

  int start(double from, double toward, const std::vector<double>& x0) {
    x = x0;
    x.resize(xdot.size());
    t = from;
    return status = sfdae_start(solver.get(), from, toward, x.data(), xdot.data());
  }
  int advance(double tout) { return status = sfdae_advance(solver.get(), tout, &t, x.data(), xdot.data()); }
  std::string message() const { return sfdae_message(solver.get()); }

  sfdae_multibody_report report() const {
    sfdae_multibody_report result;
    sfdae_multibody_report_init(&result, sizeof result);
    sfdae_get_multibody_report(solver.get(), &result);
    return result;
  }
  sfdae_statistics statistics() const {
    sfdae_statistics result;
    sfdae_statistics_init(&result, sizeof result);
    sfdae_get_statistics(solver.get(), &result);
    return result;
  }
  sfdae_characteristics characteristics() const {
    sfdae_characteristics result;
    sfdae_characteristics_init(&result, sizeof result);
    sfdae_get_characteristics(solver.get(), &result);
    return result;
  }

  struct Destroy {
    void operator()(sfdae_solver* handle) const { sfdae_destroy(&handle); }
  };
  std::unique_ptr<sfdae_solver, Destroy> solver;
  int status = SFDAE_OK;
  double t = 0.0;
  std::vector<double> x, xdot;
};

}  // namespace sfdae::test
