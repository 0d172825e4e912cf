// Error estimate of BDF.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/bdf_error_estimate.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// Orders k - 2 ... k + 1.
constexpr std::size_t most_orders = 4;

// Error constant of a step of order k: error divided by the difference between w and its predictor of degree k.
double error_constant(const BdfHistory& history, const BdfStep& step) {
  const int k = step.order;
  double constant = step.h / (step.t - history.time(k));
  if (step.has_fixed_leading) {
    double alpha0 = 0.0;
    for (int i = 0; i < k; ++i) alpha0 += step.h / (step.t - history.time(i));
    constant = std::max(constant, std::fabs(constant - bdf_alpha[k] + alpha0));
  }
  return constant;
}

class ErrorOfX final : public ErrorMap {
 public:
  ErrorOfX(StrangenessFreeSystem& system, const ErrorWeights& weights) : system_(system), weights_(weights) {}
  void map(const double* differences, int count, double* mapped) override {
    system_.error_in_x(differences, count, mapped);
  }
  double norm(const double* mapped) const override { return weights_.norm(mapped); }

 private:
  StrangenessFreeSystem& system_;
  const ErrorWeights& weights_;
};

}  // namespace

void BdfErrorEstimate::resize(std::size_t n, std::size_t size_w, bool in_place) {
  difference_.assign(size_w, 0.0);
  error_.assign(n, 0.0);
  differences_.assign(most_orders * size_w, 0.0);
  mapped_.assign(in_place ? 0 : most_orders * n, 0.0);
}

double BdfErrorEstimate::estimate(StrangenessFreeSystem& system, const BdfHistory& history, const Judged& judged,
                                  const ErrorWeights& weights, LocalTerms& terms) {
  if (system.differential() > 0) {
    ErrorOfX map(system, weights);
    return estimate(map, history, judged, terms);
  }
  std::fill(std::begin(terms.of_order), std::end(terms.of_order), -1.0);
  std::fill_n(error_.data(), error_.size(), 0.0);
  std::fill_n(terms.of_order, judged.step.order + 1, 0.0);
  return 0.0;
}

// The difference between w and its predictor of degree q is prod_{i<=q} (t - t_i) times a divided difference of order q
// + 1. It gives the local terms of the orders around k and the error of the formula.
double BdfErrorEstimate::estimate(ErrorMap& errors, const BdfHistory& history, const Judged& judged,
                                  LocalTerms& terms) {
  const BdfStep& step = judged.step;
  const int k = step.order;
  std::fill(std::begin(terms.of_order), std::end(terms.of_order), -1.0);
  const std::size_t size = history.size_w(), n = error_.size();
  const int first = std::max(1, k - 2),
            last = std::min(judged.may_rise ? k + 1 : k, std::min(history.points(), k + 3) - 1);
  // Column q - first of differences_: w minus its predictor of degree q.
  double factors[max_bdf_order + 2];
  std::copy_n(step.w.data(), size, difference_.data());
  double product = 1.0, factorial = 1.0;
  for (int q = 0; q <= last; ++q) {
    const std::vector<double>& divided = history.difference(q);
    for (std::size_t i = 0; i < size; ++i) difference_[i] -= product * divided[i];
    product *= step.t - history.time(q);
    factorial *= (q > 0 ? q : 1) * step.h;  // q! h^(q+1)
    factors[q] = factorial / product;
    if (q >= first) std::copy_n(difference_.data(), size, differences_.data() + size * index(q - first));
  }
  double* const mapped = mapped_.empty() ? differences_.data() : mapped_.data();
  const auto map = [&](int from, int to) {
    const std::size_t column = index(from - first);
    errors.map(differences_.data() + size * column, to - from + 1, mapped + n * column);
    for (int q = from; q <= to; ++q) terms.of_order[q] = factors[q] * errors.norm(mapped + n * index(q - first));
  };
  map(std::max(first, k - 1), last);
  // The term of order k - 2 matters only if that of order k - 1 suggests a lower order, too.
  if (first < k - 1 && can_lower_order(k, terms)) map(first, k - 2);
  std::copy_n(mapped + n * index(k - first), n, error_.data());
  return error_constant(history, step) * errors.norm(error_.data());
}

}  // namespace sfdae::core
