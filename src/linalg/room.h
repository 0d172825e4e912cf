// Memory for results of kernels, without initial values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace sfdae::core {

// Allocator of a std::vector whose new entries are uninitialized: memory is not written before it is used.
template <class T>
struct WithoutValues : std::allocator<T> {
  WithoutValues() = default;
  template <class Other>
  WithoutValues(const WithoutValues<Other>&) {}
  template <class Other>
  struct rebind {
    using other = WithoutValues<Other>;
  };
  template <class Other, class... Arguments>
  void construct(Other* entry, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) ::new (static_cast<void*>(entry)) Other;
    else ::new (static_cast<void*>(entry)) Other(std::forward<Arguments>(arguments)...);
  }
};

// Numbers that are valid only once they have been written.
using Room = std::vector<double, WithoutValues<double>>;

}  // namespace sfdae::core
