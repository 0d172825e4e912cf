// Singular points of a solution: behavior in front of one, and smooth continuation.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/singular_point.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Nodes are fitted from this part of the width on: the singular point reduces the accuracy of nearer ones.
constexpr double nearest_part = 1.0 / 64.0;
// Errors are evaluated at this part of the width.
constexpr double judged_part = 0.125;
constexpr std::size_t fewest_nodes = 5, most_nodes = 14;
// In tolerances: expected errors below the first make the widest fit the best one; larger than the second: not smooth.
constexpr double accurate = 0.5, smooth = 20.0;
// Maximum slope of smooth components near the point, relative to their mean over the fit: (1 - s)^3 reaches 2.2, a
// square root 3.9. (Computed for distances from 1/64 to 1.)
constexpr double steepest = 2.5;
// In tolerances: larger changes of a component show how it approaches its last value.
constexpr double telling = 10.0;
// Tolerance for the agreement of two exponents, and ranges for a fold (1/2) and for growth without bound.
constexpr double agreement = 0.15, lowest_of_fold = 0.35, highest_of_fold = 0.65, highest_of_growth = 0.15;

double distance_of(const CourseData& data, const Trail::Node& node) { return (data.t - node.t) * data.direction; }

// Nodes with distances from nearest_part width to width, the oldest first.
std::vector<const Trail::Node*> nodes_within(const CourseData& data, double width) {
  std::vector<const Trail::Node*> nodes;
  for (std::size_t k = 0; k < data.trail.count(); ++k) {
    const double distance = distance_of(data, data.trail.node(k));
    if (distance <= width && distance >= nearest_part * width) nodes.push_back(&data.trail.node(k));
  }
  return nodes;
}

bool is_steep(const CourseData& data, const SmoothCourse& course, std::size_t i) {
  constexpr int samples = 16;
  double sum = 0.0, nearest = 0.0;
  for (int k = 0; k <= samples; ++k) {
    const double part = nearest_part + (1.0 - nearest_part) * k / samples;
    const double slope =
        course.fit.evaluate(i, course.degrees[i], data.t - data.direction * part * course.width).xdot;
    if (k == 0) nearest = std::fabs(slope);
    sum += slope * slope;
  }
  const double mean = std::sqrt(sum / (samples + 1));
  return mean * course.width > data.tolerances[i] && nearest > steepest * mean;
}

// Fits all components; returns the largest expected error of the differential variables.
double judge(const CourseData& data, SmoothCourse& course) {
  const double t = data.t + data.direction * judged_part * course.width;
  double largest = 0.0;
  for (std::size_t i = 0; i < data.tolerances.size(); ++i) {
    const CourseFit::Accuracy accuracy = course.fit.accuracy(i, t);
    course.degrees[i] = accuracy.degree;
    course.errors[i] = accuracy.error / data.tolerances[i];
    const bool is_smooth = course.errors[i] <= smooth && !is_steep(data, course, i);
    if (!is_smooth) course.degrees[i] = -1;
    if (data.is_differentiated[i] != 0) largest = std::max(largest, is_smooth ? course.errors[i] : HUGE_VAL);
  }
  return largest;
}

// p with (far^p - near^p) / (middle^p - near^p) = ratio, near < middle < far.
double power_of(double near, double middle, double far, double ratio) {
  const auto grown = [near](double distance, double p) {
    return std::fabs(p) < 1e-9 ? std::log(distance / near) : std::expm1(p * std::log(distance / near));
  };
  double low = -3.0, high = 4.0;
  for (int k = 0; k < 60; ++k) {
    const double p = 0.5 * (low + high);
    (grown(far, p) / grown(middle, p) < ratio ? low : high) = p;
  }
  return 0.5 * (low + high);
}

// Exponent of the distance that component i follows near the point; empty if the nodes disagree.
std::optional<double> power_of_component(const CourseData& data, std::size_t i) {
  // Nodes nearer than this part of the largest distance are inaccurate; ratio of the distances of compared nodes.
  constexpr double inaccurate = 1e-6, apart = 3.0;
  const double widest = distance_of(data, data.trail.node(0));
  const Trail::Node* last = nullptr;
  std::vector<const Trail::Node*> chosen;
  for (std::size_t k = data.trail.count(); k-- > 0;) {
    const Trail::Node& node = data.trail.node(k);
    const double distance = distance_of(data, node);
    if (!(distance > inaccurate * widest)) continue;
    if (last == nullptr) {
      last = &node;
      continue;
    }
    const double before = distance_of(data, chosen.empty() ? *last : *chosen.back());
    if (distance < apart * before) continue;
    if (chosen.empty() && std::fabs(node.x[i] - last->x[i]) <= telling * data.tolerances[i]) continue;
    chosen.push_back(&node);
  }
  if (chosen.size() < 3) return std::nullopt;
  const double near = distance_of(data, *last);
  double powers[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const Trail::Node &middle = *chosen[k], &far = *chosen[k + 1];
    const double ratio = (far.x[i] - last->x[i]) / (middle.x[i] - last->x[i]);
    if (!(ratio > 1.0)) return std::nullopt;
    powers[k] = power_of(near, distance_of(data, middle), distance_of(data, far), ratio);
  }
  if (std::fabs(powers[0] - powers[1]) > agreement) return std::nullopt;
  return powers[0];
}

std::string part_in_words(SingularPart part) {
  switch (part) {
    case SingularPart::constraints: return " The constraints (A2) lose rank there.";
    case SingularPart::differential: return " The differential part (E T2) loses rank there.";
    case SingularPart::both: return " The constraints (A2) and the differential part (E T2) lose rank there.";
    case SingularPart::unknown: break;
  }
  return "";
}

}  // namespace

std::string description(const SingularPoint& point) {
  std::string text = part_in_words(point.part);
  switch (point.kind) {
    case SingularKind::fold:
      return text + format(
                        " It is a fold: x[%d] goes as the power %.2f of the distance, x' is unbounded, and no "
                        "solution continues.",
                        point.component, point.exponent);
    case SingularKind::crossing: return text + " The solution is smooth in front of it; branches may cross there.";
    case SingularKind::unbounded: return text + format(" x[%d] grows without bound toward it.", point.component);
    case SingularKind::unknown: break;
  }
  return text + " Whether the solution is smooth there was not determined.";
}

// The widest fit that is accurate, or the most accurate one.
std::optional<SmoothCourse> smooth_course(const CourseData& data) {
  std::optional<SmoothCourse> best;
  double least = smooth;
  for (std::size_t k = data.trail.count(); k-- > 0;) {
    const double width = distance_of(data, data.trail.node(k));
    if (!(width > 0.0)) continue;
    std::vector<const Trail::Node*> nodes = nodes_within(data, width);
    if (nodes.size() < fewest_nodes) continue;
    if (nodes.size() > most_nodes) {
      std::vector<const Trail::Node*> some;
      for (std::size_t r = 0; r < most_nodes; ++r) some.push_back(nodes[r * (nodes.size() - 1) / (most_nodes - 1)]);
      nodes = std::move(some);
    }
    const std::size_t n = data.tolerances.size();
    SmoothCourse course{CourseFit(nodes), width, std::vector<int>(n, 0), std::vector<double>(n, 0.0)};
    const double error = judge(data, course);
    if (!(error <= std::max(accurate, least))) continue;
    least = std::min(least, error);
    best = std::move(course);
  }
  return best;
}

void classify(const CourseData& data, const std::optional<SmoothCourse>& course, SingularPoint& point) {
  if (data.trail.count() == 0) return;
  for (std::size_t i = 0; i < data.tolerances.size(); ++i) {
    const std::optional<double> power = power_of_component(data, i);
    if (!power) continue;
    const bool is_fold = *power >= lowest_of_fold && *power <= highest_of_fold;
    const bool grows = *power <= highest_of_growth && data.is_differentiated[i] != 0;
    if (!is_fold && !(grows && point.kind != SingularKind::fold)) continue;
    // If there are several folds, the one nearest to a square root is taken.
    const bool is_better = point.component < 0 || (is_fold && point.kind != SingularKind::fold) ||
                           std::fabs(*power - 0.5) < std::fabs(point.exponent - 0.5);
    if (!is_better) continue;
    point.kind = is_fold ? SingularKind::fold : SingularKind::unbounded;
    point.component = static_cast<int>(i);
    point.exponent = *power;
  }
  if (point.kind == SingularKind::unknown && course) point.kind = SingularKind::crossing;
}

}  // namespace sfdae::core
