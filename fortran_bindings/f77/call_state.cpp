// What survives between calls of DGELDA or SFNDAE.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/call_state.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "linalg/archive.h"
#include "linalg/index.h"

namespace sfdae::f77 {

namespace {

// kind = is_running + 2 is_constant + 4 METHOD
constexpr int running_bit = 1, constant_bit = 2, method_factor = 4;
constexpr int last_real = 20;

bool is_whole(double value) { return value == std::floor(value); }

}  // namespace

void CallState::invalidate() { arguments_.iwork.set(word, 0); }

std::size_t CallState::size_of_matrices(bool is_constant) const {
  const std::size_t n = core::index(arguments_.n);
  return is_constant ? 2 * n * n : 0;
}

std::size_t CallState::saved_length() const { return static_cast<std::size_t>(arguments_.rwork(length)); }

// Of all words, folded to a positive INTEGER of 32 bits.
std::int64_t CallState::checksum(std::size_t reals) const {
  core::WordHash hash;
  hash.add(static_cast<std::uint64_t>(arguments_.m));
  hash.add(static_cast<std::uint64_t>(arguments_.n));
  hash.add(static_cast<std::uint64_t>(arguments_.iwork.get(kind)));
  for (int position : {t_start, t_returned, span, length}) hash.add(&arguments_.rwork(position), 1);
  hash.add(&arguments_.rwork(first_real), reals);
  return static_cast<std::int64_t>((hash.value() >> 33) ^ (hash.value() & 0x7fffffffu));
}

int CallState::load(Progress& progress) const {
  if (arguments_.liw < shortest_iwork || arguments_.lrw < last_real) return code::bad_info;
  for (int size : {arguments_.m, arguments_.n})
    if (size <= 0 || size > largest_order) return code::bad_info;
  if (arguments_.iwork.get(word) != arguments_.routine->state_word) return code::bad_info;
  const std::int64_t kinds = arguments_.iwork.get(kind);
  progress.is_running = (kinds & running_bit) != 0;
  progress.is_constant = (kinds & constant_bit) != 0;
  const double reals = arguments_.rwork(length), room = static_cast<double>(arguments_.lrw - last_real);
  if (!(reals >= 0.0 && reals <= room && is_whole(reals))) return code::bad_info;
  if (saved_length() < size_of_matrices(progress.is_constant)) return code::bad_info;
  if (checksum(saved_length()) != arguments_.iwork.get(sum)) return code::bad_info;
  if (kinds / method_factor != arguments_.method) return code::bad_method;
  progress.span = arguments_.rwork(span);
  progress.t_returned = arguments_.rwork(t_returned);
  progress.t_start = arguments_.rwork(t_start);
  return code::ok;
}

bool CallState::save(const Progress& progress, const double* matrices, core::DaeSystem& system,
                     core::Integration* integration) {
  invalidate();
  const std::size_t room = static_cast<std::size_t>(arguments_.lrw - last_real);
  const std::size_t constants = size_of_matrices(progress.is_constant);
  core::Archive counter = core::Archive::counter();
  if (integration == nullptr) system.archive(counter);
  const std::size_t rest = integration != nullptr ? core::checkpoint_size(system, *integration) : counter.size();
  if (constants + rest > room) return false;
  double* to = &arguments_.rwork(first_real);
  std::copy_n(matrices, constants, to);
  if (integration != nullptr) {
    core::save_checkpoint(system, *integration, to + constants);
  } else {
    core::Archive archive = core::Archive::writer(to + constants, rest);
    system.archive(archive);
  }
  arguments_.rwork(span) = progress.span;
  arguments_.rwork(t_returned) = progress.t_returned;
  arguments_.rwork(t_start) = progress.t_start;
  arguments_.rwork(length) = static_cast<double>(constants + rest);
  arguments_.iwork.set(kind, (progress.is_running ? running_bit : 0) + (progress.is_constant ? constant_bit : 0) +
                                 method_factor * arguments_.method);
  arguments_.iwork.set(sum, checksum(constants + rest));
  arguments_.iwork.set(word, arguments_.routine->state_word);
  return true;
}

void CallState::restore_system(core::Model& model, const core::ModelOptions& options,
                               const Progress& progress) const {
  const std::size_t constants = size_of_matrices(progress.is_constant);
  core::Archive archive =
      core::Archive::reader(&arguments_.rwork(first_real) + constants, saved_length() - constants);
  model.restore(options, archive);
}

std::unique_ptr<core::Integration> CallState::restore(core::Model& model, const core::ModelOptions& model_options,
                                                      const core::IntegrationOptions& options,
                                                      const Progress& progress) const {
  const std::size_t constants = size_of_matrices(progress.is_constant);
  const core::SavedCheckpoint saved{&arguments_.rwork(first_real) + constants, saved_length() - constants};
  return core::restore_checkpoint(model, model_options, options, saved);
}

}  // namespace sfdae::f77
