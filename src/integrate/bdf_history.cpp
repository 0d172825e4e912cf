// The last points of a BDF integration and the polynomials through them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/bdf_history.h"

#include <algorithm>

namespace sfdae::core {

void BdfHistory::resize(std::size_t n, std::size_t size_w) {
  for (int i = 0; i < capacity; ++i) {
    w_[index(i)].resize(size_w);
    dw_[index(i)].resize(size_w);
    x_[index(i)].resize(n);
    dx_[index(i)].resize(n);
  }
}

void BdfHistory::start(const StartingPoint& point) {
  resize(point.x.size(), point.w.size());
  times_[0] = point.t;
  w_[0] = point.w;
  x_[0] = point.x;
  slope_w_ = point.wdot;
  slope_x_ = point.xdot;
  points_ = 2;
  is_fictitious_ = true;
  is_same_[0] = x_[0] == w_[0];
}

void BdfHistory::place_fictitious_point(double h) {
  times_[1] = times_[0] - h;
  for (std::size_t i = 0; i < slope_w_.size(); ++i) w_[1][i] = w_[0][i] - h * slope_w_[i];
  for (std::size_t i = 0; i < slope_x_.size(); ++i) x_[1][i] = x_[0][i] - h * slope_x_[i];
  is_same_[1] = x_[1] == w_[1];
}

void BdfHistory::append(double t, const std::vector<double>& w, const std::vector<double>& x) {
  // The oldest vectors make room for the newest.
  const int count = std::min(points_ + 1, capacity);
  std::rotate(w_.begin(), w_.begin() + count - 1, w_.begin() + count);
  std::rotate(x_.begin(), x_.begin() + count - 1, x_.begin() + count);
  std::rotate(times_.begin(), times_.begin() + count - 1, times_.begin() + count);
  std::rotate(is_same_.begin(), is_same_.begin() + count - 1, is_same_.begin() + count);
  times_[0] = t;
  std::copy_n(w.data(), w_[0].size(), w_[0].data());
  std::copy_n(x.data(), x_[0].size(), x_[0].data());
  is_same_[0] = x_[0] == w_[0];
  points_ = count;
}

void BdfHistory::compute_differences(int count, bool with_x) {
  differences_of_history(times_, w_, count, dw_);
  shares_ = std::all_of(is_same_.begin(), is_same_.begin() + count, [](bool same) { return same; });
  if (with_x && !shares_) differences_of_history(times_, x_, count, dx_);
}

int BdfHistory::archive_size(Archive& archive, const Sizes& sizes, int max_points, int& last_order) {
  int points = std::min(points_, max_points);
  archive.small(points, is_fictitious_, last_order);
  if (archive.is_reading()) {
    if (points < 2 || points > capacity || last_order < 0 || last_order > max_bdf_order) throw DamagedArchive();
    points_ = points;
    resize(sizes.x, sizes.w);
  }
  return points;
}

void BdfHistory::archive_points(Archive& archive, int points) {
  archive.reals(times_.data(), index(points));
  // Before the first step the second point is fictitious, and its values follow from the slopes.
  const bool has_slope = points == 2 && is_fictitious_;
  for (int i = 0; i < (has_slope ? 1 : points); ++i) {
    archive.reals(w_[index(i)], size_w());
    archive.reals(x_[index(i)], size_x());
  }
  if (has_slope) {
    archive.reals(slope_w_, size_w());
    archive.reals(slope_x_, size_x());
  }
  for (int i = 0; i < points; ++i) is_same_[index(i)] = x_[index(i)] == w_[index(i)];
}

}  // namespace sfdae::core
