// SPDX-License-Identifier: BSD-3-Clause
#include "reference.h"

#include <algorithm>
#include <cmath>

namespace campaign {

namespace {

constexpr std::size_t most_points = 400000;
// Steps tried, accepted or not; most meshes need some thousands.
constexpr int most_attempts = 80000;
// States smaller than this part of their largest value are known to that accuracy only.
constexpr double least_part = 0.01;

std::vector<Formula> gradient_formulas(const SmallProblem& problem) {
  std::vector<Formula> result;
  for (const Formula& value : problem.values)
    for (int j = 0; j < problem.num_states(); ++j) result.push_back(derivative(value, Operation::unknown, j));
  return result;
}

}  // namespace

Reference::Reference(const SmallProblem& problem, double end, const std::vector<double>& outputs, double tolerance)
    : problem_(problem),
      method_(problem),
      further_(*problem.formulas, problem.values),
      gradients_(*problem.formulas, gradient_formulas(problem)),
      end_(end) {
  double part_of_longest = 1.0;
  for (int attempts = 0; attempts < 4 && !(known_ && error_ <= 100.0 * tolerance); ++attempts) {
    sizes_.assign(static_cast<std::size_t>(problem.num_unknowns()), 0.0);
    known_ = make_mesh(outputs, tolerance * part_of_longest, part_of_longest);
    if (!known_) break;
    note_values(outputs);
    part_of_longest *= 0.43;
  }
}

bool Reference::make_mesh(const std::vector<double>& outputs, double tolerance, double part_of_longest) {
  std::vector<double> limits = outputs;
  for (const Window& window : problem_.windows) limits.insert(limits.end(), {window.begin, window.end});
  std::sort(limits.begin(), limits.end());
  const double longest = part_of_longest * std::min(end_ / 50.0, problem_.windows.empty() ? problem_.feature : end_);
  points_ = {{0.0, problem_.start, {}}};
  output_points_.clear();
  double t = 0.0, h = 1e-4 * longest;
  int attempts = 0;
  for (double limit : limits) {
    while (t < limit && t < end_) {
      double most = longest;
      for (const Window& window : problem_.windows)
        if (t >= window.begin && t < window.end) most = part_of_longest * window.step;
      h = std::min(h, most);
      const bool to_limit = t + 1.0001 * h >= limit;
      const double end = to_limit ? limit : t + h;
      if (++attempts > most_attempts) return false;
      const double error = attempt(t, end);
      if (error <= tolerance) {
        const double longer =
            (end - t) * std::min(4.0, 0.9 * std::pow(tolerance / std::max(error, 1e-300), 1.0 / 6.0));
        h = to_limit ? std::max(h, longer) : longer;
        t = end;
        if (points_.size() > most_points) return false;
      } else {
        h = (end - t) * (std::isfinite(error) ? std::max(0.1, 0.9 * std::pow(tolerance / error, 1.0 / 6.0)) : 0.25);
        points_.erase(std::find_if(points_.begin() + 1, points_.end(), [&](const auto& p) { return p.t > t; }),
                      points_.end());
        if (!(h > 1e-14 * end) && !(t == 0.0 && h > 1e-250)) return false;
      }
    }
    if (std::binary_search(outputs.begin(), outputs.end(), limit)) output_points_.push_back(points_.size() - 1);
  }
  return true;
}

// Adds the points of a step in four parts, and compares the end with that of one step. A kink or a steep front before
// the first stages of both would be noticed by neither, so that the first part is short.
double Reference::attempt(double t, double end) {
  const double h = end - t;
  const std::size_t n = problem_.start.size();
  if (n == 0) {
    points_.push_back({end, {}, {}});
    return 0.0;
  }
  const std::vector<double> begin = points_.back().x;
  std::vector<double> once, x = begin;
  if (!method_.step(t, h, begin, once)) return HUGE_VAL;
  double from = t;
  for (double part : {1.0 / 64.0, 1.0 / 8.0, 1.0 / 2.0, 1.0}) {
    const double to = part == 1.0 ? end : t + part * h;
    if (!method_.step(from, to - from, x, x)) return HUGE_VAL;
    points_.push_back({to, x, method_.transition()});
    from = to;
  }
  double error = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double size = std::abs(x[k]) + least_part * std::max(sizes_[k], 1e-3);
    error = std::max(error, std::abs(x[k] - once[k]) / (31.0 * size));
    if (error < 1e-9) sizes_[k] = std::max(sizes_[k], std::abs(x[k]));
  }
  return error;
}

bool Reference::advance(double t, double h, std::vector<double>& x, int depth, bool second) const {
  std::vector<double> end;
  if (second ? method_.extrapolated_step(t, h, x, end) : method_.step(t, h, x, end)) {
    x = end;
    return true;
  }
  return depth > 0 && advance(t, h / 2.0, x, depth - 1, second) &&
         advance(t + h / 2.0, h / 2.0, x, depth - 1, second);
}

void Reference::note_values(const std::vector<double>& outputs) {
  const auto n = static_cast<std::size_t>(problem_.num_states());
  std::vector<double> x = problem_.start, further(problem_.values.size());
  std::size_t output = 0;
  error_ = 0.0;
  values_.clear();
  for (std::size_t p = 0; p < points_.size(); ++p) {
    ReferencePoint& point = points_[p];
    if (p > 0 && n > 0) {
      const double begin = points_[p - 1].t, half = (point.t - begin) / 2.0;
      known_ = known_ && advance(begin, half, x, 10, false) && advance(begin + half, half, x, 10, false);
    }
    const bool is_output = output < outputs.size() && output_points_[output] == p;
    for (std::size_t k = 0; k < n; ++k) {
      if (is_output) {
        const double size = std::abs(x[k]) + least_part * std::max(sizes_[k], 1e-3);
        error_ = std::max(error_, std::abs(x[k] - point.x[k]) / size);
      }
      sizes_[k] = std::max(sizes_[k], std::abs(x[k]));
    }
    if (!problem_.values.empty()) further_.evaluate(point.t, x.data(), nullptr, further.data());
    for (std::size_t k = 0; k < further.size(); ++k) {
      sizes_[n + k] = std::max(sizes_[n + k], std::abs(further[k]));
      if (!std::isfinite(further[k])) known_ = false;
    }
    std::vector<double> all = x;
    all.insert(all.end(), further.begin(), further.end());
    if (p == 0) start_ = all;
    if (is_output) {
      values_.push_back(all);
      ++output;
    }
    point.x = x;
  }
}

std::vector<double> Reference::perturbed(std::size_t output, double rtol, const std::vector<double>& atol) const {
  const auto n = static_cast<std::size_t>(problem_.num_states());
  std::vector<double> largest(n + problem_.values.size(), 0.0);
  if (n == 0) return largest;
  std::vector<double> product(n * n, 0.0);  // of the transitions from a point to the output
  for (std::size_t i = 0; i < n; ++i) product[i * n + i] = 1.0;
  for (std::size_t p = output_points_[output] + 1; p-- > 0;) {
    const ReferencePoint& point = points_[p];
    double change = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < n; ++j)
        sum += std::abs(product[i * n + j]) * (rtol * std::abs(point.x[j]) + atol[j]);
      largest[i] = std::max(largest[i], sum);
      change = std::max(change, sum);
    }
    if (p == 0 || change == 0.0) break;
    std::vector<double> next(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k < n; ++k) next[i * n + j] += product[i * n + k] * point.transition[k * n + j];
    product = next;
  }
  if (problem_.values.empty()) return largest;
  const ReferencePoint& point = points_[output_points_[output]];
  std::vector<double> gradients(problem_.values.size() * n);
  gradients_.evaluate(point.t, point.x.data(), nullptr, gradients.data());
  for (std::size_t k = 0; k < problem_.values.size(); ++k)
    for (std::size_t j = 0; j < n; ++j) largest[n + k] += std::abs(gradients[k * n + j]) * largest[j];
  return largest;
}

double Reference::difference_of_second_method() const {
  std::vector<double> x = problem_.start;
  double difference = 0.0;
  std::size_t output = 0;
  for (std::size_t p = 1; p < points_.size() && output < output_points_.size(); ++p) {
    const double begin = points_[p - 1].t;
    if (!x.empty() && !advance(begin, points_[p].t - begin, x, 10, true)) return HUGE_VAL;
    if (output_points_[output] != p) continue;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double size = std::abs(x[k]) + least_part * std::max(sizes_[k], 1e-3);
      difference = std::max(difference, std::abs(x[k] - points_[p].x[k]) / size);
    }
    ++output;
  }
  return difference;
}

}  // namespace campaign
