// A problem whose callbacks only copy: values recorded in one run are played back in the next, so that what is timed
// is the library and not the problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "family_problem.h"
#include "linear_family.h"

namespace sfdae_bench {

class Replay {
 public:
  explicit Replay(std::shared_ptr<const sfdae_test::LinearFamily> family) : family_(std::move(family)) {
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = family_->m();
    problem.num_unknowns = family_->n();
    problem.E = [](double t, int k, double* to, void* self) { return static_cast<Replay*>(self)->get(0, t, k, to); };
    problem.A = [](double t, int k, double* to, void* self) { return static_cast<Replay*>(self)->get(1, t, k, to); };
    problem.f = [](double t, int k, double* to, void* self) { return static_cast<Replay*>(self)->get(2, t, k, to); };
    problem.user = this;
  }
  Replay(const Replay&) = delete;
  Replay& operator=(const Replay&) = delete;

  // The same sequence of calls as in the run recorded comes now.
  void rewind() {
    playing_ = true;
    next_ = 0;
  }
  // Plays everything once: what the callbacks cost.
  void play_all(double* buffer) {
    for (const std::vector<double>& values : records_) std::memcpy(buffer, values.data(), values.size() * sizeof(double));
  }
  std::size_t calls() const { return records_.size(); }

  sfdae_linear_problem problem;

 private:
  int get(int which, double t, int order, double* to) {
    if (!playing_) {
      const int m = family_->m(), count = which == 2 ? m : m * family_->n();
      std::vector<double> values(static_cast<std::size_t>(count));
      if (which == 0) family_->E(t, order, values.data());
      else if (which == 1) family_->A(t, order, values.data());
      else family_->f(t, order, values.data());
      records_.push_back(std::move(values));
      next_ = records_.size() - 1;
    }
    if (next_ >= records_.size()) return -1;
    const std::vector<double>& values = records_[next_++];
    std::memcpy(to, values.data(), values.size() * sizeof(double));
    return 0;
  }

  std::shared_ptr<const sfdae_test::LinearFamily> family_;
  std::vector<std::vector<double>> records_;
  std::size_t next_ = 0;
  bool playing_ = false;
};

}  // namespace sfdae_bench
