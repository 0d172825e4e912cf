// SPDX-License-Identifier: BSD-3-Clause
// Problems of all kinds as the C API takes them, with the interval and the guess that runs start from.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "linear_family.h"
#include "multibody/callbacks.h"
#include "multibody/recorded.h"
#include "sfdae/expression.hpp"
#include "sfdae/sfdae.h"

namespace sfdae_bench {

inline std::size_t size(int count) { return static_cast<std::size_t>(count); }

struct Problem {
  std::variant<sfdae_linear_problem, sfdae_nonlinear_problem, sfdae_multibody_problem> c;
  std::shared_ptr<void> owner;  // of what the callbacks use
  double t0 = 0.0, tf = 1.0;
  std::vector<double> x0 = {};

  int n() const;
  int create(sfdae_solver** solver, const sfdae_options* options) const;
  // What is wrong with it, in words.
  std::pair<int, std::string> check(const sfdae_options* options) const;

  sfdae_linear_problem& linear() { return std::get<sfdae_linear_problem>(c); }
  sfdae_nonlinear_problem& nonlinear() { return std::get<sfdae_nonlinear_problem>(c); }
  sfdae_multibody_problem& multibody() { return std::get<sfdae_multibody_problem>(c); }

  Problem on(double from, double to) const {
    Problem other = *this;
    other.t0 = from, other.tf = to;
    return other;
  }
  Problem from(std::vector<double> guess) const {
    Problem other = *this;
    other.x0 = std::move(guess);
    return other;
  }
};

// ---- Linear ----

// Writes the derivative of E, A or f, or of the prescribed values ('p').
using LinearFunction = std::function<int(char which, double t, int order, double* values)>;
Problem linear_problem(int m, int n, LinearFunction function, std::vector<int> prescribed = {});

using Family = std::shared_ptr<const sfdae_test::LinearFamily>;
// Runs after the values were written and may change them; what it returns is returned.
using Interference = std::function<int(char which, double t, int order, double* values)>;
// Starts at the exact solution, or at ones.
Problem family_problem(const Family& family, double t0, double tf, const Interference& interference = nullptr,
                       std::vector<int> prescribed = {});
Problem constant_family_problem(const Family& family, double t0, double tf);

// ---- Nonlinear ----

using sfdae::Expression;
using RecordedFunction = std::function<void(sfdae_record*, const Expression& t, const Expression* x,
                                            const Expression* xdot, Expression* F)>;
Problem recorded_problem(int m, int n, RecordedFunction function, std::vector<int> differentiations = {},
                         std::vector<int> prescribed = {}, std::function<double(double t)> value = nullptr);

// residual(t, x, xdot, F) for any scalar type.
template <class Residual>
Problem recorded(int m, int n, Residual residual, std::vector<int> differentiations = {}) {
  return recorded_problem(
      m, n,
      [residual](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
        residual(t, x, xdot, F);
      },
      std::move(differentiations));
}

// F and its Jacobians along a jet, as sfdae_total_derivative_function.
using TotalDerivative =
    std::function<int(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot)>;
Problem derivative_problem(int m, int n, TotalDerivative function);

// ---- Multibody ----

enum class Form { recorded, callbacks, general, extended };

// Multipliers start at zero. general: F(t, x, x') = 0; extended: differentiated only as far as necessary.
template <class System>
Problem mechanical_problem(const System& system, Form form, double t0, double tf, std::vector<double> guess,
                           int coordinates = SFDAE_COORDINATES_ORTHOGONAL) {
  struct Owner {
    System system;
    std::vector<int> differentiations;
  };
  auto owner = std::make_shared<Owner>(Owner{system, sfdae_test::differentiations(system.sizes)});
  const sfdae_test::SystemSizes& s = system.sizes;
  guess.resize(size(s.unknowns()), 0.0);
  Problem problem{sfdae_multibody_problem{}, owner, t0, tf, std::move(guess)};
  if (form == Form::recorded || form == Form::callbacks) {
    sfdae_multibody_problem& c = problem.multibody();
    sfdae_multibody_problem_init(&c, sizeof c);
    c.num_positions = s.positions;
    c.num_constraints = s.holonomic;
    c.num_nonholonomic = s.nonholonomic;
    c.coordinates = coordinates;
    if (form == Form::recorded) c.equations = &sfdae_test::RecordedMultibody<System>::multibody;
    else sfdae_test::MultibodyCallbacks<System>::fill(owner->system, c);
    c.user = &owner->system;
    return problem;
  }
  sfdae_nonlinear_problem c;
  sfdae_nonlinear_problem_init(&c, sizeof c);
  c.num_equations = c.num_unknowns = s.unknowns();
  c.equations = &sfdae_test::RecordedMultibody<System>::general;
  if (form == Form::extended) c.differentiations = owner->differentiations.data();
  c.user = &owner->system;
  problem.c = c;
  return problem;
}

sfdae_options options_of(int method = SFDAE_METHOD_BDF, double tol = 1e-6);
inline const char* name_of(int method) {
  return method == SFDAE_METHOD_BDF ? "bdf" : method == SFDAE_METHOD_RADAU ? "radau" : "automatic";
}

}  // namespace sfdae_bench
