// State as a sequence of doubles: one function of a class names its members, and counts, writes or reads them.
//
// The doubles are plain numbers, so that they survive being copied as such, by any language.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sfdae::core {

// Thrown if the data read cannot have been written by an Archive.
struct DamagedArchive {};

// Checksum of a sequence of words: FNV-1a with its constants for 64 bits. High bits are folded down after each word, as
// a product changes no bits below the lowest one that differs.
class WordHash {
 public:
  void add(std::uint64_t word) {
    value_ = (value_ ^ word) * 1099511628211u;
    value_ ^= value_ >> 29;
  }
  void add(const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) add(std::bit_cast<std::uint64_t>(values[i]));
  }
  // The integers and how many there are.
  void add_all(std::span<const int> values) {
    add(values.size());
    for (const int value : values) add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
  }
  std::uint64_t value() const { return value_; }
  // Cut to the 52 bits that a double holds.
  double value_as_real() const { return static_cast<double>(value_ >> 12); }

 private:
  std::uint64_t value_ = 14695981039346656037u;
};

class Archive {
 public:
  static Archive counter() { return Archive(nullptr, nullptr, 0); }
  static Archive writer(double* to, std::size_t length) { return Archive(to, nullptr, length); }
  static Archive reader(const double* from, std::size_t length) { return Archive(nullptr, from, length); }

  bool is_reading() const { return from_ != nullptr; }
  std::size_t size() const { return size_; }  // doubles counted, written or read so far
  bool has_ended() const { return size_ == length_; }
  std::size_t rest() const { return length_ - size_; }  // remaining to be read

  // Reading beyond the end, or NaN, throws DamagedArchive.
  void real(double& value) { reals(&value, 1); }
  void reals(double* values, std::size_t count);
  // A vector is resized when reading; when writing, missing entries count as zero.
  void reals(std::vector<double>& values, std::size_t count);
  // Two counts from 0 to 2^26 - 1, larger ones cut, in one double.
  void counts(long& first, long& second);
  // Integers from -1 to 65534 and flags, three to a double.
  template <class... Integers>
  void small(Integers&... values) {
    int packed[] = {static_cast<int>(values)...};
    pack(packed, sizeof...(values));
    const int* next = packed;
    if (is_reading()) ((values = static_cast<Integers>(*next++)), ...);
  }
  void small(int* values, std::size_t count) { pack(values, count); }

 private:
  Archive(double* to, const double* from, std::size_t length) : to_(to), from_(from), length_(length) {}
  std::size_t checked(std::size_t count) const {
    if (count > length_ - size_) throw DamagedArchive();
    return count;
  }
  void pack(int* values, std::size_t count);

  double* to_;
  const double* from_;
  std::size_t length_;
  std::size_t size_ = 0;
};

}  // namespace sfdae::core
