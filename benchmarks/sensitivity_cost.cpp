// What sensitivities cost beside x: microseconds of processor time of an integration without them, with one
// parameter, with ten and with the adjoint.
//
// Columns: method, steps, the time of x alone, what one and ten sensitivities add, relative, and what the gradient of a
// functional of the end values by ten parameters adds, kept steps included; with all of them,
// and with 60, so that the others are made again. Run it with OPENBLAS_NUM_THREADS=1. Arguments:
// nothing; or "large": problems of 20 to 400 unknowns, forward sensitivities alone; or a problem (0, ..., 9), a
// method (0: BDF, 1: Radau) and a count (-1, -2: the adjoint), of which one integration is done, to be profiled or
// counted.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "sfdae/sfdae.hpp"

namespace {

using sfdae::Expression;

struct Problem {
  std::string name;
  sfdae::NonlinearProblem equations;
  std::vector<double> x;
  double end;
  int structure = SFDAE_STRUCTURE_AUTOMATIC;
};

std::string name_of(int j) { return std::string("p").append(std::to_string(j)); }

Expression parameter_of(const Expression& t, int j, double value) { return sfdae::parameter(t, name_of(j), value); }

// Mass points on massless rods, index raw; parameters: gravity, four lengths and masses in turn, damping.
Problem chain(int links, double end) {
  sfdae::NonlinearProblem problem(5 * links, 5 * links);
  problem.equations = [links](const Expression& t, auto x, auto xdot, auto F) {
    const Expression g = parameter_of(t, 0, 9.81);
    std::vector<Expression> L, m;
    for (int i = 0; i < links; ++i) L.push_back(parameter_of(t, 1 + 2 * (i % 4), 1.0));
    for (int i = 0; i < links; ++i) m.push_back(parameter_of(t, 2 + 2 * (i % 4), 1.0));
    const Expression damping = parameter_of(t, 9, 0.1);
    for (int i = 2 * links + 1; i < 9; ++i) parameter_of(t, i, 1.0);
    const auto at = [&](int i, int k) { return i < 0 ? 0.0 * t : x[5 * i + k]; };
    for (int i = 0; i < links; ++i) {
      F[5 * i] = xdot[5 * i] - x[5 * i + 2];
      F[5 * i + 1] = xdot[5 * i + 1] - x[5 * i + 3];
      for (int k = 0; k < 2; ++k) {
        Expression force = (at(i, k) - at(i - 1, k)) * x[5 * i + 4] + damping * x[5 * i + 2 + k];
        if (i + 1 < links) force = force - (at(i + 1, k) - at(i, k)) * x[5 * i + 9];
        if (k == 1) force = force + m[std::size_t(i)] * g;
        F[5 * i + 2 + k] = m[std::size_t(i)] * xdot[5 * i + 2 + k] + force;
      }
      const Expression dx = at(i, 0) - at(i - 1, 0), dy = at(i, 1) - at(i - 1, 1);
      F[5 * i + 4] = dx * dx + dy * dy - L[std::size_t(i)] * L[std::size_t(i)];
    }
  };
  std::vector<double> x(std::size_t(5 * links), 0.0);
  for (int i = 0; i < links; ++i) {
    x[std::size_t(5 * i)] = 0.6 * (i + 1);
    x[std::size_t(5 * i + 1)] = -0.8 * (i + 1);
  }
  return {links == 1 ? "pendulum" : "chain of " + std::to_string(links), std::move(problem), std::move(x), end};
}

// Diffusion and a reaction with ten rates, each of some cells.
Problem stiff(int n) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [n](const Expression& t, auto x, auto xdot, auto F) {
    std::vector<Expression> rate;
    for (int j = 0; j < 10; ++j) rate.push_back(parameter_of(t, j, 1.0 + 0.1 * j));
    const auto at = [&](int i) { return i < 0 ? 1.0 + 0.0 * t : i >= n ? 0.0 * t : x[i]; };
    for (int i = 0; i < n; ++i)
      F[i] = xdot[i] - 500.0 * (at(i - 1) - 2.0 * x[i] + at(i + 1)) - rate[std::size_t(i % 10)] * x[i] * (1.0 - x[i]);
  };
  return {std::to_string(n) + " stiff equations", std::move(problem), std::vector<double>(std::size_t(n), 0.1), 5.0};
}

// Two species that react in cells of a line and diffuse, 2 cells unknowns; the first parameters are those of the
// reaction.
Problem brusselator(int cells) {
  sfdae::NonlinearProblem problem(2 * cells, 2 * cells);
  problem.equations = [cells](const Expression& t, auto x, auto xdot, auto F) {
    const Expression a = parameter_of(t, 0, 1.0), b = parameter_of(t, 1, 3.0), diffusion = parameter_of(t, 2, 0.02);
    for (int j = 3; j < 10; ++j) parameter_of(t, j, 1.0);
    const double squared = double(cells + 1) * double(cells + 1);
    const auto at = [&](int i, int k) { return i < 0 || i >= cells ? 0.0 * t + (k == 0 ? 1.0 : 3.0) : x[2 * i + k]; };
    for (int i = 0; i < cells; ++i) {
      const Expression u = x[2 * i], v = x[2 * i + 1], reaction = u * u * v;
      F[2 * i] =
          xdot[2 * i] - a - reaction + (b + 1.0) * u - squared * diffusion * (at(i - 1, 0) - 2.0 * u + at(i + 1, 0));
      F[2 * i + 1] =
          xdot[2 * i + 1] - b * u + reaction - squared * diffusion * (at(i - 1, 1) - 2.0 * v + at(i + 1, 1));
    }
  };
  std::vector<double> x;
  for (int i = 0; i < cells; ++i) {
    x.push_back(1.0 + std::sin(2.0 * 3.14159265358979 * (i + 1) / (cells + 1)));
    x.push_back(3.0);
  }
  return {"Brusselator, n = " + std::to_string(2 * cells), std::move(problem), std::move(x), 10.0};
}

Problem problem_of(int number) {
  switch (number) {
    case 0: return chain(1, 10.0);
    case 1: return chain(4, 2.0);
    case 2: return stiff(40);
    case 3: return stiff(100);
    case 4: return stiff(400);
    case 5: return brusselator(50);
    case 6: return brusselator(200);
    case 7: {
      Problem problem = chain(4, 2.0);
      problem.structure = SFDAE_STRUCTURE_REQUIRED;
      problem.name += ", extension";
      return problem;
    }
    case 8: return chain(8, 2.0);
    default: return chain(20, 2.0);
  }
}

// Seconds of the processor for the steps, without the start.
double run(const Problem& problem, int method, int count, long& steps) {
  const bool by_adjoint = count < 0, makes_again = count == -2;
  if (by_adjoint) count = 10;
  sfdae::Options options;
  options.rtol = options.atol = 1e-6;
  options.method = method;
  options.structure = problem.structure;
  sfdae::Solver solver(problem.equations, options);
  if (count > 0) {
    sfdae::Sensitivities wanted;
    for (int j = 0; j < count; ++j) wanted.parameters.push_back(name_of(j));
    wanted.adjoint = by_adjoint;
    wanted.max_kept_steps = makes_again ? 60 : 0;
    solver.set_sensitivities(wanted);
  }
  sfdae::Point point{0.0, problem.x, {}};
  solver.start(point, problem.end);
  const std::clock_t begin = std::clock();
  solver.advance(problem.end, point);
  if (by_adjoint) {
    sfdae::Matrix weights(int(problem.x.size()), 1);
    for (int i = 0; i < weights.rows(); ++i) weights(i, 0) = 1.0;
    solver.gradient({problem.end}, weights);
  }
  const std::clock_t end = std::clock();
  steps = solver.statistics().steps;
  return double(end - begin) / CLOCKS_PER_SEC;
}

// repetitions: of which the shortest count; number_of_counts: columns.
void print_table(int first, int last, int repetitions, int number_of_counts) {
  std::printf("%-20s %-6s %6s %10s %8s %8s %8s %8s\n", "", "method", "steps", "x alone/us", "one", "ten", "adjoint",
              "again");
  for (int number = first; number < last; ++number) {
    const Problem problem = problem_of(number);
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      double best[] = {1e300, 1e300, 1e300, 1e300, 1e300};
      const int counts[] = {0, 1, 10, -1, -2};
      long steps = 0;
      for (int repetition = 0; repetition < repetitions; ++repetition)
        for (int k = 0; k < number_of_counts; ++k)
          best[k] = std::min(best[k], run(problem, method, counts[k], steps));
      std::printf("%-20s %-6s %6ld %10.0f", problem.name.c_str(), method == SFDAE_METHOD_BDF ? "BDF" : "Radau", steps,
                  1e6 * best[0]);
      for (int k = 1; k < number_of_counts; ++k) std::printf(" %+7.0f%%", 100.0 * (best[k] / best[0] - 1.0));
      std::printf("\n");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    if (argc == 2 && std::string(argv[1]) == "large") print_table(3, 10, 3, 3);
    else print_table(0, 3, 15, 5);
    return 0;
  }
  long steps = 0;
  const double seconds = run(problem_of(std::atoi(argv[1])), std::atoi(argv[2]), std::atoi(argv[3]), steps);
  std::printf("%ld steps, %.0f microseconds\n", steps, 1e6 * seconds);
  return 0;
}
