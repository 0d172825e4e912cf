// SPDX-License-Identifier: BSD-3-Clause
// What a user sees of a run, as lines of text: numbers with 17 digits, so that equal lines mean equal bits. Their hash
// stands for the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace sfdae_bench {

// Words of messages and reports that are replaced before texts are compared: lines `old => new` of a file, applied one
// after the other.
class Words {
 public:
  Words() = default;
  explicit Words(const std::string& path);  // throws std::runtime_error
  std::string applied_to(std::string text) const;

 private:
  std::vector<std::pair<std::string, std::string>> rules_;
};

class Trace {
 public:
  explicit Trace(const Words& words, bool prints = false) : words_(words), prints_(prints) {}

  void number(const char* what, double value) { numbers(what, &value, 1); }
  void numbers(const char* what, const double* values, std::size_t count);
  void numbers(const char* what, const std::vector<double>& values) { numbers(what, values.data(), values.size()); }
  void integer(const char* what, long long value);
  void text(const char* what, const std::string& value);

  // FNV-1a of all lines.
  std::uint64_t hash() const { return hash_; }

 private:
  void end_line();

  const Words& words_;
  bool prints_;
  std::string line_;
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

struct Run {
  std::string name;
  std::function<void(Trace&)> work;
};
using Runs = std::vector<Run>;

void add_linear_runs(Runs& runs);
void add_linear_option_runs(Runs& runs);
void add_nonlinear_runs(Runs& runs);
void add_nonlinear_option_runs(Runs& runs);
void add_multibody_runs(Runs& runs);
void add_multibody_option_runs(Runs& runs);
void add_argument_runs(Runs& runs);
void add_wrapper_runs(Runs& runs);
void add_dgelda_runs(Runs& runs);
void add_sfndae_runs(Runs& runs);
void add_cost_runs(Runs& runs);

}  // namespace sfdae_bench
