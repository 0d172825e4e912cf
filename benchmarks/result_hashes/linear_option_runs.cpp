// SPDX-License-Identifier: BSD-3-Clause
// Linear problems: options, initial values, prescribed components, callbacks that fail, checks of derivatives, calls in
// unusual orders.
#include <cmath>
#include <limits>
#include <string>

#include "random_family.h"
#include "session.h"
#include "testset_linear.h"

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

constexpr double inf = std::numeric_limits<double>::infinity();

Family chain_family() { return chain(4, 1); }
Problem chain_problem() { return family_problem(chain_family(), 0.0, 1.5); }

using Change = std::function<void(sfdae_options&)>;

void add_options(Runs& runs) {
  const auto add = [&runs](const std::string& name, int method, const Change& change, const Plan& plan = {}) {
    sfdae_options options = options_of(method);
    change(options);
    runs.push_back({"option_" + name + "_" + name_of(method),
                    [=](Trace& trace) { solve(trace, chain_problem(), options, plan); }});
  };
  for (int order = 1; order <= 4; ++order)
    add("max_order_" + std::to_string(order), SFDAE_METHOD_BDF, [=](sfdae_options& o) { o.max_order = order; });
  for (const int stages : {1, 3, 5, 7})
    add("stages_" + std::to_string(stages), SFDAE_METHOD_RADAU, [=](sfdae_options& o) {
      o.min_stages = o.max_stages = stages;
      if (stages == 1) o.rtol = o.atol = 1e-3;
    });
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    for (const double tol : {1e-2, 1e-4, 1e-12})
      add("tol_" + std::to_string(static_cast<int>(-std::log10(tol))), method,
          [=](sfdae_options& o) { o.rtol = o.atol = tol; });
    add("stop_time", method, [](sfdae_options& o) { o.use_stop_time = 1, o.stop_time = 1.5; });
    add("stop_time_early", method, [](sfdae_options& o) { o.use_stop_time = 1, o.stop_time = 1.0; });
    add("max_step", method, [](sfdae_options& o) { o.max_step = 0.02; });
    add("initial_step", method, [](sfdae_options& o) { o.initial_step = 1e-7; });
    add("max_steps", method, [](sfdae_options& o) { o.max_steps = 5; });
    add("time_scale", method, [](sfdae_options& o) { o.time_scale = 1e-3; });
    add("many_outputs", method, [](sfdae_options&) {}, {.outputs = 150});
    add("tolerance_zero", method, [](sfdae_options& o) { o.rtol = 1e-15, o.atol = 0.0; });
    add("differences", method, [](sfdae_options& o) { o.difference_derivatives = 1; });
  }
  add("many_outputs", SFDAE_METHOD_AUTOMATIC, [](sfdae_options&) {}, {.outputs = 150, .checkpoint = true});

  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    runs.push_back({std::string("option_tolerance_vectors_") + name_of(method), [=](Trace& trace) {
                      sfdae_options options = options_of(method);
                      std::vector<double> rtol(9, 1e-5), atol(9, 1e-7);
                      rtol[2] = 1e-9, atol[4] = 1e-3;
                      options.rtol_vector = rtol.data();
                      options.atol_vector = atol.data();
                      solve(trace, chain_problem(), options);
                    }});
}

void add_difference_derivatives(Runs& runs) {
  for (int mu = 0; mu <= 3; ++mu)
    for (const double spacing : {0.0, 1e-2}) {
      const Family family = kron(6, mu);
      const Problem problem = family_problem(family, 0.0, 0.8, [](char, double, int order, double*) {
        return order > 0 ? SFDAE_ORDER_NOT_AVAILABLE : 0;
      });
      sfdae_options options = options_of(mu % 2 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU, 1e-5);
      options.difference_derivatives = 1;
      options.difference_step = spacing;
      runs.push_back({"differences_" + std::to_string(mu) + (spacing > 0.0 ? "_spacing" : ""),
                      [=](Trace& trace) { solve(trace, problem, options); }});
    }
  const Problem without = family_problem(Family(kron(6, 2)), 0.0, 0.8, [](char, double, int order, double*) {
    return order > 1 ? SFDAE_ORDER_NOT_AVAILABLE : 0;
  });
  runs.push_back({"order_missing", [=](Trace& trace) { solve(trace, without, options_of()); }});
}

void add_initial_values(Runs& runs) {
  const auto add = [&runs](const std::string& name, const Change& change, std::vector<double> shift = {}) {
    Problem problem = chain_problem();
    for (std::size_t i = 0; i < shift.size(); ++i) problem.x0[i] += shift[i];
    sfdae_options options = options_of();
    change(options);
    runs.push_back({"initial_" + name, [=](Trace& trace) {
                      solve(trace, problem, options, {.outputs = 1});
                      Session session(trace, problem, options);
                      if (session) session.make_consistent(0.3, problem.x0);
                    }});
  };
  static const int differential[] = {0, 0, 1, 1, 0, 0, 1, 1, 0}, everything[] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
  static const int multiplier[] = {0, 0, 0, 0, 0, 0, 0, 0, 1}, one[] = {1, 0, 0, 0, 0, 0, 0, 0, 0};
  static const double weights[] = {1.0, 0.1, 1.0, 1.0, 2.0, 3.0, 1.0, 1.0, 100.0};
  const std::vector<double> far = {0.3, -0.2, 0.1, 0.0, 0.5, 0.1, 0.0, -0.4, 7.0};
  const auto mode = [](int which, const int* fixed, const double* weight = nullptr) {
    return [=](sfdae_options& o) { o.initial_values = which, o.fixed = fixed, o.initial_weights = weight; };
  };
  add("exact", mode(SFDAE_INITIAL_NEAREST, nullptr));
  add("nearest", mode(SFDAE_INITIAL_NEAREST, nullptr), far);
  add("weights", mode(SFDAE_INITIAL_NEAREST, nullptr, weights), far);
  add("fixed", mode(SFDAE_INITIAL_FIXED, differential), far);
  add("fixed_one", mode(SFDAE_INITIAL_FIXED, one), far);
  add("fixed_weights", mode(SFDAE_INITIAL_FIXED, one, weights), far);
  add("fixed_multiplier", mode(SFDAE_INITIAL_FIXED, multiplier), far);
  add("fixed_all", mode(SFDAE_INITIAL_FIXED, everything), far);
  add("fixed_all_exact", mode(SFDAE_INITIAL_FIXED, everything));
  add("accept_exact", mode(SFDAE_INITIAL_ACCEPT, nullptr));
  add("accept_wrong", mode(SFDAE_INITIAL_ACCEPT, nullptr), far);
  add("accept_near", mode(SFDAE_INITIAL_ACCEPT, nullptr), {1e-8});
  add("nan", mode(SFDAE_INITIAL_NEAREST, nullptr), {std::nan("")});
  add("huge", mode(SFDAE_INITIAL_NEAREST, nullptr), {1e200});
}

void add_prescribed(Runs& runs) {
  const auto add = [&runs](const std::string& name, const Problem& problem) {
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      runs.push_back({"prescribed_" + name + "_" + name_of(method), [=](Trace& trace) {
                        solve(trace, problem, options_of(method), {.outputs = 3, .checkpoint = true});
                      }});
  };
  add("kron_1", family_problem(Family(kron(6, 1, 0.5, 1)), 0.0, 1.0, nullptr, {2}));
  add("kron_2", family_problem(Family(kron(7, 2, 0.5, 2)), 0.0, 1.0, nullptr, {6, 1}));
  add("kron_1_of_2", family_problem(Family(kron(7, 0, 0.5, 2)), 0.0, 1.0, nullptr, {3}));
  add("underdetermined", family_problem(Family(lin_underdet().family), 0.0, 1.0, nullptr, {2}));
  add("underdetermined_other", family_problem(Family(lin_underdet().family), 0.0, 1.0, nullptr, {0}));
  add("too_many", family_problem(Family(kron(6, 1)), 0.0, 1.0, nullptr, {0}));
  add("failing",
      family_problem(Family(kron(6, 1, 0.5, 1)), 0.0, 1.0,
                     [](char which, double t, int, double*) { return which == 'p' && t > 0.4 ? 1 : 0; }, {2}));
}

void add_failing_callbacks(Runs& runs) {
  const auto add = [&runs](const std::string& name, const Interference& interference) {
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      runs.push_back({"callback_" + name + "_" + name_of(method), [=](Trace& trace) {
                        const Problem problem = family_problem(chain_family(), 0.0, 1.5, interference);
                        solve(trace, problem, options_of(method), {.outputs = 3});
                      }});
  };
  const auto answer_after = [](char function, double time, int answer) {
    return [=](char which, double t, int, double*) { return which == function && t > time ? answer : 0; };
  };
  const auto value_after = [](char function, double time, double value) {
    return [=](char which, double t, int, double* values) {
      if (which == function && t > time) values[0] = value;
      return 0;
    };
  };
  add("A_fails_late", answer_after('A', 0.7, 1));
  add("f_stops_late", answer_after('f', 0.7, -1));
  add("E_fails_at_start", answer_after('E', -1.0, 7));
  add("f_stops_at_start", answer_after('f', -1.0, -2));
  add("A_nan_late", value_after('A', 0.7, std::nan("")));
  add("f_inf_late", value_after('f', 0.7, inf));
  add("f_nan_at_start", value_after('f', -1.0, std::nan("")));
  add("missing_late", answer_after('A', 0.7, SFDAE_ORDER_NOT_AVAILABLE));
  add("fails_for_a_while", [](char which, double t, int, double*) { return which == 'f' && t > 0.5 && t < 0.51; });
  add("jump", [](char which, double t, int order, double* values) {
    if (which == 'f' && t > 0.6 && order == 0) values[4] += 0.3;
    return 0;
  });
}

void add_derivative_checks(Runs& runs) {
  const auto add = [&runs](const std::string& name, const Interference& interference) {
    runs.push_back({"check_" + name, [=](Trace& trace) {
                      const Problem problem = family_problem(Family(kron(4, 1)), 0.0, 1.0, interference);
                      Session session(trace, problem, options_of());
                      for (const int order : {1, 3, 13}) {
                        sfdae_derivative_check check;
                        sfdae_derivative_check_init(&check, sizeof check);
                        session.called("check", sfdae_check_derivatives(session.solver(), 0.4, order, &check));
                        trace_check(trace, check);
                      }
                    }});
  };
  add("right", nullptr);
  for (const char function : {'E', 'A', 'f'})
    for (const int wrong_order : {1, 2})
      add(std::string("wrong_") + function + "_" + std::to_string(wrong_order),
          [=](char which, double, int order, double* values) {
            if (which == function && order == wrong_order) values[1] += 1e-3;
            return 0;
          });
  add("missing", [](char, double, int order, double*) { return order > 1 ? SFDAE_ORDER_NOT_AVAILABLE : 0; });
  add("failing", [](char which, double, int, double*) { return which == 'A' ? 3 : 0; });
}

void interpolate_within_steps(Trace& trace, int method) {
  const Problem problem = chain_problem();
  Session session(trace, problem, options_of(method));
  session.start();
  session.advance(0.5);
  sfdae_statistics s;
  sfdae_statistics_init(&s, sizeof s);
  sfdae_get_statistics(session.solver(), &s);
  for (const double part : {-0.5, 0.0, 0.01, 0.3, 0.7, 1.0, 1.5})
    session.interpolate(s.t_internal - (1.0 - part) * s.last_step);
  session.outputs(1.5, 2);
  session.describe();
}

void stop_and_go_on(Trace& trace, int method) {
  const Problem problem = chain_problem();
  Session session(trace, problem, options_of(method));
  session.start();
  session.stop_after = 4;
  session.outputs(0.5, 2);
  session.stop_after = 0;
  session.called("request_stop", sfdae_request_stop(session.solver()));
  session.advance(1.0);
  session.outputs(1.5, 2);
  session.describe();
}

void restart_elsewhere(Trace& trace, int method) {
  const Problem problem = chain_problem();
  Session session(trace, problem, options_of(method));
  session.start();
  session.outputs(0.7, 2);
  std::vector<double> pushed = session.x;
  pushed[6] += 1.0;
  session.start(0.7, 1.5, pushed);
  session.outputs(1.5, 2);
  session.start(1.5, 0.0, session.x);
  session.outputs(0.2, 3);
  session.advance(0.5);
  session.describe();
}

void change_options(Trace& trace, int method) {
  const Problem problem = chain_problem();
  sfdae_options options = options_of(method, 1e-4);
  Session session(trace, problem, options);
  session.start();
  session.outputs(0.5, 2);
  options.rtol = options.atol = 1e-8;
  session.set_options(options);
  session.outputs(0.8, 2);
  options.max_order = 2;
  options.method = SFDAE_METHOD_RADAU - method;
  session.set_options(options);
  session.advance(1.0);
  options.reduction = SFDAE_REDUCTION_SVD;
  session.set_options(options);
  session.advance(1.2);
  session.start(1.0, 1.5, session.x);
  session.outputs(1.5, 2);
  options.rtol = -1.0;
  session.set_options(options);
  session.describe();
}

void integrate_backward(Trace& trace, int method) {
  const Problem problem = family_problem(Family(kron(7, 2)), 1.0, -0.5);
  solve(trace, problem, options_of(method, 1e-8), {.outputs = 5, .checkpoint = true, .events = true});
}

void look_for_directed_events(Trace& trace, int method) {
  const Problem problem = family_problem(chain_family(), 0.0, 6.0);
  for (const std::vector<int>& directions :
       {std::vector<int>{1, -1, 0}, std::vector<int>{-1, 1, 1}, std::vector<int>{0, 2, 0}}) {
    Session session(trace, problem, options_of(method));
    session.set_events(0.4, directions);
    session.start();
    session.outputs(6.0, 2);
    session.describe();
  }
}

void restore_what_does_not_fit(Trace& trace, int method) {
  const Problem problem = chain_problem(), other = family_problem(Family(kron(9, 1)), 0.0, 1.0);
  Session session(trace, problem, options_of(method));
  session.checkpoint();
  session.start();
  session.advance(0.6);
  std::vector<double> saved = session.checkpoint();
  Session second(trace, other, options_of(method));
  second.restore(saved);
  second.describe();
  Session third(trace, problem, options_of(SFDAE_METHOD_RADAU - method));
  third.restore(saved);
  third.describe();
  saved[saved.size() / 2] += 1.0;
  session.restore(saved);
  saved.pop_back();
  session.restore(saved);
  session.advance(1.0);
  session.describe();
}

void call_out_of_turn(Trace& trace) {
  const Problem problem = chain_problem();
  Session session(trace, problem, options_of());
  session.advance(1.0);
  session.step(1.0);
  session.interpolate(0.0);
  session.describe();
  session.inspect(0.0, 1);
  session.analyze(0.0, 0.0);
  session.analyze(0.0, std::nan(""));
  session.analyze(0.5, 1.0);
  session.analyze_at(0.5, 1.0);
  session.advance(1.0);
  session.make_consistent(0.2, problem.x0);
  session.start();
  session.advance(-1.0);
  session.advance(inf);
  session.advance(0.0);
  session.advance(1.0);
  session.make_consistent(0.2, problem.x0);
  session.advance(1.5);
  session.inspect(0.0, 13);
  session.called("get_decision", sfdae_get_decision(session.solver(), 1000, nullptr));
  session.called("set_parameter", sfdae_set_parameter(session.solver(), "g", 1.0));
  session.called("get_multibody_report", sfdae_get_multibody_report(session.solver(), nullptr));
  session.describe();
}

void add_sequences(Runs& runs) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    const auto add = [&](const std::string& name, void (*sequence)(Trace&, int)) {
      runs.push_back({"sequence_" + name + "_" + name_of(method), [=](Trace& trace) { sequence(trace, method); }});
    };
    add("interpolation", interpolate_within_steps);
    add("stops", stop_and_go_on);
    add("restart", restart_elsewhere);
    add("options", change_options);
    add("backward", integrate_backward);
    add("event_directions", look_for_directed_events);
    add("checkpoint_misfits", restore_what_does_not_fit);
  }
  runs.push_back({"sequence_out_of_turn", call_out_of_turn});
}

void add_contradictions(Runs& runs) {
  for (const double rho : {1e-12, 1e-7, 1e-2})
    for (const bool ignored : {false, true})
      for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
        LinearTestProblem p = redundant_row(rho);
        const Problem problem = family_problem(Family(std::move(p.family)), p.t0, p.tf).from(p.x0);
        sfdae_options options = options_of(method);
        options.ignore_inconsistency = ignored ? 1 : 0;
        runs.push_back({"contradiction_" + std::to_string(static_cast<int>(-std::log10(rho))) +
                            (ignored ? "_ignored_" : "_") + name_of(method),
                        [=](Trace& trace) { solve(trace, problem, options); }});
      }
}

}  // namespace

void add_linear_option_runs(Runs& runs) {
  add_options(runs);
  add_difference_derivatives(runs);
  add_initial_values(runs);
  add_prescribed(runs);
  add_failing_callbacks(runs);
  add_derivative_checks(runs);
  add_sequences(runs);
  add_contradictions(runs);
}

}  // namespace sfdae_bench
