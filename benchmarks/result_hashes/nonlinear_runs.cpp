// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear problems: formulas, the test set over shorter intervals, random systems, small difficult ones.
#include <cmath>
#include <string>

#include "../../tests/nonlinear/random_system.h"
#include "dual_jet.h"
#include "session.h"
#include "test_set/formula_problems.h"
#include "test_set/test_set.h"

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};

void add(Runs& runs, const std::string& name, const Problem& problem, const sfdae_options& options,
         const Plan& plan = {}) {
  runs.push_back({name, [=](Trace& trace) { solve(trace, problem, options, plan); }});
}

void add_formulas(Runs& runs) {
  for (const FormulaProblem& p : formula_problems()) {
    const TestProblem& data = p.data;
    const Problem problem =
        recorded(data.m, data.n,
                 [&p](const auto& t, const auto* x, const auto* xdot, auto* F) { p.residual(t, x, xdot, F); })
            .on(data.t0, data.t0 + std::min(data.tf - data.t0, 2.0))
            .from(data.x0);
    for (const int method : methods) {
      sfdae_options options = options_of(method, method == SFDAE_METHOD_RADAU ? 1e-8 : 1e-6);
      if (method == SFDAE_METHOD_AUTOMATIC) options.reduction = SFDAE_REDUCTION_SVD;
      add(runs, "formula_" + data.name + "_" + name_of(method), problem, options,
          {.outputs = 3, .checkpoint = method == SFDAE_METHOD_BDF, .events = method == SFDAE_METHOD_RADAU});
    }
  }
}

void add_test_set(Runs& runs) {
  for_each_problem_of_test_set([&runs](const TestProblem& p, auto equations) {
    const bool is_large = p.n > 100;
    const double length = p.tf - p.t0, share = is_large ? 1e-5 : p.n > 20 ? 0.05 : 0.1;
    const Problem problem = recorded(p.m, p.n,
                                     [equations](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                       equations(0, t, x, xdot, F);
                                     })
                                .on(p.t0, p.t0 + share * length)
                                .from(p.x0);
    for (const int method : methods) {
      if (is_large && method != SFDAE_METHOD_BDF) continue;
      add(runs, "test_set_" + p.name + "_" + name_of(method), problem,
          options_of(method, method == SFDAE_METHOD_RADAU ? 1e-7 : 1e-5), {.outputs = 2, .checkpoint = !is_large});
    }
  });
}

// The same recorded and by callbacks, the latter also with derivatives above the index missing.
template <class Residual>
void add_derivatives(Runs& runs, const TestProblem& p, double tf, Residual residual) {
  const TotalDerivative all = total_derivative(p.m, p.n, residual);
  const int mu = p.values.mu;
  const Problem whole = derivative_problem(p.m, p.n, all).on(p.t0, tf).from(p.x0);
  const Problem few =
      derivative_problem(p.m, p.n,
                         [=](double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot) {
                           if (order > mu) return SFDAE_ORDER_NOT_AVAILABLE;
                           return all(t, order, derivatives, F, F_x, F_xdot);
                         })
          .on(p.t0, tf)
          .from(p.x0);
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    add(runs, "derivatives_" + p.name + "_" + name_of(method), whole, options_of(method),
        {.checkpoint = true, .events = true});
    add(runs, "derivatives_few_" + p.name + "_" + name_of(method), few, options_of(method), {.outputs = 2});
  }
}

void add_total_derivatives(Runs& runs) {
  const auto of = [&runs](const TestProblem& p, double tf, auto residual) { add_derivatives(runs, p, tf, residual); };
  of(pendulum(), 1.0, [](const auto& t, auto... a) { pendulum_residual(t, a...); });
  of(car_axis(), 0.5, [](const auto& t, auto... a) { car_axis_residual(t, a...); });
  of(akzo(), 2.0, [](const auto& t, auto... a) { akzo_residual(t, a...); });
  of(transistor_amplifier(), 0.01, [](const auto& t, auto... a) { transistor_amplifier_residual(t, a...); });
  of(rigid_slider_crank(), 0.5, [](const auto& t, auto... a) { rigid_slider_crank_residual(t, a...); });
}

void add_random_systems(Runs& runs) {
  for (unsigned seed = 1; seed <= 36; ++seed) {
    const RandomSystem system(RandomSystem::random_shape(seed), seed);
    std::vector<double> x, xdot;
    system.exact(0.0, x, xdot);
    if (seed % 3 == 0)
      for (double& value : x) value += 0.01;
    const auto residual = [system](const auto& t, const auto* u, const auto* udot, auto* F) {
      system.residual(t, u, udot, F);
    };
    const int method = methods[seed % 3];
    add(runs, "random_system_" + std::to_string(seed),
        recorded(system.m(), system.n(), residual).on(0.0, 1.0).from(x),
        options_of(method, seed % 2 == 0 ? 1e-6 : 1e-9),
        {.outputs = 2, .by_steps = seed % 5 == 0, .checkpoint = seed % 4 == 0, .events = seed % 6 == 0});
    if (seed % 6 == 1) {
      sfdae_options svd = options_of(method, 1e-6);
      svd.reduction = SFDAE_REDUCTION_SVD;
      add(runs, "random_system_svd_" + std::to_string(seed),
          recorded(system.m(), system.n(), residual).on(0.0, 0.5).from(x), svd);
    }
  }
}

template <class Residual>
void add_hard(Runs& runs, const std::string& name, int m, std::vector<double> x0, double tf, Residual residual) {
  const int n = static_cast<int>(x0.size());
  const Problem problem = recorded(m, n, residual).on(0.0, tf).from(std::move(x0));
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    add(runs, "hard_" + name + "_" + name_of(method), problem, options_of(method, 1e-5), {.outputs = 2});
}

// Solutions that end, ranks that change, guesses outside of the domain.
void add_ends(Runs& runs) {
  add_hard(runs, "finite_escape", 1, {1.0}, 2.0,
           [](const auto&, const auto* x, const auto* xdot, auto* F) { F[0] = xdot[0] - x[0] * x[0]; });
  add_hard(runs, "square_root", 1, {1.0}, 3.0,
           [](const auto&, const auto* x, const auto* xdot, auto* F) { F[0] = xdot[0] + sqrt(x[0]); });
  add_hard(runs, "impasse", 2, {1.0, 1.0}, 2.0, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + 1.0;
    F[1] = x[1] * x[1] - x[0];
  });
  add_hard(runs, "rank_change", 2, {1.0, 2.0}, 3.0, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = x[0] - cos(t);
    F[1] = x[0] * xdot[1] - x[1] + 1.0;
  });
  add_hard(runs, "exceptional_start", 1, {0.0}, 1.0,
           [](const auto& t, const auto* x, const auto* xdot, auto* F) { F[0] = xdot[0] * t - x[0]; });
  add_hard(runs, "linear_domain", 2, {1.0, 0.0}, 2.0, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = x[1] - t * x[0];
    F[1] = xdot[0] - log(1.0 - t) * x[0];
  });
  const auto logarithm = [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[0] - x[1] + 1.0;
    F[1] = log(x[1]) - sin(t);
  };
  add_hard(runs, "far_guess", 2, {1.0, 20.0}, 3.0, logarithm);
  add_hard(runs, "guess_outside", 2, {1.0, -20.0}, 3.0, logarithm);
  add_hard(runs, "guess_nan", 2, {1.0, std::nan("")}, 3.0, logarithm);
}

void add_hard_cases(Runs& runs) {
  add_hard(runs, "jumps", 1, {0.0}, 5.0, [](const auto& t, const auto*, const auto* xdot, auto* F) {
    F[0] = xdot[0] - choose(sin(6.0 * t), Expression(1.0), Expression(-1.0));
  });
  add_hard(runs, "van_der_pol", 2, {2.0, -0.66}, 2.0, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] - x[1];
    F[1] = 1e-6 * xdot[1] - ((1.0 - x[0] * x[0]) * x[1] - x[0]);
  });
  add_hard(runs, "robertson", 3, {1.0, 0.0, 0.0}, 40.0, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + 0.04 * x[0] - 1e4 * x[1] * x[2];
    F[1] = xdot[1] - 0.04 * x[0] + 1e4 * x[1] * x[2] + 3e7 * x[1] * x[1];
    F[2] = x[0] + x[1] + x[2] - 1.0;
  });
  for (const double offset : {0.0, 1e-9, 1e-1})
    add_hard(runs,
             offset == 0.0   ? "no_contradiction"
             : offset < 1e-3 ? "tiny_contradiction"
                             : "contradiction",
             3, {1.0, 1.0}, 2.0, [offset](const auto& t, const auto* x, const auto* xdot, auto* F) {
               const auto circle = x[0] * x[0] + x[1] * x[1] - 2.0 - sin(t);
               F[0] = xdot[0] + x[0] - x[1];
               F[1] = circle;
               F[2] = 2.0 * circle - offset;
             });
  add_hard(runs, "contradiction_late", 3, {1.0, 1.0}, 2.0,
           [](const auto& t, const auto* x, const auto* xdot, auto* F) {
             F[0] = xdot[0] + x[0];
             F[1] = x[1] - x[0];
             F[2] = (2.0 + x[0]) * (x[1] - x[0]) - max(Expression(0.0), 0.01 * (t - 1.0));
           });
}

void add_unusual_structures(Runs& runs) {
  add_hard(runs, "rising_rank", 3, {0.0, 0.0, 1.0}, 2.0, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    const auto s = sin(t), F1 = x[0] * x[0] + x[0] - s - s * s;
    F[0] = F1;
    F[1] = x[1] - x[0] + xdot[1] * F1;
    F[2] = xdot[2] + x[2] - x[0];
  });
  add_hard(runs, "free_component", 2, {1.0, 0.5, 0.3}, 1.5,
           [](const auto&, const auto* x, const auto* xdot, auto* F) {
             F[0] = xdot[0] - x[0] * x[2];
             F[1] = x[1] - x[0] * x[0];
           });
  add_hard(runs, "redundant", 3, {1.0, 1.0}, 1.5, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[0] * x[1];
    F[1] = x[1] - x[0];
    F[2] = (x[1] - x[0]) * (2.0 + x[0]);
  });
  add_hard(runs, "path_control", 5, {0.1, 0.1, 0.9, 0.9, 0.1}, 1.5,
           [](const auto& t, const auto* x, const auto* xdot, auto* F) {
             F[0] = xdot[0] - x[2];
             F[1] = xdot[1] - x[3];
             F[2] = xdot[2] - (x[1] - x[0] - sin(x[0]));
             F[3] = xdot[3] - (x[0] - x[1] + x[4]);
             F[4] = x[0] - sin(t);
           });
  add_hard(runs, "every_function", 12, std::vector<double>(12, 0.3), 1.0,
           [](const auto& t, const auto* x, const auto* xdot, auto* F) {
             const auto s = x[0];
             F[0] = xdot[0] + 0.4 * s - 0.1 * cos(t);
             F[1] = x[1] - tan(s) - exp(-s);
             F[2] = x[2] - asin(0.5 * s) - acos(0.5 * s) * t;
             F[3] = x[3] - atan(s) + atan2(s, 1.0 + t);
             F[4] = x[4] - sinh(s) * cosh(t) - tanh(s);
             F[5] = x[5] - log(2.0 + s) - sqrt(1.0 + s * s);
             F[6] = x[6] - pow(1.5 + s, 2.5) - pow(s, 3.0) - pow(2.0, s);
             F[7] = x[7] - abs(s - 5.0) - min(s, 2.0 + s);
             F[8] = x[8] - max(s, -1.0) / (3.0 + s);
             F[9] = x[9] - choose(s, s * s, -s);
             F[10] = xdot[10] - x[1] * x[2] + x[10];
             F[11] = xdot[11] - pow(x[3], x[5]) * 0.1 + x[11] * pow(x[11], -2.0);
           });
}

}  // namespace

void add_nonlinear_runs(Runs& runs) {
  add_formulas(runs);
  add_test_set(runs);
  add_total_derivatives(runs);
  add_random_systems(runs);
  add_ends(runs);
  add_hard_cases(runs);
  add_unusual_structures(runs);
}

}  // namespace sfdae_bench
