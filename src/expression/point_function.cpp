// Power series of functions that are known by their partial derivatives: Taylor's formula in several variables,
//     f(a + d) = sum over multi-indices alpha of  D^alpha f(a) / alpha!  d^alpha,   d = a_1 s + a_2 s^2 + ...
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/point_function.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "expression/series.h"
#include "linalg/index.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

namespace {

using series::highest_order;

// All partial derivatives of an order.
class Tensor {
 public:
  explicit Tensor(const PointFunction& function) : function_(function) {}

  // Returns the function's result, or a code of its own.
  int load(int order, const double* arguments) {
    size_ = 1;
    for (int i = 0; i < order; ++i) {
      size_ *= index(function_.num_arguments());
      if (size_ > PointFunction::max_derivatives) return SFDAE_ORDER_NOT_AVAILABLE;
    }
    std::fill_n(values_.begin(), size_, 0.0);
    return function_.derivatives(order, arguments, values_.data());
  }
  bool is_finite() const {
    return std::all_of(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(size_),
                       [](double value) { return std::isfinite(value); });
  }
  // Slice of derivatives by `first`, then by all others; or by `first` and one more argument.
  const double* slice(const std::vector<int>& first) const { return values_.data() + place_of(first).offset; }
  const double* slice(const std::vector<int>& first, int next) const {
    const Place place = place_of(first);
    return values_.data() + place.offset + index(next) * (place.size / index(function_.num_arguments()));
  }

 private:
  struct Place {
    std::size_t offset, size;
  };
  Place place_of(const std::vector<int>& first) const {
    Place place{0, size_};
    for (int by : first) {
      place.size /= index(function_.num_arguments());
      place.offset += index(by) * place.size;
    }
    return place;
  }

  const PointFunction& function_;
  std::array<double, PointFunction::max_derivatives> values_;
  std::size_t size_ = 0;
};

// Adds the terms of one order m of Taylor's formula to a series.
class Terms {
 public:
  Terms(int num_arguments, const CallSeries& call, int order) : k_(num_arguments), call_(call), K_(order) {
    products_[0].fill(0.0);
    products_[0][0] = 1.0;
  }

  void add(const double* derivatives, int m, double* sum) {
    derivatives_ = derivatives;
    m_ = m;
    sum_ = sum;
    descend({0, 0, 0, 0, 1.0});
  }

 private:
  // Nondecreasing indices so far; each multi-index has one such sequence.
  struct Place {
    int depth, last, repeated;
    std::size_t offset;
    double weight;  // 1 / alpha!
  };

  void descend(const Place& place) {
    if (place.depth == m_) {
      const double factor = place.weight * derivatives_[place.offset];
      if (factor == 0.0) return;
      const auto& product = products_[index(m_)];
      for (int i = m_; i <= K_; ++i) sum_[i] += factor * product[index(i)];
      return;
    }
    for (int i = place.last; i < k_; ++i) {
      const int repeated = i == place.last ? place.repeated + 1 : 1;
      multiply(place.depth, call_.arguments + i * call_.stride);
      descend({place.depth + 1, i, repeated, place.offset * index(k_) + index(i), place.weight / repeated});
    }
  }

  // Coefficients below order depth + 1 of a product of depth + 1 factors vanish.
  void multiply(int depth, const double* argument) {
    const auto& from = products_[index(depth)];
    auto& to = products_[index(depth + 1)];
    for (int i = depth + 1; i <= K_; ++i) {
      double sum = 0.0;
      for (int j = 1; j <= i - depth; ++j) sum += argument[j] * from[index(i - j)];
      to[index(i)] = sum;
    }
  }

  int k_;
  CallSeries call_;
  int K_;
  std::array<std::array<double, highest_order + 1>, highest_order + 2> products_;
  const double* derivatives_ = nullptr;
  int m_ = 0;
  double* sum_ = nullptr;
};

// False if an argument is not finite.
bool load_point(const CallSeries& series, int num_arguments, double* point) {
  for (int i = 0; i < num_arguments; ++i) {
    point[i] = series.arguments[i * series.stride];
    if (!std::isfinite(point[i])) return false;
  }
  return true;
}

bool is_constant(const CallSeries& series, int num_arguments, int order) {
  for (int i = 0; i < num_arguments; ++i)
    for (int j = 1; j <= order; ++j)
      if (series.arguments[i * series.stride + j] != 0.0) return false;
  return true;
}

}  // namespace

void evaluate(const FunctionCall& call, const CallSeries& series, int order) {
  const int k = call.function->num_arguments(), given = static_cast<int>(call.by.size());
  const auto slope = [&](int i) { return series.slopes + i * series.stride; };
  // Terms of order m in d contribute to coefficients from m on, and to those of slopes from m - 1 on.
  const auto poison_from = [&](int m) {
    series::poison(series.value, m, order);
    if (series.slopes != nullptr)
      for (int i = 0; i < k; ++i) series::poison(slope(i), std::max(m - 1, 0), order);
  };
  std::array<double, PointFunction::max_arguments> point{};
  if (!load_point(series, k, point.data())) return poison_from(0);
  for (int j = 0; j <= order; ++j) series.value[j] = 0.0;
  if (series.slopes != nullptr)
    for (int i = 0; i < k; ++i)
      for (int j = 0; j <= order; ++j) slope(i)[j] = 0.0;
  Tensor tensor(*call.function);
  Terms terms(k, series, order);
  const int last = is_constant(series, k, order) ? 0 : order;
  for (int m = 0; m <= last + (series.slopes != nullptr ? 1 : 0); ++m) {
    if (tensor.load(given + m, point.data()) != 0 || !tensor.is_finite()) return poison_from(m);
    if (m <= last) terms.add(tensor.slice(call.by), m, series.value);
    if (series.slopes == nullptr || m == 0) continue;
    for (int i = 0; i < k; ++i) terms.add(tensor.slice(call.by, i), m - 1, slope(i));
  }
}

MissingOrder missing_order(const FunctionCall& call, const double* arguments, int order) {
  Tensor tensor(*call.function);
  const int given = static_cast<int>(call.by.size());
  for (int m = given; m <= given + order; ++m)
    if (const int code = tensor.load(m, arguments)) return {code, m};
  return {};
}

}  // namespace sfdae::core
