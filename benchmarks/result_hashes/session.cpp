// SPDX-License-Identifier: BSD-3-Clause
#include "session.h"

#include <algorithm>
#include <cmath>

namespace sfdae_bench {

Session::Session(Trace& trace, const Problem& problem, const sfdae_options& options)
    : t(problem.t0), x(problem.x0), trace_(trace), problem_(problem) {
  xdot.resize(x.size());
  const sfdae_options with_monitor = observed(options);
  const int status = problem.create(&solver_, &with_monitor);
  trace_.text("create", sfdae_status_name(status));
  if (status >= 0) return;
  const auto [checked, text] = problem.check(&with_monitor);
  trace_.text("check", std::string(sfdae_status_name(checked)) + ": " + text);
}

sfdae_options Session::observed(sfdae_options options) {
  options.monitor = &Session::observe;
  options.monitor_user = this;
  return options;
}

int Session::observe(const sfdae_progress* p, void* user) {
  auto& self = *static_cast<Session*>(user);
  const double step[] = {p->t, p->step, static_cast<double>(p->order), static_cast<double>(p->steps)};
  self.trace_.numbers("  step", step, 4);
  self.trace_.numbers("  x", p->x, size(p->num_unknowns));
  ++self.steps_seen_;
  return self.stop_after > 0 && self.steps_seen_ % self.stop_after == 0 ? 1 : 0;
}

int Session::called(const char* name, int status) {
  trace_.text(name, std::string(sfdae_status_name(status)) + ": " + sfdae_message(solver_));
  return status;
}

int Session::reached(const char* name, int status) {
  called(name, status);
  trace_.number("t", t);
  trace_.numbers("x", x);
  trace_.numbers("xdot", xdot);
  return status;
}

int Session::start(double t0, double toward, const std::vector<double>& guess) {
  t = t0, x = guess;
  return reached("start", sfdae_start(solver_, t, toward, x.data(), xdot.data()));
}

int Session::make_consistent(double at, std::vector<double> guess) {
  std::vector<double> slope(xdot.size(), -7.0);
  const int status = called("make_consistent", sfdae_make_consistent(solver_, at, guess.data(), slope.data()));
  trace_.numbers("x", guess);
  trace_.numbers("xdot", slope);
  sfdae_initial_report report;
  sfdae_initial_report_init(&report, sizeof report);
  called("get_initial_report", sfdae_get_initial_report(solver_, &report));
  trace_.number("change", report.largest_change);
  return status;
}

int Session::advance(double tout) {
  return reached("advance", sfdae_advance(solver_, tout, &t, x.data(), xdot.data()));
}

int Session::step(double tout) { return reached("step", sfdae_step(solver_, tout, &t, x.data(), xdot.data())); }

bool Session::outputs(double tout, int count) {
  constexpr int most_interruptions = 40;
  const double from = t;
  int interruptions = 0;
  for (int i = 1; i <= count; ++i) {
    const double next = i == count ? tout : from + (tout - from) * i / count;
    int status = advance(next);
    for (; status == SFDAE_EVENT || status == SFDAE_STOPPED; status = advance(next)) {
      if (status == SFDAE_EVENT) {
        int which[3] = {9, 9, 9};
        called("get_events", sfdae_get_events(solver_, which));
        for (const int sign : which) trace_.integer("event", sign);
      }
      if (++interruptions > most_interruptions) return false;
    }
    if (status < 0) return false;
  }
  return true;
}

int Session::interpolate(double at) {
  std::vector<double> value(x.size(), -7.0), slope(x.size(), -7.0);
  const int status = called("interpolate", sfdae_interpolate(solver_, at, value.data(), slope.data()));
  trace_.number("t", at);
  trace_.numbers("x", value);
  trace_.numbers("xdot", slope);
  return status;
}

int Session::set_options(const sfdae_options& options) {
  const sfdae_options with_monitor = observed(options);
  return called("set_options", sfdae_set_options(solver_, &with_monitor));
}

std::vector<double> Session::checkpoint() {
  std::size_t length = 0;
  called("get_checkpoint_length", sfdae_get_checkpoint_length(solver_, &length));
  std::vector<double> values(std::max<std::size_t>(length, 1));
  called("save_checkpoint", sfdae_save_checkpoint(solver_, values.data(), length));
  values.resize(length);
  trace_.integer("checkpoint length", static_cast<long long>(length));
  trace_.numbers("checkpoint", values);
  return values;
}

int Session::restore(const std::vector<double>& checkpoint) {
  return called("restore_checkpoint", sfdae_restore_checkpoint(solver_, checkpoint.data(), checkpoint.size()));
}

int Session::evaluate_events(double t, const double* x, const double* xdot, double* g, void* user) {
  const auto& self = *static_cast<const Session*>(user);
  g[0] = x[0] - self.event_level_;
  g[1] = xdot[self.x.size() - 1];
  g[2] = std::sin(3.0 * t);
  return 0;
}

void Session::set_events(double level, const std::vector<int>& directions) {
  event_level_ = level;
  called("set_events", sfdae_set_events(solver_, 3, &Session::evaluate_events,
                                        directions.empty() ? nullptr : directions.data(), this));
}

void Session::characteristics() {
  sfdae_characteristics c;
  sfdae_characteristics_init(&c, sizeof c);
  if (called("get_characteristics", sfdae_get_characteristics(solver_, &c)) < 0) return;
  const int values[] = {c.strangeness_index, c.differential, c.algebraic,   c.undetermined,
                        c.redundant,         c.rank_E,       c.leading_term};
  for (const int value : values) trace_.integer("characteristic", value);
  const double numbers[] = {c.t, c.time_scale, c.smallest_gap};
  trace_.numbers("analysis", numbers, 3);
}

void Session::decisions() {
  int count = 0;
  called("get_num_decisions", sfdae_get_num_decisions(solver_, &count));
  trace_.integer("decisions", count);
  for (int i = 0; i < count; ++i) {
    sfdae_decision d;
    sfdae_decision_init(&d, sizeof d);
    sfdae_get_decision(solver_, i, &d);
    const double all[] = {d.t,
                          static_cast<double>(d.level),
                          static_cast<double>(d.stage),
                          static_cast<double>(d.what),
                          static_cast<double>(d.rows),
                          static_cast<double>(d.columns),
                          static_cast<double>(d.rank),
                          d.kept,
                          d.dropped,
                          d.noise,
                          d.threshold,
                          d.gap,
                          static_cast<double>(d.verdict)};
    trace_.numbers("decision", all, std::size(all));
  }
}

void Session::describe() {
  if (solver_ == nullptr) return;
  characteristics();
  decisions();

  sfdae_initial_report r;
  sfdae_initial_report_init(&r, sizeof r);
  called("get_initial_report", sfdae_get_initial_report(solver_, &r));
  const double initial[] = {r.t,
                            r.residual_before,
                            r.residual_after,
                            r.largest_change,
                            static_cast<double>(r.component),
                            static_cast<double>(r.derivative_exact)};
  trace_.numbers("initial", initial, std::size(initial));

  sfdae_change c;
  sfdae_change_init(&c, sizeof c);
  if (called("get_change", sfdae_get_change(solver_, &c)) >= 0) {
    trace_.number("change", c.t);
    for (const int value :
         {c.old_strangeness_index, c.old_differential, c.old_algebraic, c.old_undetermined, c.old_redundant,
          c.new_strangeness_index, c.new_differential, c.new_algebraic, c.new_undetermined, c.new_redundant})
      trace_.integer("change", value);
  }

  sfdae_statistics s;
  sfdae_statistics_init(&s, sizeof s);
  called("get_statistics", sfdae_get_statistics(solver_, &s));
  for (const long count : {s.steps, s.error_failures, s.other_failures, s.reductions, s.factorizations,
                           s.evaluations_E, s.evaluations_A, s.evaluations_f, static_cast<long>(s.last_order),
                           static_cast<long>(s.next_order), s.evaluations_F, s.linearizations})
    trace_.integer("statistics", count);
  const double numbers[] = {s.last_step,   s.next_step,  s.t_internal, s.smallest_kept,
                            s.consistency, s.first_step, s.rounding};
  trace_.numbers("statistics", numbers, std::size(numbers));

  if (std::holds_alternative<sfdae_multibody_problem>(problem_.c)) {
    sfdae_multibody_report m;
    sfdae_multibody_report_init(&m, sizeof m);
    called("get_multibody_report", sfdae_get_multibody_report(solver_, &m));
    for (const long count :
         {static_cast<long>(m.holonomic), static_cast<long>(m.nonholonomic), static_cast<long>(m.redundant),
          static_cast<long>(m.degrees_of_freedom), static_cast<long>(m.position_freedom), m.partitions})
      trace_.integer("multibody", count);
    const double values[] = {m.t, m.condition, m.position_residual, m.velocity_residual};
    trace_.numbers("multibody", values, std::size(values));
  }

  std::size_t needed = 0;
  called("report", sfdae_report(solver_, nullptr, 0, &needed));
  std::string text(needed, '\0');
  sfdae_report(solver_, text.data(), needed, nullptr);
  text.resize(needed > 0 ? needed - 1 : 0);
  trace_.text("report", text);
}

void Session::inspect(double at, int level) {
  sfdae_characteristics c;
  sfdae_characteristics_init(&c, sizeof c);
  sfdae_get_characteristics(solver_, &c);
  const std::size_t n = size(problem_.n()), d = size(c.differential), a = size(c.algebraic),
                    m = d + a + size(c.redundant), blocks = size(level + 1), rows = m * size(c.strangeness_index + 1);
  trace_.number("inspection at", at);
  std::vector<double> M(blocks * m * blocks * n), N(blocks * m * n), g(blocks * m);
  called("get_derivative_array", sfdae_get_derivative_array(solver_, at, level, M.data(), N.data(), g.data()));
  for (const auto& matrix : {M, N, g}) trace_.numbers("array", matrix);

  int vhat = 0;
  if (called("get_projectors", sfdae_get_projectors(solver_, at, nullptr, nullptr, nullptr, nullptr, &vhat)) < 0)
    return;
  trace_.integer("vhat", vhat);
  std::vector<double> Z1(m * d), Z2(rows * a), Z3(rows * size(vhat)), T2(n * (n - a));
  called("get_projectors", sfdae_get_projectors(solver_, at, Z1.data(), Z2.data(), Z3.data(), T2.data(), &vhat));
  for (const auto& matrix : {Z1, Z2, Z3, T2}) trace_.numbers("projector", matrix);

  std::vector<double> E1(d * n), A1(d * n), f1(d), A2(a * n), f2(a);
  double residual = -7.0;
  called("get_strangeness_free",
         sfdae_get_strangeness_free(solver_, at, E1.data(), A1.data(), f1.data(), A2.data(), f2.data(), &residual));
  for (const auto& matrix : {E1, A1, f1, A2, f2}) trace_.numbers("strangeness-free", matrix);
  trace_.number("residual", residual);
}

void trace_check(Trace& trace, const sfdae_derivative_check& check) {
  trace.text("function", std::string(1, check.function == 0 ? '0' : check.function));
  for (const int value : {check.order, check.row, check.column, check.suspicious}) trace.integer("check", value);
  const double values[] = {check.supplied, check.difference, check.error, check.uncertainty};
  trace.numbers("check", values, std::size(values));
}

void solve(Trace& trace, const Problem& problem, const sfdae_options& options, const Plan& plan) {
  Session session(trace, problem, options);
  if (!session) return;
  if (plan.events) session.set_events(problem.x0.empty() ? 0.0 : problem.x0[0]);
  if (session.start() >= 0) {
    if (plan.by_steps) {
      int status = SFDAE_STEP_TAKEN;
      for (int i = 0; i < 300 && status > 0; ++i) status = session.step(problem.tf);
    } else if (plan.checkpoint) {
      session.outputs(0.5 * (problem.t0 + problem.tf), std::max(1, plan.outputs / 2));
      const std::vector<double> saved = session.checkpoint();
      Session second(trace, problem, options);
      if (plan.events) second.set_events(problem.x0.empty() ? 0.0 : problem.x0[0]);
      if (second.restore(saved) >= 0) {
        second.t = session.t;
        second.outputs(problem.tf, std::max(1, plan.outputs / 2));
        second.describe();
      }
      session.outputs(problem.tf, std::max(1, plan.outputs / 2));
    } else {
      session.outputs(problem.tf, plan.outputs);
    }
  }
  session.describe();
}

}  // namespace sfdae_bench
