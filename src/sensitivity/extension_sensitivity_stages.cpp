// The stages of an implicit Runge-Kutta step for sensitivities along the minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/extension_sensitivity_stages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Negligible errors of S, relative to its largest entries in units of x: without hidden constraints, and with them,
// which S has to fulfil to machine precision. Below the last value, changes that stop decreasing may be rounding
// errors.
constexpr double negligible_error = 1e-10, negligible_error_of_hidden = 1e-12, rounding_of_changes = 1e-10;
// One system for all stages takes less time than more iterations, or slower ones.
constexpr int most_iterations_of_stages = 12;
constexpr double slowest_rate = 0.2;
// States of all stages, those in pairs counted once: with so many, full matrices take less time than iterations with
// the factors of x.
constexpr int most_states_of_stages = 120;
// Iterations with factors of x cost the same for each parameter. Chosen, not measured.
constexpr int most_iterated = 2;
// The first change is all of S, the second one its rounding errors.
constexpr int most_refinements = 4;

}  // namespace

void ExtensionSensitivityStages::set_choice(const StateChoice& choice, const SensitivitySlots& slots) {
  choice_ = &choice;
  slots_ = &slots;
  together_.forget();
  before_.times.clear();
  source_.clear();
  std::vector<int> number(index(equations_.extension().n()), 0);
  for (std::size_t k = 0; k < choice.states().size(); ++k) number[index(choice.states()[k])] = static_cast<int>(k);
  for (int column : equations_.extension().column())
    source_.push_back(choice.is_slope(column)
                          ? num_rows() + number[index(equations_.extension().columns()[index(column)].unknown)]
                          : choice.slot(column));
}

void ExtensionSensitivityStages::resize(int s) {
  const std::size_t size = index(num_rows()) * index(count()) * index(s) + 1;
  for (auto* v : {&unknowns_, &r_, &transformed_})
    if (v->size() < size) v->resize(size);
}

bool ExtensionSensitivityStages::solve(const Task& task, ExtensionLinearization* by, double* S) {
  resize(task.method.s);
  const bool is_there = by != nullptr && iterate(task, [&] { take_away(task, *by); });
  if (!is_there) {
    ++factorizations_;
    if (!together_.solve(task, *choice_, *slots_, unknowns_)) return false;
  }
  return copy_to(task.method.s, S);
}

// Returns false if a value is not finite.
bool ExtensionSensitivityStages::copy_to(int s, double* S) const {
  for (int i = 0; i < s; ++i)
    for (int q = 0; q < count(); ++q) {
      const double* const from = unknowns_.data() + index(i * count() + q) * index(num_rows());
      for (int j = 0; j < equations_.extension().n(); ++j) *S++ = from[slots_->of_x(j)];
    }
  return all_finite(unknowns_.data(), index(num_rows()) * index(count()) * index(s));
}

// ---- By states -------------------------------------------------------------------------------------------------

// Solves and refines: pivots need not be large.
bool ExtensionSensitivityStages::solve_locally(const Task& task, const ExtensionLinearization& linearization,
                                               LocalStages* by, double* S) {
  const int s = task.method.s;
  resize(s);
  if (by != nullptr && count() <= most_iterated && iterate(task, [&] { take_away(task, *by); })) return copy_to(s, S);
  // Allows for as many states in pairs as possible.
  if (!local_.is_of_use(s, 2 * most_states_of_stages)) return false;
  const auto value = [&](std::size_t e, int i) { return task.rows[index(i)].values[e]; };
  if (!local_.linearize(task.method, task.h, value, linearization, most_states_of_stages)) return false;
  ++factorizations_;
  std::fill(unknowns_.begin(), unknowns_.end(), 0.0);
  for (int iteration = 0; iteration < most_refinements; ++iteration) {
    set_residuals(task);
    take_away(task, local_);
    const double change = add_changes(task);
    if (change <= negligible_error_of_hidden) return copy_to(s, S);
  }
  return false;
}

void ExtensionSensitivityStages::take_away(const Task& task, LocalStages& by) {
  const int rows = num_rows();
  for (int q = 0; q < count(); ++q) by.solve({block(r_, 0, q), rows, task.method.s, count() * rows});
}

// ---- Iterations ------------------------------------------------------------------------------------------------

template <class TakeAway>
bool ExtensionSensitivityStages::iterate(const Task& task, TakeAway take_away) {
  const bool has_hidden = equations_.extension().highest_level() > 0;
  const double target = has_hidden ? negligible_error_of_hidden : negligible_error;
  predict(task);
  // With hidden constraints every other iteration may gain little.
  double before = std::numeric_limits<double>::infinity(), earlier = before, rate_before = 1.0,
         most = before;  // what has to be left with the slowest rate that is of use
  for (int iteration = 0; iteration < most_iterations_of_stages; ++iteration) {
    set_residuals(task);
    take_away();
    const double change = add_changes(task);
    if (!(change <= std::numeric_limits<double>::max())) return false;
    // The first change removes the error of the prediction; nothing is known of the next one.
    const double rate = iteration > 0 ? change / before : 1.0;
    const bool is_slow = iteration > 1 && (change > slowest_rate * std::max(before, earlier) || change > most);
    const bool is_there =
        change * std::min(std::max(rate, rate_before), 1.0) <= target || (is_slow && change <= rounding_of_changes);
    if (is_there) note_step(task);
    if (is_there || is_slow) return is_there;
    earlier = iteration > 0 ? before : change;
    before = change;
    rate_before = iteration > 0 ? rate : has_hidden ? 1.0 : 0.0;
    most = slowest_rate * (iteration > 0 ? most : change);
  }
  return false;
}

// Extrapolates the polynomial of the last step, or repeats the values at the start of this one.
void ExtensionSensitivityStages::predict(const Task& task) {
  if (extrapolate(task)) return;
  const int n = equations_.extension().n();
  std::fill(unknowns_.begin(), unknowns_.end(), 0.0);
  for (int i = 0; i < task.method.s; ++i)
    for (int q = 0; q < count(); ++q)
      for (int j = 0; j < n; ++j) block(unknowns_, i, q)[slots_->of_x(j)] = task.S_start[std::ptrdiff_t(q) * n + j];
}

bool ExtensionSensitivityStages::extrapolate(const Task& task) {
  constexpr double farthest = 3.0;  // in steps; chosen, not measured
  const std::size_t points = before_.times.size(), size = index(num_rows()) * index(count());
  if (points < 3) return false;
  const double span = before_.times.back() - before_.times.front();
  const double distance = task.jets[index(task.method.s - 1)].t - before_.times.back();
  if (!(std::fabs(distance) <= farthest * std::fabs(span))) return false;
  for (int i = 0; i < task.method.s; ++i) {
    double* const to = block(unknowns_, i, 0);
    std::fill_n(to, size, 0.0);
    for (std::size_t k = 0; k < points; ++k) {
      double L = 1.0;
      for (std::size_t j = 0; j < points; ++j)
        if (j != k) L *= (task.jets[index(i)].t - before_.times[j]) / (before_.times[k] - before_.times[j]);
      const double* const from = before_.unknowns.data() + k * size;
      for (std::size_t r = 0; r < size; ++r) to[r] += L * from[r];
    }
  }
  return true;
}

void ExtensionSensitivityStages::note_step(const Task& task) {
  const std::size_t size = index(num_rows()) * index(count()) * index(task.method.s);
  before_.unknowns.resize(std::max(before_.unknowns.size(), size));
  std::copy_n(unknowns_.begin(), size, before_.unknowns.begin());
  before_.times.clear();
  for (int i = 0; i < task.method.s; ++i) before_.times.push_back(task.jets[index(i)].t);
}

// r_: right-hand sides minus the rows applied to the unknowns.
void ExtensionSensitivityStages::set_residuals(const Task& task) {
  const std::vector<int>& states = choice_->states();
  const int s = task.method.s, size = static_cast<int>(states.size()) * count();
  changes_.resize(std::max(changes_.size(), index(size) * index(s) + 1));
  slopes_.resize(changes_.size());
  double* next = changes_.data();
  for (int i = 0; i < s; ++i)
    for (int q = 0; q < count(); ++q) {
      const double* const at = block(unknowns_, i, q);
      const double* const start = task.S_start + std::ptrdiff_t(q) * equations_.extension().n();
      for (int j : states) *next++ = at[slots_->of_x(j)] - start[j];
    }
  const int ld = std::max(size, 1);
  multiply(1.0 / task.h, Op::plain, ConstView{changes_.data(), size, s, ld}, Op::transposed,
           ConstView{task.method.D.data(), s, s, s}, 0.0, View{slopes_.data(), size, s, ld});
  for (int i = 0; i < s; ++i)
    for (int q = 0; q < count(); q += at_once) {
      const int width = std::min(at_once, count() - q);
      if (width == 1) subtract_rows<1>(task.rows[index(i)], i, q, 1);
      else subtract_rows<at_once>(task.rows[index(i)], i, q, width);
    }
}

// Parameters from q on, the first `used` of at most `width`: others repeat the last.
template <int width>
void ExtensionSensitivityStages::subtract_rows(const SensitivityRows& rows, int i, int q, int used) {
  const std::size_t num_rows = index(this->num_rows()), d = choice_->states().size();
  sources_.resize(std::max(sources_.size(), (num_rows + d) * width + 1));
  double* const y = sources_.data();
  const double* right[width];
  double* r[width];
  for (int c = 0; c < width; ++c) {
    const int of = q + std::min(c, used - 1);
    const double *const at = block(unknowns_, i, of), *const slopes = slopes_.data() + index(i * count() + of) * d;
    for (std::size_t k = 0; k < num_rows; ++k) y[k * width + index(c)] = at[k];
    for (std::size_t k = 0; k < d; ++k) y[(num_rows + k) * width + index(c)] = slopes[k];
    right[c] = rows.right.data() + index(of) * num_rows;
    r[c] = block(r_, i, of);
  }
  const int* const first = equations_.extension().first().data();
  const int* const source = source_.data();
  const double* const values = rows.values.data();
  for (std::size_t row = 0; row < num_rows; ++row) {
    double sum[width];
    for (int c = 0; c < width; ++c) sum[c] = right[c][row];
    for (int e = first[row]; e < first[row + 1]; ++e) {
      const double* const from = y + index(source[e]) * width;
      for (int c = 0; c < width; ++c) sum[c] -= values[e] * from[c];
    }
    for (int c = 0; c < width; ++c) r[c][row] = sum[c];
  }
}

// As for the stages of x: multiplied by T^-1 they are one real system and (s - 1) / 2 complex ones. r_ becomes the
// changes.
void ExtensionSensitivityStages::take_away(const Task& task, ExtensionLinearization& by) {
  const StageMethod& method = task.method;
  const int s = method.s, size = num_rows() * count();
  const View r{r_.data(), size, s, size}, transformed{transformed_.data(), size, s, size};
  multiply(1.0, Op::plain, r, Op::transposed, ConstView{method.T_inverse.data(), s, s, s}, 0.0, transformed);
  by.solve_step(transformed.column(0), count());
  pair_.resize(index(size) + 1);
  for (int k = 0; 2 * k + 2 < s; ++k) {
    double *const first = transformed.column(2 * k + 1), *const second = transformed.column(2 * k + 2);
    for (int i = 0; i < size; ++i) pair_[index(i)] = {first[i], -second[i]};
    by.solve_pair(index(k), pair_.data(), count());
    for (int i = 0; i < size; ++i) {
      first[i] = pair_[index(i)].real();
      second[i] = -pair_[index(i)].imag();
    }
  }
  multiply(1.0, Op::plain, transformed, Op::transposed, ConstView{method.T.data(), s, s, s}, 0.0, r);
}

// The largest change of S relative to the largest entry of its column, both in units of x. Not finite if any value is
// not.
double ExtensionSensitivityStages::add_changes(const Task& task) {
  const std::size_t n = index(equations_.extension().n()), rows = index(num_rows());
  per_scale_.resize(n);
  for (std::size_t j = 0; j < n; ++j) per_scale_[j] = task.scales[j] > 0.0 ? 1.0 / task.scales[j] : 1.0;
  double largest = 0.0;
  for (int q = 0; q < count(); ++q) {
    double size = 0.0, change = 0.0, sum = 0.0;
    for (int i = 0; i < task.method.s; ++i) {
      double* __restrict to = block(unknowns_, i, q);
      const double* __restrict by = block(r_, i, q);
      for (std::size_t k = 0; k < rows; ++k) to[k] += by[k];
      for (std::size_t j = 0; j < n; ++j) {
        const std::size_t slot = index(slots_->of_x(static_cast<int>(j)));
        const double of_x = std::fabs(to[slot]) * per_scale_[j], of_change = std::fabs(by[slot]) * per_scale_[j];
        size = std::max(size, of_x);
        change = std::max(change, of_change);
        sum += of_change;
      }
    }
    if (!(sum <= std::numeric_limits<double>::max())) return std::numeric_limits<double>::infinity();
    if (change > 0.0) largest = std::max(largest, size > 0.0 ? change / size : 1.0);
  }
  return largest;
}

void ExtensionSensitivityStages::archive(Archive& archive, const ExtensionLinearization& linearization) {
  local_.archive(archive, linearization);
  together_.archive(archive, *choice_);
  int points = static_cast<int>(before_.times.size());
  archive.small(points);
  if (points < 0 || points > max_stages) throw DamagedArchive();
  archive.reals(before_.times, index(points));
  if (points > 0) archive.reals(before_.unknowns, index(points) * index(num_rows()) * index(count()));
}

}  // namespace sfdae::core
