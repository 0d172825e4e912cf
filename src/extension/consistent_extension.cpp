// Consistent jets of the extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/consistent_extension.h"

#include <algorithm>
#include <cmath>

#include "extension/least_change_step.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// In squares of the sizes of x, W of what may move freely: far below what is to stay, far above rounding. Chosen, not
// measured.
constexpr double weight_of_free = 1e-10;
// Steps are halved so often, at most, where residuals do not become smaller.
constexpr int most_halvings = 10;
constexpr int most_iterations = 50;
// Of the sum of weighted changes: steps that are that small lead nowhere.
constexpr double settled = 1e-14;
constexpr int few_iterations = 12;

// Of one iteration: of x in units of x, or of its tolerance, the largest; of derivatives, which may vanish, the same.
class Change {
 public:
  void add(int order, double dx, double value, double size) {
    const double before = std::fabs(value - dx), scale = std::max(std::fabs(value), before);
    is_finite_ = is_finite_ && std::isfinite(value);
    if (dx == 0.0 || !is_finite_) return;
    double& largest = order == 0 ? of_x_ : of_derivatives_;
    largest = std::max(largest, std::fabs(dx) / (order == 0 ? std::max(scale, size) : scale));
  }
  bool is_finite() const { return is_finite_; }
  bool is_negligible() const { return std::max(of_x_, of_derivatives_) <= 4.0 * unit_roundoff; }
  bool is_small() const { return of_x_ <= small && of_derivatives_ <= small; }
  double of_x() const { return of_x_; }
  static constexpr double small = 1e-8;

 private:
  double of_x_ = 0.0, of_derivatives_ = 0.0;
  bool is_finite_ = true;
};

// Until nothing changes, or what changes are rounding errors: those of x are small, and residuals do not become smaller.
class Progress {
 public:
  // terms: sizes of what is added up in the residuals.
  bool has_ended(const Change& change, double residual, double terms) {
    constexpr double rounding = 1e-12;
    const bool stands = iterations_ > 0 && residual >= 0.1 * residual_ &&
                        residual <= std::max(Change::small * largest_, rounding * terms);
    is_stuck_ = iterations_ > 2 && residual >= 0.1 * residual_ && !change.is_small();
    const bool is_small = change.is_small() && iterations_ > 0 && change.of_x() >= 0.1 * before_;
    largest_ = std::max(largest_, residual);
    residual_ = residual;
    before_ = change.of_x();
    ++iterations_;
    return change.is_negligible() || is_small || (stands && change.of_x() <= Change::small);
  }

  // Residuals have stopped becoming smaller: it is of no use to go on where every step should be as good as the last.
  bool is_stuck() const { return is_stuck_; }

 private:
  int iterations_ = 0;
  bool is_stuck_ = false;
  double residual_ = 0.0, largest_ = 0.0, before_ = 0.0;
};

double largest_entry(const std::vector<double>& v) {
  double largest = 0.0;
  for (double entry : v) largest = std::isfinite(entry) ? std::max(largest, std::fabs(entry)) : HUGE_VAL;
  return largest;
}

// The largest sum of |derivative| |unknown|; x: of column c.
template <class Value>
double largest_terms(const std::vector<int>& first, const std::vector<int>& column, const std::vector<double>& values,
                     Value x) {
  double largest = 0.0;
  for (std::size_t i = 0; i + 1 < first.size(); ++i) {
    double sum = 0.0;
    for (int e = first[i]; e < first[i + 1]; ++e) sum += std::fabs(values[index(e)] * x(column[index(e)]));
    largest = std::max(largest, sum);
  }
  return largest;
}

// Residuals in units of the largest derivative of their rows.
void scale_rows(const std::vector<int>& first, const std::vector<double>& values, std::vector<double>& factors) {
  factors.assign(first.size() - 1, 1.0);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    double largest = 0.0;
    for (int e = first[i]; e < first[i + 1]; ++e) largest = std::max(largest, std::fabs(values[index(e)]));
    if (largest > 0.0) factors[i] = 1.0 / largest;
  }
}

}  // namespace

std::vector<char> differentiated_unknowns(const Signature& signature) {
  std::vector<char> flags(index(signature.size()), 0);
  for (int i = 0; i < signature.size(); ++i)
    for (const Signature::Entry& entry : signature.row(i))
      if (entry.order > 0) flags[index(entry.unknown)] = 1;
  return flags;
}

void ConsistentExtension::fail(const Jet& jet, const char* why) const {
  throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                format("no values consistent with the constraints were found at t = %.15g: ", jet.t) + why +
                    " Give a better guess.");
}

bool ConsistentExtension::is_held(const MinimalExtension::Column& column) const {
  return column.order == 0 && request_.kind == InitialValues::fixed && request_.fixed[index(column.unknown)] != 0;
}

// Of the square of a change.
double ConsistentExtension::weight(const MinimalExtension::Column& column) const {
  const std::size_t j = index(column.unknown);
  if (column.order > 0) return 0.0;
  if (request_.is_weighted()) return request_.weights[j] * request_.weights[j];
  if (!request_.differentiated_stay()) return 1.0;
  const double of_size = 1.0 / (sizes_[j] * sizes_[j]);
  return differentiated_[j] != 0 ? of_size : weight_of_free * of_size;
}

Jet ConsistentExtension::find(const PointOfInterest& point) {
  Jet guess;
  guess.t = point.t;
  guess.n = extension_.n();
  guess.x.assign(point.x, point.x + extension_.n());
  guess.set_order(extension_.jet_order());
  if (point.xdot != nullptr) std::copy_n(point.xdot, extension_.n(), guess.column(1));
  Jet jet = guess;
  // What is beyond the extension has no meaning.
  for (int j = 0; j < extension_.n(); ++j)
    if (extension_.offsets().d[index(j)] == 0) jet.column(1)[j] = 0.0;
  for (int stage = extension_.first_stage(); stage <= 0; ++stage) solve_stage(stage, guess, jet);
  if (has_to_move(guess, jet)) solve_together(guess, jet);
  return jet;
}

Jet ConsistentExtension::find_from(const PointOfInterest& point, const Jet& known) {
  Jet guess = known, jet = known;
  std::copy_n(point.x, extension_.n(), guess.x.begin());
  solve_together(guess, jet);
  return jet;
}

// Stages move what they have to, but not with an eye on those that come; fixed values they do not know of.
bool ConsistentExtension::has_to_move(const Jet& guess, const Jet& jet) const {
  constexpr double moved = 1e-6;  // of the tolerances; by judgement
  if (request_.is_weighted()) return true;
  for (int j = 0; j < extension_.n(); ++j) {
    const double change = std::fabs(jet.x[index(j)] - guess.x[index(j)]);
    const bool stays = is_held({j, 0}) || !request_.differentiated_stay() || differentiated_[index(j)] != 0;
    if (stays && change > moved * sizes_[index(j)]) return true;
  }
  return false;
}

// Newton's method, each step the least change back to the guess; derivatives, of which nothing is known, count little.
void ConsistentExtension::solve_stage(int stage, const Jet& guess, Jet& jet) {
  const int rows = extension_.first_row(stage + 1) - extension_.first_row(stage);
  const int first = extension_.first_column(stage), count = extension_.first_column(stage + 1) - first;
  if (rows == 0) return;
  const auto columns = extension_.columns().begin() + first;
  MinimalExtension::StageMatrix J;
  const LeastChangeStep::Equations equations{J.first, J.column, count};
  LeastChangeStep step;
  std::vector<double> W(index(count)), dx(index(count)), r(index(rows)), factors;
  std::vector<char> held(index(count), 0);
  for (int k = 0; k < count; ++k) {
    const double size = sizes_[index(columns[k].unknown)];
    W[index(k)] = rows == count ? 0.0 : columns[k].order > 0 ? weight_of_free / (size * size) : weight(columns[k]);
  }
  const auto residual = [&](const Jet& at) {
    const CallbackError error = extension_.stage_residuals(stage, at, r.data());
    if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
    for (std::size_t i = 0; i < r.size(); ++i) r[i] *= -factors[i];
    return error.status == SFDAE_OK ? largest_entry(r) : HUGE_VAL;
  };
  Progress progress;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    CallbackError error = extension_.linearize_stage(stage, jet, J);
    if (error.status != SFDAE_OK) error.raise();
    if (iteration == 0) step.analyze(equations);
    scale_rows(J.first, J.values, factors);
    for (int i = 0; i < rows; ++i)
      for (int e = J.first[index(i)]; e < J.first[index(i + 1)]; ++e) J.values[index(e)] *= factors[index(i)];
    if (!step.factor(equations, J.values, W, held)) fail(jet, "the equations are singular there.");
    const double size_of_residual = residual(jet);
    if (size_of_residual == HUGE_VAL) {
      error = extension_.stage_residuals(stage, jet, r.data());
      if (error.status != SFDAE_OK) error.raise();
      fail(jet, "the equations overflow.");
    }
    for (int k = 0; k < count; ++k) {
      const auto [unknown, order] = columns[k];
      dx[index(k)] = W[index(k)] * (guess.column(order)[unknown] - jet.column(order)[unknown]);
    }
    step.solve(equations, held, dx.data(), r.data());
    const Jet start = jet;
    Change change;
    double factor = 1.0;
    for (int halving = 0;; ++halving, factor *= 0.5) {
      change = {};
      for (int k = 0; k < count; ++k) {
        const auto [unknown, order] = columns[k];
        double& value = jet.column(order)[unknown];
        value = start.column(order)[unknown] + factor * dx[index(k)];
        change.add(order, dx[index(k)], value, sizes_[index(unknown)]);
      }
      if (residual(jet) <= size_of_residual || change.is_small() || halving == most_halvings) break;
    }
    if (!change.is_finite()) fail(jet, "the search has diverged.");
    const double terms = largest_terms(J.first, J.column, J.values, [&](int k) {
      const auto [unknown, order] = columns[k];
      return jet.column(order)[unknown];
    });
    if (factor == 1.0 && progress.has_ended(change, size_of_residual, terms)) return;
  }
  fail(jet, "the search does not come to an end.");
}

namespace {

// All equations of the extension, linearized for changes that are least.
class WholeStep {
 public:
  WholeStep(MinimalExtension& extension, std::vector<double> W, std::vector<char> held)
      : extension_(extension),
        equations_{extension.first(), extension.column(), extension.num_columns()},
        W_(std::move(W)),
        held_(std::move(held)),
        dx_(W_.size()),
        r_(index(extension.num_rows())) {
    step_.analyze(equations_);
  }

  // The change from the jet on: toward the guess, or, without one, least. False: singular. Throws Failure.
  bool compute(const Jet& jet, const Jet* guess) {
    CallbackError error = extension_.linearize(jet);
    if (error.status == SFDAE_OK) error = extension_.residuals(jet, r_.data());
    if (error.status != SFDAE_OK) error.raise();
    values_ = extension_.values();
    scale_rows(equations_.first, values_, factors_);
    for (int i = 0; i < equations_.rows(); ++i) {
      r_[index(i)] *= -factors_[index(i)];
      for (int e = equations_.first[index(i)]; e < equations_.first[index(i + 1)]; ++e)
        values_[index(e)] *= factors_[index(i)];
    }
    residual_ = largest_entry(r_);
    terms_ = largest_terms(equations_.first, equations_.column, values_, [&](int k) {
      const auto [unknown, order] = extension_.columns()[index(k)];
      return jet.column(order)[unknown];
    });
    if (!std::isfinite(residual_) || !step_.factor(equations_, values_, W_, held_)) return false;
    for (std::size_t k = 0; k < dx_.size(); ++k) {
      const auto [unknown, order] = extension_.columns()[k];
      dx_[k] = guess != nullptr ? W_[k] * (guess->column(order)[unknown] - jet.column(order)[unknown]) : 0.0;
    }
    step_.solve(equations_, held_, dx_.data(), r_.data());
    return true;
  }
  // Before the change, in units of the largest derivatives; and what is added up there.
  double residual() const { return residual_; }
  double terms() const { return terms_; }
  Change apply(double part, const std::vector<double>& sizes, Jet& jet) const {
    Change change;
    for (std::size_t k = 0; k < dx_.size(); ++k) {
      const auto [unknown, order] = extension_.columns()[k];
      double& value = jet.column(order)[unknown];
      value += part * dx_[k];
      change.add(order, part * dx_[k], value, sizes[index(unknown)]);
    }
    return change;
  }
  // Of the squares of changes from the guess, weighted; of dx.
  double sum(const Jet& guess, const Jet& jet) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < dx_.size(); ++k) {
      const auto [unknown, order] = extension_.columns()[k];
      sum += W_[k] * std::pow(jet.column(order)[unknown] - guess.column(order)[unknown], 2);
    }
    return sum;
  }
  double sum_of_change() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < dx_.size(); ++k) sum += W_[k] * dx_[k] * dx_[k];
    return sum;
  }

 private:
  MinimalExtension& extension_;
  LeastChangeStep::Equations equations_;
  LeastChangeStep step_;
  std::vector<double> W_;
  std::vector<char> held_;
  std::vector<double> dx_, r_, factors_, values_;
  double residual_ = 0.0, terms_ = 0.0;
};

// By changes that are least. False: the search does not come to an end.
bool fulfil(WholeStep& step, const std::vector<double>& sizes, Jet& jet) {
  Progress progress;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!step.compute(jet, nullptr)) return false;
    const Change change = step.apply(1.0, sizes, jet);
    if (!change.is_finite()) return false;
    if (progress.has_ended(change, step.residual(), step.terms())) return true;
  }
  return false;
}

// Steps toward the guess, each as long as the sum of changes becomes smaller by it; from a jet that fulfils the equations.
void approach(WholeStep& step, const Jet& guess, const std::vector<double>& sizes, Jet& jet) {
  constexpr int most = 300;
  constexpr double shortest = 1.0 / 1024.0;
  for (int iteration = 0; iteration < most; ++iteration) {
    const double sum = step.sum(guess, jet);
    if (!step.compute(jet, &guess) || step.sum_of_change() <= settled * sum) return;
    const WholeStep full = step;
    bool is_nearer = false;
    for (double part = 1.0; !is_nearer && part >= shortest; part *= 0.5) {
      Jet next = jet;
      is_nearer =
          full.apply(part, sizes, next).is_finite() && fulfil(step, sizes, next) && step.sum(guess, next) < sum;
      if (is_nearer) jet = std::move(next);
    }
    if (!is_nearer) return;
  }
}

// The whole steps alone: fast, but where constraints are bent, or derivatives of high order lose too many digits, they may
// not come to an end.
bool hurry(WholeStep& step, const Jet& guess, const std::vector<double>& sizes, Jet& jet) {
  Progress progress;
  for (int iteration = 0; iteration < few_iterations; ++iteration) {
    if (!step.compute(jet, &guess)) return false;
    const Change change = step.apply(1.0, sizes, jet);
    if (!change.is_finite()) return false;
    if (progress.has_ended(change, step.residual(), step.terms())) return true;
    if (progress.is_stuck()) return false;
  }
  return false;
}

}  // namespace

void ConsistentExtension::solve_together(const Jet& guess, Jet& jet) {
  const std::vector<MinimalExtension::Column>& columns = extension_.columns();
  std::vector<double> W(columns.size());
  std::vector<char> held(columns.size(), 0);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto [unknown, order] = columns[k];
    W[k] = weight(columns[k]);
    held[k] = is_held(columns[k]) ? 1 : 0;
    if (held[k] != 0) jet.column(order)[unknown] = guess.column(order)[unknown];
  }
  WholeStep step(extension_, std::move(W), std::move(held));
  if (!request_.is_weighted()) {
    Jet quick = jet;
    if (hurry(step, guess, sizes_, quick)) {
      jet = std::move(quick);
      return;
    }
    // The jet is consistent, if not the nearest one.
    if (request_.kind != InitialValues::fixed) return;
  }
  if (fulfil(step, sizes_, jet)) {
    approach(step, guess, sizes_, jet);
    return;
  }
  if (request_.kind == InitialValues::fixed)
    throw Failure(
        SFDAE_NO_CONSISTENT_VALUES,
        format("no consistent values were found near the guess at t = %.15g that leave the fixed components as "
               "they are. Give a better guess, or fix fewer components.",
               jet.t));
  fail(jet, "the search does not come to an end.");
}

void ConsistentExtension::report(const PointOfInterest& point, const Jet& found, ConsistentPoint& result) const {
  const std::size_t n = index(extension_.n());
  const std::vector<double> given(point.x, point.x + n),
      consistent(found.x.begin(), found.x.begin() + extension_.n());
  std::vector<double> changes(n, 0.0);
  double sum = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    const double change = consistent[j] - given[j];
    sum = std::hypot(sum, change);
    if (differentiated_[j] != 0) changes[j] = change;
  }
  result.change.residual_before = sum;
  report_change(request_, point.t, given, consistent, result.change);
  if (request_.reports_changes())
    result.value_change = largest_change(given.data(), changes.data(), request_.tolerances, extension_.n());
}

}  // namespace sfdae::core
