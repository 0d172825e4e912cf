// variations [--problems N] [--first K] [--seed S] [--case NUMBER] [--check-references]: variations of laws, gains,
// problems, sizes, units, methods and formulations, judged by references of their own (../README.md).
//
// A problem is run in several variants; case NUMBER is variant NUMBER mod 6 of problem NUMBER / 6. Each problem has a
// process of its own, so that a crash or a call that does not return is an answer, too: a wrong one.
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "../extent.h"
#include "tables.h"

namespace campaign {
namespace {

// 20,000 runs, at a share of 1.
constexpr int all_problems = 3500, least_problems = 10;
// No run may take longer, in seconds of processor time.
constexpr int longest_run = 60;

// Between the two methods of the reference, relative to the sizes of states.
constexpr double largest_difference = 1e-6;

struct Arguments {
  int problems = -1, first = 0, seed = 1, single = -1;
  bool checks_references = false;
};

Arguments parsed(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const auto number = [&](const char* name, int& value) {
      if (std::strcmp(argv[i], name) != 0 || i + 1 >= argc) return false;
      value = std::atoi(argv[++i]);
      return true;
    };
    if (number("--problems", arguments.problems) || number("--first", arguments.first) ||
        number("--seed", arguments.seed) || number("--case", arguments.single))
      continue;
    if (std::strcmp(argv[i], "--check-references") != 0) {
      std::fprintf(stderr, "variations: unknown argument %s\n", argv[i]);
      std::exit(2);
    }
    arguments.checks_references = true;
  }
  if (arguments.problems < 0)
    arguments.problems = static_cast<int>(problem_numbers(all_problems, least_problems).size());
  return arguments;
}

// From now on; SIGPROF ends the process then.
void limit_time() {
  itimerval limit{};
  limit.it_value.tv_sec = longest_run;
  setitimer(ITIMER_PROF, &limit, nullptr);
}

// The process of a problem: writes the results of its variants to the pipe.
void run_variants(int number, int seed, int pipe_end) {
  limit_time();
  const Case problem = random_case(number, seed);
  const auto references = make_references(problem);
  for (int k = 0; k < variants_of_problem; ++k) {
    limit_time();
    const RunResult result = run(problem, random_variant(problem, number, k, seed), references, false);
    if (write(pipe_end, &result, sizeof result) != static_cast<ssize_t>(sizeof result)) _exit(1);
  }
  _exit(0);
}

std::vector<RunResult> results_of(int number, int seed, int& end) {
  int ends[2];
  std::vector<RunResult> results;
  if (pipe(ends) != 0) return results;
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_variants(number, seed, ends[1]);
  }
  close(ends[1]);
  RunResult result;
  while (read(ends[0], &result, sizeof result) == static_cast<ssize_t>(sizeof result)) results.push_back(result);
  close(ends[0]);
  waitpid(child, &end, 0);
  return results;
}

int run_all(const Arguments& arguments) {
  Tables tables;
  for (int number = arguments.first; number < arguments.first + arguments.problems; ++number) {
    const Case problem = random_case(number, arguments.seed);
    int end = 0;
    const std::vector<RunResult> results = results_of(number, arguments.seed, end);
    const int count = static_cast<int>(results.size());
    for (int k = 0; k < count; ++k)
      tables.add(number * variants_of_problem + k, problem, random_variant(problem, number, k, arguments.seed),
                 results[static_cast<std::size_t>(k)]);
    if (count < variants_of_problem)
      tables.add_lost(number * variants_of_problem + count, problem,
                      WIFSIGNALED(end) ? strsignal(WTERMSIG(end)) : "no result");
  }
  tables.print();
  return tables.are_good() ? 0 : 1;
}

int run_single(const Arguments& arguments) {
  const int number = arguments.single / variants_of_problem, variant = arguments.single % variants_of_problem;
  const Case problem = random_case(number, arguments.seed);
  const auto references = make_references(problem);
  for (std::size_t k = 0; k < references.size(); ++k)
    std::printf("reference %zu: %s, error %.1e, difference to the second method %.1e\n", k,
                references[k]->is_known() ? "known" : "not known", references[k]->error(),
                references[k]->is_known() ? references[k]->difference_of_second_method() : HUGE_VAL);
  const RunResult result = run(problem, random_variant(problem, number, variant, arguments.seed), references, true);
  return result.verdict == Verdict::wrong ? 1 : 0;
}

// The largest error estimates of references, and the largest differences to the second method.
int check_references(const Arguments& arguments) {
  double worst_error = 0.0, worst_difference = 0.0;
  int unknown = 0, count = 0, doubtful = 0;
  for (int number = arguments.first; number < arguments.first + arguments.problems; ++number) {
    const Case problem = random_case(number, arguments.seed);
    for (const auto& reference : make_references(problem)) {
      ++count;
      if (!reference->is_known()) {
        ++unknown;
        std::printf("problem %d: no reference\n", number);
        continue;
      }
      const double difference = reference->difference_of_second_method();
      if (difference > 1e-9 + 2.0 * reference->error())
        std::printf("problem %d: error %.1e, difference %.1e\n", number, reference->error(), difference);
      if (difference > largest_difference) ++doubtful;
      worst_error = std::max(worst_error, reference->error());
      worst_difference = std::max(worst_difference, difference);
    }
  }
  std::printf("%d references, %d not known, largest error %.1e, largest difference to the second method %.1e\n",
              count, unknown, worst_error, worst_difference);
  return unknown > 0 || doubtful > 0 ? 1 : 0;
}

}  // namespace
}  // namespace campaign

int main(int argc, char** argv) {
  const campaign::Arguments arguments = campaign::parsed(argc, argv);
  if (arguments.checks_references) return campaign::check_references(arguments);
  return arguments.single >= 0 ? campaign::run_single(arguments) : campaign::run_all(arguments);
}
