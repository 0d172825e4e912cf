// Problems of strangeness index 0, n = 20 ... 400, beside IDA with dense matrices: processor time for start (recording,
// index analysis, consistent values) and for the integration, and correct digits at the end, at rtol = atol = tol. The
// last columns are IDA's time for all at the same digits, interpolated between its tolerances, and the ratios to it.
//
//   index0_cost [problem [n [tol [bdf|radau]]]]      one run alone, without IDA, where all four are given
//
//   brusselator  u' = 1 + u^2 v - 4 u + a u_xx, v' = 3 u - u^2 v + a v_xx, a = 1/50, by lines, to t = 10 [HW96, IV.10]
//   heat         (1 + u^2) u' = (exp(u) u_x)_x + sin(pi x) cos t, u = 0 at both ends as equations, by lines, to t = 1
//   ring         the ring modulator with capacities Cs = 2e-12 F, n = 15, to t = 1e-4: stiff oscillations [MM08]
//   network      x_i' = -x_i + 0.3 x_(i+1) z_i - 0.1 z_(i+3), 0 = z_i + 0.1 z_i^3 - sin x_i - 0.2 z_(i+1), to t = 5
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// [MM08] F. Mazzia, C. Magherini: Test Set for Initial Value Problem Solvers, release 2.4. Bari, 2008.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "ida_solver.h"
#include "sfdae/expression.hpp"
#include "sfdae/sfdae.h"

namespace {

using sfdae_bench::PeerProblem;
using sfdae_bench::SolverRun;

constexpr double pi = 3.14159265358979323846;

int current_n = 0;  // of the residuals below, as IDA's callbacks have no data of their own

template <class V>
void brusselator(const V&, const V* x, const V* xdot, V* F) {
  using std::exp, std::sin, std::cos;
  const int points = current_n / 2;
  const double per_square = 0.02 * (points + 1) * (points + 1);
  for (int i = 0; i < points; ++i) {
    // u and v in turn, so that neighbours are close.
    const auto at = [&](int k, int which, double border) {
      return k < 0 || k >= points ? V(border) : V(x[2 * k + which]);
    };
    const V &u = x[2 * i], &v = x[2 * i + 1];
    const V square = u * u * v;
    F[2 * i] =
        xdot[2 * i] - (1.0 + square - 4.0 * u + per_square * (at(i - 1, 0, 1.0) - 2.0 * u + at(i + 1, 0, 1.0)));
    F[2 * i + 1] =
        xdot[2 * i + 1] - (3.0 * u - square + per_square * (at(i - 1, 1, 3.0) - 2.0 * v + at(i + 1, 1, 3.0)));
  }
}

template <class V>
void heat(const V& t, const V* x, const V* xdot, V* F) {
  using std::exp, std::sin, std::cos;
  const int n = current_n;
  const double per_square = (n - 1.0) * (n - 1.0);
  const V c = cos(t);
  // The inner points first.
  const auto u = [&](int k) -> const V& { return k == 0 ? x[n - 2] : k == n - 1 ? x[n - 1] : x[k - 1]; };
  for (int i = 1; i < n - 1; ++i) {
    const V right = exp(0.5 * (u(i) + u(i + 1))), left = exp(0.5 * (u(i) + u(i - 1)));
    F[i - 1] = (1.0 + u(i) * u(i)) * xdot[i - 1] -
               per_square * (right * (u(i + 1) - u(i)) - left * (u(i) - u(i - 1))) -
               10.0 * std::sin(pi * i / (n - 1.0)) * c;
  }
  F[n - 2] = x[n - 2];
  F[n - 1] = x[n - 1];
}

template <class V>
void network(const V&, const V* x, const V* xdot, V* F) {
  using std::exp, std::sin, std::cos;
  const int h = current_n / 2;
  for (int i = 0; i < h; ++i) {
    const V& z = x[h + i];
    F[i] = xdot[i] + x[i] - 0.3 * x[(i + 1) % h] * z + 0.1 * x[h + (i + 3) % h];
    F[h + i] = z + 0.1 * z * z * z - sin(x[i]) - 0.2 * x[h + (i + 1) % h];
  }
}

// Both currents and voltages, in A and V, as [MM08] has them.
template <class V>
void ring_modulator(const V& t, const V* y, const V* ydot, V* F) {
  using std::exp, std::sin, std::cos;
  constexpr double C = 1.6e-8, Cs = 2e-12, Cp = 1e-8, Lh = 4.45, Ls1 = 2e-3, Ls2 = 5e-4, Ls3 = 5e-4;
  constexpr double R = 25000.0, Rp = 50.0, Rg1 = 36.3, Rg2 = 17.3, Rg3 = 17.3, Ri = 50.0, Rc = 600.0;
  const auto diode = [](const V& U) { return 40.67286402e-9 * (exp(17.7493332 * U) - 1.0); };
  const V in1 = 0.5 * sin(2e3 * pi * t), in2 = 2.0 * sin(2e4 * pi * t);
  const V q1 = diode(y[2] - y[4] - y[6] - in2), q2 = diode(-y[3] + y[5] - y[6] - in2);
  const V q3 = diode(y[3] + y[4] + y[6] + in2), q4 = diode(-y[2] - y[5] + y[6] + in2);
  F[0] = C * ydot[0] - (y[7] - 0.5 * y[9] + 0.5 * y[10] + y[13] - y[0] / R);
  F[1] = C * ydot[1] - (y[8] - 0.5 * y[11] + 0.5 * y[12] + y[14] - y[1] / R);
  F[2] = Cs * ydot[2] - (y[9] - q1 + q4);
  F[3] = Cs * ydot[3] - (-y[10] + q2 - q3);
  F[4] = Cs * ydot[4] - (y[11] + q1 - q3);
  F[5] = Cs * ydot[5] - (-y[12] - q2 + q4);
  F[6] = Cp * ydot[6] - (-y[6] / Rp + q1 + q2 - q3 - q4);
  F[7] = Lh * ydot[7] + y[0];
  F[8] = Lh * ydot[8] + y[1];
  F[9] = Ls2 * ydot[9] - (0.5 * y[0] - y[2] - Rg2 * y[9]);
  F[10] = Ls3 * ydot[10] - (-0.5 * y[0] + y[3] - Rg3 * y[10]);
  F[11] = Ls2 * ydot[11] - (0.5 * y[1] - y[4] - Rg2 * y[11]);
  F[12] = Ls3 * ydot[12] - (-0.5 * y[1] + y[5] - Rg3 * y[12]);
  F[13] = Ls1 * ydot[13] - (-y[0] + in1 - (Ri + Rg1) * y[13]);
  F[14] = Ls1 * ydot[14] - (-y[1] - (Rc + Rg1) * y[14]);
}

struct Problem {
  const char* name;
  double tf;
  void (*ida)(int, double, const double*, const double*, double*);
  void (*record)(const sfdae::Expression&, const sfdae::Expression*, const sfdae::Expression*, sfdae::Expression*);
  double (*start)(int, int);  // component of n
  int (*differential)(int);
  int only_n = 0;  // 0: of any size
};

const Problem problems[] = {
    {"brusselator", 10.0,
     [](int, double t, const double* x, const double* xdot, double* F) { brusselator(t, x, xdot, F); },
     &brusselator<sfdae::Expression>,
     [](int i, int n) { return i % 2 == 0 ? 1.0 + std::sin(2.0 * pi * (i / 2 + 1) / (n / 2 + 1)) : 3.0; },
     [](int n) { return n; }},
    {"heat", 1.0, [](int, double t, const double* x, const double* xdot, double* F) { heat(t, x, xdot, F); },
     &heat<sfdae::Expression>, [](int i, int n) { return i < n - 2 ? std::sin(pi * (i + 1) / (n - 1.0)) : 0.0; },
     [](int n) { return n - 2; }},
    {"network", 5.0, [](int, double t, const double* x, const double* xdot, double* F) { network(t, x, xdot, F); },
     &network<sfdae::Expression>, [](int i, int n) { return i < n / 2 ? 0.5 + 0.01 * (i % 50) : 0.5; },
     [](int n) { return n / 2; }},
    {"ring", 1e-4,
     [](int, double t, const double* x, const double* xdot, double* F) { ring_modulator(t, x, xdot, F); },
     &ring_modulator<sfdae::Expression>, [](int, int) { return 0.0; }, [](int n) { return n; }, 15}};

int write(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
          sfdae_expression* residual, void* user) {
  const auto& problem = *static_cast<const Problem*>(user);
  const std::vector<sfdae::Expression> unknowns(x, x + current_n), slopes(xdot, xdot + current_n);
  std::vector<sfdae::Expression> F(static_cast<std::size_t>(current_n));
  problem.record(sfdae::Expression(t), unknowns.data(), slopes.data(), F.data());
  std::transform(F.begin(), F.end(), residual, [](const sfdae::Expression& e) { return e.c(); });
  return 0;
}

double milliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Run {
  double start = 0.0, integration = 0.0;
  std::vector<double> x;
  sfdae_statistics counts;
  std::string failure;
};

Run solve(const Problem& problem, double tol, int method) {
  Run run;
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  options.method = method;
  options.max_steps = 1000000;
  options.use_stop_time = 1;
  options.stop_time = problem.tf;
  sfdae_nonlinear_problem equations;
  sfdae_nonlinear_problem_init(&equations, sizeof equations);
  equations.num_equations = equations.num_unknowns = current_n;
  equations.equations = &write;
  equations.user = const_cast<Problem*>(&problem);
  for (int i = 0; i < current_n; ++i) run.x.push_back(problem.start(i, current_n));
  std::vector<double> xdot(run.x.size());
  sfdae_solver* solver = nullptr;
  double t = 0.0;
  const double begin = milliseconds();
  int status = sfdae_create_nonlinear(&solver, &equations, &options);
  if (status >= 0) status = sfdae_start(solver, t, problem.tf, run.x.data(), xdot.data());
  run.start = milliseconds() - begin;
  if (status >= 0) status = sfdae_advance(solver, problem.tf, &t, run.x.data(), xdot.data());
  run.integration = milliseconds() - begin - run.start;
  if (status < 0) run.failure = std::string(sfdae_status_name(status)) + ": " + sfdae_message(solver);
  sfdae_statistics_init(&run.counts, sizeof run.counts);
  sfdae_get_statistics(solver, &run.counts);
  sfdae_destroy(&solver);
  return run;
}

PeerProblem peer(const Problem& problem) {
  PeerProblem peer;
  peer.problem = problem.name;
  peer.residual = problem.ida;
  peer.tf = problem.tf;
  for (int i = 0; i < current_n; ++i) peer.x0.push_back(problem.start(i, current_n));
  peer.xdot0.assign(peer.x0.size(), 0.0);
  peer.differential = problem.differential(current_n);
  // Without algebraic unknowns x' has to be given; it occurs as it is, or at rest vanishes.
  if (peer.differential == current_n) {
    std::vector<double> slope(peer.x0.size());
    problem.ida(0, 0.0, peer.x0.data(), peer.xdot0.data(), slope.data());
    for (std::size_t i = 0; i < slope.size(); ++i) peer.xdot0[i] = -slope[i];
  }
  return peer;
}

// Of the worst component, relative to its size or, where it is small, to 1e-2.
double digits(const std::vector<double>& x, const std::vector<double>& reference) {
  double worst = 1e-16;
  for (std::size_t i = 0; i < x.size(); ++i)
    worst = std::max(worst, std::fabs(x[i] - reference[i]) / std::max(1e-2, std::fabs(reference[i])));
  return -std::log10(worst);
}

struct PeerRun {
  double digits, milliseconds;
};

// Milliseconds at so many digits; beyond the ends by the nearest two runs.
double at_digits(const std::vector<PeerRun>& runs, double wanted) {
  std::size_t k = 1;
  while (k + 1 < runs.size() && runs[k].digits < wanted) ++k;
  const PeerRun &a = runs[k - 1], &b = runs[k];
  const double slope = (std::log(b.milliseconds) - std::log(a.milliseconds)) / (b.digits - a.digits);
  return a.milliseconds * std::exp(slope * (wanted - a.digits));
}

// The best of several rounds in which all are solved one after the other: the speed of a machine may change with what
// else it does.
void compare(const Problem& problem, int n) {
  current_n = n;
  if (!sfdae_bench::ida_is_available()) return;
  const PeerProblem peer_problem = peer(problem);
  const std::vector<double> reference = sfdae_bench::solve_with_ida(peer_problem, 1e-11).x;
  const std::vector<double> peer_tolerances = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};
  const std::vector<double> tolerances = {1e-4, 1e-6, 1e-8};
  std::vector<SolverRun> peer_runs(peer_tolerances.size());
  std::vector<double> peer_times(peer_tolerances.size(), 1e300);
  std::vector<Run> runs(tolerances.size());
  for (int round = 0; round < (n > 100 ? 1 : n > 20 ? 5 : 25); ++round) {
    for (std::size_t k = 0; k < peer_runs.size(); ++k) {
      const double begin = milliseconds();
      peer_runs[k] = sfdae_bench::solve_with_ida(peer_problem, peer_tolerances[k]);
      peer_times[k] = std::min(peer_times[k], milliseconds() - begin);
    }
    for (std::size_t k = 0; k < runs.size(); ++k) {
      Run run = solve(problem, tolerances[k], SFDAE_METHOD_BDF);
      if (round == 0 || run.start + run.integration < runs[k].start + runs[k].integration) runs[k] = run;
    }
  }
  std::vector<PeerRun> peers;
  for (std::size_t k = 0; k < peer_runs.size(); ++k) {
    const SolverRun& run = peer_runs[k];
    if (!run.failure.empty()) continue;
    std::printf("%-12s %4d %-6s %7.0e %6.2f %9s %9.2f %6ld %6ld %6ld\n", problem.name, n, "IDA", peer_tolerances[k],
                digits(run.x, reference), "", peer_times[k], run.steps, run.evaluations, run.factorizations);
    if (peers.empty() || digits(run.x, reference) > peers.back().digits + 0.2)
      peers.push_back({digits(run.x, reference), peer_times[k]});
  }
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Run& best = runs[k];
    if (!best.failure.empty()) {
      std::printf("%-12s %4d %-6s %7.0e %s\n", problem.name, n, "BDF", tolerances[k], best.failure.c_str());
      continue;
    }
    const double found = digits(best.x, reference), ida = at_digits(peers, found);
    std::printf(
        "%-12s %4d %-6s %7.0e %6.2f %9.2f %9.2f %6ld %6ld %6ld %6ld | IDA %9.2f  all %6.2f  integration %6.2f\n",
        problem.name, n, "BDF", tolerances[k], found, best.start, best.integration, best.counts.steps,
        best.counts.evaluations_F, best.counts.linearizations, best.counts.factorizations, ida,
        (best.start + best.integration) / ida, best.integration / ida);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc > 1 ? argv[1] : "all";
  const int only = argc > 2 ? std::atoi(argv[2]) : 0;
  if (argc > 4) {
    current_n = only;
    for (const Problem& problem : problems) {
      if (wanted != problem.name) continue;
      const Run run =
          solve(problem, std::atof(argv[3]), std::string(argv[4]) == "bdf" ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU);
      std::printf("start %.3f integration %.3f steps %ld F %ld linearizations %ld factorizations %ld x0 %.15g %s\n",
                  run.start, run.integration, run.counts.steps, run.counts.evaluations_F, run.counts.linearizations,
                  run.counts.factorizations, run.x[0], run.failure.c_str());
    }
    return 0;
  }
  std::printf("%-12s %4s %-6s %7s %6s %9s %9s %6s %6s %6s %6s\n", "problem", "n", "solver", "tol", "digits", "start",
              "integr.", "steps", "F", "lin.", "LU");
  for (const Problem& problem : problems)
    for (const int n : {15, 20, 50, 100, 200, 400}) {
      const bool has_size = problem.only_n == 0 ? n >= 20 : n == problem.only_n;
      if (has_size && (wanted == "all" || wanted == problem.name) && (only == 0 || only == n)) compare(problem, n);
    }
}
