// Memory of a program through functions of its own. Included by one source file of it: it replaces operator new.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

namespace sfdae::test {

// Defined by the program: before memory is taken, where std::bad_alloc says that there is none, and given back.
void before_allocation();
void before_release(void* memory) noexcept;

inline void* allocate(std::size_t size, std::size_t alignment) {
  before_allocation();
  void* memory = alignment > 0 ? std::aligned_alloc(alignment, (size / alignment + 1) * alignment)
                               : std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

// GCC takes std::free for a mismatch where it becomes part of the caller of operator delete.
[[gnu::noinline]] inline void release(void* memory) noexcept {
  before_release(memory);
  std::free(memory);
}

}  // namespace sfdae::test

void* operator new(std::size_t size) { return sfdae::test::allocate(size, 0); }
void* operator new[](std::size_t size) { return sfdae::test::allocate(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return sfdae::test::allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return sfdae::test::allocate(size, static_cast<std::size_t>(alignment));
}
// Algorithms of the standard library do without memory where there is none.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return sfdae::test::allocate(size, 0);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory, const std::nothrow_t&) noexcept { sfdae::test::release(memory); }
void operator delete(void* memory) noexcept { sfdae::test::release(memory); }
void operator delete[](void* memory) noexcept { sfdae::test::release(memory); }
void operator delete(void* memory, std::size_t) noexcept { sfdae::test::release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { sfdae::test::release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { sfdae::test::release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { sfdae::test::release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { sfdae::test::release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { sfdae::test::release(memory); }
