// All times at which functions of t alone in recorded equations switch to another branch, however close to each other:
// by interval arithmetic and bisection, as [Moo66] finds zeros.
//
// [Moo66] R. E. Moore: Interval Analysis. Prentice-Hall, 1966. Chapter 7.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "expression/switching_functions.h"

namespace sfdae::core {

// Half the width of a gap about a time within which rounding errors may decide the branch: 64 of them. A linear
// function of t, modulo a period, has a few. size: magnitude of the times that t is a difference of.
inline double half_of_gap(double t, double size) {
  return 64.0 * std::numeric_limits<double>::epsilon() * std::max(std::fabs(t), size);
}

// Interval of times within which rounding errors decide the branch.
struct SwitchingGap {
  double start, end;
  int jumping_order;  // the least order of derivatives that may jump
};

class SwitchingTimes {
 public:
  // Parameters have the values that the evaluators, which must outlive this object, have at the time of a call.
  explicit SwitchingTimes(const std::vector<const TaylorEvaluator*>& evaluators);

  bool empty() const { return branches_.empty(); }
  // Magnitude of times of the integration; gaps about times next to 0 depend on it.
  void set_size(double size) {
    size_ = size;
    version_ = -1;  // discards earlier results
  }
  // Factor by which a search extends beyond the time needed; 4 at first, so that most steps find the answer.
  void set_looks_ahead(double factor) { looks_ahead_ = factor; }
  double half_gap(double t) const;

  // The gaps in an interval, increasing, up to `known_to()`. That is before `toward` if a gap beyond `from` has been
  // found, or if the search ended early: at `from` itself if rounding errors alone decide the branch next to it.
  const std::vector<SwitchingGap>& find(double from, double toward);
  double known_to() const { return known_to_; }

 private:
  struct Piece {
    double start, end;  // in the direction of the search
    bool is_gap;
  };
  struct Borders {
    double start = 0.0, end = 0.0;
    bool is_open = false;
  };
  void forget(double from, double beside);
  bool extend(double toward);
  bool look_at(const Piece& piece);
  void split(const Piece& piece, std::size_t part, const Crossing& crossing);
  double gap_about(double t, std::size_t part, std::size_t which, double room);
  bool close(double at);
  void find_branches(Interval t);
  void keep(SwitchingGap gap);

  std::vector<SwitchingFunctions> parts_;
  std::vector<Branch> branches_, before_;  // on the piece, and before the gap
  std::vector<SwitchingGap> gaps_;         // all of them from low_ to high_
  double low_ = 0.0, high_ = 0.0, known_to_ = 0.0, size_ = 1.0, direction_ = 1.0, looks_ahead_ = 4.0;
  long version_ = -1;
  std::vector<Piece> pieces_;  // to be looked at, the next one last
  Borders open_;               // the gap that has begun
};

}  // namespace sfdae::core
