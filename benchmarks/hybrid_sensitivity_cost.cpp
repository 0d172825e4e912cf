// What sensitivities of hybrid systems cost beside x: milliseconds of processor time of a run without them, with one
// parameter, with ten where there are so many, with all, and with the adjoint.
//
// Rectifier: a capacitor at a source through a diode, strangeness index 1 while that conducts and 0 else, 400
// transitions at events. Pairs of modes: d differential equations x' = A sin(x), whose A are parameters, and a
// constraint that is solved for an unknown of its own in one mode (mu = 0), and restricts x in the other (mu = 1),
// which jumps by impulses; 8 transitions at times. Run it with OPENBLAS_NUM_THREADS=1. Arguments: nothing; or a
// problem (0, ..., 3), a method (0: BDF, 1: Radau) and a count (-1: all, -2: all with the adjoint), of which one run
// is done, to be profiled or counted.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "sfdae/hybrid.hpp"

namespace {

using sfdae::Expression;

struct System {
  std::string name;
  std::vector<sfdae::NonlinearProblem> modes;
  std::vector<sfdae::Transition> transitions;
  std::vector<std::string> parameters;
  std::vector<double> x;
  double end, tolerance, max_step;  // 0: no limit
};

std::string name_of(int j) { return std::string("p").append(std::to_string(j)); }

// v, i, voltage of the diode; the source has four harmonics, with a phase each.
System rectifier() {
  System system{"rectifier", {}, {}, {}, {0.0, 0.0, 0.0}, 200.0, 1e-8, 0.1};
  for (int j = 0; j < 10; ++j) system.parameters.push_back(name_of(j));
  for (const bool conducts : {false, true}) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [conducts](const Expression& t, auto x, auto xdot, auto F) {
      const auto p = [&](int j, double value) { return sfdae::parameter(t, name_of(j), value); };
      const Expression capacity = p(0, 1.0), load = p(1, 1.0);
      Expression source = 0.0 * t;
      for (int k = 0; k < 4; ++k)
        source =
            source + p(2 + 2 * k, k == 0 ? 1.0 : 0.02) * sin(6.283185307179586 * (k + 1) * t + p(3 + 2 * k, 0.1 * k));
      F[0] = capacity * xdot[0] + load * x[0] - x[1];
      F[1] = x[0] + x[2] - source;
      F[2] = conducts ? x[2] + 0.0 * t : x[1] + 0.0 * t;
    };
    system.modes.push_back(std::move(problem));
    sfdae::Transition transition;
    transition.from = conducts ? 1 : 0;
    transition.to = conducts ? 0 : 1;
    transition.kind = SFDAE_TRANSITION_ZERO;
    transition.direction = conducts ? -1 : 1;
    transition.function = [conducts](double, auto x, auto) { return conducts ? x[1] : x[2]; };
    system.transitions.push_back(std::move(transition));
  }
  return system;
}

System pair(int d) {
  System system{std::to_string(d * (d + 1)) + " parameters",  {},  {},   {},
                std::vector<double>(std::size_t(d + 1), 1.0), 9.0, 1e-7, 0.0};
  for (int j = 0; j < d * (d + 1); ++j) system.parameters.push_back(name_of(j));
  for (const int mode : {0, 1}) {
    sfdae::NonlinearProblem problem(d + 1, d + 1);
    problem.equations = [d, mode](const Expression& t, auto x, auto xdot, auto F) {
      const auto p = [&](int i, int j) {
        const int number = i * d + j;
        return sfdae::parameter(t, name_of(number), i == j ? -0.5 : 0.3 * std::sin(1.0 + 2.7 * number));
      };
      for (int i = 0; i < d; ++i) {
        F[i] = xdot[i] - std::cos(i) * x[d];
        for (int j = 0; j < d; ++j) F[i] = F[i] - (mode == 0 ? 1.0 : -1.0) * p(i, j) * sin(x[j]);
      }
      F[d] = (mode == 0 ? x[d] : 0.0 * x[d]) - sin(2.0 * t);
      for (int j = 0; j < d; ++j) F[d] = F[d] + (j == 0 ? 1.0 : 0.2) * p(d, j) * x[j];
    };
    system.modes.push_back(std::move(problem));
  }
  for (int k = 1; k <= 8; ++k) {
    sfdae::Transition transition;
    transition.from = (k + 1) % 2;
    transition.to = k % 2;
    transition.kind = SFDAE_TRANSITION_TIME;
    transition.time = k;
    system.transitions.push_back(std::move(transition));
  }
  return system;
}

System system_of(int number) { return number == 0 ? rectifier() : pair(1 + 2 * number); }

// Seconds of the processor for the run without its start, and for a gradient.
double run(const System& system, int method, int count, long& transitions) {
  const bool by_adjoint = count == -2;
  if (count < 0) count = static_cast<int>(system.parameters.size());
  sfdae::Options options;
  options.rtol = options.atol = system.tolerance;
  options.method = method;
  options.max_step = system.max_step;
  std::vector<std::unique_ptr<sfdae::Solver>> solvers;
  sfdae::Hybrid hybrid;
  for (const sfdae::NonlinearProblem& mode : system.modes) {
    solvers.push_back(std::make_unique<sfdae::Solver>(mode, options));
    hybrid.add_mode(*solvers.back());
  }
  for (const sfdae::Transition& transition : system.transitions) hybrid.add_transition(transition);
  if (count > 0) {
    sfdae::Sensitivities wanted;
    wanted.parameters.assign(system.parameters.begin(), system.parameters.begin() + count);
    wanted.adjoint = by_adjoint;
    hybrid.set_sensitivities(wanted);
  }
  sfdae::Point point{0.0, system.x, {}};
  hybrid.start(0, point, system.end);
  const std::clock_t begin = std::clock();
  hybrid.advance(system.end, point);
  if (by_adjoint) {
    sfdae::Matrix weights(static_cast<int>(system.x.size()), 1);
    for (int i = 0; i < weights.rows(); ++i) weights(i, 0) = 1.0;
    hybrid.gradient({system.end}, weights);
  }
  const std::clock_t end = std::clock();
  transitions = hybrid.num_passages();
  return double(end - begin) / CLOCKS_PER_SEC;
}

void print_table() {
  constexpr int repetitions = 5;
  std::printf("%-15s %-6s %12s %11s %8s %8s %8s %8s\n", "", "method", "transitions", "x alone/ms", "one", "ten",
              "all", "adjoint");
  for (int number = 0; number < 4; ++number) {
    const System system = system_of(number);
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      const int counts[] = {0, 1, 10, -1, -2};
      double best[] = {1e300, 1e300, 1e300, 1e300, 1e300};
      long transitions = 0;
      for (int repetition = 0; repetition < repetitions; ++repetition)
        for (int k = 0; k < 5; ++k) best[k] = std::min(best[k], run(system, method, counts[k], transitions));
      std::printf("%-15s %-6s %12ld %11.1f", system.name.c_str(), method == SFDAE_METHOD_BDF ? "BDF" : "Radau",
                  transitions, 1e3 * best[0]);
      for (int k = 1; k < 5; ++k) std::printf(" %8.1f", 1e3 * best[k]);
      std::printf("\n");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    print_table();
    return 0;
  }
  long transitions = 0;
  const double seconds = run(system_of(std::atoi(argv[1])), std::atoi(argv[2]), std::atoi(argv[3]), transitions);
  std::printf("%ld transitions, %.2f ms\n", transitions, 1e3 * seconds);
  return 0;
}
