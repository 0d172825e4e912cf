// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/sparse_lu.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <type_traits>
#include <utility>

#include "linalg/condition.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Nanoseconds of a factorization and of the solutions that come with it, as benchmarks/sparse_factors.cpp measured them
// with OpenBLAS on one thread; only their ratios matter. KLU: with known pivots, the usual case.
constexpr double solutions = 10.0;  // integrations solve 10 to 40 times with each factorization

// b_i := b_i 2^(exponents_i - shift); returns the shift, nonzero only if something would overflow or vanish.
template <class Number>
int scale_in(const std::vector<int>& exponents, Number* b) {
  constexpr int harmless = 300;
  int largest = exponent_of_zero;
  for (std::size_t i = 0; i < exponents.size(); ++i)
    largest = std::max(largest, binary_exponent(b[i]) + exponents[i]);
  const int shift = std::abs(largest) > harmless && largest > exponent_of_zero / 2 ? largest : 0;
  for (std::size_t i = 0; i < exponents.size(); ++i) b[i] = times_power_of_two(b[i], exponents[i] - shift);
  return shift;
}

template <class Number>
void scale_out(const std::vector<int>& exponents, int shift, Number* b) {
  for (std::size_t i = 0; i < exponents.size(); ++i) b[i] = times_power_of_two(b[i], exponents[i] + shift);
}

}  // namespace

template <class Number>
double SparseLu<Number>::Times::of_both() const {
  return factorization + solutions * solution;
}

template <class Number>
typename SparseLu<Number>::Times SparseLu<Number>::dense_times(double n) {
  return {n * (50.0 + 0.3 * n) + 0.033 * (2.0 / 3.0) * n * n * n, n * (10.0 + 0.3 * n)};
}

template <class Number>
typename SparseLu<Number>::Times SparseLu<Number>::band_times(const BandOrder& order) {
  const double n = static_cast<double>(order.row_place.size()), entries = 2.0 * order.lower + order.upper;
  return {n * (40.0 + 1.5 * order.lower) + 0.045 * order.flops(), n * (10.0 + 0.4 * entries)};
}

template <class Number>
typename SparseLu<Number>::Times SparseLu<Number>::klu_times(double n, double fill, double flops) {
  return {2.0 * fill + 0.35 * flops, 5.0 * n + 1.7 * fill};
}

template <class Number>
void SparseLu<Number>::analyze(std::shared_ptr<const SparsePattern> pattern, std::optional<SparseMethod> forced) {
  assert(pattern->first.size() == index(pattern->size) + 1);
  is_factored_ = may_be_regular_ = false;
  pattern_ = std::move(pattern);
  scales_ = Equilibration();
  choose(*pattern_, forced);
}

template <class Number>
void SparseLu<Number>::choose(const SparsePattern& pattern, std::optional<SparseMethod> forced) {
  // KLU's quotients differ from those of std::complex.
  if (std::is_same_v<Number, double> && !forced && pattern.size > 0 && is_diagonal(pattern)) {
    may_be_regular_ = true;
    DiagonalFactors<Number> diagonal;
    diagonal.analyze(pattern);
    times_ = klu_times(pattern.size, static_cast<double>(diagonal.fill()), 0.0);
    factors_ = std::move(diagonal);
    return;
  }
  const std::vector<int> column_of = maximum_matching(pattern);
  may_be_regular_ = std::find(column_of.begin(), column_of.end(), -1) == column_of.end();
  const auto wants = [&](SparseMethod method) { return !forced || *forced == method; };
  DenseFactors<Number> dense;
  dense.analyze(pattern);
  factors_ = std::move(dense);
  times_ = {};
  // A matrix that is never factored needs no other order.
  if (pattern.size == 0 || !may_be_regular_) return;
  times_ = dense_times(pattern.size);
  if (forced == SparseMethod::dense) return;
  if (wants(SparseMethod::band)) {
    BandOrder order = band_order(pattern, column_of);
    const Times times = band_times(order);
    if (forced || times.of_both() < times_.of_both()) {
      times_ = times;
      BandFactors<Number> band;
      band.analyze(pattern, std::move(order));
      factors_ = std::move(band);
    }
  }
  if (forced ? forced == SparseMethod::klu : klu_is_available()) {
    KluFactors<Number> klu;
    klu.analyze(pattern);
    const Times times = klu_times(pattern.size, static_cast<double>(klu.fill()), klu.flops());
    if (forced || times.of_both() < times_.of_both()) {
      times_ = times;
      factors_ = std::move(klu);
    }
  }
}

template <class Number>
Number* SparseLu<Number>::own_values() {
  scaled_.resize(pattern_->row.size());
  return scaled_.data();
}

template <class Number>
bool SparseLu<Number>::factor(const Number* values) {
  is_factored_ = false;
  if (!may_be_regular_ || !all_finite_numbers(values, pattern_->row.size())) return false;
  const SparsePattern& pattern = *pattern_;
  const CompressedLines columns{pattern.size, pattern.size, pattern.first.data(), pattern.row.data()};
  if (!scales_.compute(columns, values)) return false;
  scaled_.resize(pattern.row.size());
  norm_ = 0.0;
  for (int j = 0; j < pattern.size; ++j) {
    double sum = 0.0;
    for (std::size_t k = index(pattern.first[index(j)]); k < index(pattern.first[index(j) + 1]); ++k) {
      scaled_[k] =
          times_power_of_two(values[k], scales_.of_lines()[index(j)] + scales_.of_crossings()[index(pattern.row[k])]);
      sum += std::abs(scaled_[k]);
    }
    norm_ = std::max(norm_, sum);
  }
  is_factored_ = std::visit([&](auto& factors) { return factors.factor(pattern, scaled_.data()); }, factors_);
  return is_factored_;
}

template <class Number>
bool SparseLu<Number>::has_new_pivots() const {
  return std::visit([](const auto& factors) { return factors.has_new_pivots(); }, factors_);
}

template <class Number>
void SparseLu<Number>::forget_pivots() {
  is_factored_ = false;
  std::visit([](auto& factors) { factors.forget_pivots(); }, factors_);
}

// A x = b is S (2^-columns x) = 2^rows b; A^T x = b is S^T (2^-rows x) = 2^columns b.
template <class Number>
void SparseLu<Number>::solve(Op op, Number* b, int count) {
  assert(is_factored_);
  const std::vector<int>& in = op == Op::plain ? scales_.of_crossings() : scales_.of_lines();
  const std::vector<int>& out = op == Op::plain ? scales_.of_lines() : scales_.of_crossings();
  shifts_.resize(std::max(shifts_.size(), index(count)));
  for (int c = 0; c < count; ++c) shifts_[index(c)] = scale_in(in, b + index(c) * index(pattern_->size));
  std::visit([&](auto& factors) { factors.solve(op, b, count); }, factors_);
  for (int c = 0; c < count; ++c) scale_out(out, shifts_[index(c)], b + index(c) * index(pattern_->size));
}

template <class Number>
double SparseLu<Number>::reciprocal_condition() {
  if (!is_factored_) return 0.0;
  if (pattern_->size == 0) return 1.0;
  const QuietArithmetic quiet;
  const double inverse_norm = std::visit(
      [&](auto& factors) {
        return estimate_inverse_norm<Number>(
            pattern_->size, [&](Number* x) { factors.solve(Op::plain, x, 1); },
            [&](Number* x) { factors.solve(Op::transposed, x, 1); });
      },
      factors_);
  // Also where the estimate is NaN.
  return inverse_norm > 0.0 ? 1.0 / norm_ / inverse_norm : 0.0;
}

template <class Number>
Determinant<Number> SparseLu<Number>::determinant() const {
  assert(is_factored_);
  Determinant<Number> determinant = std::visit([](const auto& factors) { return factors.determinant(); }, factors_);
  for (const std::vector<int>* exponents : {&scales_.of_lines(), &scales_.of_crossings()})
    for (int exponent : *exponents) determinant.log2 -= exponent;
  return determinant;
}

template <class Number>
std::size_t SparseLu<Number>::fill() const {
  return std::visit([](const auto& factors) { return factors.fill(); }, factors_);
}

template class SparseLu<double>;
template class SparseLu<std::complex<double>>;

}  // namespace sfdae::core
