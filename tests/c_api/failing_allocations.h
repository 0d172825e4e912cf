// Allocations that fail on demand, and sequences of calls on one handle, run with and without such failures.
// Included by one source file of a program: it replaces operator new.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "family_run.h"
#include "replaced_new.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {

// What operator new does within calls of the library; the test's own callbacks allocate nothing.
struct Allocations {
  bool armed = false;
  long seen = 0, failed = 0;  // while armed
  long first = 0;             // the one to fail; 0: none
  bool all_later = false;     // fail, too
  long blocks = 0;            // in use, armed or not
};
inline Allocations allocations;

void before_allocation() {
  Allocations& a = allocations;
  if (a.armed) {
    ++a.seen;
    if (a.first > 0 && (a.seen == a.first || (a.all_later && a.seen > a.first))) {
      ++a.failed;
      throw std::bad_alloc();
    }
  }
  ++a.blocks;
}

void before_release(void* memory) noexcept {
  if (memory != nullptr) --allocations.blocks;
}

// Runs a call of the library in which allocations count.
template <class Function>
int armed(Function function) {
  allocations.armed = true;
  const int status = function();
  allocations.armed = false;
  return status;
}

// A handle with what its calls have returned.
struct Session {
  sfdae_solver* solver = nullptr;
  double t = 0.0;
  std::vector<double> x, xdot, checkpoint;
  std::vector<double> result;  // of the last call
  long outputs = 0;            // returned, where a call asks for many
};

// One call of the library, within armed(). Fills `result` unless it fails; returns its status.
struct Call {
  std::string name;
  std::function<int(Session&)> run;
  bool returns_point = false;  // t, x, x', whatever the status
  int failure = SFDAE_OK;      // without missing memory: this one, or a success
};

struct Sequence {
  std::string name;
  std::vector<double> x;    // to begin with
  std::vector<Call> calls;  // the first one creates the handle; those from the second one on may be made again
  double tolerance = 0.0;   // of results after a failure, relative to those of an undisturbed run; 0: every bit
  int density = 4;          // of the allocations that fail, per doubling of their number
};

// Every so many allocations fail in turn, fewer where tests are small; all of them with SFDAE_TEST_STRIDE=1 in the
// environment.
inline long stride_of_faults(long usual) {
  if (const char* text = std::getenv("SFDAE_TEST_STRIDE")) return std::max(1L, std::atol(text));
  const int part = sfdae_test::scaled_count(1000, 10);
  return part < 200 ? usual * 200 / part : usual;
}

class FaultRun {
 public:
  struct Counts {
    long injected = 0, refused = 0, compared = 0, differing = 0;
    double largest_difference = 0.0;
  };

  explicit FaultRun(const Sequence& sequence) : sequence_(sequence) {
    // Once more, as tables are computed at their first use.
    for (int pass = 0; pass < 2; ++pass) {
      expected_.clear();
      Session session = begin();
      for (std::size_t j = 0; j < sequence_.calls.size(); ++j) {
        const int status = call(session, j);
        EXPECT_EQ(status < 0 ? status : 0, sequence_.calls[j].failure)
            << sequence_.name << ", " << sequence_.calls[j].name << ": " << message(session);
        expected_.push_back({status, session.result});
      }
      sfdae_destroy(&session.solver);
    }
  }

  // Of each call the first allocations in turn, then fewer, but every stride-th at least: it fails alone, or with all
  // later ones. The call is repeated then; or the next ones are made without it, and all again.
  const Counts& run(long stride) {
    for (std::size_t i = 0; i < sequence_.calls.size(); ++i) {
      for (long k = 1; fail_at(i, k); k += step_of(k, stride)) {
      }
      insist(i, stride);
    }
    return counts_;
  }

 private:
  struct Expected {
    int status;
    std::vector<double> result;
  };
  struct Fault {
    std::size_t call;
    long first;
    bool all_later, is_repeated;
  };

  long step_of(long k, long stride) const {
    return std::clamp(k / sfdae_test::scaled_count(sequence_.density), 1L, stride);
  }

  Session begin() const {
    Session session;
    session.x = sequence_.x;
    session.xdot.assign(session.x.size(), 0.0);
    return session;
  }
  int call(Session& session, std::size_t j) const {
    session.result.clear();
    return sequence_.calls[j].run(session);
  }
  static std::string message(const Session& session) {
    return session.solver != nullptr ? sfdae_message(session.solver) : "no handle";
  }

  // False if the call has fewer allocations.
  bool fail_at(std::size_t i, long k) {
    const bool happened = disturb({i, k, false, true});
    return happened && disturb({i, k, true, true}) && (i == 0 || disturb({i, k, true, false}));
  }

  bool disturb(const Fault& fault) {
    SCOPED_TRACE(sequence_.name + ", " + sequence_.calls[fault.call].name + ", allocation " +
                 std::to_string(fault.first) + (fault.all_later ? " and later" : "") +
                 (fault.is_repeated ? "" : ", not repeated"));
    const long blocks = allocations.blocks;
    bool happened = false;
    {
      Session session = begin();
      for (std::size_t j = 0; j < fault.call; ++j) call(session, j);
      const int status = fail(session, fault);
      happened = allocations.failed > 0;
      if (happened) {
        ++counts_.injected;
        continue_after(session, fault, status);
      }
      sfdae_destroy(&session.solver);
      EXPECT_EQ(session.solver, nullptr);
    }
    // Reports of failures have blocks of their own.
    if (!testing::Test::HasFailure()) {
      EXPECT_EQ(allocations.blocks, blocks) << "not given back";
    }
    return happened;
  }

  // One handle and one call, which is repeated until its allocations last.
  void insist(std::size_t i, long stride) {
    SCOPED_TRACE(sequence_.name + ", " + sequence_.calls[i].name + ", again and again");
    Session session = begin();
    for (std::size_t j = 0; j < i; ++j) call(session, j);
    long k = 1;
    int status = fail(session, {i, k, false, true});
    while (status == SFDAE_OUT_OF_MEMORY) {
      ++counts_.injected;
      k += step_of(k, stride);
      status = fail(session, {i, k, false, true});
    }
    compare(session, i, status);
    for (std::size_t j = i + 1; j < sequence_.calls.size(); ++j) compare(session, j, call(session, j));
    sfdae_destroy(&session.solver);
  }

  int fail(Session& session, const Fault& fault) {
    const Session before = session;
    allocations.seen = allocations.failed = 0;
    allocations.first = fault.first;
    allocations.all_later = fault.all_later;
    const int status = call(session, fault.call);
    allocations.first = 0;
    if (status != SFDAE_OUT_OF_MEMORY) return status;
    if (session.solver != nullptr) {
      EXPECT_STREQ(sfdae_message(session.solver), "out of memory.");
    }
    if (!sequence_.calls[fault.call].returns_point) {
      EXPECT_EQ(session.t, before.t);
      EXPECT_EQ(session.x, before.x);
      EXPECT_EQ(session.xdot, before.xdot);
    }
    return status;
  }

  void continue_after(Session& session, const Fault& fault, int status) {
    std::size_t next = fault.call;
    if (status == SFDAE_OUT_OF_MEMORY) {
      ++counts_.refused;
      if (session.solver != nullptr) look_around(session);
      if (fault.is_repeated) {
        compare(session, next, call(session, next));
      } else {
        // Whatever they return.
        for (std::size_t j = next + 1; j < sequence_.calls.size(); ++j) call(session, j);
        session.x = sequence_.x;
        session.outputs = 0;
        next = 0;
      }
    } else {
      compare(session, next, status);
    }
    for (++next; next < sequence_.calls.size(); ++next) compare(session, next, call(session, next));
  }

  // All that only reads.
  static void look_around(Session& session) {
    const sfdae_solver* solver = session.solver;
    std::vector<char> text(20000);
    sfdae_report(solver, text.data(), text.size(), nullptr);
    sfdae_statistics statistics;
    sfdae_statistics_init(&statistics, sizeof statistics);
    sfdae_get_statistics(solver, &statistics);
    sfdae_characteristics characteristics;
    sfdae_characteristics_init(&characteristics, sizeof characteristics);
    sfdae_get_characteristics(solver, &characteristics);
    sfdae_multibody_report report;
    sfdae_multibody_report_init(&report, sizeof report);
    sfdae_get_multibody_report(solver, &report);
    std::vector<int> which(100);
    sfdae_get_events(solver, which.data());
    std::size_t length = 0;
    if (sfdae_get_checkpoint_length(session.solver, &length) == SFDAE_OK) {
      std::vector<double> checkpoint(length);
      EXPECT_EQ(sfdae_save_checkpoint(session.solver, checkpoint.data(), length), SFDAE_OK);
    }
  }

  void compare(const Session& session, std::size_t j, int status) {
    const Expected& expected = expected_[j];
    const std::string& name = sequence_.calls[j].name;
    EXPECT_EQ(status, expected.status) << name << ": " << message(session);
    if (status != expected.status) return;
    ASSERT_EQ(session.result.size(), expected.result.size()) << name;
    double difference = 0.0;
    for (std::size_t i = 0; i < session.result.size(); ++i) {
      const double is = session.result[i], should_be = expected.result[i];
      if (is == should_be) continue;
      difference = std::max(difference, std::fabs(is - should_be) / (1.0 + std::fabs(should_be)));
      if (!std::isfinite(is)) difference = std::numeric_limits<double>::infinity();
    }
    EXPECT_LE(difference, sequence_.tolerance) << name;
    ++counts_.compared;
    if (difference > 0.0) ++counts_.differing;
    counts_.largest_difference = std::max(counts_.largest_difference, difference);
  }

  const Sequence& sequence_;
  std::vector<Expected> expected_;
  Counts counts_;
};

}  // namespace sfdae::test
