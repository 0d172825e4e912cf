// Search for places within a step where inputs differ from the polynomials through their values at its nodes.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/input_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Distance allowed between an input and the polynomial, as part of the range of the input. (Chosen.)
constexpr double visible_part = 0.3;
// Excess allowed above or below the node values without being predicted, as part of the range. (Chosen.)
constexpr double visible_excess = 0.05;
// Peaks this part of the range outside the node values are located, whether they are predicted or not. (Chosen.)
constexpr double peak_part = 1e-4;
// Distances are found up to this factor. (Measured: 1 to 11 pieces for most inputs.)
constexpr double place_factor = 1.25;
// Parabolas lead from the largest sample to the peak, each through points at a quarter of the last one's distances,
// until one gains less than peak_gain of the range, a thousandth of a relevant change of an exponential. (Chosen.)
constexpr int parabolas = 12;
constexpr double peak_gain = 1e-8;
constexpr double reach_in_next = 0.25;
// Changes below this part of the size of an input are considered rounding errors.
constexpr double least_range = 1e-10;
// The same holds below so many rounding errors, as in 1 - cos(t) near 0; peaks count above fewer. (Chosen.)
constexpr double above_noise = 64.0, noise_at_peaks = 4.0;
// Smaller changes, relative to its size, are ignored: enclosures of constant sums of squares cause such. (Chosen.)
constexpr double least_sought = 1e-6;
// Maximum of pieces of a step; beyond it the inputs are considered unknown. (Measured: 75 were enough for all but sums
// of many sines with unrelated periods.)
constexpr std::size_t most_pieces = 256;
// Pieces of a step, and of the time scale of inputs, if user-supplied functions contribute: they are unknown between
// samples. (Chosen.)
constexpr double fewest_samples = 32.0, per_change = 4.0;
// Places nearer to each other than this part of a step are merged. (Chosen: far below the width of relevant peaks.)
constexpr double same_place = 1e-6;

}  // namespace

void set_lagrange_weights(std::span<const double> nodes, double t, double* weights) {
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    weights[k] = 1.0;
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != k) weights[k] *= (t - nodes[j]) / (nodes[k] - nodes[j]);
  }
}

void NodePolynomials::resize(std::size_t inputs) {
  at_nodes_.assign(inputs, {});
  now_.assign(inputs, 0.0);
}

void NodePolynomials::set_basis(std::span<const double> nodes) {
  for (std::size_t k = 0; k < count_; ++k) {
    std::array<double, most_nodes>& c = basis_[k];
    c.fill(0.0);
    c[0] = 1.0;
    const double at = (nodes[k] - middle_) / half_;
    for (std::size_t j = 0, degree = 0; j < count_; ++j) {
      if (j == k) continue;
      const double other = (nodes[j] - middle_) / half_, scale = 1.0 / (at - other);
      ++degree;
      for (std::size_t m = degree; m > 0; --m) c[m] = scale * (c[m - 1] - other * c[m]);
      c[0] *= -scale * other;
    }
  }
}

void NodePolynomials::set(TimeInputs& inputs, std::span<const double> nodes, double h) {
  half_ = 0.5 * h;
  middle_ = nodes[0] + half_;
  count_ = nodes.size();
  set_basis(nodes);
  for (AtNodes& input : at_nodes_) {
    input.coefficients.fill(0.0);
    input.is_defined = true;
  }
  for (std::size_t k = 0; k < count_; ++k) {
    inputs.evaluate(nodes[k], now_.data());
    const bool is_within = (nodes[k] - nodes[0]) * h >= 0.0;
    for (std::size_t i = 0; i < now_.size(); ++i) {
      AtNodes& input = at_nodes_[i];
      const Interval here = Interval::of(now_[i]);
      input.is_defined = input.is_defined && std::isfinite(now_[i]);
      input.all = k == 0 ? here : hull(input.all, here);
      if (is_within) input.within = k == 0 ? here : hull(input.within, here);
      for (std::size_t m = 0; m < count_; ++m) input.coefficients[m] += now_[i] * basis_[k][m];
    }
  }
}

double NodePolynomials::value(std::size_t i, double y) const {
  const std::array<double, most_nodes>& c = at_nodes_[i].coefficients;
  double sum = 0.0;
  for (std::size_t m = count_; m > 0; --m) sum = sum * y + c[m - 1];
  return sum;
}

Interval NodePolynomials::values(std::size_t i, Interval y) const {
  const std::array<double, most_nodes>& c = at_nodes_[i].coefficients;
  Interval sum;
  for (std::size_t m = count_; m > 0; --m) sum = sum * y + Interval::of(c[m - 1]);
  return sum;
}

Interval NodePolynomials::slopes(std::size_t i, Interval y) const {
  const std::array<double, most_nodes>& c = at_nodes_[i].coefficients;
  Interval sum;
  for (std::size_t m = count_; m > 1; --m) sum = sum * y + Interval::of(static_cast<double>(m - 1) * c[m - 1]);
  return 1.0 / half_ * sum;
}

Interval NodePolynomials::bends(std::size_t i, Interval y) const {
  const std::array<double, most_nodes>& c = at_nodes_[i].coefficients;
  Interval sum;
  for (std::size_t m = count_; m > 2; --m)
    sum = sum * y + Interval::of(0.5 * static_cast<double>((m - 1) * (m - 2)) * c[m - 1]);
  return 1.0 / (half_ * half_) * sum;
}

void InputSearch::resize(int inputs) {
  const std::size_t n = index(inputs);
  polynomials_.resize(n);
  seen_.resize(n);
  enclosed_.resize(n);
  noise_.resize(n);
  for (Sample& sample : samples_)
    for (std::vector<double>* v : {&sample.values, &sample.distances}) v->assign(n, 0.0);
  pieces_.reserve(most_pieces + 1);
  unseen_.resize(3 * n);
  peaks_.resize(2 * n);
}

// Best-first search: the piece with the largest score is halved.
void InputSearch::search(TimeInputs& inputs, std::span<const double> nodes, double h, double fastest) {
  const QuietArithmetic quiet;
  polynomials_.set(inputs, nodes, h);
  find_noise(inputs, nodes[0], nodes[0] + h);
  with_peaks_ = inputs.are_with_steep_functions();
  constexpr Extreme none{0.0, 0.0, 0.0};
  std::fill(seen_.begin(), seen_.end(), Seen{{-infinity, 0.0, 0.0}, {infinity, 0.0, 0.0}, none, none, none});
  pieces_.clear();
  farthest_ = 0.0;
  double count = 1.0;
  if (!inputs.are_enclosed())
    count = std::fmax(fewest_samples, fastest > 0.0 ? std::ceil(per_change * std::fabs(h) / fastest) : 0.0);
  const bool are_too_many = !(count <= static_cast<double>(most_pieces));
  const int first = are_too_many ? 1 : static_cast<int>(count);
  take(inputs, -1.0, 2.0 / first, samples_[0]);
  for (int k = 0; k < first; ++k) {
    Sample &start = samples_[index(k % 2)], &end = samples_[index((k + 1) % 2)];
    const Piece piece{-1.0 + 2.0 * k / first, -1.0 + 2.0 * (k + 1) / first, 0.0};
    take(inputs, piece.high, 2.0 / first, end);
    add_piece(inputs, piece, start, end);
  }
  while (pieces_.front().score > 1.0 && pieces_.size() < most_pieces) {
    std::pop_heap(pieces_.begin(), pieces_.end());
    const Piece piece = pieces_.back();
    pieces_.pop_back();
    const double middle = 0.5 * (piece.low + piece.high), reach = 0.5 * (piece.high - piece.low);
    take(inputs, piece.low, reach, samples_[0]);
    take(inputs, middle, reach, samples_[1]);
    take(inputs, piece.high, reach, samples_[2]);
    add_piece(inputs, {piece.low, middle, 0.0}, samples_[0], samples_[1]);
    add_piece(inputs, {middle, piece.high, 0.0}, samples_[1], samples_[2]);
  }
  doubt_ = are_too_many ? infinity : pieces_.front().score;
  find_places(inputs);
}

// Enclosures of values at a single time have the width of their rounding errors.
void InputSearch::find_noise(TimeInputs& inputs, double start, double end) {
  std::fill(noise_.begin(), noise_.end(), 0.0);
  for (const double t : {start, end}) {
    inputs.enclose(Interval::of(t), enclosed_.data());
    for (std::size_t i = 0; i < noise_.size(); ++i) {
      const double width = enclosed_[i].value.high - enclosed_[i].value.low;
      if (std::isfinite(width)) noise_[i] = std::fmax(noise_[i], width);
    }
  }
}

void InputSearch::take(TimeInputs& inputs, double y, double reach, Sample& sample) {
  const double t = polynomials_.time(y), width = reach * std::fabs(polynomials_.half());
  inputs.evaluate(t, sample.values.data());
  const auto note = [&](Extreme& extreme, double value) {
    if (value > extreme.value) extreme = {value, t, width};
  };
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const double value = sample.values[i], distance = std::fabs(value - polynomials_.value(i, y));
    sample.distances[i] = distance;
    Seen& seen = seen_[i];
    note(seen.high, value);
    if (value < seen.low.value) seen.low = {value, t, width};
    note(seen.far, distance);
    const Interval nodes = polynomials_.range(i);
    note(seen.above, std::fmin(value - nodes.high, distance));
    note(seen.below, std::fmin(nodes.low - value, distance));
  }
}

void InputSearch::add_piece(TimeInputs& inputs, Piece piece, const Sample& start, const Sample& end) {
  const double t = polynomials_.time(piece.low), stop = polynomials_.time(piece.high);
  inputs.enclose(between(t, stop), enclosed_.data());
  // Inputs without enclosures are known by their samples only.
  for (std::size_t i = 0; i < seen_.size(); ++i)
    if (polynomials_.is_defined(i) && inputs.is_enclosed(i))
      piece.score = std::fmax(piece.score, score(i, piece, start, end));
  pieces_.push_back(piece);
  std::push_heap(pieces_.begin(), pieces_.end());
}

// With u = u_0 + (u_1 - u_0) s + r on a piece of width w, |r| <= w^2 / 8 max |u''|, for u and for its distance from the
// polynomial. The slopes of the distance give another bound: half the sum of its end values and w times its slope.
double InputSearch::score(std::size_t i, const Piece& piece, const Sample& start, const Sample& end) {
  const TimeSeries& u = enclosed_[i];
  const Interval y{piece.low, piece.high}, nodes = polynomials_.range(i);
  const double width = std::fabs(polynomials_.half()) * (piece.high - piece.low), part = 0.25 * width * width;
  const Seen& seen = seen_[i];
  const double sought = std::max({range_of(i), least_sought * nodes.magnitude(), above_noise * noise_[i]});
  const auto ratio = [](double value, double enough) {
    return value <= enough ? 0.0 : std::isnan(value) ? infinity : value / enough;
  };
  double far =
      std::fmax(start.distances[i], end.distances[i]) + part * (u.bend - polynomials_.bends(i, y)).magnitude();
  const double clearly_seen = visible_excess * sought;
  if (!(far <= clearly_seen)) {
    const double steepness = (u.slope - polynomials_.slopes(i, y)).magnitude();
    far = std::fmin(far, 0.5 * (start.distances[i] + end.distances[i] + width * steepness));
    far = std::fmin(far, (u.value - polynomials_.values(i, y)).magnitude());
  }
  farthest_ = std::fmax(farthest_, ratio(far, sought));
  double result = ratio(far, std::fmax(visible_part * sought, place_factor * seen.far.value));
  if (!with_peaks_ && far <= clearly_seen) return result;
  const bool is_monotone = u.slope.low >= 0.0 || u.slope.high <= 0.0;
  const auto bound = [&](double sign) {
    const Interval value = sign > 0.0 ? u.value : -u.value, bend = sign > 0.0 ? u.bend : -u.bend;
    const double ends = std::fmax(sign * start.values[i], sign * end.values[i]);
    return is_monotone ? ends : std::fmin(value.high, ends + part * std::fmax(0.0, -bend.low));
  };
  const double high = bound(1.0), low = bound(-1.0);
  result = std::fmax(
      result, ratio(std::fmin(high - nodes.high, far), std::fmax(clearly_seen, place_factor * seen.above.value)));
  result = std::fmax(
      result, ratio(std::fmin(low + nodes.low, far), std::fmax(clearly_seen, place_factor * seen.below.value)));
  if (!with_peaks_) return result;
  const Interval within = polynomials_.range_within(i);
  const double least = std::fmax(peak_part * sought, noise_at_peaks * noise_[i]);
  result = std::fmax(result, ratio(high - std::fmax(seen.high.value, within.high), least));
  return std::fmax(result, ratio(low - std::fmax(-seen.low.value, -within.low), least));
}

// 0: the input is constant to machine precision.
double InputSearch::range_of(std::size_t i) const {
  const Interval nodes = polynomials_.range(i);
  const double low = std::fmin(seen_[i].low.value, nodes.low), high = std::fmax(seen_[i].high.value, nodes.high);
  const double range = high - low;
  const double least = std::fmax(least_range * std::fmax(std::fabs(low), std::fabs(high)), above_noise * noise_[i]);
  return range > least ? range : 0.0;
}

void InputSearch::find_places(TimeInputs& inputs) {
  unseen_.clear();
  peaks_.clear();
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const double range = range_of(i);
    if (range == 0.0 || !polynomials_.is_defined(i)) continue;
    const Seen& seen = seen_[i];
    unseen_.add(seen.above.value / (visible_excess * range), seen.above.t);
    unseen_.add(seen.below.value / (visible_excess * range), seen.below.t);
    unseen_.add(seen.far.value / (visible_part * range), seen.far.t);
    if (!with_peaks_) continue;
    const Interval within = polynomials_.range_within(i);
    const double extent = std::fmax(seen.high.value, within.high) - std::fmin(seen.low.value, within.low);
    const double least = std::fmax(peak_part * extent, noise_at_peaks * noise_[i]);
    if (seen.high.value - within.high > least)
      peaks_.add((seen.high.value - within.high) / least, peak(inputs, i, 1.0, seen.high));
    if (within.low - seen.low.value > least)
      peaks_.add((within.low - seen.low.value) / least, peak(inputs, i, -1.0, seen.low));
  }
  const double same = 2.0 * same_place * std::fabs(polynomials_.half());
  unseen_.finish(same);
  peaks_.finish(same);
}

// Refines the largest sample, for values times sign, by parabolas within the step.
double InputSearch::peak(TimeInputs& inputs, std::size_t i, double sign, const Extreme& from) {
  const double start = polynomials_.time(-1.0), end = polynomials_.time(1.0);
  const auto room = [&](double time) { return std::fmin(std::fabs(time - start), std::fabs(end - time)); };
  std::vector<double>& now = samples_[0].values;
  const auto value = [&](double time) {
    inputs.evaluate(time, now.data());
    return sign * now[i];
  };
  double at = from.t, reach = std::fmin(from.reach, room(at)), middle = value(at);
  for (int round = 0; round < parabolas; ++round) {
    const double before = value(at - reach), after = value(at + reach), bend = before - 2.0 * middle + after;
    if (!std::isfinite(bend)) break;
    const double shift = 0.5 * (before - after) / bend;
    const bool is_inside = bend < 0.0 && std::fabs(shift) <= 1.0;
    if (!is_inside && !(std::fmax(before, after) > middle)) break;
    at += is_inside ? shift * reach : after > before ? reach : -reach;
    reach = std::fmin(is_inside ? reach_in_next * reach : reach, room(at));
    const double last = std::exchange(middle, value(at));
    if (is_inside && std::fabs(middle - last) <= peak_gain * range_of(i)) break;
  }
  return at;
}

void InputSearch::Places::resize(std::size_t most) {
  places_.reserve(most);
  t_.reserve(most);
}

void InputSearch::Places::add(double score, double t) {
  if (score > 1.0) places_.push_back({score, t});
}

void InputSearch::Places::finish(double same) {
  std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.t < b.t; });
  std::size_t count = 0;
  for (const Place& place : places_) {
    if (count == 0 || place.t - places_[count - 1].t > same) places_[count++] = place;
    else places_[count - 1].score = std::fmax(places_[count - 1].score, place.score);
  }
  places_.resize(count);
  std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.score > b.score; });
  t_.clear();
  for (const Place& place : places_) t_.push_back(place.t);
}

}  // namespace sfdae::core
