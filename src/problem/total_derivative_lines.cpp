// One-sided comparison of total derivatives that a callback supplies along a jet with its functions.
//
//     F^(k)            of F^(k-1)  along the polynomial with the derivatives given, at t + s
//     F_x^(k), F_x'^(k)  of F^(k)  along jets that move in a direction at random; then in each x_j and x'_j, where a
//                                  row is wrong
//
// dF^(k)/dx^(j) = C(k, j) F_x^(k-j) + C(k, j-1) F_x'^(k-j+1).
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/total_derivative_lines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "linalg/index.h"
#include "linalg/random.h"
#include "problem/shifted_jet.h"
#include "problem/supplied_line.h"

namespace sfdae::core {

namespace {

// F^(k), F_x^(k), F_x'^(k), k = 0..highest, one after the other.
struct Orders0ToHighest {
  std::vector<double> F, F_x, F_xdot;
};

class TotalLines {
 public:
  TotalLines(CallbackProblem& problem, double t, const double* derivatives, int max_order)
      : problem_(problem),
        t_(t),
        m_(index(problem.m())),
        n_(index(problem.n())),
        highest_(max_order),
        jet_(derivatives, derivatives + n_ * index(max_order + 2)) {
    resize(here_);
    resize(there_);
  }

  std::optional<DerivativeMismatch> mismatch(double reach) {
    CallbackError error = evaluate(t_, jet_, true, here_);
    if (error.status == SFDAE_ORDER_MISSING && error.order > 0) {
      highest_ = error.order - 1;
      error = evaluate(t_, jet_, true, here_);
    }
    if (error.status == SFDAE_CALLBACK_STOPPED || error.status == SFDAE_STOPPED) error.raise();
    if (error.status != SFDAE_OK) return {};
    auto wrong = highest_ > 0 ? in_time(reach) : std::nullopt;
    return wrong ? wrong : in_space();
  }

 private:
  void resize(Orders0ToHighest& values) const {
    values.F.resize(m_ * index(highest_ + 1));
    values.F_x.resize(values.F.size() * n_);
    values.F_xdot.resize(values.F_x.size());
  }

  CallbackError evaluate(double t, const std::vector<double>& jet, bool with_jacobians, Orders0ToHighest& to) {
    for (int k = 0; k <= highest_; ++k) {
      const std::size_t rows = m_ * index(k), area = rows * n_;
      CallbackProblem::Outputs outputs{to.F.data() + rows};
      if (with_jacobians) outputs = {to.F.data() + rows, to.F_x.data() + area, to.F_xdot.data() + area};
      if (problem_.stop_is_requested()) {
        CallbackError stopped;
        stopped.status = SFDAE_STOPPED;
        stopped.t = t;
        return stopped;
      }
      const CallbackError error = problem_.call(t, k, jet.data(), outputs);
      if (error.status != SFDAE_OK) return error;
    }
    return {};
  }

  // Skips equations that are not differentiated so often.
  bool counts(int row, int order) const {
    const std::vector<int>& most = problem_.differentiations();
    return most.empty() || order <= most[index(row)];
  }

  std::optional<DerivativeMismatch> in_time(double reach) {
    const int count = problem_.m() * highest_;
    SuppliedLine line{count, problem_.m(), t_, reach, {}, here_.F};
    line.base.resize(m_ * index(highest_ + 1));
    line.evaluate = [this](double s, double* values) {
      const CallbackError error = evaluate(t_ + s, shifted_jet(jet_, n_, s), false, there_);
      std::copy_n(there_.F.begin(), m_ * index(highest_ + 1), values);
      return error;
    };
    const LineContradiction* worst = nullptr;
    const auto found = contradictions(line, unconfirmed_entries(line), least_wrong_part);
    for (const LineContradiction& c : found) {
      const int order = c.entry / problem_.m() + 1;
      if (!counts(c.entry % problem_.m(), order)) continue;
      if (worst == nullptr || order < worst->entry / problem_.m() + 1) worst = &c;
    }
    if (worst == nullptr) return {};
    return DerivativeMismatch{.function = 'F',
                              .order = worst->entry / problem_.m() + 1,
                              .row = worst->entry % problem_.m(),
                              .supplied = worst->supplied,
                              .difference = worst->difference};
  }

  // F of all orders along jet_ + s d, and its derivative, with d n x (highest + 2).
  SuppliedLine space_line(const std::vector<double>& d) {
    const int count = problem_.m() * (highest_ + 1);
    const auto write = [this, &d, count](const Orders0ToHighest& values, double* to) {
      std::copy_n(values.F.begin(), count, to);
      std::fill_n(to + count, count, 0.0);
      for (int k = 0; k <= highest_; ++k) add_directional(values, k, d, to + count + m_ * index(k));
    };
    SuppliedLine line{count, count, 0.0, 1.0, {}, std::vector<double>(2 * index(count))};
    write(here_, line.base.data());
    line.terms = sizes_of_terms();
    line.evaluate = [this, &d, write](double s, double* to) {
      std::vector<double> jet(jet_);
      for (std::size_t i = 0; i < jet.size(); ++i) jet[i] += s * d[i];
      const CallbackError error = evaluate(t_, jet, true, there_);
      if (error.status == SFDAE_OK) write(there_, to);
      return error;
    };
    return line;
  }

  // Residuals are near zero, as differences of terms of this size.
  std::vector<double> sizes_of_terms() const {
    const auto absolute = [](std::vector<double> values) {
      for (double& value : values) value = std::fabs(value);
      return values;
    };
    const Orders0ToHighest sizes{{}, absolute(here_.F_x), absolute(here_.F_xdot)};
    const std::vector<double> jet = absolute(jet_);
    std::vector<double> terms(m_ * index(highest_ + 1), 0.0);
    for (int k = 0; k <= highest_; ++k) add_directional(sizes, k, jet, terms.data() + m_ * index(k));
    return terms;
  }

  // sum_j (C(k, j) F_x^(k-j) + C(k, j-1) F_x'^(k-j+1)) d_j
  void add_directional(const Orders0ToHighest& values, int k, const std::vector<double>& d, double* to) const {
    double binomial = 1.0;  // C(k, j)
    for (int j = 0; j <= k; ++j) {
      add_product(values.F_x, k - j, binomial, d.data() + n_ * index(j), to);
      add_product(values.F_xdot, k - j, binomial, d.data() + n_ * index(j + 1), to);
      binomial *= static_cast<double>(k - j) / (j + 1);
    }
  }

  void add_product(const std::vector<double>& matrices, int order, double factor, const double* d, double* to) const {
    const double* matrix = matrices.data() + m_ * n_ * index(order);
    for (std::size_t j = 0; j < n_; ++j) {
      if (d[j] == 0.0) continue;
      for (std::size_t i = 0; i < m_; ++i) to[i] += factor * d[j] * matrix[i + m_ * j];
    }
  }

  double unit_of(std::size_t position) const { return std::max(std::fabs(jet_[position]), least_unit_); }

  std::optional<DerivativeMismatch> in_space() {
    std::minstd_rand generator(1);
    // If all of x is zero, its size is unknown.
    double largest = 0.0;
    for (std::size_t j = 0; j < n_; ++j) largest = std::max(largest, std::fabs(jet_[j]));
    least_unit_ = largest > 0.0 ? largest : 1.0;
    std::vector<double> d(jet_.size(), 0.0);
    for (std::size_t i = 0; i < n_ * index(highest_ + 2); ++i) {
      const double r = symmetric_random(generator);
      d[i] = unit_of(i) * (r < 0.0 ? -0.5 : 0.5) * (1.0 + std::fabs(r));
    }
    if (unconfirmed_entries(space_line(d)).empty()) return {};
    std::optional<DerivativeMismatch> lowest;
    for (const char which : {'x', 'd'})
      for (std::size_t j = 0; j < n_; ++j) {
        const auto wrong = in_column(which, j);
        if (wrong && (!lowest || wrong->order < lowest->order)) lowest = wrong;
      }
    return lowest;
  }

  std::optional<DerivativeMismatch> in_column(char which, std::size_t j) {
    const std::size_t position = (which == 'x' ? 0 : n_) + j;
    std::vector<double> d(jet_.size(), 0.0);
    d[position] = unit_of(position);
    const SuppliedLine line = space_line(d);
    const auto found = contradictions(line, unconfirmed_entries(line), least_wrong_part);
    for (const LineContradiction& c : found) {
      const int order = c.entry / problem_.m(), row = c.entry % problem_.m();
      if (!counts(row, order)) continue;
      // dF^(k)/dx'_j = k F_x^(k-1) + F_x'^(k)
      const std::size_t at = index(row) + m_ * j;
      const double rest = which == 'd' && order > 0 ? order * here_.F_x[at + m_ * n_ * index(order - 1)] : 0.0;
      return DerivativeMismatch{.function = which,
                                .order = order,
                                .row = row,
                                .column = static_cast<int>(j),
                                .supplied = c.supplied / d[position] - rest,
                                .difference = c.difference / d[position] - rest};
    }
    return {};
  }

  CallbackProblem& problem_;
  double t_;
  std::size_t m_, n_;
  int highest_;
  std::vector<double> jet_;
  double least_unit_ = 1.0;
  Orders0ToHighest here_, there_;
};

}  // namespace

void demand_total_derivatives(CallbackProblem& problem, double t, double toward, const double* derivatives,
                              int max_order) {
  const DerivativeChecking checking(problem);
  const double direction = toward < t ? -1.0 : 1.0;
  const double reach = direction * std::min(std::fabs(toward - t), problem.room(t, direction));
  if (const auto wrong = TotalLines(problem, t, derivatives, max_order).mismatch(reach))
    throw WrongDerivative(*wrong, t, problem.equation_names());
}

}  // namespace sfdae::core
