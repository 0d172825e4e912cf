// A problem whose callbacks only copy: values recorded in one run are played back in the next, so that what is timed
// is the library and not the problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "family_problem.h"
#include "linear_family.h"

namespace sfdae_bench {

using sfdae_test::Callback;

struct RecordedCall {
  Callback function;
  double t;
  int order;
  int leading_dimension;  // of the array that received the values
  int status;
  std::vector<double> values;  // without padding
};

class Replay {
 public:
  explicit Replay(std::shared_ptr<const sfdae_test::LinearFamily> family) : source_(std::move(family)) {
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = source_.m();
    problem.num_unknowns = source_.n();
    problem.E = [](double t, int k, double* to, void* self) { return get(self, Callback::E, t, k, to); };
    problem.A = [](double t, int k, double* to, void* self) { return get(self, Callback::A, t, k, to); };
    problem.f = [](double t, int k, double* to, void* self) { return get(self, Callback::f, t, k, to); };
    problem.user = this;
  }
  Replay(const Replay&) = delete;
  Replay& operator=(const Replay&) = delete;

  // The same sequence of calls as in the run recorded comes now.
  void rewind() {
    playing_ = true;
    next_ = 0;
  }
  // Whether the calls since rewind() were those recorded, all of them.
  bool is_complete() const { return next_ == calls_.size(); }
  // Whether one of them was not the one recorded: it failed, and so do all after it.
  bool has_diverged() const { return next_ > calls_.size(); }

  // What a callback does: 0 or a status of the C API. leading_dimension >= m; of no meaning for f.
  int get(Callback function, double t, int order, double* to, int leading_dimension) {
    if (!playing_) record(function, t, order, leading_dimension);
    if (next_ >= calls_.size() || !is_same(calls_[next_], function, t, order)) {
      next_ = calls_.size() + 1;
      return -1;
    }
    const RecordedCall& call = calls_[next_++];
    if (call.status == 0) copy(call, to, leading_dimension);
    return call.status;
  }

  const sfdae_test::LinearFamily& family() const { return source_.family(); }
  const std::vector<RecordedCall>& calls() const { return calls_; }

  sfdae_linear_problem problem;

 private:
  static int get(void* self, Callback function, double t, int order, double* to) {
    Replay& replay = *static_cast<Replay*>(self);
    return replay.get(function, t, order, to, replay.source_.m());
  }
  // Memory that is aligned differently changes rounding and so the steps, but not by more than this.
  static bool is_same(const RecordedCall& call, Callback function, double t, int order) {
    return call.function == function && call.order == order && std::fabs(call.t - t) <= 1e-9 * (1.0 + std::fabs(t));
  }
  void record(Callback function, double t, int order, int leading_dimension) {
    const int count = source_.m() * (function == Callback::f ? 1 : source_.n());
    RecordedCall call{function, t, order, leading_dimension, 0, std::vector<double>(static_cast<std::size_t>(count))};
    const auto values = function == Callback::E   ? source_.problem.E
                        : function == Callback::A ? source_.problem.A
                                                  : source_.problem.f;
    call.status = values(t, order, call.values.data(), source_.problem.user);
    calls_.push_back(std::move(call));
    next_ = calls_.size() - 1;
  }
  void copy(const RecordedCall& call, double* to, int leading_dimension) const {
    const auto rows = static_cast<std::size_t>(source_.m());
    if (call.function == Callback::f || leading_dimension == source_.m()) {
      std::memcpy(to, call.values.data(), call.values.size() * sizeof(double));
      return;
    }
    for (int j = 0; j < source_.n(); ++j)
      std::memcpy(to + static_cast<std::ptrdiff_t>(j) * leading_dimension,
                  call.values.data() + static_cast<std::size_t>(j) * rows, rows * sizeof(double));
  }

  sfdae_test::FamilyProblem source_;
  std::vector<RecordedCall> calls_;
  std::size_t next_ = 0;
  bool playing_ = false;
};

}  // namespace sfdae_bench
