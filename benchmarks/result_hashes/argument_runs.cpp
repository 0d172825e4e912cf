// SPDX-License-Identifier: BSD-3-Clause
// Problems and options that are refused, with what is said about them; names of statuses.
#include <climits>
#include <cmath>
#include <limits>
#include <string>

#include "session.h"
#include "test_set/pendulum.h"

namespace sfdae_bench {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

Problem oscillator() {
  return linear_problem(2, 2,
                        [](char which, double, int order, double* values) {
                          if (order == 0 && which == 'E') values[0] = values[3] = 1.0;
                          if (order == 0 && which == 'A') values[1] = -1.0, values[2] = 1.0;
                          return 0;
                        })
      .from({1.0, 0.0});
}
Problem recorded_pendulum() {
  return recorded(5, 5,
                  [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                    sfdae_test::pendulum_residual(t, x, xdot, F);
                  })
      .from({1.0, 0.0, 0.0, 0.0, 0.0});
}
Problem multibody_pendulum(Form form) {
  return mechanical_problem(sfdae_test::DirectSystem<sfdae_test::Pendulum>(), form, 0.0, 1.0, {1.0, 0.0});
}

// What every change is answered with.
template <class Object>
struct Changes {
  std::vector<std::function<void(Object&)>> all;
};

void try_all_options(Trace& trace, const Problem& problem) {
  static const double negative[] = {1.0, -1.0, 1.0, 1.0, 1.0}, none[] = {0.0, 0.0, 0.0, 0.0, 0.0};
  static const int flags[] = {0, 2, 0, 0, 0};
  const Changes<sfdae_options> changes{{
      [](sfdae_options& o) { o.size = 0; },
      [](sfdae_options& o) { o.rtol = -1.0; },
      [](sfdae_options& o) { o.rtol = 1.0; },
      [](sfdae_options& o) { o.rtol = std::nan(""); },
      [](sfdae_options& o) { o.atol = -1.0; },
      [](sfdae_options& o) { o.atol = inf; },
      [](sfdae_options& o) { o.rtol = o.atol = 0.0; },
      [](sfdae_options& o) { o.rtol_vector = negative; },
      [](sfdae_options& o) { o.atol_vector = negative; },
      [](sfdae_options& o) { o.rtol_vector = o.atol_vector = none; },
      [](sfdae_options& o) { o.max_index = -1; },
      [](sfdae_options& o) { o.max_index = 13; },
      [](sfdae_options& o) { o.reduction = 2; },
      [](sfdae_options& o) { o.rank_tol = -1.0; },
      [](sfdae_options& o) { o.rank_tol = 1.0; },
      [](sfdae_options& o) { o.time_scale = -1.0; },
      [](sfdae_options& o) { o.time_scale = inf; },
      [](sfdae_options& o) { o.difference_derivatives = 2; },
      [](sfdae_options& o) { o.difference_step = -1.0; },
      [](sfdae_options& o) { o.initial_values = 3; },
      [](sfdae_options& o) { o.initial_values = SFDAE_INITIAL_FIXED; },
      [](sfdae_options& o) { o.initial_values = SFDAE_INITIAL_FIXED, o.fixed = flags; },
      [](sfdae_options& o) { o.initial_weights = negative; },
      [](sfdae_options& o) { o.ignore_inconsistency = -1; },
      [](sfdae_options& o) { o.consistency_tol = 0.0; },
      [](sfdae_options& o) { o.consistency_tol = 1.0; },
      [](sfdae_options& o) { o.max_order = 0; },
      [](sfdae_options& o) { o.max_order = 6; },
      [](sfdae_options& o) { o.initial_step = -1.0; },
      [](sfdae_options& o) { o.max_step = -1.0; },
      [](sfdae_options& o) { o.max_step = std::nan(""); },
      [](sfdae_options& o) { o.use_stop_time = 2; },
      [](sfdae_options& o) { o.use_stop_time = 1, o.stop_time = std::nan(""); },
      [](sfdae_options& o) { o.use_stop_time = 1, o.stop_time = -1.0; },
      [](sfdae_options& o) { o.max_steps = 0; },
      [](sfdae_options& o) { o.leading_term = 4; },
      [](sfdae_options& o) { o.method = 3; },
      [](sfdae_options& o) { o.min_stages = 2; },
      [](sfdae_options& o) { o.max_stages = 9; },
      [](sfdae_options& o) { o.min_stages = 7, o.max_stages = 3; },
  }};
  for (const auto& change : changes.all) {
    sfdae_options options = options_of();
    change(options);
    Session session(trace, problem, options);
    if (session) session.start();
    Session good(trace, problem, options_of());
    good.set_options(options);
  }
}

template <class CProblem>
void try_problems(Trace& trace, const Problem& problem, const Changes<CProblem>& changes) {
  for (const auto& change : changes.all) {
    Problem changed = problem;
    change(std::get<CProblem>(changed.c));
    Session session(trace, changed, options_of());
    trace.integer("created", session ? 1 : 0);
    // The text may be cut off.
    char text[12] = "";
    const sfdae_options options = options_of();
    int status = 0;
    if constexpr (std::is_same_v<CProblem, sfdae_linear_problem>)
      status = sfdae_check_linear(&changed.linear(), &options, text, sizeof text);
    else if constexpr (std::is_same_v<CProblem, sfdae_nonlinear_problem>)
      status = sfdae_check_nonlinear(&changed.nonlinear(), &options, text, sizeof text);
    else status = sfdae_check_multibody(&changed.multibody(), &options, text, sizeof text);
    trace.text("check", sfdae_status_name(status));
  }
}

void linear_mistakes(Trace& trace) {
  using P = sfdae_linear_problem;
  static const int wrong[] = {0, 0}, outside[] = {2}, inside[] = {1};
  try_problems<P>(trace, oscillator(),
                  {{
                      [](P&) {},
                      [](P& p) { p.size = 1; },
                      [](P& p) { p.num_equations = 0; },
                      [](P& p) { p.num_unknowns = 0; },
                      [](P& p) { p.num_unknowns = -3; },
                      [](P& p) { p.num_equations = 5001; },
                      [](P& p) { p.num_unknowns = INT_MAX; },
                      [](P& p) { p.E = nullptr; },
                      [](P& p) { p.A = nullptr; },
                      [](P& p) { p.f = nullptr; },
                      [](P& p) { p.constant_E = 2; },
                      [](P& p) { p.constant_A = -1; },
                      [](P& p) { p.num_prescribed = -1; },
                      [](P& p) { p.num_prescribed = 1; },
                      [](P& p) { p.num_prescribed = 1, p.prescribed = inside; },
                      [](P& p) { p.num_prescribed = 1, p.prescribed = outside, p.prescribed_values = p.f; },
                      [](P& p) { p.num_prescribed = 2, p.prescribed = wrong, p.prescribed_values = p.f; },
                      [](P& p) { p.num_prescribed = 3, p.prescribed = wrong, p.prescribed_values = p.f; },
                  }});
}

void nonlinear_mistakes(Trace& trace) {
  using P = sfdae_nonlinear_problem;
  static const int negative[] = {0, -1, 0, 0, 0}, large[] = {0, 0, 13, 0, 0}, outside[] = {5};
  const auto values = [](double, int, double*, void*) { return 0; };
  const auto derivative = [](double, int, const double*, double*, double*, double*, void*) { return 0; };
  const auto refusing = [](sfdae_record*, sfdae_expression, const sfdae_expression*, const sfdae_expression*,
                           sfdae_expression*, void*) { return 4; };
  const auto stopping = [](sfdae_record*, sfdae_expression, const sfdae_expression*, const sfdae_expression*,
                           sfdae_expression*, void*) { return -4; };
  try_problems<P>(trace, recorded_pendulum(),
                  {{
                      [](P&) {},
                      [](P& p) { p.size = 1; },
                      [](P& p) { p.num_equations = 0; },
                      [](P& p) { p.num_unknowns = -3; },
                      [](P& p) { p.num_equations = 5001; },
                      [](P& p) { p.equations = nullptr; },
                      [=](P& p) { p.total_derivative = derivative; },
                      [=](P& p) { p.equations = refusing; },
                      [=](P& p) { p.equations = stopping; },
                      [](P& p) { p.differentiations = negative; },
                      [](P& p) { p.differentiations = large; },
                      [](P& p) { p.num_prescribed = 1; },
                      [=](P& p) { p.num_prescribed = 1, p.prescribed = outside, p.prescribed_values = values; },
                  }});
}

void multibody_mistakes(Trace& trace) {
  using P = sfdae_multibody_problem;
  const Changes<P> changes{{
      [](P&) {},
      [](P& p) { p.size = 0; },
      [](P& p) { p.num_positions = -1; },
      [](P& p) { p.num_positions = 0; },
      [](P& p) { p.num_positions = p.num_velocities = p.num_constraints = 2000; },
      [](P& p) { p.num_velocities = INT_MIN; },
      [](P& p) { p.num_velocities = 1; },
      [](P& p) { p.num_constraints = 5001; },
      [](P& p) { p.num_nonholonomic = -1; },
      [](P& p) { p.num_nonholonomic = 1; },
      [](P& p) { p.forces = nullptr; },
      [](P& p) { p.constraints = nullptr; },
      [](P& p) { p.constraint_jacobian = nullptr; },
      [](P& p) { p.mass = nullptr; },
      [](P& p) { p.equations = nullptr; },
      [](P& p) { p.coordinates = 2; },
      [](P& p) { p.forces = [](double, const double*, const double*, double*, void*) { return 0; }; },
  }};
  try_problems<P>(trace, multibody_pendulum(Form::callbacks), changes);
  // Formulas that nobody writes.
  Problem recorded = multibody_pendulum(Form::recorded);
  recorded.multibody().equations = [](sfdae_record*, sfdae_expression, const sfdae_expression*,
                                      const sfdae_expression*, const sfdae_multibody_formulas*, void*) { return 0; };
  try_problems<P>(trace, recorded, changes);
}

void null_arguments(Trace& trace) {
  const Problem problem = oscillator();
  Session session(trace, problem, options_of());
  session.start();
  sfdae_solver* const s = session.solver();
  double x[2] = {1.0, 0.0}, t = 0.0;
  session.called("start", sfdae_start(s, 0.0, 1.0, nullptr, nullptr));
  session.called("start", sfdae_start(s, 0.0, 1.0, x, nullptr));
  session.called("advance", sfdae_advance(s, 0.5, nullptr, x, nullptr));
  session.called("advance", sfdae_advance(s, 0.5, &t, nullptr, nullptr));
  session.called("step", sfdae_step(s, 0.5, &t, nullptr, nullptr));
  session.called("interpolate", sfdae_interpolate(s, 0.0, nullptr, nullptr));
  session.called("make_consistent", sfdae_make_consistent(s, 0.0, nullptr, nullptr));
  session.called("analyze_at", sfdae_analyze_at(s, 0.0, 1.0, nullptr, nullptr));
  session.called("set_options", sfdae_set_options(s, nullptr));
  session.called("set_events", sfdae_set_events(s, 3, nullptr, nullptr, nullptr));
  session.called("set_events", sfdae_set_events(s, -1, nullptr, nullptr, nullptr));
  session.called("set_events", sfdae_set_events(s, 0, nullptr, nullptr, nullptr));
  session.called("get_events", sfdae_get_events(s, nullptr));
  session.called("get_characteristics", sfdae_get_characteristics(s, nullptr));
  session.called("get_statistics", sfdae_get_statistics(s, nullptr));
  session.called("get_change", sfdae_get_change(s, nullptr));
  session.called("get_initial_report", sfdae_get_initial_report(s, nullptr));
  session.called("get_decision", sfdae_get_decision(s, -1, nullptr));
  session.called("get_num_decisions", sfdae_get_num_decisions(s, nullptr));
  session.called("save", sfdae_save_checkpoint(s, nullptr, 0));
  session.called("save", sfdae_save_checkpoint(s, x, 2));
  session.called("restore", sfdae_restore_checkpoint(s, x, 2));
  session.called("restore", sfdae_restore_checkpoint(s, nullptr, 2));
  session.called("report", sfdae_report(s, nullptr, 5, nullptr));
  session.called("set_parameter", sfdae_set_parameter(s, nullptr, 1.0));
  session.called("check", sfdae_check_derivatives(s, 0.0, 0, nullptr));
  session.called("check", sfdae_check_total_derivatives(s, 0.0, x, 0, nullptr));
  session.called("check", sfdae_check_multibody_derivatives(s, 0.0, x, x, nullptr));
  for (const int status :
       {sfdae_start(nullptr, 0.0, 1.0, x, x), sfdae_advance(nullptr, 1.0, &t, x, x), sfdae_destroy(nullptr),
        sfdae_request_stop(nullptr), sfdae_create_linear(nullptr, nullptr, nullptr),
        sfdae_linear_problem_init(nullptr, 8), sfdae_options_init(nullptr, 8)})
    trace.text("without a solver", sfdae_status_name(status));
  trace.text("message", sfdae_message(nullptr));
}

// A solver called from within its own callback.
void calls_within_callbacks(Trace& trace) {
  sfdae_solver* solver = nullptr;
  int calls = 0;
  const Problem problem = linear_problem(1, 1, [&](char which, double, int order, double* values) {
                            if (order == 0 && which == 'E') values[0] = 1.0;
                            if (order == 0 && which == 'A') values[0] = -1.0;
                            if (solver != nullptr && ++calls < 4) {
                              double x = 1.0;
                              sfdae_statistics s;
                              sfdae_statistics_init(&s, sizeof s);
                              trace.text("inside", sfdae_status_name(sfdae_start(solver, 0.0, 1.0, &x, nullptr)));
                              trace.text("inside", sfdae_status_name(sfdae_get_statistics(solver, &s)));
                              trace.text("inside", sfdae_status_name(sfdae_destroy(&solver)));
                            }
                            return 0;
                          }).from({1.0});
  Session session(trace, problem, options_of());
  solver = session.solver();
  session.start();
  session.outputs(1.0, 2);
  session.describe();
}

}  // namespace

void add_argument_runs(Runs& runs) {
  runs.push_back({"options_linear", [](Trace& trace) { try_all_options(trace, oscillator()); }});
  runs.push_back({"options_nonlinear", [](Trace& trace) { try_all_options(trace, recorded_pendulum()); }});
  runs.push_back(
      {"options_multibody", [](Trace& trace) { try_all_options(trace, multibody_pendulum(Form::callbacks)); }});
  runs.push_back({"mistakes_linear", linear_mistakes});
  runs.push_back({"mistakes_nonlinear", nonlinear_mistakes});
  runs.push_back({"mistakes_multibody", multibody_mistakes});
  runs.push_back({"null_arguments", null_arguments});
  runs.push_back({"calls_within_callbacks", calls_within_callbacks});
  runs.push_back({"status_names", [](Trace& trace) {
                    for (int status = 10; status >= -110; --status) trace.text("status", sfdae_status_name(status));
                    trace.text("version", sfdae_version());
                  }});
}

}  // namespace sfdae_bench
