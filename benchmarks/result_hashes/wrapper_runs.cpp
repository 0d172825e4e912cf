// SPDX-License-Identifier: BSD-3-Clause
// The C++ wrapper: results and exceptions.
#include <cmath>
#include <stdexcept>
#include <string>

#include "problem.h"
#include "sfdae/sfdae.hpp"
#include "trace.h"

namespace sfdae_bench {

namespace {

// Traces what a call throws.
template <class Call>
void attempt(Trace& trace, const char* name, Call call) {
  try {
    if constexpr (std::is_void_v<decltype(call())>) {
      call();
      trace.text(name, "done");
    } else {
      trace.text(name, sfdae::status_name(call()));
    }
  } catch (const sfdae::Error& error) {
    trace.text(name, std::string("Error ") + sfdae::status_name(error.status()) + ": " + error.what());
  } catch (const std::exception& exception) {
    trace.text(name, std::string("exception: ") + exception.what());
  }
}

void trace_point(Trace& trace, const sfdae::Point& point) {
  trace.number("t", point.t);
  trace.numbers("x", point.x);
  trace.numbers("xdot", point.xdot);
}

void trace_matrix(Trace& trace, const sfdae::Matrix& matrix) {
  trace.numbers("matrix", matrix.data(), size(matrix.rows() * matrix.columns()));
}

sfdae::LinearProblem linear(double fails_after) {
  sfdae::LinearProblem problem(2, 2);
  problem.E = [](double t, int order, sfdae::MatrixRef E) {
    if (order == 0) E(1, 0) = 1.0, E(1, 1) = -t;
    if (order == 1) E(1, 1) = -1.0;
  };
  problem.A = [](double t, int order, sfdae::MatrixRef A) {
    if (order == 0) A(0, 0) = -1.0, A(0, 1) = t;
    if (order == 1) A(0, 1) = 1.0;
  };
  problem.f = [=](double t, int order, sfdae::VectorRef f) {
    if (t > fails_after) throw std::runtime_error("f is not known here");
    f[0] = order % 2 == 0 ? std::exp(-t) : -std::exp(-t);
  };
  return problem;
}

sfdae::MultibodyProblem pendulum() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [](const sfdae::Expression& t, auto q, auto, const auto& to) {
    to.M(0, 0) = to.M(1, 1) = parameter(t, "mass", 2.0);
    to.f[1] = -9.81 * parameter(t, "mass", 1.0);
    to.g[0] = q[0] * q[0] + q[1] * q[1] - 1.0;
  };
  return problem;
}

template <class Solver>
void trace_state(Trace& trace, Solver& solver) {
  attempt(trace, "state", [&] {
    const sfdae::Characteristics c = solver.characteristics();
    for (const int value : {c.strangeness_index, c.differential, c.algebraic}) trace.integer("value", value);
    trace.integer("decisions", static_cast<long long>(solver.decisions().size()));
    trace.number("change", solver.initial_report().largest_change);
    trace.integer("steps", solver.statistics().steps);
    trace.text("report", solver.report());
    trace.text("message", solver.message());
  });
  attempt(trace, "change", [&] { trace.number("change", solver.change().t); });
  attempt(trace, "multibody", [&] { trace.number("condition", solver.multibody_report().condition); });
}

void linear_wrapper(Trace& trace, double fails_after) {
  sfdae::Options options;
  options.rtol_vector = {1e-6, 1e-7};
  options.monitor = [&trace](const sfdae::Progress& p) {
    trace.number("step", p.t);
    return p.steps == 3;
  };
  sfdae::Solver solver(linear(fails_after), options);
  sfdae::Point point{0.0, {1.1, 1.0}, {}};
  attempt(trace, "advance", [&] { return solver.advance(1.0, point); });
  attempt(trace, "start", [&] { return solver.start(point, 1.0); });
  trace_point(trace, point);
  for (int i = 1; i <= 4; ++i) {
    attempt(trace, "advance", [&] { return solver.advance(0.25 * i, point); });
    trace_point(trace, point);
  }
  attempt(trace, "inspect", [&] {
    const sfdae::DerivativeArray array = solver.derivative_array(0.3, 1);
    trace_matrix(trace, array.M);
    trace_matrix(trace, array.N);
    trace.numbers("g", array.g);
    const sfdae::Projectors p = solver.projectors(0.3);
    for (const auto& matrix : {p.Z1, p.Z2, p.Z3, p.T2}) trace_matrix(trace, matrix);
    const sfdae::StrangenessFreeSystem s = solver.strangeness_free(0.3);
    for (const auto& matrix : {s.E1, s.A1, s.A2}) trace_matrix(trace, matrix);
    trace.number("error", solver.check_derivatives(0.3, 2).error);
  });
  trace_state(trace, solver);
  attempt(trace, "options", [&] {
    options.atol_vector = {1.0};
    return solver.set_options(options);
  });
  attempt(trace, "directions", [&] { return solver.set_events(2, nullptr, {1}); });
  attempt(trace, "parameter", [&] { return solver.set_parameter("k", 1.0); });
  point.x.pop_back();
  attempt(trace, "start", [&] { return solver.start(point, 1.0); });
}

void multibody_wrapper(Trace& trace, int method) {
  sfdae::Options options;
  options.method = method;
  sfdae::Solver solver(pendulum(), options);
  solver.set_events(2,
                    [](double, sfdae::ConstVectorRef x, sfdae::ConstVectorRef xdot, sfdae::VectorRef g) {
                      g[0] = x[0];
                      g[1] = xdot[3];
                    },
                    {0, 1});
  sfdae::Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
  attempt(trace, "start", [&] { return solver.start(point, 3.0); });
  for (int i = 0; i < 8 && point.t < 2.0; ++i) {
    attempt(trace, "advance", [&] { return solver.advance(2.0, point); });
    trace_point(trace, point);
    for (const int sign : solver.events()) trace.integer("event", sign);
  }
  const std::vector<double> saved = solver.save_checkpoint();
  trace.numbers("checkpoint", saved);
  sfdae::Solver second(pendulum(), options);
  attempt(trace, "restore", [&] { return second.restore_checkpoint(saved); });
  second.set_events(2, [](double, auto, auto, auto) {});
  attempt(trace, "restore", [&] { return second.restore_checkpoint(saved); });
  attempt(trace, "restore", [&] { return second.restore_checkpoint({}); });
  attempt(trace, "parameter", [&] { return solver.set_parameter("mass", 3.0); });
  attempt(trace, "advance", [&] { return solver.advance(3.0, point); });
  trace.number("mass", solver.parameter("mass"));
  attempt(trace, "check", [&] {
    trace.number("error", solver.check_multibody_derivatives(0.0, {0.6, 0.8}, {0.0, 0.0}).error);
  });
  attempt(trace, "check", [&] {
    trace.number("error", solver.check_multibody_derivatives(0.0, {0.6}, {0.0, 0.0}).error);
  });
  trace_state(trace, solver);
}

void refusals(Trace& trace) {
  sfdae::Options options;
  options.rtol = -1.0;
  trace.text("check", sfdae::Solver::check(linear(9.0), options));
  trace.text("check", sfdae::Solver::check(pendulum(), options));
  trace.text("check", sfdae::Solver::check(pendulum()));
  attempt(trace, "create", [&] { sfdae::Solver(linear(9.0), options); });
  attempt(trace, "create", [&] { sfdae::Solver(sfdae::LinearProblem(1, 1)); });
  attempt(trace, "create", [&] { sfdae::Solver(sfdae::NonlinearProblem(0, 1)); });
  sfdae::NonlinearProblem throwing(1, 1);
  throwing.equations = [](const auto&, auto, auto, auto) { throw std::runtime_error("no equations today"); };
  attempt(trace, "create", [&] { sfdae::Solver solver(throwing); });
  sfdae::NonlinearProblem counted(1, 1);
  counted.equations = [](const auto&, auto x, auto xdot, auto F) { F[0] = xdot[0] + x[0]; };
  counted.differentiations = {1, 2};
  attempt(trace, "create", [&] { sfdae::Solver solver(counted); });
  sfdae::MultibodyProblem callbacks(2, 1);
  attempt(trace, "create", [&] { sfdae::Solver solver(callbacks); });
}

}  // namespace

void add_wrapper_runs(Runs& runs) {
  runs.push_back({"wrapper_linear", [](Trace& trace) { linear_wrapper(trace, 9.0); }});
  runs.push_back({"wrapper_linear_throws", [](Trace& trace) { linear_wrapper(trace, 0.6); }});
  runs.push_back({"wrapper_linear_throws_at_start", [](Trace& trace) { linear_wrapper(trace, -1.0); }});
  runs.push_back({"wrapper_multibody_bdf", [](Trace& trace) { multibody_wrapper(trace, SFDAE_METHOD_BDF); }});
  runs.push_back({"wrapper_multibody_radau", [](Trace& trace) { multibody_wrapper(trace, SFDAE_METHOD_RADAU); }});
  runs.push_back({"wrapper_refusals", refusals});
}

}  // namespace sfdae_bench
