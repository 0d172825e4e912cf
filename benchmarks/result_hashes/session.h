// SPDX-License-Identifier: BSD-3-Clause
// A solver of which every call is traced: returned status, message, values, accepted steps.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "problem.h"
#include "trace.h"

namespace sfdae_bench {

class Session {
 public:
  // Traces what is wrong if nothing could be created. The problem has to live as long.
  Session(Trace& trace, const Problem& problem, const sfdae_options& options);
  ~Session() { sfdae_destroy(&solver_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  explicit operator bool() const { return solver_ != nullptr; }
  sfdae_solver* solver() const { return solver_; }

  // Traces status and message of a call that has been made.
  int called(const char* name, int status);

  int analyze(double t0, double toward) { return called("analyze", sfdae_analyze(solver_, t0, toward, nullptr)); }
  int analyze_at(double t0, double toward) {
    return called("analyze_at", sfdae_analyze_at(solver_, t0, toward, x.data(), nullptr));
  }
  int start(double t0, double toward, const std::vector<double>& guess);
  int start() { return start(problem_.t0, problem_.tf, problem_.x0); }
  int make_consistent(double at, std::vector<double> guess);
  int advance(double tout);
  int step(double tout);
  // Equidistant outputs up to tout; goes on after events. False if the integration cannot go on.
  bool outputs(double tout, int count);
  int interpolate(double at);
  int set_options(const sfdae_options& options);

  std::vector<double> checkpoint();
  int restore(const std::vector<double>& checkpoint);
  // g_0 = x_0 - level, g_1 = x'_last, g_2 = sin 3 t.
  void set_events(double level, const std::vector<int>& directions = {});

  // Characteristic values, rank decisions, reports, statistics.
  void describe();
  void characteristics();
  void decisions();
  void inspect(double at, int level);  // derivative array, projectors, strangeness-free system

  int stop_after = 0;  // steps after which the monitor stops a call; 0: never
  double t = 0.0;
  std::vector<double> x, xdot;

 private:
  static int observe(const sfdae_progress* progress, void* user);
  static int evaluate_events(double t, const double* x, const double* xdot, double* g, void* user);
  int reached(const char* name, int status);
  sfdae_options observed(sfdae_options options);

  Trace& trace_;
  const Problem& problem_;
  sfdae_solver* solver_ = nullptr;
  int steps_seen_ = 0;
  double event_level_ = 0.0;
};

void trace_check(Trace& trace, const sfdae_derivative_check& check);

// How a run proceeds.
struct Plan {
  int outputs = 4;
  bool by_steps = false;    // one-step mode
  bool checkpoint = false;  // saved half way, restored into a second solver, both go on
  bool events = false;
};
void solve(Trace& trace, const Problem& problem, const sfdae_options& options, const Plan& plan = {});

}  // namespace sfdae_bench
