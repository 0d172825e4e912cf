// SPDX-License-Identifier: BSD-3-Clause
#include "program/sweep.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "program/exit_codes.h"
#include "program/interruption.h"
#include "program/numbers.h"

namespace sfdae::cli {

namespace {

std::optional<std::size_t> number_from_environment(const char* name) {
  const char* const text = std::getenv(name);
  const std::optional<double> value = text != nullptr ? parse_number(text) : std::nullopt;
  if (!value || !(*value >= 0.0) || *value > 1e9) return std::nullopt;
  return static_cast<std::size_t>(*value);
}

}  // namespace

Grid::Grid(std::vector<ParameterChoice> assignments) : assignments_(std::move(assignments)) {
  constexpr std::size_t max_count = 10'000'000;  // far beyond available memory and time
  for (const ParameterChoice& assignment : assignments_) {
    if (assignment.values.size() > max_count / count_)
      throw ProgramError(wrong_use, "--set: more than 1e7 combinations of values");
    count_ *= assignment.values.size();
  }
}

std::vector<double> Grid::values(std::size_t instance) const {
  std::vector<double> result(assignments_.size());
  for (std::size_t k = assignments_.size(); k-- > 0;) {
    const std::vector<double>& values = assignments_[k].values;
    result[k] = values[instance % values.size()];
    instance /= values.size();
  }
  return result;
}

Share share_of_process() {
  // Only srun of Slurm sets the number of tasks of the step; a batch script is a single process.
  constexpr const char* variables[][2] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                          {"PMI_RANK", "PMI_SIZE"},
                                          {"SLURM_PROCID", "SLURM_STEP_NUM_TASKS"}};
  for (const auto& [rank_name, size_name] : variables) {
    const auto rank = number_from_environment(rank_name), size = number_from_environment(size_name);
    if (rank && size && *rank < *size) return {*rank, *size};
  }
  return {};
}

std::vector<Instance> run_sweep(std::size_t count, Share share, int jobs, const SolveInstance& solve_instance,
                                const std::function<void(std::size_t)>& finished) {
  const std::size_t mine = count > share.rank ? (count - share.rank - 1) / share.size + 1 : 0;
  std::vector<Instance> instances(mine);
  std::vector<char> is_done(mine, 0);
  std::atomic<std::size_t> next{0};
  std::size_t num_done = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < mine && !was_interrupted(); i = next++) {
        instances[i] = solve_instance(share.rank + i * share.size);
        is_done[i] = 1;
        const std::scoped_lock lock(mutex);
        finished(++num_done);
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    const auto wanted = std::min(mine, static_cast<std::size_t>(jobs > 0 ? jobs : 1));
    for (std::size_t k = 1; k < wanted; ++k) threads.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  std::vector<Instance> done;
  for (std::size_t i = 0; i < mine; ++i)
    if (is_done[i] != 0) done.push_back(std::move(instances[i]));
  return done;
}

}  // namespace sfdae::cli
