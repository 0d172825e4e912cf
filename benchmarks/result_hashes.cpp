// SPDX-License-Identifier: BSD-3-Clause
// One hash for each of several hundred runs, of everything that a user sees of it, bit for bit: for comparing two
// states of the library that have to give the same results (scripts/compare-results.sh does it for two revisions).
//
//   result_hashes [--words FILE]                 name and hash of every run, one line each
//   result_hashes [--words FILE] --only NAME     of one run
//   result_hashes [--words FILE] --text NAME     what is hashed, as text with 17 digits
//   result_hashes --list                         names
//
// FILE has lines `old => new`: words to be replaced in messages and reports before they are hashed. Hashes depend on
// the machine, its BLAS and the compiler. The runs cost_... are meant for counting instructions, see cost_runs.cpp.
// Set OPENBLAS_NUM_THREADS=1.
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>

#include "result_hashes/trace.h"

namespace {

using namespace sfdae_bench;

Runs all_runs() {
  Runs runs;
  add_linear_runs(runs);
  add_linear_option_runs(runs);
  add_nonlinear_runs(runs);
  add_nonlinear_option_runs(runs);
  add_multibody_runs(runs);
  add_multibody_option_runs(runs);
  add_argument_runs(runs);
  add_wrapper_runs(runs);
  add_dgelda_runs(runs);
  add_sfndae_runs(runs);
  add_cost_runs(runs);
  return runs;
}

void execute(const Run& run, const Words& words, bool prints) {
  Trace trace(words, prints);
  try {
    run.work(trace);
  } catch (const std::exception& exception) {
    trace.text("exception", exception.what());
  }
  if (!prints) std::printf("%s %016llx\n", run.name.c_str(), static_cast<unsigned long long>(trace.hash()));
  std::fflush(stdout);
}

int usage() {
  std::fprintf(stderr, "usage: result_hashes [--words FILE] [--list | --only NAME | --text NAME]\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Words words;
  std::string name;
  bool lists = false, prints = false;
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (std::strcmp(argv[i], "--list") == 0) {
      lists = true;
    } else if (std::strcmp(argv[i], "--words") == 0 && has_value) {
      try {
        words = Words(argv[++i]);
      } catch (const std::exception& exception) {
        std::fprintf(stderr, "result_hashes: %s\n", exception.what());
        return 2;
      }
    } else if ((std::strcmp(argv[i], "--only") == 0 || std::strcmp(argv[i], "--text") == 0) && has_value) {
      prints = argv[i][2] == 't';
      name = argv[++i];
    } else {
      return usage();
    }
  }
  bool found = false;
  for (const Run& run : all_runs()) {
    if (!name.empty() && run.name != name) continue;
    found = true;
    if (lists) std::printf("%s\n", run.name.c_str());
    else execute(run, words, prints);
  }
  if (!found) std::fprintf(stderr, "result_hashes: no run %s\n", name.c_str());
  return found ? 0 : 1;
}
