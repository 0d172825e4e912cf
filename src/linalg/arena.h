// Scratch memory for numerical kernels: grows during the first calls, allocates nothing afterwards. All blocks begin at
// multiples of a cache line: long vectors are slower elsewhere, and sums of BLAS depend on the alignment of their
// operands.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

// A stack of doubles in chunks. Pointers stay valid until the frame in which they were taken ends.
class Arena {
 public:
  Arena() = default;
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  // Memory taken during the lifetime of a frame is released when it ends.
  class Frame {
   public:
    explicit Frame(Arena& arena) : arena_(arena), chunk_(arena.chunk_), used_(arena.used_) {}
    ~Frame() {
      arena_.chunk_ = chunk_;
      arena_.used_ = used_;
    }
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

   private:
    Arena& arena_;
    std::size_t chunk_;
    std::size_t used_;
  };

  // count uninitialized doubles.
  double* take(std::size_t count) {
    count = (count + 8) & ~std::size_t{7};  // whole cache lines
    while (chunk_ < chunks_.size() && used_ + count > chunks_[chunk_].size) {
      ++chunk_;
      used_ = 0;
    }
    if (chunk_ == chunks_.size()) grow(count);
    double* result = chunks_[chunk_].first + used_;
    used_ += count;
    return result;
  }

  double* zeros(std::size_t count) {
    double* result = take(count);
    std::fill_n(result, count, 0.0);
    return result;
  }

  View matrix(int rows, int cols) {
    const int ld = padded_rows(rows);
    return {take(index(ld) * index(cols)), rows, cols, ld};
  }

  int* integers(int count) { return reinterpret_cast<int*>(take(index(count) / 2 + 1)); }

 private:
  struct Chunk {
    std::unique_ptr<double[]> memory;
    double* first;
    std::size_t size;
  };

  // Chunks from 32 KiB on, each twice as large as the one before, so that they are few.
  void grow(std::size_t count) {
    const std::size_t size = std::max({count, std::size_t{4096}, chunks_.empty() ? 0 : 2 * chunks_.back().size});
    constexpr std::size_t line = 64;  // bytes
    std::unique_ptr<double[]> memory(new double[size + line / sizeof(double)]);
    double* first =
        memory.get() + (line - reinterpret_cast<std::uintptr_t>(memory.get()) % line) % line / sizeof(double);
    chunks_.push_back({std::move(memory), first, size});
    used_ = 0;
  }

  std::vector<Chunk> chunks_;
  std::size_t chunk_ = 0;
  std::size_t used_ = 0;
};

}  // namespace sfdae::core
