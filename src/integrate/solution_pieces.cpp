// The solution over a whole run.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/solution_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Degrees tried in order: the points of one are among those of the next.
constexpr int chebyshev_degrees[] = {4, 8, 16};
constexpr int max_chebyshev_degree = 16;
// Size allowed for the last two coefficients, in tolerances: they bound the truncated terms, because coefficients of
// smooth functions decrease. The integrator's own polynomials have errors up to half a tolerance.
constexpr double tail = 0.3;
// Value in tolerances for an unknown error of a piece.
constexpr double unknown = 1e300;
// Steps of problems without differential equations are as long as the interval.
constexpr int most_interval_halvings = 10;

using Points = std::array<double, max_chebyshev_degree + 1>;

// cos(pi j / 16), the points of the highest degree, from 1 to -1, bitwise symmetric.
const Points& points() {
  static const Points all = [] {
    Points cosines{};
    for (int j = 0; j < max_chebyshev_degree / 2; ++j) {
      cosines[index(j)] = std::cos(std::numbers::pi * j / max_chebyshev_degree);
      cosines[index(max_chebyshev_degree - j)] = -cosines[index(j)];
    }
    return cosines;
  }();
  return all;
}

}  // namespace

// x at the points cos(pi j / 16) of an interval, if known, and coefficients.
struct SolutionPieces::Samples {
  double a, b;
  std::array<bool, max_chebyshev_degree + 1> known{};
  std::vector<double> x;  // (max_degree + 1) n
  int degree = 0;
  std::vector<double> coefficients;  // (degree + 1) n
  bool is_accurate = true;           // all values known so far

  double time(int j) const {
    if (j == 0) return b;
    if (j == max_chebyshev_degree) return a;
    return a + (b - a) * 0.5 * (1.0 + points()[index(j)]);
  }
};

void SolutionPieces::forget() {
  pieces_.clear();
  coefficients_.clear();
}

// Removes pieces that begin at or after t; the piece that contains t ends there.
void SolutionPieces::cut(double t) {
  while (!pieces_.empty() && (pieces_.back().a - t) * direction_ >= 0.0) {
    coefficients_.resize(pieces_.back().first);
    pieces_.pop_back();
  }
  end_ = t;
}

SolutionPieces::Accuracy SolutionPieces::accuracy() const {
  Accuracy result{0.0, start_};
  for (const Piece& piece : pieces_)
    if (piece.left_out > result.in_tolerances) result = {piece.left_out, piece.a};
  return result;
}

void SolutionPieces::add(int n, const Step& step) {
  const double direction = step.b < step.a ? -1.0 : 1.0;
  const bool is_within = !pieces_.empty() && n == n_ && direction == direction_ &&
                         (step.a - start_) * direction >= 0.0 && (end_ - step.a) * direction >= 0.0;
  if (!is_within) forget();
  n_ = n;
  direction_ = direction;
  if (!step.continues && is_within) cut(step.a);
  if (pieces_.empty()) start_ = end_ = step.a;
  const std::size_t pieces_before = pieces_.size(), coefficients_before = coefficients_.size();
  try {
    Samples samples{step.a, step.b, {}, std::vector<double>(index(max_chebyshev_degree + 1) * index(n)), 0, {}};
    add_interval(step, samples, most_interval_halvings);
  } catch (...) {
    pieces_.resize(pieces_before);
    coefficients_.resize(coefficients_before);
    throw;
  }
  end_ = step.b;
}

// Computes coefficients through the values at the points; returns the size of the last two, in tolerances.
double SolutionPieces::fit(const Step& step, Samples& samples) const {
  const std::size_t n = index(n_);
  double largest = 0.0;
  for (int degree : chebyshev_degrees) {
    const int stride = max_chebyshev_degree / degree;
    for (int j = 0; j <= max_chebyshev_degree; j += stride) {
      if (samples.known[index(j)]) continue;
      samples.known[index(j)] = true;
      samples.is_accurate &= step.sample(samples.time(j), samples.x.data() + index(j) * n);
    }
    samples.degree = degree;
    samples.coefficients.assign(index(degree + 1) * n, 0.0);
    // c_k = 2 / degree sum'' x_j cos(pi j k / degree), with the first and last terms and coefficients halved.
    for (int k = 0; k <= degree; ++k)
      for (int j = 0; j <= degree; ++j) {
        const int turn = j * k * stride % (2 * max_chebyshev_degree);
        const double cosine = points()[index(turn <= max_chebyshev_degree ? turn : 2 * max_chebyshev_degree - turn)];
        const double halves = (j % degree == 0 ? 0.5 : 1.0) * (k % degree == 0 ? 0.5 : 1.0);
        const double factor = 2.0 / degree * halves * cosine;
        const double* const x = samples.x.data() + index(j * stride) * n;
        double* const c = samples.coefficients.data() + index(k) * n;
        for (std::size_t i = 0; i < n; ++i) c[i] += factor * x[i];
      }
    const double* const last = samples.coefficients.data() + index(degree) * n;
    const double* const last_but_one = samples.coefficients.data() + index(degree - 1) * n;
    largest = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double left_out = std::fabs(last[i]) + std::fabs(last_but_one[i]);
      if (left_out == 0.0) continue;
      const double allowed =
          std::max(step.tolerance(static_cast<int>(i), samples.x.data()),
                   step.tolerance(static_cast<int>(i), samples.x.data() + max_chebyshev_degree * n));
      // NaN also counts as unknown.
      largest = left_out / unknown < allowed ? std::max(largest, left_out / allowed) : unknown;
    }
    if (!samples.is_accurate) largest = unknown;
    if (largest <= tail) break;
  }
  return largest;
}

void SolutionPieces::add_interval(const Step& step, Samples& samples, int halvings) {
  const double left_out = fit(step, samples), middle = samples.time(max_chebyshev_degree / 2);
  if (left_out > tail && halvings > 0 && middle != samples.a && middle != samples.b) {
    Samples halves[2] = {{samples.a, middle, {}, samples.x, 0, {}}, {middle, samples.b, {}, samples.x, 0, {}}};
    double best = left_out;
    for (Samples& half : halves) best = std::min(best, fit(step, half));
    if (best < 0.5 * left_out) {
      for (Samples& half : halves) add_interval(step, half, halvings - 1);
      return;
    }
  }
  pieces_.push_back({samples.a, samples.b, samples.degree, left_out, coefficients_.size()});
  coefficients_.insert(coefficients_.end(), samples.coefficients.begin(), samples.coefficients.end());
}

bool SolutionPieces::evaluate(double t, double* x, double* xdot) const {
  if (pieces_.empty() || !((t - start_) * direction_ >= 0.0) || !((end_ - t) * direction_ >= 0.0)) return false;
  // The last piece that begins at t or before.
  const auto after =
      std::upper_bound(pieces_.begin() + 1, pieces_.end(), t * direction_,
                       [this](double time, const Piece& piece) { return time < piece.a * direction_; });
  const Piece& piece = *(after - 1);
  const std::size_t n = index(n_);
  const double s = std::clamp(((t - piece.a) - (piece.b - t)) / (piece.b - piece.a), -1.0, 1.0);
  const double to_time = 2.0 / (piece.b - piece.a);
  // T_k and T_k' by their recurrences.
  double T = 1.0, T_next = s, slope = 0.0, slope_next = 1.0;
  std::fill_n(x, n, 0.0);
  if (xdot != nullptr) std::fill_n(xdot, n, 0.0);
  for (int k = 0; k <= piece.degree; ++k) {
    const double* const c = coefficients_.data() + piece.first + index(k) * n;
    for (std::size_t i = 0; i < n; ++i) x[i] += c[i] * T;
    if (xdot != nullptr)
      for (std::size_t i = 0; i < n; ++i) xdot[i] += c[i] * slope * to_time;
    const double T_after = 2.0 * s * T_next - T, slope_after = 2.0 * T_next + 2.0 * s * slope_next - slope;
    T = T_next, T_next = T_after, slope = slope_next, slope_next = slope_after;
  }
  return true;
}

void SolutionPieces::archive(Archive& archive) {
  int sign = direction_ < 0.0 ? 1 : 0;
  double count = static_cast<double>(pieces_.size());
  archive.small(n_, sign);
  archive.real(count);
  if (archive.is_reading()) {
    direction_ = sign == 0 ? 1.0 : -1.0;
    // Each piece takes more than one number.
    if (!(count >= 0.0 && count <= static_cast<double>(archive.rest())) || count != std::floor(count))
      throw DamagedArchive();
    pieces_.resize(static_cast<std::size_t>(count));
  }
  archive.real(start_);
  archive.real(end_);
  std::size_t first = 0;
  for (Piece& piece : pieces_) {
    archive.real(piece.a);
    archive.real(piece.b);
    archive.small(piece.degree);
    archive.real(piece.left_out);
    piece.first = first;
    first += index(std::max(piece.degree, 0) + 1) * index(std::max(n_, 0));
  }
  archive.reals(coefficients_, first);
  if (archive.is_reading() && !is_sound()) throw DamagedArchive();
}

// True if the data read can be evaluated.
bool SolutionPieces::is_sound() const {
  const auto ahead = [this](double from, double to) { return (to - from) * direction_ > 0.0; };
  if (n_ < 1) return pieces_.empty();
  if (!std::isfinite(start_) || !std::isfinite(end_)) return false;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    const bool has_degree = std::find(std::begin(chebyshev_degrees), std::end(chebyshev_degrees), piece.degree) !=
                            std::end(chebyshev_degrees);
    if (!has_degree || !std::isfinite(piece.a) || !std::isfinite(piece.b) || !ahead(piece.a, piece.b)) return false;
    if (!(piece.left_out >= 0.0)) return false;
    if (i == 0 ? piece.a != start_ : !ahead(pieces_[i - 1].a, piece.a)) return false;
  }
  if (!pieces_.empty() && (!ahead(pieces_.back().a, end_) || ahead(pieces_.back().b, end_))) return false;
  return std::all_of(coefficients_.begin(), coefficients_.end(), [](double c) { return std::isfinite(c); });
}

}  // namespace sfdae::core
