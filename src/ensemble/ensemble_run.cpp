// The instances of an ensemble, divided among threads.
// SPDX-License-Identifier: BSD-3-Clause
#include "ensemble/ensemble_run.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// The first instance whose analysis succeeds is the precedent; at most this many are tried. (Chosen.)
constexpr int most_asked_for_precedent = 10;

constexpr InstanceOutcome not_begun{SFDAE_STOPPED, 0, 0, "stopped on request before this instance was begun."};

class EnsembleRun {
 public:
  EnsembleRun(Solver& prototype, const EnsembleTask& task) : prototype_(prototype), task_(task) {}

  EnsembleSummary run() {
    EnsembleWorker worker(prototype_, task_);
    std::vector<std::thread> others;
    const int wanted = threads_wanted();
    others.reserve(index(wanted));
    find_precedent(worker);
    summary_.threads = 1;
    // If threads or memory for them are missing, fewer threads do the work.
    try {
      while (static_cast<int>(others.size()) + 1 < wanted) others.emplace_back([this] { work_in_thread(); });
    } catch (const std::exception&) {
    }
    work(worker);
    for (std::thread& other : others) other.join();
    for (int i = next_.load(); i < task_.ensemble.num_instances; ++i) write(i, not_begun);
    // If the last instance had already ended, no instance took the request.
    if (monitor_has_stopped_) prototype_.problem().take_stop_request();
    return summary_;
  }

 private:
  int threads_wanted() const {
    const int processors = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int asked = task_.ensemble.num_threads > 0 ? task_.ensemble.num_threads : processors;
    return std::min(asked, task_.ensemble.num_instances);
  }

  // The choice of the precedent does not depend on the number of threads.
  void find_precedent(EnsembleWorker& worker) {
    const int count = task_.ensemble.num_instances;
    if (prototype_.system() != nullptr) precedent_ = precedent_of(prototype_.system()->analysis());
    if (count < 2) return;
    for (int i = 0; i < std::min(count, most_asked_for_precedent) && precedent_.values.mu < 0; ++i) {
      precedent_ = worker.analyze(i);
      ++summary_.analyses;
    }
  }

  void work_in_thread() noexcept {
    try {
      EnsembleWorker worker(prototype_, task_);
      {
        const std::lock_guard lock(mutex_);
        ++summary_.threads;
      }
      work(worker);
    } catch (...) {
      // Without memory for this worker, the others solve its instances.
    }
  }

  void work(EnsembleWorker& worker) noexcept {
    for (int i = claim(); i >= 0; i = claim()) {
      const InstanceOutcome outcome = worker.solve(i, precedent_);
      const std::lock_guard lock(mutex_);
      write(i, outcome);
      ++ended_;
      call_monitor(i, outcome.status);
    }
  }

  // The next instance, or -1.
  int claim() {
    if (prototype_.problem().stop_is_requested()) return -1;
    int i = next_.load();
    while (i < task_.ensemble.num_instances)
      if (next_.compare_exchange_weak(i, i + 1)) return i;
    return -1;
  }

  void write(int i, const InstanceOutcome& outcome) {
    const sfdae_ensemble_results& results = task_.results;
    results.statuses[i] = outcome.status;
    if (results.num_outputs != nullptr) results.num_outputs[i] = outcome.outputs;
    if (results.messages != nullptr)
      std::snprintf(results.messages + index(i) * results.message_length, results.message_length, "%s",
                    outcome.message);
    summary_.analyses += outcome.analyses;
    if (outcome.status == SFDAE_STOPPED) ++summary_.stopped;
    if (outcome.status >= 0) return;
    ++summary_.failed;
    if (summary_.first_failed >= 0 && summary_.first_failed < i) return;
    summary_.first_failed = i;
    summary_.failure = outcome;
  }

  void call_monitor(int i, int status) {
    const sfdae_ensemble& ensemble = task_.ensemble;
    if (ensemble.monitor == nullptr || summary_.monitor_threw) return;
    bool stops = true;
    const sfdae_ensemble_progress progress{sizeof progress, i, status, ended_, ensemble.num_instances};
    try {
      stops = ensemble.monitor(&progress, ensemble.monitor_user) != 0;
    } catch (...) {
      summary_.monitor_threw = true;
    }
    if (!stops) return;
    monitor_has_stopped_ = true;
    prototype_.problem().request_stop();
  }

  Solver& prototype_;
  const EnsembleTask& task_;
  Precedent precedent_;
  std::atomic<int> next_{0};
  std::mutex mutex_;  // guards the members below, the results and the monitor
  int ended_ = 0;
  bool monitor_has_stopped_ = false;
  EnsembleSummary summary_;
};

}  // namespace

EnsembleSummary solve_ensemble(Solver& prototype, const EnsembleTask& task) {
  return EnsembleRun(prototype, task).run();
}

}  // namespace sfdae::core
