// Times at which conditions switch while x moves along a polynomial.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/switch_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "expression/false_position.h"
#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "expression/symbolic_gradient.h"
#include "linalg/divided_differences.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

constexpr std::size_t most_points = PointsOfCurve::most;
// Largest number of switches in a step; steps with more of them become shorter.
constexpr std::size_t most_times = 64;

// Places of parameters, in this order: the user's, the start, the length, points outside both ends of the way, margins,
// divided differences of each unknown.
struct Places {
  explicit Places(const Record& record, std::size_t conditions)
      : start(record.num_user_parameters()),
        length(start + 1),
        points(length + 1),
        margins(points + static_cast<int>(most_points) - 2),
        differences(margins + static_cast<int>(conditions)) {}
  int start, length, points, margins, differences;
};

// The degree in t and x of each node, more than 1 for anything but a polynomial.
std::vector<int> degrees_of(const Record& record) {
  constexpr int high = 2;
  std::vector<int> degree(index(record.num_nodes()), 0);
  for (int i = 0; i < record.num_nodes(); ++i) {
    const Node node = record.node(i);
    const Operands operands = record.operands(i);
    int largest = 0, sum = 0;
    for (int k = 0; k < operands.size(); ++k) {
      largest = std::max(largest, degree[index(operands[k])]);
      sum += degree[index(operands[k])];
    }
    switch (node.operation) {
      case Operation::time:
      case Operation::unknown: degree[index(i)] = 1; break;
      case Operation::derivative: degree[index(i)] = high; break;
      case Operation::add:
      case Operation::subtract:
      case Operation::negate: degree[index(i)] = largest; break;
      case Operation::multiply: degree[index(i)] = std::min(sum, high); break;
      case Operation::divide: degree[index(i)] = degree[index(node.b)] > 0 ? high : largest; break;
      default: degree[index(i)] = largest > 0 ? high : 0;
    }
  }
  return degree;
}

bool is_linear(const Condition& condition, const std::vector<int>& degrees) {
  return !condition.is_of_layer && degrees[index(condition.node)] <= 1;
}

class Recording {
 public:
  Recording(const Record& record, const std::vector<Condition>& conditions)
      : record_(record), conditions_(conditions), places_(record, conditions.size()), recorder_(0) {
    for (int k = 0; k < places_.differences; ++k) parameter(k);
  }

  std::shared_ptr<const Record> functions() {
    const std::vector<int> copies =
        copy_with_leaves(record_, recorder_, [this](const Node& leaf) { return along_the_way(leaf); });
    const std::vector<int> degrees = degrees_of(record_);
    std::vector<int> results;
    for (std::size_t k = 0; k < conditions_.size(); ++k) {
      const int number = static_cast<int>(k), node = conditions_[k].node;
      const bool has_curve = conditions_[k].is_of_layer || is_linear(conditions_[k], degrees);
      const int g = has_curve ? curve(record_.n() + number) : copies[index(node)];
      results.push_back(recorder_.greater(g, parameter(places_.margins + number)));
    }
    return recorder_.finish(std::move(results));
  }
  std::vector<int> unknowns() const {
    std::vector<int> all(curves_.size());
    for (const auto& [unknown, curve] : curves_) all[index(curve.number)] = unknown;
    return all;
  }

 private:
  struct Curve {
    int number, node;
  };
  int parameter(int k) { return recorder_.parameter("value " + std::to_string(k), 0.0); }
  int add(int a, int b) { return recorder_.apply(Operation::add, a, b); }
  int subtract(int a, int b) { return recorder_.apply(Operation::subtract, a, b); }
  int multiply(int a, int b) { return recorder_.apply(Operation::multiply, a, b); }

  int along_the_way(const Node& leaf) {
    switch (leaf.operation) {
      case Operation::time:
        return add(parameter(places_.start), multiply(recorder_.time(), parameter(places_.length)));
      case Operation::unknown: return curve(leaf.a);
      case Operation::parameter:
        return leaf.a < record_.num_user_parameters() ? parameter(leaf.a) : beyond_margin(leaf.a);
      default: return recorder_.constant(0.0);
    }
  }
  // The parameter of a condition shifts its zero, within other conditions, too.
  int beyond_margin(int parameter_of_condition) {
    // In the order of their parameters.
    const auto found = std::lower_bound(conditions_.begin(), conditions_.end(), parameter_of_condition,
                                        [](const Condition& each, int number) { return each.parameter < number; });
    if (found == conditions_.end() || found->parameter != parameter_of_condition) return recorder_.constant(0.0);
    const int number = static_cast<int>(found - conditions_.begin());
    return subtract(recorder_.constant(0.0), parameter(places_.margins + number));
  }
  // The polynomial in Newton's form.
  int curve(int unknown) {
    const auto [place, is_new] = curves_.try_emplace(unknown, Curve{static_cast<int>(curves_.size()), -1});
    if (!is_new) return place->second.node;
    const int first = places_.differences + static_cast<int>(most_points) * place->second.number;
    const auto beside = [&](int k) {
      if (k == 0) return recorder_.time();
      return subtract(recorder_.time(), k == 1 ? recorder_.constant(1.0) : parameter(places_.points + k - 2));
    };
    std::array<int, most_points> differences{};
    for (int k = 0; k < static_cast<int>(most_points); ++k) differences[index(k)] = parameter(first + k);
    int node = differences[most_points - 1];
    for (int k = static_cast<int>(most_points) - 2; k >= 0; --k)
      node = add(differences[index(k)], multiply(beside(k), node));
    return place->second.node = node;
  }

  const Record& record_;
  const std::vector<Condition>& conditions_;
  Places places_;
  Recorder recorder_;
  std::map<int, Curve> curves_;
};

}  // namespace

LinearConditions::LinearConditions(const Record& record, const std::vector<Condition>& conditions)
    : is_linear_(conditions.size(), 0), factors_(conditions.size()) {
  const std::vector<int> degrees = degrees_of(record);
  Recorder recorder(record.n());
  const std::vector<int> copies = copy_nodes(record, recorder);
  std::vector<int> leaves, derivatives;
  for (int j = 0; j < record.n(); ++j) leaves.push_back(recorder.unknown(j));
  for (std::size_t k = 0; k < conditions.size(); ++k) {
    if (!is_linear(conditions[k], degrees)) continue;
    is_linear_[k] = 1;
    const std::vector<int> gradient = symbolic_gradient(recorder, copies[index(conditions[k].node)], leaves);
    for (std::size_t j = 0; j < leaves.size(); ++j) {
      if (gradient[j] < 0 || recorder.number(gradient[j]) == 0.0) continue;
      factors_[k].push_back({static_cast<int>(j), 0.0});
      derivatives.push_back(gradient[j]);
    }
  }
  values_.resize(derivatives.size());
  if (!derivatives.empty()) derivatives_.emplace(recorder.finish(std::move(derivatives)));
}

void LinearConditions::update(const TaylorEvaluator& evaluator) {
  if (!derivatives_ || version_ == evaluator.changes_of_parameters()) return;
  version_ = evaluator.changes_of_parameters();
  for (int i = 0; i < evaluator.num_parameters(); ++i) derivatives_->set_parameter(i, evaluator.parameter(i));
  const std::vector<double> jet(2 * index(evaluator.record().n()), 0.0);
  if (!derivatives_->values(0.0, jet.data(), 0, values_.data()))
    std::fill(values_.begin(), values_.end(), std::numeric_limits<double>::quiet_NaN());
  auto value = values_.begin();
  for (std::vector<Factor>& each : factors_)
    for (Factor& factor : each) factor.value = *value++;
}

SwitchSearch::SwitchSearch(const TaylorEvaluator& evaluator, const std::vector<Condition>& conditions)
    : evaluator_(evaluator), margins_(conditions.size()), branches_(conditions.size()) {
  if (conditions.empty()) return;
  Recording recording(evaluator.record(), conditions);
  along_ = std::make_unique<TaylorEvaluator>(recording.functions());
  unknowns_ = recording.unknowns();
  const int n = evaluator.record().n();
  curve_of_condition_.assign(conditions.size(), -1);
  for (std::size_t j = 0; j < unknowns_.size(); ++j)
    if (unknowns_[j] >= n) curve_of_condition_[index(unknowns_[j] - n)] = static_cast<int>(j);
  if (std::any_of(unknowns_.begin(), unknowns_.end(), [n](int unknown) { return unknown >= n; })) {
    std::vector<int> nodes;
    for (const Condition& each : conditions) nodes.push_back(each.node);
    own_functions_ = std::make_unique<ConditionFunctions>(evaluator, nodes);
    values_.resize(nodes.size());
  }
  at_ends_.resize(2 * conditions.size());
  linear_.emplace(evaluator.record(), conditions);
  has_layers_ =
      std::any_of(conditions.begin(), conditions.end(), [](const Condition& each) { return each.is_of_layer; });
  differences_.resize(most_points * unknowns_.size());
  distances_.resize(unknowns_.size());
  slopes_.resize(unknowns_.size());
  lines_.reserve(count());
  zeros_.reserve(count());
  switches_ = std::make_unique<SwitchingTimes>(std::vector<const TaylorEvaluator*>{along_.get()});
  switches_->set_looks_ahead(1.0);
  times_between_.reserve(std::max(most_times, count()));
}

namespace {

using Differences = std::array<double, most_points>;

// Position of a point as a fraction of the way.
double part_of(const PointsOfCurve& points, std::size_t i) {
  return i == 1 ? 1.0 : (points.t[i] - points.t[0]) / (points.t[1] - points.t[0]);
}

Differences parts_of(const PointsOfCurve& points) {
  Differences part{};
  for (std::size_t i = 0; i < points.count; ++i) part[i] = part_of(points, i);
  return part;
}

}  // namespace

// A linear condition is a sum of multiples of unknowns and an affine function of t, of which the values at both ends
// determine the first two differences, and others are 0.
void SwitchSearch::set_differences(const PointsOfCurve& points, const double* g_start, const double* g_end) {
  const Differences part = parts_of(points);
  const std::size_t unknowns = unknowns_.size();
  const auto row = [&](int k) { return differences_.data() + index(k) * unknowns; };
  const int count = static_cast<int>(points.count);
  const int n = evaluator_.record().n();
  linear_->update(evaluator_);
  for (int k = 0; k < count; ++k) {
    const double* const x = points.x[index(k)];
    if (has_layers_) own_functions_->evaluate(points.t[index(k)], x, nullptr, values_.data());
    for (std::size_t j = 0; j < unknowns; ++j)
      row(k)[j] = unknowns_[j] < n ? x[unknowns_[j]] : own_value(x, index(unknowns_[j] - n));
  }
  divided_differences(part, count, unknowns, row);
  for (std::size_t k = 0; k < this->count(); ++k)
    if (linear_->factors(k) != nullptr) {
      row(0)[curve_of_condition_[k]] = g_start[k];
      row(1)[curve_of_condition_[k]] = g_end[k] - g_start[k];
    }
}

double SwitchSearch::own_value(const double* x, std::size_t condition) const {
  const std::vector<LinearConditions::Factor>* const factors = linear_->factors(condition);
  if (factors == nullptr) return values_[condition];
  double sum = 0.0;
  for (const LinearConditions::Factor& factor : *factors) sum += factor.value * x[factor.unknown];
  return sum;
}

// The deviation from the straight line is a polynomial s (s - 1) r(s), s = 0 ... 1: r and r' are bounded by Horner's
// scheme.
void SwitchSearch::set_bends(const PointsOfCurve& points) {
  const Differences part = parts_of(points);
  const std::size_t unknowns = unknowns_.size();
  std::fill(distances_.begin(), distances_.end(), 0.0);
  std::fill(slopes_.begin(), slopes_.end(), 0.0);
  for (std::size_t k = points.count; k-- > 2;) {
    const double farthest = std::max(std::fabs(part[k]), std::fabs(1.0 - part[k]));
    const double* const difference = differences_.data() + k * unknowns;
    for (std::size_t j = 0; j < unknowns; ++j) {
      slopes_[j] = distances_[j] + farthest * slopes_[j];
      distances_[j] = std::fabs(difference[j]) + farthest * distances_[j];
    }
  }
  for (std::size_t j = 0; j < unknowns; ++j) {
    slopes_[j] = distances_[j] + 0.25 * slopes_[j];
    distances_[j] *= 0.25;
  }
}

// Value of a condition at a fraction of the way.
double SwitchSearch::value_of(const Line& line, double part) const {
  double bend = 0.0;
  for (std::size_t k = line.points->count; k-- > 2;)
    bend = differences_[k * unknowns_.size() + line.curve] + (part - part_of(*line.points, k)) * bend;
  return line.start + part * (line.end - line.start) + part * (part - 1.0) * bend;
}

bool SwitchSearch::find_simple(const PointsOfCurve& points, const double* g_start, const double* g_end) {
  times_between_.clear();
  known_to_ = points.t[1];
  first_.reset();
  lines_.clear();
  if (count() == 0) return true;
  if (std::find(curve_of_condition_.begin(), curve_of_condition_.end(), -1) != curve_of_condition_.end())
    return false;
  set_differences(points, g_start, g_end);
  set_bends(points);
  for (std::size_t k = 0; k < count(); ++k) {
    const std::size_t curve = index(curve_of_condition_[k]);
    const double distance = distances_[curve], slope = slopes_[curve];
    const double low = std::min(g_start[k], g_end[k]), high = std::max(g_start[k], g_end[k]);
    if (low > distance || high <= -distance) continue;
    if (!(low <= 0.0 && high > 0.0 && high - low > slope)) return false;
    lines_.push_back({curve, &points, g_start[k], g_end[k]});
  }
  if (lines_.size() > 1) find_times_between();
  return true;
}

// Each of the lines switches once.
void SwitchSearch::find_times_between() {
  constexpr double near = 1e-13;  // of the way
  zeros_.clear();
  for (const Line& line : lines_)
    zeros_.push_back(
        zero_between([&](double part) { return value_of(line, part); }, {0.0, 1.0, line.start, line.end}, near));
  std::sort(zeros_.begin(), zeros_.end());
  const PointsOfCurve& points = *lines_[0].points;
  for (std::size_t k = 1; k < zeros_.size(); ++k)
    if (zeros_[k] > zeros_[k - 1])
      times_between_.push_back(points.t[0] + 0.5 * (zeros_[k] + zeros_[k - 1]) * (points.t[1] - points.t[0]));
}

void SwitchSearch::set_curve(const PointsOfCurve& points) {
  const Places places(evaluator_.record(), count());
  const double start = points.t[0], length = points.t[1] - start;
  for (int k = 0; k < evaluator_.record().num_user_parameters(); ++k)
    along_->set_parameter(k, evaluator_.parameter(k));
  along_->set_parameter(places.start, start);
  along_->set_parameter(places.length, length);
  for (std::size_t i = 2; i < points.count; ++i)
    along_->set_parameter(places.points + static_cast<int>(i) - 2, part_of(points, i));
  double *const g_start = at_ends_.data(), *const g_end = g_start + count();
  if (own_functions_) {
    own_functions_->evaluate(points.t[0], points.x[0], nullptr, g_start);
    own_functions_->evaluate(points.t[1], points.x[1], nullptr, g_end);
  }
  set_differences(points, g_start, g_end);
  int place = places.differences;
  for (std::size_t j = 0; j < unknowns_.size(); ++j)
    for (std::size_t k = 0; k < most_points; ++k)
      along_->set_parameter(place++, k < points.count ? differences_[k * unknowns_.size() + j] : 0.0);
}

const std::vector<double>& SwitchSearch::find(const PointsOfCurve& points, const double* margins) {
  times_between_.clear();
  known_to_ = points.t[1];
  first_.reset();
  if (count() == 0) return times_between_;
  set_curve(points);
  const Places places(evaluator_.record(), count());
  const auto set_margins = [&] {
    for (std::size_t k = 0; k < count(); ++k)
      along_->set_parameter(places.margins + static_cast<int>(k), margins_[k]);
  };
  std::fill(margins_.begin(), margins_.end(), 0.0);
  if (margins != nullptr) {
    set_margins();
    if (!along_->values(0.0, nullptr, 0, branches_.data())) std::fill(branches_.begin(), branches_.end(), 0.0);
    // A condition that is met stays so down to -margin.
    for (std::size_t k = 0; k < count(); ++k) margins_[k] = branches_[k] > 0.0 ? -margins[k] : margins[k];
  }
  set_margins();
  const auto time_at = [&](double part) { return points.t[0] + part * (points.t[1] - points.t[0]); };
  for (double known = 0.0; known < 1.0;) {
    const std::vector<SwitchingGap>& gaps = switches_->find(known, 1.0);
    const auto next =
        std::find_if(gaps.begin(), gaps.end(), [&](const SwitchingGap& gap) { return gap.start > known; });
    const bool has_next = next != gaps.end() && next->start < 1.0;
    if (!first_ && has_next) first_ = time_at(0.5 * (next->start + next->end));
    if (known > 0.0 && has_next) times_between_.push_back(time_at(0.5 * (known + next->start)));
    const bool is_unknown = !has_next && switches_->known_to() < 1.0;
    if (is_unknown || times_between_.size() == most_times) known_to_ = time_at(is_unknown ? known : next->end);
    if (is_unknown || !has_next || times_between_.size() == most_times) break;
    known = next->end;
  }
  return times_between_;
}

}  // namespace sfdae::core
