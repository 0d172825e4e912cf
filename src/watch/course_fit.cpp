// Least-squares polynomials through points of a solution.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/course_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Higher degrees amplify roundoff and step errors too much outside the nodes. (Chosen.)
constexpr std::size_t highest_degree = 6;

}  // namespace

// p_0 = 1, p_(k+1) = (s - alpha_k) p_k - beta_k p_(k-1), orthogonal over the nodes [F57].
CourseFit::CourseFit(const std::vector<const Trail::Node*>& nodes) {
  const std::size_t m = nodes.size();
  n_ = nodes.front()->x.size();
  origin_ = nodes.front()->t;
  unit_ = nodes.back()->t - origin_;
  const std::size_t terms = std::min(highest_degree + 1, m - 1);
  coefficients_.resize(n_ * terms);
  deviations_.resize(n_ * terms);
  std::vector<double> s(m), p(m, 1.0), before(m, 0.0), residual(n_ * m);
  for (std::size_t r = 0; r < m; ++r) {
    s[r] = scaled(nodes[r]->t);
    std::copy(nodes[r]->x.begin(), nodes[r]->x.end(), residual.begin() + static_cast<std::ptrdiff_t>(r * n_));
  }
  for (std::size_t k = 0; k < terms; ++k) {
    double gamma = 0.0, moment = 0.0;
    for (std::size_t r = 0; r < m; ++r) gamma += p[r] * p[r], moment += s[r] * p[r] * p[r];
    alpha_.push_back(moment / gamma);
    beta_.push_back(k == 0 ? 0.0 : gamma / gamma_.back());
    gamma_.push_back(gamma);
    for (std::size_t i = 0; i < n_; ++i) {
      double c = 0.0, sum = 0.0;
      for (std::size_t r = 0; r < m; ++r) c += residual[r * n_ + i] * p[r];
      c /= gamma;
      for (std::size_t r = 0; r < m; ++r) {
        residual[r * n_ + i] -= c * p[r];
        sum += residual[r * n_ + i] * residual[r * n_ + i];
      }
      coefficients_[k * n_ + i] = c;
      deviations_[k * n_ + i] = std::sqrt(sum / static_cast<double>(m - k - 1 > 0 ? m - k - 1 : 1));
    }
    for (std::size_t r = 0; r < m; ++r) {
      const double next = (s[r] - alpha_[k]) * p[r] - beta_[k] * before[r];
      before[r] = p[r];
      p[r] = next;
    }
  }
}

CourseFit::Accuracy CourseFit::accuracy(std::size_t i, double t) const {
  Accuracy best{0, std::numeric_limits<double>::infinity()};
  const double s = scaled(t);
  double p = 1.0, before = 0.0, variance = 0.0;
  for (std::size_t k = 0; k + 1 < alpha_.size(); ++k) {
    variance += p * p / gamma_[k];
    const double next = (s - alpha_[k]) * p - beta_[k] * before;
    const double error =
        std::fabs(coefficients_[(k + 1) * n_ + i] * next) + deviations_[k * n_ + i] * std::sqrt(variance);
    if (error < best.error) best = {static_cast<int>(k), error};
    before = p;
    p = next;
  }
  return best;
}

CourseFit::Value CourseFit::evaluate(std::size_t i, int degree, double t) const {
  const double s = scaled(t);
  double p = 1.0, before = 0.0, slope = 0.0, slope_before = 0.0;
  Value value{0.0, 0.0};
  for (std::size_t k = 0; k <= index(degree); ++k) {
    const double c = coefficients_[k * n_ + i];
    value.x += c * p;
    value.xdot += c * slope;
    const double next = (s - alpha_[k]) * p - beta_[k] * before,
                 slope_next = p + (s - alpha_[k]) * slope - beta_[k] * slope_before;
    before = p, slope_before = slope;
    p = next, slope = slope_next;
  }
  value.xdot /= unit_;
  return value;
}

}  // namespace sfdae::core
