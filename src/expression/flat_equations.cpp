// Algebraic equations that do not depend on an unknown to first order.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/flat_equations.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "expression/held_conditions.h"
#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// An entry of F_x is flat if the equation changes by more than ten times what the entry predicts. (Chosen.)
constexpr double flat = 0.1;
// Changes of an equation, in units of its uncertainty, beyond which it is not flat. (Chosen.)
constexpr double steep = 100.0;
// Widths are tried from one tolerance on, each twice the one before. (Chosen: up to 1e12 tolerances.)
constexpr int most_widths = 40;

class FlatSearch {
 public:
  FlatSearch(const TaylorEvaluator& evaluator, double t, const double* x, const double* tolerances)
      : equations_(evaluator),
        record_(equations_.record()),
        tolerances_(tolerances),
        t_(t),
        n_(index(record_.n())),
        x_(x, x + n_),
        jet_(2 * n_),
        values_(index(record_.m())),
        is_differentiated_(n_, 0) {
    // Branches may be held at present.
    for (int i = record_.num_user_parameters(); i < equations_.num_parameters(); ++i)
      equations_.set_parameter(i, 0.0);
    for (const Tape::Variable& target : equations_.tape().targets)
      if (target.derivative) is_differentiated_[index(target.unknown)] = 1;
  }

  std::vector<FlatEquation> find() {
    std::vector<FlatEquation> found;
    if (!find_entries(x_, entries_)) return found;
    // Entries that are the same at another point belong to linear terms.
    std::vector<double> beside(x_), other;
    for (std::size_t i = 0; i < n_; ++i) beside[i] += tolerances_[i];
    if (!find_entries(beside, other)) return found;
    const std::vector<double> entries = entries_;
    const Tape& tape = equations_.tape();
    for (int i = 0; i < record_.m(); ++i) {
      if ((record_.dependence(record_.residual(i)) & on_derivatives) != 0) continue;
      for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i) + 1]; ++e) {
        const std::size_t j = index(tape.targets[e].unknown);
        if (is_differentiated_[j] != 0 || entries[e] == other[e]) continue;
        // Over the distance to zero slope the equation changes by far more than its uncertainty.
        const double distance = tolerances_[j] * entries[e] / (other[e] - entries[e]);
        if (std::fabs(entries[e] * distance) > steep * openness(i, e, entries)) continue;
        if (const auto equation = flat_near(i, e)) found.push_back(*equation);
      }
    }
    return found;
  }

 private:
  bool find_entries(const std::vector<double>& x, std::vector<double>& entries) {
    entries.assign(equations_.tape().targets.size(), 0.0);
    std::copy(x.begin(), x.end(), jet_.begin());
    return equations_.entries(t_, jet_.data(), 0, std::vector<int>(values_.size(), 0), entries.data());
  }

  // Returns the uncertainty of equation i from the tolerances of the unknowns other than that of entry e.
  double openness(int i, std::size_t e, const std::vector<double>& entries) const {
    const Tape& tape = equations_.tape();
    double sum = 0.0;
    for (std::size_t k = tape.first_target[index(i)]; k < tape.first_target[index(i) + 1]; ++k)
      if (k != e) sum += std::fabs(entries[k]) * tolerances_[tape.targets[k].unknown];
    return sum;
  }

  std::optional<double> value(int i, std::size_t j, double x) {
    std::copy(x_.begin(), x_.end(), jet_.begin());
    jet_[j] = x;
    if (!equations_.values_of({i}, t_, jet_.data(), 0, values_.data())) return std::nullopt;
    return values_[index(i)];
  }

  // Checks this point, and the point of zero slope if that is near.
  std::optional<FlatEquation> flat_near(int i, std::size_t e) {
    constexpr int most_moves = 20;
    const std::size_t j = index(equations_.tape().targets[e].unknown);
    double center = x_[j];
    for (int move = 0; move < most_moves && std::isfinite(center); ++move) {
      const auto equation = flat_in(i, e, center);
      if (equation) return std::fabs(center - x_[j]) <= equation->width ? equation : std::nullopt;
      std::vector<double> beside(x_), entries;
      beside[j] = center + tolerances_[j];
      if (!find_entries(beside, entries)) return std::nullopt;
      center -= tolerances_[j] * entries_[e] / (entries[e] - entries_[e]);
    }
    return std::nullopt;
  }

  std::optional<FlatEquation> flat_in(int i, std::size_t e, double center) {
    const std::size_t j = index(equations_.tape().targets[e].unknown);
    std::vector<double> at(x_);
    at[j] = center;
    if (!find_entries(at, entries_)) return std::nullopt;
    const double open = openness(i, e, entries_);
    const std::optional<double> here = value(i, j, center);
    if (!here || !(open > 0.0) || !std::isfinite(open) || !(tolerances_[j] > 0.0)) return std::nullopt;
    // A linear term of this slope would have this size there.
    const double most = flat * open / std::fabs(entries_[e]);
    double width = tolerances_[j];
    for (int tried = 0; tried < most_widths && width <= most; ++tried, width *= 2.0) {
      const auto below = value(i, j, center - width), above = value(i, j, center + width);
      if (!below || !above) return std::nullopt;
      const double fall = *here - *below, rise = *above - *here;
      if (std::fabs(rise) < open || std::fabs(fall) < open) {
        if (std::max(std::fabs(rise), std::fabs(fall)) > steep * open) return std::nullopt;
        continue;
      }
      if ((rise > 0.0) != (fall > 0.0) || !others_stay(i, e, center, width, open)) return std::nullopt;
      return FlatEquation{i, static_cast<int>(j), center, width, std::copysign(open / width, rise)};
    }
    return std::nullopt;
  }

  // Returns whether the influence of other unknowns on the equation is about the same on both sides, so that it does
  // not end here.
  bool others_stay(int i, std::size_t e, double center, double width, double open) {
    constexpr double similar = 2.0;  // (Chosen.)
    std::vector<double> beside(x_), entries;
    const std::size_t j = index(equations_.tape().targets[e].unknown);
    for (const double side : {-width, width}) {
      beside[j] = center + side;
      if (!find_entries(beside, entries)) return false;
      const double there = openness(i, e, entries);
      if (!(there < similar * open && open < similar * there)) return false;
    }
    return true;
  }

  TaylorEvaluator equations_;
  const Record& record_;
  const double* tolerances_;
  double t_;
  std::size_t n_;
  std::vector<double> x_, jet_, values_, entries_;
  std::vector<char> is_differentiated_;
};

}  // namespace

std::vector<FlatEquation> flat_equations(const TaylorEvaluator& evaluator, double t, const double* x,
                                         const double* tolerances) {
  const QuietArithmetic quiet;
  return FlatSearch(evaluator, t, x, tolerances).find();
}

std::shared_ptr<const Record> with_terms(const Record& record, const std::vector<FlatEquation>& terms) {
  Recorder recorder(record.n());
  const auto apply = [&](Operation operation, int a, int b) { return recorder.apply(operation, a, b); };
  const std::vector<int> copies = copy_with_choices(record, recorder, [&](const CopiedChoice& copied) {
    return recorder.apply(Operation::choose, copied.condition, copied.if_met, copied.otherwise);
  });
  std::vector<int> residuals;
  for (int i = 0; i < record.m(); ++i) residuals.push_back(copies[index(record.residual(i))]);
  for (const FlatEquation& term : terms) {
    const int change = apply(Operation::subtract, recorder.unknown(term.unknown), recorder.constant(term.center));
    const int scaled = apply(Operation::divide, change, recorder.constant(term.width));
    const int below = apply(Operation::add, recorder.constant(1.0), apply(Operation::multiply, scaled, scaled));
    const int rise = apply(Operation::multiply, recorder.constant(term.slope), change);
    int& residual = residuals[index(term.equation)];
    residual = apply(Operation::add, residual, apply(Operation::divide, rise, below));
  }
  return with_conditions(recorder.finish(std::move(residuals), record.equation_names()));
}

}  // namespace sfdae::core
