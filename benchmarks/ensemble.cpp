// Many instances: 10,000 pendula with random parameters by an ensemble of one and two threads, and by one solver each.
// Prints a table; times are those of processors, as other programs may run beside: an ensemble ends when the busiest of
// its threads has.
//
//     ensemble [instances]
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "sfdae/sfdae.hpp"

namespace {

using AnyProblem = std::variant<sfdae::NonlinearProblem, sfdae::MultibodyProblem>;

double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

sfdae::MultibodyProblem multibody_pendulum() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [](const auto& t, auto q, auto, auto to) {
    const sfdae::Expression L = parameter(t, "L", 1.0);
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[1] = -parameter(t, "g", 9.81);
    to.g[0] = q[0] * q[0] + q[1] * q[1] - L * L;
  };
  return problem;
}

sfdae::NonlinearProblem raw_pendulum() {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    const sfdae::Expression L = parameter(t, "L", 1.0);
    F[0] = xdot[0] - x[2], F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + 2.0 * x[0] * x[4], F[3] = xdot[3] + 2.0 * x[1] * x[4] + parameter(t, "g", 9.81);
    F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
  };
  return problem;
}

sfdae::Ensemble random_pendula(int instances, std::minstd_rand& generator) {
  sfdae::Ensemble ensemble;
  ensemble.parameter_names = {"L", "g"};
  ensemble.parameters = sfdae::Matrix(2, instances);
  ensemble.x0 = sfdae::Matrix(5, instances);
  ensemble.times = {10.0};
  const auto random = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(generator()) / static_cast<double>(std::minstd_rand::max());
  };
  for (int i = 0; i < instances; ++i) {
    const double L = random(0.5, 2.0), angle = random(-1.5, 1.5);
    ensemble.parameters(0, i) = L, ensemble.parameters(1, i) = random(5.0, 15.0);
    ensemble.x0(0, i) = L * std::sin(angle), ensemble.x0(1, i) = -L * std::cos(angle);
  }
  return ensemble;
}

// All instances, one solver each: seconds of creation, of starts and of integrations alone, and x at the end of those
// of the last call.
struct OneByOne {
  double creating = 0.0, starting = 0.0, advancing = 0.0;
  std::vector<double> x;
};

void solve_one_by_one(const AnyProblem& problem, const sfdae::Options& options, const sfdae::Ensemble& ensemble,
                      OneByOne& result) {
  for (int i = 0; i < ensemble.x0.columns(); ++i) {
    const double begin = thread_seconds();
    sfdae::Solver solver = std::visit([&](const auto& kind) { return sfdae::Solver(kind, options); }, problem);
    for (int p = 0; p < 2; ++p)
      solver.set_parameter(ensemble.parameter_names[static_cast<std::size_t>(p)], ensemble.parameters(p, i));
    sfdae::Point point{0.0, {}, {}};
    for (int j = 0; j < 5; ++j) point.x.push_back(ensemble.x0(j, i));
    const double created = thread_seconds();
    solver.start(point, 10.0);
    const double started = thread_seconds();
    sfdae::Point reached = point;
    solver.advance(10.0, reached);
    result.creating += created - begin;
    result.starting += started - created;
    result.advancing += thread_seconds() - started;
    result.x.insert(result.x.end(), reached.x.begin(), reached.x.end());
  }
}

// Sums over ensembles.
struct Times {
  double busiest = 0.0, all = 0.0;  // threads
  bool same_bits = true;
  int analyses = 0;
};

void solve_together(sfdae::Solver& solver, sfdae::Ensemble ensemble, int threads, const std::vector<double>& x,
                    Times& times) {
  std::map<std::thread::id, std::pair<double, double>> seconds;  // first and last
  const double begin = thread_seconds();
  seconds[std::this_thread::get_id()] = {begin, begin};
  ensemble.threads = threads;
  ensemble.monitor = [&](const sfdae::EnsembleProgress&) {
    seconds[std::this_thread::get_id()].second = thread_seconds();
    return false;
  };
  sfdae::EnsembleSolution solution = solver.solve_ensemble(ensemble);
  double busiest = 0.0;
  for (const auto& [id, interval] : seconds) {
    busiest = std::max(busiest, interval.second - interval.first);
    times.all += interval.second - interval.first;
  }
  times.busiest += busiest;
  times.same_bits = times.same_bits && solution.x().size() == x.size() &&
                    std::memcmp(solution.x().data(), x.data(), x.size() * sizeof(double)) == 0;
  times.analyses += solution.num_analyses;
}

// In turns, ensemble after ensemble: the speed of a machine may change with what else it does.
void measure(const std::string& name, const AnyProblem& problem, int method, int instances) {
  constexpr int most_in_turn = 500;
  sfdae::Options options;
  options.method = method;
  sfdae::Solver solver = std::visit([&](const auto& kind) { return sfdae::Solver(kind, options); }, problem);
  std::minstd_rand generator(5);
  OneByOne alone;
  Times one, two;
  for (int done = 0; done < instances; done += most_in_turn) {
    const sfdae::Ensemble ensemble = random_pendula(std::min(most_in_turn, instances - done), generator);
    alone.x.clear();
    solve_one_by_one(problem, options, ensemble, alone);
    solve_together(solver, ensemble, 1, alone.x, one);
    solve_together(solver, ensemble, 2, alone.x, two);
  }
  const double each = 1e6 / instances;
  std::printf("%-26s %8.1f %8.1f %8.1f | %8.1f %8.1f | %6.3f %6.3f %6.3f | %d %s\n", name.c_str(),
              alone.creating * each, alone.starting * each, alone.advancing * each, one.all * each,
              two.busiest * each, one.busiest / two.busiest, alone.advancing / one.all, alone.advancing / two.all,
              two.analyses, one.same_bits && two.same_bits ? "same bits" : "DIFFERENT");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int instances = argc > 1 ? std::atoi(argv[1]) : 10000;
  std::printf("%d pendula, t = 10, 1e-6. us an instance, by processor time\n", instances);
  std::printf("%-26s %8s %8s %8s | %8s %8s | %6s %6s %6s |\n", "", "create", "start", "advance", "1 thread", "2",
              "gain", "bare/1", "bare/2");
  measure("multibody, Radau", multibody_pendulum(), SFDAE_METHOD_RADAU, instances);
  measure("multibody, BDF", multibody_pendulum(), SFDAE_METHOD_BDF, instances);
  measure("whole array, Radau", raw_pendulum(), SFDAE_METHOD_RADAU, instances);
  measure("whole array, BDF", raw_pendulum(), SFDAE_METHOD_BDF, instances);
}
