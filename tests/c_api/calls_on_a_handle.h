// Calls of the library on one handle, for sequences of them (failing_allocations.h). Problems go from t = 0 to 1.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "failing_allocations.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {

inline void run_with_faults(const Sequence& sequence) {
  FaultRun run(sequence);
  const FaultRun::Counts& counts = run.run(stride_of_faults(500));
  std::printf("%s: %ld faults, %ld refused, %ld compared, %ld differing, at most by %.2g\n", sequence.name.c_str(),
              counts.injected, counts.refused, counts.compared, counts.differing, counts.largest_difference);
}

using Create = int (*)(sfdae_solver**, const sfdae_options&);

inline Call create_call(Create create, const sfdae_options& options) {
  return {"create", [create, options](Session& s) { return armed([&] { return create(&s.solver, options); }); }};
}

// Creates a solver of n recorded equations.
inline int create_recorded(sfdae_solver** solver, const sfdae_options& options, int n,
                           sfdae_equations_function equations, const char* const* names = nullptr) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = n;
  problem.equations = equations;
  problem.equation_names = names;
  return sfdae_create_nonlinear(solver, &problem, &options);
}

inline sfdae_options options_of(int method, double tol) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.method = method;
  options.rtol = options.atol = tol;
  options.max_index = 3;
  options.max_stages = 5;
  return options;
}

inline int waves(double t, const double* x, const double* xdot, double* g, void*) {
  g[0] = std::cos(12.0 * t);
  g[1] = x[0] - 0.1 * xdot[0] - 10.0;
  return 0;
}

inline void keep_point(Session& s) {
  s.result.assign(1, s.t);
  s.result.insert(s.result.end(), s.x.begin(), s.x.end());
  s.result.insert(s.result.end(), s.xdot.begin(), s.xdot.end());
}

inline Call set_options(const std::string& name, const sfdae_options& options) {
  return {name, [options](Session& s) { return armed([&] { return sfdae_set_options(s.solver, &options); }); }};
}

inline Call start(const std::string& name, std::vector<double> guess) {
  return {name, [guess = std::move(guess)](Session& s) {
            std::vector<double> x = guess, xdot(guess.size(), 0.0);
            const int status = armed([&] { return sfdae_start(s.solver, 0.0, 1.0, x.data(), xdot.data()); });
            if (status < 0) {
              EXPECT_EQ(x, guess);
              return status;
            }
            s.t = 0.0, s.x = x, s.xdot = xdot;
            keep_point(s);
            return status;
          }};
}

inline Call advance(const std::string& name, double tout) {
  return {name,
          [tout](Session& s) {
            const int status = armed([&] { return sfdae_advance(s.solver, tout, &s.t, s.x.data(), s.xdot.data()); });
            if (status >= 0) keep_point(s);
            return status;
          },
          true};
}

inline Call advance_without_slopes(const std::string& name, double tout) {
  return {name,
          [tout](Session& s) {
            const int status = armed([&] { return sfdae_advance(s.solver, tout, &s.t, s.x.data(), nullptr); });
            if (status >= 0) s.result = s.x;
            return status;
          },
          true};
}

inline Call step(const std::string& name) {
  return {name,
          [](Session& s) {
            const int status = armed([&] { return sfdae_step(s.solver, 1.0, &s.t, s.x.data(), s.xdot.data()); });
            if (status >= 0) keep_point(s);
            return status;
          },
          true};
}

inline Call set_events(const std::string& name, int count) {
  return {name, [count](Session& s) {
            return armed([&] { return sfdae_set_events(s.solver, count, waves, nullptr, nullptr); });
          }};
}

inline Call analyze(const std::vector<double>& guess, bool needs_x) {
  return {"analyze", [x = guess, needs_x](Session& s) {
            sfdae_characteristics c;
            sfdae_characteristics_init(&c, sizeof c);
            const int status = armed([&] {
              return needs_x ? sfdae_analyze_at(s.solver, 0.0, 1.0, x.data(), &c)
                             : sfdae_analyze(s.solver, 0.0, 1.0, &c);
            });
            s.result = {1.0 * c.strangeness_index, 1.0 * c.differential, 1.0 * c.algebraic};
            return status;
          }};
}

Call make_consistent(const std::vector<double>& near) {
  return {"make consistent", [guess = near](Session& s) {
            std::vector<double> x = guess, xdot(guess.size(), 0.0);
            const int status = armed([&] { return sfdae_make_consistent(s.solver, 0.0, x.data(), xdot.data()); });
            s.result = x;
            s.result.insert(s.result.end(), xdot.begin(), xdot.end());
            return status;
          }};
}

// new_values: whether ranks at the point are beyond doubt.
inline Call get_change(bool new_values = true) {
  return {"get change", [new_values](Session& s) {
            sfdae_change change;
            sfdae_change_init(&change, sizeof change);
            const int status = armed([&] { return sfdae_get_change(s.solver, &change); });
            s.result = {change.t, new_values ? change.new_differential : 0.0};
            return status;
          }};
}

inline Call interpolate() {
  return {"interpolate", [](Session& s) {
            sfdae_statistics c;
            sfdae_statistics_init(&c, sizeof c);
            sfdae_get_statistics(s.solver, &c);
            std::vector<double> x(s.x.size()), xdot(x);
            const int status = armed(
                [&] { return sfdae_interpolate(s.solver, c.t_internal - 0.3 * c.last_step, x.data(), xdot.data()); });
            s.result = x;
            s.result.insert(s.result.end(), xdot.begin(), xdot.end());
            return status;
          }};
}

inline Call report() {
  return {"report", [](Session& s) {
            std::vector<char> text(20000);
            return armed([&] { return sfdae_report(s.solver, text.data(), text.size(), nullptr); });
          }};
}

inline std::vector<Call> checkpoint_calls() {
  return {{"checkpoint length",
           [](Session& s) {
             std::size_t length = 0;
             const int status = armed([&] { return sfdae_get_checkpoint_length(s.solver, &length); });
             if (status >= 0) s.checkpoint.assign(length, 0.0);
             return status;
           }},
          {"save", [](Session& s) {
             return armed([&] { return sfdae_save_checkpoint(s.solver, s.checkpoint.data(), s.checkpoint.size()); });
           }}};
}

inline Call restore() {
  return {
      "restore", [](Session& s) {
        return armed([&] { return sfdae_restore_checkpoint(s.solver, s.checkpoint.data(), s.checkpoint.size()); });
      }};
}

}  // namespace sfdae::test
