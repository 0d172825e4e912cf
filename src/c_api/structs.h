// Public structs across versions: the caller's `size` tells how much of them exists.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "sfdae/sfdae.h"

namespace sfdae::core {

// Larger sizes count as uninitialized memory.
inline constexpr std::size_t largest_struct = 65536;

inline bool is_plausible_size(std::size_t size) { return size >= sizeof(std::size_t) && size <= largest_struct; }

// Writes `defaults` with the caller's size, and zeros to members that this version does not know.
template <class Struct>
int initialize(Struct* target, std::size_t size, const Struct& defaults) {
  if (target == nullptr || !is_plausible_size(size)) return SFDAE_ILLEGAL_ARGUMENT;
  std::memset(static_cast<void*>(target), 0, size);
  std::memcpy(static_cast<void*>(target), &defaults, std::min(size, sizeof(Struct)));
  std::memcpy(static_cast<void*>(target), &size, sizeof size);
  return SFDAE_OK;
}

// The caller's struct in the present layout: members that the caller does not know have their defaults.
template <class Struct>
Struct read_struct(const Struct& source, const Struct& defaults) {
  Struct result = defaults;
  std::memcpy(static_cast<void*>(&result), &source, std::min(source.size, sizeof(Struct)));
  return result;
}

// Fills a struct of the caller's, whose size was set by its init function.
template <class Struct>
bool fill_struct(Struct* target, const Struct& source) {
  if (target == nullptr || !is_plausible_size(target->size)) return false;
  const std::size_t size = target->size;
  std::memcpy(static_cast<void*>(target), &source, std::min(size, sizeof(Struct)));
  std::memcpy(static_cast<void*>(target), &size, sizeof size);
  return true;
}

sfdae_linear_problem default_problem();
sfdae_nonlinear_problem default_nonlinear_problem();
sfdae_multibody_problem default_multibody_problem();
sfdae_options default_options();

}  // namespace sfdae::core
