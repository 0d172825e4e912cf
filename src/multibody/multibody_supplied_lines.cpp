// Derivatives that callbacks of a mechanical system supply, compared with their functions from one side.
//
//     g_q d + g_t    of g        along (t + s, q + s d), d at random; then along each q_j and t, where a row is wrong
//     gamma, eta     of C v + r  along (t + s, q + s S v), v held, C v + r as it is at the start
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_supplied_lines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/random.h"
#include "problem/supplied_line.h"

namespace sfdae::core {

namespace {

class Lines {
 public:
  Lines(CallbackMultibody& problem, const MultibodyCheckPoint& point)
      : problem_(problem),
        t_(point.t),
        q_(point.q, point.q + sizes().positions),
        v_(point.v, point.v + sizes().velocities),
        least_gap_(point.least_gap),
        here_(sizes()),
        there_(sizes()),
        moved_q_(q_) {
    const double direction = point.toward < t_ ? -1.0 : 1.0;
    reach_ = direction * std::min(std::fabs(point.toward - t_), problem.room(t_, direction));
  }

  std::optional<DerivativeMismatch> mismatch() {
    if (sizes().constraints() == 0 || !evaluate(t_, q_, v_, here_)) return {};
    const bool has_positions = sizes().holonomic > 0;
    if (has_positions && !is_confirmed())
      if (const auto wrong = of_positions()) return wrong;
    const std::vector<double> given_v(v_);
    const auto wrong = of_velocities();
    if (!wrong || !has_positions) return wrong;
    // Curvatures are compared only if gradients are right: here one by one.
    v_ = given_v;
    if (!evaluate(t_, q_, v_, here_)) return wrong;
    const auto cause = of_positions();
    return cause ? cause : wrong;
  }

 private:
  const MultibodySizes& sizes() const { return problem_.sizes(); }

  bool evaluate(double t, const std::vector<double>& q, const std::vector<double>& v, MultibodyTerms& terms) {
    const CallbackError error = problem_.constraint_terms(t, q.data(), v.data(), terms);
    if (error.status == SFDAE_CALLBACK_STOPPED || error.status == SFDAE_STOPPED) error.raise();
    return error.status == SFDAE_OK;
  }

  // d; time passes along it if time_passes.
  struct Direction {
    std::vector<double> d;
    bool time_passes;
  };

  // g and g_q d + g_t along a direction; the parameter scales d, and the time if it passes.
  SuppliedLine position_line(const Direction& along) {
    const int nl = sizes().holonomic;
    const auto write = [this, nl, &along](const MultibodyTerms& terms, double* values) {
      std::copy_n(terms.g.begin(), nl, values);
      multiply(1.0, Op::plain, terms.g_q, along.d.data(), 0.0, values + nl);
      for (int i = 0; i < nl && along.time_passes; ++i) values[nl + i] += reach_ * terms.velocity_rest[index(i)];
    };
    SuppliedLine line{nl, nl, 0.0, 1.0, {}, std::vector<double>(index(2 * nl))};
    write(here_, line.base.data());
    // Values near zero on the constraints are differences of terms of this size.
    line.terms.resize(index(nl), 0.0);
    for (int j = 0; j < sizes().positions; ++j)
      for (int i = 0; i < nl; ++i) line.terms[index(i)] += std::fabs(here_.g_q(i, j) * q_[index(j)]);
    line.evaluate = [this, &along, write](double s, double* values) {
      for (std::size_t j = 0; j < q_.size(); ++j) moved_q_[j] = q_[j] + s * along.d[j];
      const double t = along.time_passes ? t_ + s * reach_ : t_;
      const CallbackError error = problem_.constraint_terms(t, moved_q_.data(), v_.data(), there_);
      if (error.status == SFDAE_OK) write(there_, values);
      return error;
    };
    return line;
  }

  // Positions are lengths and angles of unknown sizes: each moves by its value, and those near zero by a fraction of
  // the largest one (by judgement).
  double unit_of(std::size_t j) const {
    constexpr double part = 1e-3;
    const double largest = max_abs(q_.data(), sizes().positions);
    return largest > 0.0 ? std::max(std::fabs(q_[j]), part * largest) : 1.0;
  }

  bool has_rate() const { return problem_.functions().constraint_rate != nullptr; }

  // Tests one random direction.
  bool is_confirmed() {
    std::minstd_rand generator(1);
    Direction direction{q_, has_rate()};
    for (std::size_t j = 0; j < q_.size(); ++j) direction.d[j] = unit_of(j) * away_from_zero(generator);
    return unconfirmed_entries(position_line(direction)).empty();
  }

  std::optional<DerivativeMismatch> of_positions() {
    for (std::size_t j = 0; j < q_.size(); ++j) {
      Direction column{std::vector<double>(q_.size(), 0.0), false};
      column.d[j] = unit_of(j);
      if (const auto wrong = worst_on(position_line(column), {'G', static_cast<int>(j), column.d[j]})) return wrong;
    }
    if (!has_rate()) return {};
    const Direction in_time{std::vector<double>(q_.size(), 0.0), true};
    return worst_on(position_line(in_time), {'T', 0, reach_});
  }

  // A random number of 0.5 to 1, of either sign.
  static double away_from_zero(std::minstd_rand& generator) {
    const double r = symmetric_random(generator);
    return (r < 0.0 ? -0.5 : 0.5) * (1.0 + std::fabs(r));
  }

  // Row and column that a line tests; unit: derivatives along the line are those by the unknown times it.
  struct Subject {
    char function;
    int column;
    double unit;
  };

  std::optional<DerivativeMismatch> worst_on(const SuppliedLine& line, const Subject& subject) const {
    const LineContradiction* worst = nullptr;
    const auto found = contradictions(line, unconfirmed_entries(line), least_gap_);
    for (const LineContradiction& c : found)
      if (worst == nullptr || c.strength > worst->strength) worst = &c;
    if (worst == nullptr) return {};
    return DerivativeMismatch{.function = subject.function,
                              .order = 1,
                              .row = worst->entry,
                              .column = subject.column,
                              .supplied = worst->supplied / subject.unit,
                              .difference = worst->difference / subject.unit};
  }

  // Nonzero velocities that fulfil the constraints as well as the given ones do.
  std::vector<double> general_velocity() const {
    // Relative threshold for directions that the constraints leave free; rows are the user's, without scaling.
    constexpr double rounding = 1e-10;
    std::minstd_rand generator(1);
    double size =
        std::max(max_abs(v_.data(), sizes().velocities), max_abs(q_.data(), sizes().positions) / std::fabs(reach_));
    if (!(size > 0.0 && size < 1e100)) size = 1.0;
    std::vector<double> w(v_.size()), normal(index(sizes().constraints()));
    for (double& component : w) component = size * away_from_zero(generator);
    multiply(1.0, Op::plain, here_.C, w.data(), 0.0, normal.data());
    const std::vector<double> part = least_squares(here_.C, normal, rounding * max_abs(here_.C));
    for (std::size_t j = 0; j < w.size(); ++j) w[j] += v_[j] - part[j];
    return w;
  }

  std::optional<DerivativeMismatch> of_velocities() {
    const int nl = sizes().holonomic, count = sizes().constraints();
    const sfdae_multibody_problem& given = problem_.functions();
    const bool has_gamma = nl > 0 && given.constraint_curvature != nullptr;
    const bool has_eta = count > nl && given.nonholonomic_curvature != nullptr;
    if (!has_gamma && !has_eta) return {};
    v_ = general_velocity();
    if (!evaluate(t_, q_, v_, here_)) return {};
    std::vector<double> rates(v_);
    if (problem_.has_kinematics()) {
      rates.resize(q_.size());
      multiply(1.0, Op::plain, here_.S, v_.data(), 0.0, rates.data());
    }
    const auto write = [&](const MultibodyTerms& terms, double* values) {
      std::copy_n(terms.velocity_rest.begin(), count, values);
      multiply(1.0, Op::plain, terms.C, v_.data(), 1.0, values);
      std::copy_n(terms.acceleration_rest.begin(), count, values + count);
      // Functions that are not given are not compared.
      if (!has_gamma) std::fill_n(values, nl, 0.0);
      if (!has_eta) std::fill_n(values + nl, count - nl, 0.0);
    };
    SuppliedLine line{count, count, t_, reach_, {}, std::vector<double>(index(2 * count))};
    write(here_, line.base.data());
    for (int i = 0; i < count; ++i) line.terms.push_back(std::fabs(here_.velocity_rest[index(i)]));
    for (int j = 0; j < sizes().velocities; ++j)
      for (int i = 0; i < count; ++i) line.terms[index(i)] += std::fabs(here_.C(i, j) * v_[index(j)]);
    line.evaluate = [&](double s, double* values) {
      for (std::size_t j = 0; j < q_.size(); ++j) moved_q_[j] = q_[j] + s * rates[j];
      const CallbackError error = problem_.constraint_terms(t_ + s, moved_q_.data(), v_.data(), there_);
      if (error.status == SFDAE_OK) write(there_, values);
      return error;
    };
    auto wrong = worst_on(line, {'C', 0, 1.0});
    if (wrong && wrong->row >= nl) {
      wrong->function = 'H';
      wrong->row -= nl;
    }
    return wrong;
  }

  CallbackMultibody& problem_;
  double t_, reach_ = 0.0;
  std::vector<double> q_, v_;
  double least_gap_;
  MultibodyTerms here_, there_;
  std::vector<double> moved_q_;
};

}  // namespace

void demand_derivatives(CallbackMultibody& problem, const MultibodyCheckPoint& point) {
  const DerivativeChecking checking(problem);
  if (const auto wrong = Lines(problem, point).mismatch()) throw WrongDerivative(*wrong, point.t);
}

}  // namespace sfdae::core
