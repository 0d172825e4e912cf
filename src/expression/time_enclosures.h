// Enclosures of the values and derivatives of functions of t alone over an interval of t, by interval arithmetic on
// Taylor coefficients. Where values alone leave open which branch of a condition, or which whole number, holds, they
// are enclosed by the mean value form, too: t - sin t has a sign near 0, although t and sin t overlap.
//
// [Moo66] R. E. Moore: Interval Analysis. Prentice-Hall, 1966. Chapters 3, 11.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "expression/interval.h"
#include "expression/tape.h"
#include "linalg/index.h"

namespace sfdae::core {

// Enclosures of u, u' and u'' / 2 over an interval.
struct TimeSeries {
  Interval value, slope, bend;
};

class TimeEnclosures {
 public:
  // slots: the wanted slots of the tape.
  TimeEnclosures(const Tape& tape, const std::vector<int>& slots);

  // False: user-supplied functions, which are unknown between points, contribute to the k-th one.
  bool is_enclosed(std::size_t k) const { return is_enclosed_[index(wanted_[k])] != 0; }
  // numbers: the slots of the tape; only those that do not depend on t are read. Allocates nothing.
  void enclose(const double* numbers, Interval t);
  const TimeSeries& operator[](std::size_t k) const { return series_[index(wanted_[k])]; }

 private:
  struct Number {
    int place, slot;
  };
  void execute(Interval t);
  bool is_open(const Instruction& instruction) const;
  void use_mean_value(int place, Interval t);
  TimeSeries value_of(const Instruction& instruction) const;
  TimeSeries value_of_function(const Instruction& instruction) const;
  TimeSeries value_of_power(const Instruction& instruction) const;

  std::vector<Instruction> instructions_;  // with places in series_ in place of slots
  std::vector<Number> numbers_;
  int time_ = 0;
  std::vector<int> wanted_;
  std::vector<TimeSeries> series_;
  std::vector<TimeSeries> at_middle_;  // of the interval, if has_middle_
  bool has_middle_ = false;
  std::vector<char> is_enclosed_;
};

}  // namespace sfdae::core
