// The last points of a BDF integration and the polynomials through them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/bdf_history.h"

#include <algorithm>
#include <cstring>

namespace sfdae::core {

namespace {

// True if the slopes are equal bitwise: slope_x_ is not stored then.
bool slopes_are_same(const StartingPoint& point) {
  return !point.xdot.empty() && point.xdot.size() == point.wdot.size() &&
         std::memcmp(point.xdot.data(), point.wdot.data(), point.xdot.size() * sizeof(double)) == 0;
}

}  // namespace

// Memory is reserved here, but not touched before points are added.
void BdfHistory::resize(std::size_t n, std::size_t size_w) {
  n_ = n;
  for (Table* table : {&w_, &dw_})
    for (std::vector<double>& values : *table) {
      values.clear();
      values.reserve(size_w);
    }
  w_[0].resize(size_w);
}

void BdfHistory::reserve_x() {
  if (dx_.back().size() == n_) return;  // the one that is resized last
  for (Table* table : {&x_, &dx_})
    for (std::vector<double>& values : *table) values.resize(n_);
}

// Requires w_[i].
void BdfHistory::set_x(int i, const double* x) {
  const std::vector<double>& w = w_[index(i)];
  const bool is_same = w.size() == n_ && std::equal(w.begin(), w.end(), x);
  if (!is_same) {
    reserve_x();
    std::copy_n(x, n_, x_[index(i)].data());
  }
  is_same_[index(i)] = is_same;
}

void BdfHistory::start(const StartingPoint& point) {
  resize(point.x.size(), point.w.size());
  times_[0] = point.t;
  w_[0] = point.w;
  slope_w_ = point.wdot;
  if (slopes_are_same(point)) std::vector<double>().swap(slope_x_);
  else slope_x_ = point.xdot;
  points_ = 2;
  is_fictitious_ = true;
  set_x(0, point.x.data());
}

void BdfHistory::place_fictitious_point(double h) {
  times_[1] = times_[0] - h;
  w_[1].resize(size_w());
  for (std::size_t i = 0; i < slope_w_.size(); ++i) w_[1][i] = w_[0][i] - h * slope_w_[i];
  const std::vector<double>& slope_x = slope_x_.empty() && n_ > 0 ? slope_w_ : slope_x_;
  const bool is_same = is_same_[0] && slope_x == slope_w_;
  if (!is_same) reserve_x();
  is_same_[1] = is_same;
  if (is_same) return;
  const std::vector<double>& x = x_at(0);
  for (std::size_t i = 0; i < slope_x.size(); ++i) x_[1][i] = x[i] - h * slope_x[i];
}

void BdfHistory::append(double t, const std::vector<double>& w, const std::vector<double>& x) {
  // Allocate first: a failure changes nothing.
  if (size_w() != n_ || !std::equal(w.data(), w.data() + n_, x.data())) reserve_x();
  // The vectors of the oldest point are reused for the newest.
  const int count = std::min(points_ + 1, capacity);
  w_[index(count - 1)].resize(size_w());
  std::rotate(w_.begin(), w_.begin() + count - 1, w_.begin() + count);
  std::rotate(x_.begin(), x_.begin() + count - 1, x_.begin() + count);
  std::rotate(times_.begin(), times_.begin() + count - 1, times_.begin() + count);
  std::rotate(is_same_.begin(), is_same_.begin() + count - 1, is_same_.begin() + count);
  times_[0] = t;
  std::copy_n(w.data(), w_[0].size(), w_[0].data());
  set_x(0, x.data());
  points_ = count;
  for (std::vector<double>* slope : {&slope_w_, &slope_x_}) std::vector<double>().swap(*slope);
}

// Derivative of Lagrange polynomials: L_i' = L_i sum of 1 / (t - t_j), j != i.
double BdfHistory::formula_by_points(double t, int count, double* predicted, double* rest) const {
  std::fill_n(predicted, size_w(), 0.0);
  std::fill_n(rest, size_w(), 0.0);
  double c = 0.0;
  for (int i = 0; i < count; ++i) {
    double L = 1.0;
    for (int j = 0; j < count; ++j)
      if (j != i) L *= (t - time(j)) / (time(i) - time(j));
    const double slope = -L / (t - time(i));
    const double* __restrict w = w_[index(i)].data();
    double* __restrict p = predicted, * __restrict r = rest;
    for (std::size_t k = 0; k < size_w(); ++k) {
      p[k] += L * w[k];
      r[k] += slope * w[k];
    }
    c += 1.0 / (t - time(i));
  }
  return c;
}

void BdfHistory::compute_differences(int count, bool with_x) {
  for (int i = 0; i < count; ++i) dw_[index(i)].resize(size_w());
  differences_of_history(times_, w_, count, dw_);
  shares_ = std::all_of(is_same_.begin(), is_same_.begin() + count, [](bool same) { return same; });
  if (!with_x || shares_) return;
  for (int i = 0; i < count; ++i)
    if (is_same_[index(i)]) x_[index(i)] = w_[index(i)];
  differences_of_history(times_, x_, count, dx_);
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
  // Before the first step the second point is fictitious and follows from the slopes.
  const bool has_slope = points == 2 && is_fictitious_;
  for (int i = 0; i < (has_slope ? 1 : points); ++i) {
    archive.reals(w_[index(i)], size_w());
    std::vector<double> x = archive.is_reading() ? std::vector<double>() : x_at(i);
    archive.reals(x, size_x());
    if (archive.is_reading()) set_x(i, x.data());
  }
  if (has_slope) {
    archive.reals(slope_w_, size_w());
    if (!archive.is_reading() && slope_x_.empty() && n_ > 0) slope_x_ = slope_w_;
    archive.reals(slope_x_, size_x());
  }
}

}  // namespace sfdae::core
