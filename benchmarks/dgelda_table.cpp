// Cost and accuracy of any libraries that export dgelda_, side by side and next to published figures of GELDA 1.1.1.
//
// Cost: CPU time of the calling thread per successful step of a whole solve over [0, 1], the start included, the
// user's callbacks subtracted: they only copy values recorded in a run before, and these copies are timed alone.
// Accuracy: max |x_i - exact| / (rtol |exact_i| + atol) over all steps, and at t = 1.
// This program is linked with the static library only: a shared one would lend its dgelda_ to every library loaded.
// SPDX-License-Identifier: BSD-3-Clause
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "dgelda_library.h"
#include "gelda_figures.h"
#include "text_table.h"

namespace {

using namespace sfdae_bench;
using Family = std::shared_ptr<const sfdae_test::LinearFamily>;

struct Settings {
  bool cost = true, accuracy = true, csv = false;
  int max_n = 64;
  double tol = 1e-5;     // of the runs timed
  double seconds = 0.3;  // of runs for one figure
  std::vector<std::string> paths;
};

const char* name(Method method) { return method == Method::bdf ? "BDF" : "Radau"; }

// Without its arguments.
std::string problem_name(const Family& family) { return family->name().substr(0, family->name().find('(')); }

struct Comparison {
  Settings settings;
  std::vector<DgeldaLibrary> libraries;
  int failures = 0;  // each costs one row, or one library

  std::string label(std::size_t i) const { return settings.csv ? libraries[i].path : std::to_string(i + 1); }
  void report(const std::string& failure) {
    ++failures;
    std::fprintf(stderr, "dgelda_table: %s\n", failure.c_str());
  }
  void report(const DgeldaLibrary& library, const Family& family, Method method, const std::string& failure) {
    report(library.path + ": " + family->name() + ", " + name(method) + ": " + failure);
  }
};

bool is_arrived(int ierr) { return ierr == 2 || ierr == 3; }

[[noreturn]] void throw_stopped(int ierr, const DgeldaProblem& problem) {
  if (problem.functions().has_diverged()) throw std::runtime_error("the same run again asks for other values");
  throw std::runtime_error("stopped with IERR = " + std::to_string(ierr) + " at t = " + text(problem.t));
}

// ---- Cost ----

double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double timed_solve(DgeldaProblem& problem) {
  problem.start(0.0, false);
  const double start = thread_seconds();
  const int ierr = problem.advance(1.0);
  const double elapsed = thread_seconds() - start;
  if (!is_arrived(ierr)) throw_stopped(ierr, problem);
  return elapsed;
}

struct Cost {
  Counts counts;
  double step, callbacks;  // microseconds per successful step
};

Cost measure_cost(const DgeldaLibrary& library, const Family& family, Method method, const Settings& settings) {
  constexpr int least_runs = 3, most_runs = 1000;
  Replay functions(family);
  DgeldaProblem problem(library, functions, method, settings.tol);
  timed_solve(problem);
  const Counts counts = problem.counts();
  if (counts.steps <= 0) throw std::runtime_error("IWORK(11) is not positive");

  int leading_dimension = 1;
  for (const RecordedCall& call : functions.calls())
    leading_dimension = std::max(leading_dimension, call.leading_dimension);
  std::vector<double> buffer(static_cast<std::size_t>(leading_dimension) * static_cast<std::size_t>(family->n()));

  double total = HUGE_VAL, callbacks = HUGE_VAL, spent = 0.0;
  for (int run = 0; run < least_runs || (run < most_runs && spent < settings.seconds); ++run) {
    functions.rewind();
    const double elapsed = timed_solve(problem);
    if (!functions.is_complete()) throw std::runtime_error("the same run again asks for fewer values");
    total = std::min(total, elapsed);
    spent += elapsed;

    const double start = thread_seconds();
    repeat_callbacks(functions, buffer);
    callbacks = std::min(callbacks, thread_seconds() - start);
  }
  const double unit = 1e6 / counts.steps;
  return {counts, (total - callbacks) * unit, callbacks * unit};
}

void cost_rows(Comparison& comparison, const TextTable& table, const Family& family, const PublishedCost& published) {
  const std::vector<DgeldaLibrary>& libraries = comparison.libraries;
  for (Method method : {Method::bdf, Method::radau}) {
    const double gelda = 1e3 * (method == Method::bdf ? published.bdf : published.radau);
    double first = NAN;
    for (std::size_t i = 0; i < libraries.size(); ++i) {
      std::vector<std::string> cells = {problem_name(family), text(published.n), text(published.mu), name(method),
                                        comparison.label(i)};
      try {
        const Cost cost = measure_cost(libraries[i], family, method, comparison.settings);
        if (i == 0) first = cost.step;
        for (const std::string& cell :
             {text(cost.counts.steps), text(cost.counts.attempts()), text(cost.callbacks), text(cost.step),
              text(gelda), text(cost.step / gelda), text(i > 0 ? cost.step / first : NAN)})
          cells.push_back(cell);
      } catch (const std::exception& failure) {
        comparison.report(libraries[i], family, method, failure.what());
      }
      table.row(cells);
    }
  }
}

void print_cost(Comparison& comparison) {
  const Settings& settings = comparison.settings;
  if (!settings.csv)
    std::printf("Cost, rtol = atol = %.0e; microseconds per successful step, GELDA's as published\n", settings.tol);
  const TextTable table({{"problem", -7},
                         {"n", 4},
                         {"mu", 3},
                         {"method", -6},
                         {"library", -7},
                         {"steps", 6},
                         {"attempts", 8},
                         {"callbacks", 10},
                         {"step", 10},
                         {"GELDA", 10},
                         {"step/GELDA", 10},
                         {"step/first", 10}},
                        settings.csv);
  for (const PublishedCost& published : published_kron_cost)
    if (published.n <= settings.max_n)
      cost_rows(comparison, table, sfdae_test::kron(published.n, published.mu, 0.5), published);
  if (published_chain_cost.n <= settings.max_n)
    cost_rows(comparison, table, sfdae_test::chain(10, 2), published_chain_cost);
}

// ---- Accuracy ----

double weighted_error(const sfdae_test::LinearFamily& family, double tol, const DgeldaProblem& problem) {
  std::vector<double> exact(problem.x.size());
  family.exact(problem.t, exact.data(), nullptr);
  double worst = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double error = std::fabs(problem.x[i] - exact[i]) / (tol * std::fabs(exact[i]) + tol);
    if (!(error <= worst)) worst = error;  // keeps NaN
    if (std::isnan(worst)) break;
  }
  return worst;
}

struct Accuracy {
  Counts counts;
  double step_error, end_error;  // in units of the tolerance
};

Accuracy measure_accuracy(const DgeldaLibrary& library, const Family& family, Method method, double tol) {
  Replay functions(family);
  DgeldaProblem problem(library, functions, method, tol);
  problem.start(0.0, true);
  Accuracy accuracy{};
  int ierr = 1;
  while (ierr == 1) {
    const double before = problem.t;
    ierr = problem.advance(1.0);
    if (ierr != 1 && !is_arrived(ierr)) throw_stopped(ierr, problem);
    if (ierr == 1 && problem.t == before) throw std::runtime_error("IERR = 1, but t does not advance");
    accuracy.end_error = weighted_error(*family, tol, problem);
    if (!(accuracy.end_error <= accuracy.step_error)) accuracy.step_error = accuracy.end_error;
    if (std::isnan(accuracy.end_error)) throw std::runtime_error("the solution contains NaN");
  }
  accuracy.counts = problem.counts();
  return accuracy;
}

// One run in a diagram of work and precision: logarithms.
struct WorkPoint {
  double error, attempts;
};
using WorkCurve = std::vector<WorkPoint>;

void add_point(WorkCurve& curve, double absolute_error, int attempts) {
  if (absolute_error > 0.0 && attempts > 0) curve.push_back({std::log(absolute_error), std::log(attempts)});
}

// Logarithm of the attempts at an error: on the segment that contains it, else on the line through the nearest one.
double attempts_at(const WorkCurve& curve, double error) {
  double nearest = HUGE_VAL, attempts = NAN;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const WorkPoint &a = curve[i - 1], &b = curve[i];
    if (a.error == b.error) continue;
    const double s = (error - a.error) / (b.error - a.error), outside = std::max({0.0, -s, s - 1.0});
    if (outside >= nearest) continue;
    nearest = outside;
    attempts = (1.0 - s) * a.attempts + s * b.attempts;
  }
  return attempts;
}

// Geometric mean of attempts over those of the other curve at equal error.
double attempts_ratio(const WorkCurve& curve, const WorkCurve& other) {
  double sum = 0.0;
  for (const WorkPoint& point : curve) sum += point.attempts - attempts_at(other, point.error);
  return std::exp(sum / static_cast<double>(curve.size()));
}

struct AccuracyCase {
  Family family;
  Method method;
  const PublishedRun* published;  // one for every tolerance, or null
};

// One row for every tolerance.
WorkCurve accuracy_rows(Comparison& comparison, const TextTable& table, std::size_t library,
                        const AccuracyCase& item) {
  const Family& family = item.family;
  const PublishedRun* gelda = item.published;
  WorkCurve curve;
  for (double tol : {1e-3, 1e-5, 1e-7, 1e-9}) {
    char tol_text[16];
    std::snprintf(tol_text, sizeof tol_text, "%.0e", tol);
    std::vector<std::string> cells = {problem_name(family), text(family->n()),         text(family->values().mu),
                                      name(item.method),    comparison.label(library), tol_text};
    try {
      const Accuracy run = measure_accuracy(comparison.libraries[library], family, item.method, tol);
      add_point(curve, run.step_error * tol, run.counts.attempts());
      for (const std::string& cell :
           {text(run.counts.steps), text(run.counts.attempts()), text(run.counts.evaluations), text(run.step_error),
            text(run.end_error), gelda ? text(gelda->steps) : "", gelda ? text(gelda->error) : ""})
        cells.push_back(cell);
    } catch (const std::exception& failure) {
      comparison.report(comparison.libraries[library], family, item.method,
                        std::string("tol = ") + tol_text + ": " + failure.what());
    }
    table.row(cells);
    if (gelda) ++gelda;
  }
  return curve;
}

WorkCurve published_bdf_curve() {
  WorkCurve curve;
  for (const PublishedRun& run : published_bdf_runs) add_point(curve, run.tol * run.error, run.steps);
  return curve;
}

struct EqualError {
  std::string problem, method, library, other;
  double ratio;
};

void print_equal_error(const std::vector<EqualError>& comparisons, bool csv) {
  if (comparisons.empty()) return;
  std::printf(csv ? "\n" : "\nAttempts relative to another library at equal error, geometric mean\n");
  const TextTable table({{"problem", -7}, {"method", -6}, {"library", -7}, {"relative to", -11}, {"ratio", 7}}, csv);
  for (const EqualError& item : comparisons)
    table.row({item.problem, item.method, item.library, item.other, text(item.ratio)});
}

void print_accuracy(Comparison& comparison) {
  const bool csv = comparison.settings.csv;
  if (!csv) std::printf("Accuracy; errors in units of the tolerance, GELDA's as published\n");
  const TextTable table({{"problem", -7},
                         {"n", 4},
                         {"mu", 3},
                         {"method", -6},
                         {"library", -7},
                         {"tol", 8},
                         {"steps", 6},
                         {"attempts", 8},
                         {"evaluations", 11},
                         {"error", 8},
                         {"at end", 8},
                         {"GELDA steps", 11},
                         {"GELDA error", 11}},
                        csv);
  const Family kron = sfdae_test::kron(32, 2, 0.5), chain = sfdae_test::chain(10, 2);
  std::vector<EqualError> ratios;
  for (const AccuracyCase& item :
       {AccuracyCase{kron, Method::bdf, published_bdf_runs}, AccuracyCase{kron, Method::radau, published_radau_runs},
        AccuracyCase{chain, Method::bdf, nullptr}, AccuracyCase{chain, Method::radau, nullptr}}) {
    WorkCurve first;
    for (std::size_t i = 0; i < comparison.libraries.size(); ++i) {
      const WorkCurve curve = accuracy_rows(comparison, table, i, item);
      EqualError row{problem_name(item.family), name(item.method), comparison.label(i), "published", 0.0};
      if (item.published == published_bdf_runs) {
        row.ratio = attempts_ratio(curve, published_bdf_curve());
        ratios.push_back(row);
      }
      if (i == 0) {
        first = curve;
        continue;
      }
      row.other = comparison.label(0);
      row.ratio = attempts_ratio(curve, first);
      ratios.push_back(row);
    }
  }
  print_equal_error(ratios, csv);
}

// ---- Command line ----

constexpr const char* usage =
    "usage: dgelda_table [options] [library ...]\n"
    "Compares shared libraries that export dgelda_ (INTEGER of 32 bits). Default: the library built here.\n"
    "A name without '/' is looked for where the system keeps libraries.\n"
    "  --cost            only the time per step\n"
    "  --accuracy        only steps and errors\n"
    "  --tol TOL         rtol = atol of the runs timed (1e-5)\n"
    "  --max-n N         largest order of the problems timed, up to 100 (64)\n"
    "  --seconds S       run again for at least so long for every time measured, at least 3 times (0.3)\n"
    "  --csv             values separated by commas; tables are separated by empty lines\n"
    "  --help            this text\n"
    "Run it with OPENBLAS_NUM_THREADS=1: other threads are not counted.\n"
    "Exit status: 0; 1 if a library cannot be loaded or a run failed; 2 for a wrong option.\n";

// The positive number after an option.
double number(int argc, char** argv, int& i) {
  char* end = nullptr;
  const double value = i + 1 < argc ? std::strtod(argv[i + 1], &end) : 0.0;
  if (!(value > 0.0) || *end != '\0') throw std::invalid_argument(std::string(argv[i]) + " needs a positive number");
  ++i;
  return value;
}

Settings parse(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--cost") settings.accuracy = false;
    else if (word == "--accuracy") settings.cost = false;
    else if (word == "--csv") settings.csv = true;
    else if (word == "--tol") settings.tol = number(argc, argv, i);
    else if (word == "--max-n") settings.max_n = static_cast<int>(std::min(number(argc, argv, i), 100.0));
    else if (word == "--seconds") settings.seconds = number(argc, argv, i);
    else if (word.starts_with("-")) throw std::invalid_argument("unknown option " + word);
    else settings.paths.push_back(word);
  }
  if (!settings.cost && !settings.accuracy) settings.cost = settings.accuracy = true;
  if (settings.paths.empty()) settings.paths.push_back(SFDAE_LIBRARY);
  return settings;
}

void load_libraries(Comparison& comparison) {
  for (const std::string& path : comparison.settings.paths) {
    try {
      comparison.libraries.emplace_back(path);
    } catch (const std::exception& failure) {
      comparison.report(failure.what());
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]) == "--help") return std::fputs(usage, stdout) < 0;
  Comparison comparison;
  try {
    comparison.settings = parse(argc, argv);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "dgelda_table: %s\n%s", failure.what(), usage);
    return 2;
  }
  load_libraries(comparison);
  if (comparison.libraries.empty()) return 1;

  const Settings& settings = comparison.settings;
  if (!settings.csv)
    for (std::size_t i = 0; i < comparison.libraries.size(); ++i)
      std::printf("Library %zu: %s\n", i + 1, comparison.libraries[i].path.c_str());
  if (settings.cost) print_cost(comparison);
  if (settings.cost && settings.accuracy) std::printf("\n");
  if (settings.accuracy) print_accuracy(comparison);
  return comparison.failures == 0 ? 0 : 1;
}
