// An INTEGER array of the caller's, of either width, with positions from 1 as in Fortran.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

namespace sfdae::f77 {

class IntegerArray {
 public:
  explicit IntegerArray(std::int32_t* values) : narrow_(values) {}
  explicit IntegerArray(std::int64_t* values) : wide_(values) {}

  std::int64_t get(std::int64_t position) const {
    return narrow_ != nullptr ? narrow_[position - 1] : wide_[position - 1];
  }
  // Values that 32 bits do not hold become the nearest one that they do.
  void set(std::int64_t position, std::int64_t value) const {
    if (narrow_ == nullptr) wide_[position - 1] = value;
    else narrow_[position - 1] = static_cast<std::int32_t>(std::clamp<std::int64_t>(value, INT32_MIN, INT32_MAX));
  }

 private:
  std::int32_t* narrow_ = nullptr;
  std::int64_t* wide_ = nullptr;
};

}  // namespace sfdae::f77
