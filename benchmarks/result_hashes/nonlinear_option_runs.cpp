// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear problems: counts of differentiations, options, initial values, parameters, prescribed components, callbacks
// that fail, checks of derivatives, linear equations that are recorded, mistakes in recordings.
#include <cmath>
#include <string>

#include "dual_jet.h"
#include "random_family.h"
#include "session.h"
#include "test_set/test_set.h"

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

using Change = std::function<void(sfdae_options&)>;

constexpr auto pendulum_equations = [](const auto& t, const auto* x, const auto* xdot, auto* F) {
  pendulum_residual(t, x, xdot, F);
};

Problem pendulum_problem(std::vector<int> differentiations = {}) {
  return recorded(5, 5, pendulum_equations, std::move(differentiations)).on(0.0, 2.0).from(pendulum().x0);
}

template <class Residual>
void add_counts(Runs& runs, const TestProblem& p, double tf, Residual residual, const std::vector<int>& counts) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const int change : {0, 1, -1}) {
      std::vector<int> changed = counts;
      for (int& count : changed) count = std::max(0, count + change);
      const Problem problem = recorded(p.m, p.n, residual, changed).on(p.t0, tf).from(p.x0);
      runs.push_back(
          {"differentiations_" + p.name + "_" + std::to_string(change) + "_" + name_of(method), [=](Trace& trace) {
             solve(trace, problem, options_of(method, 1e-7), {.outputs = 2, .checkpoint = true});
           }});
    }
}

std::vector<int> repeated(std::initializer_list<std::pair<int, int>> counted) {
  std::vector<int> counts;
  for (const auto& [number, count] : counted) counts.insert(counts.end(), size(number), count);
  return counts;
}

void add_differentiations(Runs& runs) {
  add_counts(runs, pendulum(), 1.0, pendulum_equations, repeated({{2, 1}, {2, 0}, {1, 2}}));
  add_counts(
      runs, car_axis(), 0.3,
      [](const auto& t, const auto* x, const auto* xdot, auto* F) { car_axis_residual(t, x, xdot, F); },
      repeated({{4, 1}, {4, 0}, {2, 2}}));
  add_counts(
      runs, andrews(), 0.001,
      [](const auto& t, const auto* x, const auto* xdot, auto* F) { andrews_residual(t, x, xdot, F); },
      repeated({{7, 1}, {14, 0}, {6, 2}}));
}

void add_options(Runs& runs) {
  const auto add = [&runs](const std::string& name, int method, const Change& change, const Plan& plan = {}) {
    sfdae_options options = options_of(method);
    change(options);
    runs.push_back({"pendulum_" + name + "_" + name_of(method),
                    [=](Trace& trace) { solve(trace, pendulum_problem(), options, plan); }});
  };
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    for (const double tol : {1e-2, 1e-4, 1e-11})
      add("tol_" + std::to_string(static_cast<int>(-std::log10(tol))), method,
          [=](sfdae_options& o) { o.rtol = o.atol = tol; });
    add("svd", method, [](sfdae_options& o) { o.reduction = SFDAE_REDUCTION_SVD; });
    add("max_index", method, [](sfdae_options& o) { o.max_index = 1; });
    add("time_scale", method, [](sfdae_options& o) { o.time_scale = 0.01; });
    add("rank_tol", method, [](sfdae_options& o) { o.rank_tol = 1e-9; });
    add("leading_identity", method, [](sfdae_options& o) { o.leading_term = SFDAE_LEADING_IDENTITY; });
    add("leading_matrix", method, [](sfdae_options& o) { o.leading_term = SFDAE_LEADING_MATRIX; });
    add("stop_time", method, [](sfdae_options& o) { o.use_stop_time = 1, o.stop_time = 2.0; });
    add("max_step", method, [](sfdae_options& o) { o.max_step = 0.01, o.initial_step = 1e-5; });
    add("max_steps", method, [](sfdae_options& o) { o.max_steps = 7; });
    add("many_outputs", method, [](sfdae_options&) {}, {.outputs = 120, .checkpoint = true});
    add("steps", method, [](sfdae_options&) {}, {.by_steps = true});
    add("events", method, [](sfdae_options&) {}, {.checkpoint = true, .events = true});
  }
  add("many_outputs", SFDAE_METHOD_AUTOMATIC, [](sfdae_options&) {}, {.outputs = 120});
  add("order_2", SFDAE_METHOD_BDF, [](sfdae_options& o) { o.max_order = 2; });
  for (const int stages : {1, 3, 5, 7})
    add("stages_" + std::to_string(stages), SFDAE_METHOD_RADAU, [=](sfdae_options& o) {
      o.min_stages = o.max_stages = stages;
      if (stages == 1) o.rtol = o.atol = 1e-3;
    });
}

void add_initial_values(Runs& runs) {
  static const int length[] = {1, 0, 0, 0, 0}, positions[] = {1, 1, 0, 0, 0}, all[] = {1, 1, 1, 1, 1};
  static const double weights[] = {1.0, 10.0, 1.0, 2.0, 50.0};
  const auto add = [&runs](const std::string& name, std::vector<double> guess, int mode, const int* fixed = nullptr,
                           const double* initial_weights = nullptr) {
    const Problem problem = pendulum_problem().from(std::move(guess));
    sfdae_options options = options_of();
    options.initial_values = mode;
    options.fixed = fixed;
    options.initial_weights = initial_weights;
    runs.push_back({"pendulum_initial_" + name, [=](Trace& trace) {
                      solve(trace, problem, options, {.outputs = 1});
                      Session session(trace, problem, options);
                      session.make_consistent(0.5, problem.x0);
                      session.analyze(0.0, 1.0);
                      session.analyze_at(0.0, 1.0);
                      session.describe();
                    }});
  };
  const std::vector<double> no_force = {0.6, -0.8, 0.8, 0.6, 0.0}, far = {2.0, 1.0, 0.3, -0.5, 4.0};
  const std::vector<double> hanging = {0.0, -1.0, 0.0, 0.0, 0.0};
  add("no_force", no_force, SFDAE_INITIAL_NEAREST);
  add("far", far, SFDAE_INITIAL_NEAREST);
  add("hanging", hanging, SFDAE_INITIAL_NEAREST);
  add("center", {0.0, 0.0, 0.0, 0.0, 0.0}, SFDAE_INITIAL_NEAREST);
  add("weights", far, SFDAE_INITIAL_NEAREST, nullptr, weights);
  add("fixed", {0.6, -0.7, 0.8, 0.6, 0.0}, SFDAE_INITIAL_FIXED, length);
  add("fixed_impossible", {1.6, -0.7, 0.8, 0.6, 0.0}, SFDAE_INITIAL_FIXED, length);
  add("fixed_positions", {0.6, -0.8, 0.3, 0.6, 0.0}, SFDAE_INITIAL_FIXED, positions, weights);
  add("fixed_all", no_force, SFDAE_INITIAL_FIXED, all);
  add("accept", {1.0, 0.0, 0.0, 0.0, 0.0}, SFDAE_INITIAL_ACCEPT);
  add("accept_wrong", no_force, SFDAE_INITIAL_ACCEPT);
  add("nan", {std::nan(""), 0.0, 0.0, 0.0, 0.0}, SFDAE_INITIAL_NEAREST);
  add("huge", {1e200, 1e200, 0.0, 0.0, 1e300}, SFDAE_INITIAL_NEAREST);
}

Problem pushed_pendulum(bool is_prescribed, int component = 5) {
  return recorded_problem(
             5, 6,
             [](sfdae_record* record, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
               F[0] = xdot[0] - x[2];
               F[1] = xdot[1] - x[3];
               F[2] = xdot[2] + 2.0 * x[0] * x[4] - x[5];
               F[3] = xdot[3] + 2.0 * x[1] * x[4] + sfdae::parameter(record, "g", 2.0);
               F[4] = x[0] * x[0] + x[1] * x[1] - sfdae::parameter(record, "length", 1.0);
             },
             {}, is_prescribed ? std::vector<int>{component} : std::vector<int>{},
             [](double t) { return 0.3 * std::sin(t); })
      .on(0.0, 1.5)
      .from({0.1, -1.0, 0.5, 0.0, 1.0, 0.0});
}

void add_parameters(Runs& runs) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    const std::string end = std::string("_") + name_of(method);
    runs.push_back({"parameters" + end, [=](Trace& trace) {
                      const Problem problem = pushed_pendulum(true);
                      Session session(trace, problem, options_of(method));
                      session.start();
                      session.outputs(1.0, 2);
                      for (const auto& [name, value] :
                           {std::pair{"g", 9.81}, {"length", 2.0}, {"none", 1.0}, {"g", std::nan("")}}) {
                        session.called("set_parameter", sfdae_set_parameter(session.solver(), name, value));
                        double now = -1.0;
                        session.called("get_parameter", sfdae_get_parameter(session.solver(), name, &now));
                        trace.number("parameter", now);
                        session.advance(1.2);
                        session.start(1.0, 1.5, session.x);
                        session.outputs(1.5, 2);
                      }
                      session.describe();
                    }});
    runs.push_back({"prescribed_force" + end, [=](Trace& trace) {
                      solve(trace, pushed_pendulum(true), options_of(method), {.checkpoint = true, .events = true});
                    }});
    runs.push_back({"prescribed_position" + end,
                    [=](Trace& trace) { solve(trace, pushed_pendulum(true, 0), options_of(method)); }});
    runs.push_back({"prescribed_nothing" + end,
                    [=](Trace& trace) { solve(trace, pushed_pendulum(false), options_of(method)); }});
    runs.push_back({"pendulum_backward" + end, [=](Trace& trace) {
                      const TestProblem p = pendulum();
                      solve(trace, pendulum_problem().on(10.0, 8.0).from(p.references[0].x), options_of(method),
                            {.outputs = 5, .checkpoint = true, .events = true});
                    }});
    runs.push_back({"pendulum_restart" + end, [=](Trace& trace) {
                      const Problem problem = pendulum_problem();
                      Session session(trace, problem, options_of(method));
                      session.start();
                      session.stop_after = 5;
                      session.outputs(0.7, 2);
                      session.stop_after = 0;
                      sfdae_statistics s;
                      sfdae_statistics_init(&s, sizeof s);
                      sfdae_get_statistics(session.solver(), &s);
                      for (const double part : {-0.1, 0.0, 0.2, 0.9, 1.0})
                        session.interpolate(s.t_internal - (1.0 - part) * s.last_step);
                      std::vector<double> pushed = session.x;
                      pushed[2] += 1.0;
                      session.make_consistent(0.7, pushed);
                      session.start(0.7, 2.0, pushed);
                      session.set_options(options_of(SFDAE_METHOD_RADAU - method, 1e-8));
                      session.outputs(1.0, 2);
                      session.start(1.0, 2.0, session.x);
                      session.outputs(2.0, 2);
                      session.inspect(1.0, 1);
                      session.describe();
                    }});
  }
}

using Interrupt = std::function<int(double t, int order, double* F)>;

void add_failing_callbacks(Runs& runs) {
  const TotalDerivative all = total_derivative(5, 5, pendulum_equations);
  const auto add = [&runs, all](const std::string& name, const Interrupt& interrupt) {
    const Problem problem =
        derivative_problem(5, 5,
                           [=](double t, int order, const double* jet, double* F, double* F_x, double* F_xdot) {
                             all(t, order, jet, F, F_x, F_xdot);
                             return interrupt(t, order, F);
                           })
            .on(0.0, 2.0)
            .from(pendulum().x0);
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      runs.push_back({"derivatives_" + name + "_" + name_of(method),
                      [=](Trace& trace) { solve(trace, problem, options_of(method), {.outputs = 2}); }});
  };
  add("fail_late", [](double t, int, double*) { return t > 0.8 ? 1 : 0; });
  add("stop_late", [](double t, int, double*) { return t > 0.8 ? -1 : 0; });
  add("fail_at_start", [](double, int order, double*) { return order == 1 ? 5 : 0; });
  add("nan_late", [](double t, int, double* F) { return t > 0.8 ? (F[2] = std::nan(""), 0) : 0; });
  add("nan_at_start", [](double, int, double* F) { return F[2] = std::nan(""), 0; });
  add("missing", [](double, int order, double*) { return order > 1 ? SFDAE_ORDER_NOT_AVAILABLE : 0; });
  add("missing_late",
      [](double t, int order, double*) { return order > 1 && t > 0.8 ? SFDAE_ORDER_NOT_AVAILABLE : 0; });
  // Fails for a share of all calls, always the same ones.
  for (const int answer : {1, -1})
    runs.push_back({answer > 0 ? "derivatives_fail_at_random" : "derivatives_stop_at_random", [=](Trace& trace) {
                      auto numbers = std::make_shared<RandomNumbers>(7);
                      const Problem problem =
                          derivative_problem(
                              5, 5,
                              [=](double t, int order, const double* jet, double* F, double* F_x, double* F_xdot) {
                                all(t, order, jet, F, F_x, F_xdot);
                                return t > 0.2 && numbers->uniform(0.0, 1.0) < 0.02 ? answer : 0;
                              })
                              .on(0.0, 2.0)
                              .from(pendulum().x0);
                      solve(trace, problem, options_of());
                    }});
}

void add_derivative_checks(Runs& runs) {
  const TotalDerivative all = total_derivative(5, 5, pendulum_equations);
  for (const char function : {'0', 'F', 'x', 'd'})
    runs.push_back({std::string("check_total_") + function, [=](Trace& trace) {
                      const Problem problem = derivative_problem(
                          5, 5, [=](double t, int order, const double* jet, double* F, double* F_x, double* F_xdot) {
                            all(t, order, jet, F, F_x, F_xdot);
                            if (function == 'F' && order == 1) F[3] += 1e-3;
                            if (function == 'x' && order == 2 && F_x != nullptr) F_x[7] += 1e-3;
                            if (function == 'd' && order == 0 && F_xdot != nullptr) F_xdot[6] += 1e-3;
                            return order > 3 ? SFDAE_ORDER_NOT_AVAILABLE : 0;
                          });
                      Session session(trace, problem, options_of());
                      std::vector<double> jet(5 * 7);
                      for (std::size_t i = 0; i < jet.size(); ++i)
                        jet[i] = std::cos(1.0 + 2.3 * static_cast<double>(i));
                      for (const int order : {0, 1, 3, 4}) {
                        sfdae_derivative_check check;
                        sfdae_derivative_check_init(&check, sizeof check);
                        session.called(
                            "check", sfdae_check_total_derivatives(session.solver(), 0.3, jet.data(), order, &check));
                        trace_check(trace, check);
                      }
                    }});
}

// E x' = A x + f recorded: solved as linear problems, and as nonlinear ones if differentiations are counted.
void add_recorded_linear(Runs& runs) {
  struct Formulas {
    static int write(sfdae_record* record, sfdae_expression t, sfdae_expression* E, sfdae_expression* A,
                     sfdae_expression* f, void*) {
      const sfdae_expression one = sfdae_number(1.0), rate = sfdae_parameter(record, "rate", 0.5);
      E[0] = one;
      E[4] = sfdae_sin(t);
      A[0] = sfdae_negate(rate);
      A[3] = sfdae_exp(sfdae_negate(t));
      A[4] = one;
      A[8] = sfdae_cos(t);
      f[0] = sfdae_multiply(t, t);
      f[1] = sfdae_sqrt(sfdae_add(one, t));
      f[2] = sfdae_negate(sfdae_sin(sfdae_multiply(sfdae_number(3.0), t)));
      return 0;
    }
  };
  static const int counts[] = {1, 1, 1};
  for (const bool counted : {false, true})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      runs.push_back(
          {std::string("recorded_linear_") + (counted ? "counted_" : "") + name_of(method), [=](Trace& trace) {
             sfdae_nonlinear_problem c;
             sfdae_nonlinear_problem_init(&c, sizeof c);
             c.num_equations = c.num_unknowns = 3;
             c.linear_equations = Formulas::write;
             if (counted) c.differentiations = counts;
             const Problem problem{c, nullptr, 0.2, 1.2, {1.0, 0.0, 0.0}};
             solve(trace, problem, options_of(method), {.checkpoint = true, .events = true});
             Session session(trace, problem, options_of(method));
             session.start();
             session.advance(0.5);
             session.called("set_parameter", sfdae_set_parameter(session.solver(), "rate", 2.0));
             session.start();
             session.inspect(0.4, 1);
             session.outputs(1.0, 2);
             session.describe();
           }});
}

void add_mistakes(Runs& runs) {
  const auto add = [&runs](const std::string& name, const RecordedFunction& write) {
    runs.push_back({"recording_" + name, [=](Trace& trace) {
                      solve(trace, recorded_problem(2, 2, write).from({1.0, 1.0}), options_of(), {.outputs = 1});
                    }});
  };
  add("forgotten", [](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
    F[0] = xdot[0] + x[1];
  });
  add("nan", [](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
    F[0] = xdot[0] + std::nan("") * x[1];
    F[1] = x[0];
  });
  add("parameter_nan",
      [](sfdae_record* record, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
        F[0] = xdot[0] + sfdae::parameter(record, "k", std::nan("")) * x[1];
        F[1] = x[0];
      });
  add("constant", [](sfdae_record*, const Expression&, const Expression*, const Expression* xdot, Expression* F) {
    F[0] = xdot[0] - 1.0;
    F[1] = 3.0;
  });
  add("nothing", [](sfdae_record*, const Expression&, const Expression*, const Expression*, Expression* F) {
    F[0] = F[1] = 0.0;
  });
  add("division", [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
    F[0] = xdot[0] + x[1] / (0.5 - t);
    F[1] = x[1] - x[0] * x[0];
  });
  add("power", [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
    F[0] = xdot[0] + 2.0;
    F[1] = x[1] - pow(x[0], 0.5 + t);
  });
  add("name",
      [](sfdae_record* record, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
        F[0] = xdot[0] + sfdae::parameter(record, "", 1.0);
        F[1] = x[1] - x[0];
      });
}

}  // namespace

void add_nonlinear_option_runs(Runs& runs) {
  add_differentiations(runs);
  add_options(runs);
  add_initial_values(runs);
  add_parameters(runs);
  add_failing_callbacks(runs);
  add_derivative_checks(runs);
  add_recorded_linear(runs);
  add_mistakes(runs);
}

}  // namespace sfdae_bench
