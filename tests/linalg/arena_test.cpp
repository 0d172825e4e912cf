// SPDX-License-Identifier: BSD-3-Clause
// Scratch memory: frames give back what they took, pointers stay, nothing overlaps.
#include "linalg/arena.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sfdae::core {

namespace {

struct Piece {
  double* memory;
  std::size_t count;
  double mark;
};

// Sizes around the rounding to multiples of 8 and beyond the size of a first chunk.
constexpr std::size_t sizes[] = {0, 1, 7, 8, 9, 100, 4096, 4097, 3, 20000, 1, 64};

std::vector<Piece> take_marked(Arena& arena) {
  std::vector<Piece> pieces;
  for (std::size_t count : sizes) {
    pieces.push_back({arena.take(count), count, static_cast<double>(pieces.size() + 1)});
    std::fill_n(pieces.back().memory, count, pieces.back().mark);
  }
  return pieces;
}

bool intact(const Piece& piece) {
  return std::all_of(piece.memory, piece.memory + piece.count, [&](double value) { return value == piece.mark; });
}

}  // namespace

TEST(Arena, PiecesDoNotOverlapWhenTheMemoryGrows) {
  Arena arena;
  for (const Piece& piece : take_marked(arena)) EXPECT_TRUE(intact(piece)) << piece.count;
}

TEST(Arena, AFrameGivesBackWhatWasTakenInIt) {
  Arena arena;
  take_marked(arena);
  double* inside = nullptr;
  {
    const Arena::Frame frame(arena);
    inside = arena.take(10);
  }
  EXPECT_EQ(arena.take(10), inside);
}

TEST(Arena, AFrameKeepsWhatWasTakenBeforeIt) {
  Arena arena;
  const std::vector<Piece> before = take_marked(arena);
  for (int repetition = 0; repetition < 3; ++repetition) {
    const Arena::Frame frame(arena);
    const std::vector<Piece> inner = take_marked(arena);
    for (const Piece& piece : inner) EXPECT_TRUE(intact(piece));
  }
  for (const Piece& piece : before) EXPECT_TRUE(intact(piece));
}

// No allocation after the first time: the second run of the same calls finds the same memory.
TEST(Arena, RepeatedFramesUseTheSameMemory) {
  Arena arena;
  std::vector<double*> first, second;
  for (std::vector<double*>* run : {&first, &second}) {
    const Arena::Frame frame(arena);
    for (std::size_t count : sizes) run->push_back(arena.take(count));
  }
  // The first run skips ends of chunks that are too small as the second does: addresses agree.
  EXPECT_EQ(first, second);
}

// Vector loops read and write whole cache lines.
TEST(Arena, EveryPieceBeginsAtACacheLine) {
  Arena arena;
  for (const Piece& piece : take_marked(arena)) EXPECT_EQ(reinterpret_cast<std::uintptr_t>(piece.memory) % 64, 0u);
}

TEST(Arena, ZerosAreZeroInUsedMemory) {
  Arena arena;
  {
    const Arena::Frame frame(arena);
    std::fill_n(arena.take(50), 50, 3.0);
  }
  const double* zeros = arena.zeros(50);
  EXPECT_TRUE(std::all_of(zeros, zeros + 50, [](double value) { return value == 0.0; }));
}

TEST(Arena, MatricesHavePaddedColumnsInsideTheirMemory) {
  Arena arena;
  for (int rows : {0, 1, 5, 64})
    for (int cols : {0, 1, 3}) {
      const View a = arena.matrix(rows, cols);
      const double* next = arena.take(1);
      EXPECT_EQ(a.rows, rows);
      EXPECT_EQ(a.cols, cols);
      EXPECT_EQ(a.ld, padded_rows(rows));
      EXPECT_GE(next - a.data, static_cast<std::ptrdiff_t>(a.ld) * cols);
    }
}

TEST(Arena, IntegersHaveRoomForTheirCount) {
  Arena arena;
  for (int count = 0; count < 40; ++count) {
    int* integers = arena.integers(count);
    const int* next = reinterpret_cast<int*>(arena.take(1));
    EXPECT_GE(next - integers, count);
  }
}

}  // namespace sfdae::core
