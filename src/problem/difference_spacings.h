// Spacings of finite differences, chosen for every entry of a function.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

// Entries that vary on different scales of time have different ones.
struct Spacings {
  int highest = 0;  // derivatives up to this order are computed well; 0: not chosen yet
  std::vector<double> steps;
  std::vector<int> of_entry;  // numbers of steps; empty: the first one for all
  int of(int entry) const { return of_entry.empty() ? 0 : of_entry[static_cast<std::size_t>(entry)]; }
};

// Positions of the points (ChebyshevDifferences), and a probe between them that shows the interpolation error.
struct DifferencePoints {
  double half_width;  // of their interval
  double position;    // in [-1, 1], of the point of interest
  const double* samples;
  const double* probe;  // values at the probe
};

class SpacingSearch {
 public:
  // Derivatives up to order `highest` of a function with so many entries are wanted; span: the interval of interest.
  SpacingSearch(int entries, int highest, double span) : entries_(entries), highest_(highest), span_(span) {}
  void add(double step, const DifferencePoints& points);
  bool is_empty() const { return steps_.empty(); }
  // The fewest spacings, four at most, that are nearly as good as the best one for every entry.
  Spacings choose() const;

 private:
  bool serves(std::size_t candidate, std::size_t entry) const;
  double merit(std::size_t candidate, const std::vector<char>& done) const;

  int entries_, highest_;
  double span_;
  std::vector<double> steps_;
  std::vector<std::vector<float>> errors_;  // of the entries with each step, relative to their size
  std::vector<float> best_;
  std::vector<double> sizes_;  // largest values met
};

}  // namespace sfdae::core
