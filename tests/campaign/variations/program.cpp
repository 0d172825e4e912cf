// SPDX-License-Identifier: BSD-3-Clause
#include "program.h"

#include <algorithm>
#include <cmath>

namespace campaign {

Program::Program(const Formulas& formulas, const std::vector<Formula>& roots, Purpose purpose)
    : formulas_(&formulas) {
  const auto node_of = [&](int k) {
    Node node = formulas.node(k);
    if (purpose == Purpose::recording && node.operation == Operation::opaque) node.b = -1;
    return node;
  };
  std::vector<int> place(static_cast<std::size_t>(formulas.size()), -1);
  const auto at = [](auto& entries, int k) -> auto& { return entries[static_cast<std::size_t>(k)]; };
  std::vector<char> needed(place.size(), 0);
  for (const Formula& root : roots) at(needed, root.node) = 1;
  for (int k = formulas.size() - 1; k >= 0; --k) {
    if (!at(needed, k)) continue;
    const Node node = node_of(k);
    for (int argument : {node.a, node.b, node.c, node.d})
      if (argument >= 0) at(needed, argument) = 1;
  }
  for (int k = 0; k < formulas.size(); ++k) {
    if (!at(needed, k)) continue;
    Node node = node_of(k);
    for (int* argument : {&node.a, &node.b, &node.c, &node.d})
      if (*argument >= 0) *argument = at(place, *argument);
    at(place, k) = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
  }
  for (const Formula& root : roots) roots_.push_back(at(place, root.node));
  work_.resize(nodes_.size());
}

namespace {

struct Point {
  double t;
  const double *x, *slopes;
};

double value_of(const Node& node, const Formulas& formulas, const std::vector<double>& w, const Point& point) {
  const double a = node.a >= 0 ? w[static_cast<std::size_t>(node.a)] : 0.0;
  const double b = node.b >= 0 ? w[static_cast<std::size_t>(node.b)] : 0.0;
  switch (node.operation) {
    case Operation::number: return node.value;
    case Operation::time: return point.t;
    case Operation::unknown: return point.x[node.index];
    case Operation::slope: return point.slopes[node.index];
    case Operation::add: return a + b;
    case Operation::subtract: return a - b;
    case Operation::multiply: return a * b;
    case Operation::divide: return a / b;
    case Operation::power: return std::pow(a, node.index);
    case Operation::exp: return std::exp(a);
    case Operation::sqrt: return std::sqrt(a);
    case Operation::sin: return std::sin(a);
    case Operation::cos: return std::cos(a);
    case Operation::tanh: return std::tanh(a);
    case Operation::atan: return std::atan(a);
    case Operation::sinh: return std::sinh(a);
    case Operation::cosh: return std::cosh(a);
    case Operation::abs: return std::abs(a);
    case Operation::minimum: return a < b ? a : b;
    case Operation::maximum: return a < b ? b : a;
    case Operation::choose: return w[static_cast<std::size_t>(a < b ? node.c : node.d)];
    case Operation::table: return formulas.splines()[static_cast<std::size_t>(node.index)].derivative(a, node.order);
    case Operation::opaque: return b;
  }
  return 0.0;
}

}  // namespace

void Program::evaluate(double t, const double* x, const double* slopes, double* values) const {
  const Point point{t, x, slopes};
  for (std::size_t k = 0; k < nodes_.size(); ++k) work_[k] = value_of(nodes_[k], *formulas_, work_, point);
  for (std::size_t i = 0; i < roots_.size(); ++i) values[i] = work_[static_cast<std::size_t>(roots_[i])];
}

namespace {

TaylorSeries constant(double value) {
  TaylorSeries series{};
  series[0] = value;
  return series;
}

TaylorSeries sum(const TaylorSeries& a, double factor, const TaylorSeries& b, int order) {
  TaylorSeries result = a;
  add_multiple(result, factor, b, order);
  return result;
}

TaylorSeries product(const TaylorSeries& a, const TaylorSeries& b, int order) {
  TaylorSeries result{};
  add_product(result, a, b, order);
  return result;
}

TaylorSeries quotient(const TaylorSeries& a, const TaylorSeries& b, int order) {
  TaylorSeries q{};
  for (int k = 0; k <= order; ++k) {
    double rest = coefficient(a, k);
    for (int j = 0; j < k; ++j) rest -= coefficient(q, j) * coefficient(b, k - j);
    coefficient(q, k) = rest / b[0];
  }
  return q;
}

TaylorSeries root(const TaylorSeries& a, int order) {
  TaylorSeries s{};
  s[0] = std::sqrt(a[0]);
  for (int k = 1; k <= order; ++k) {
    double rest = coefficient(a, k);
    for (int j = 1; j < k; ++j) rest -= coefficient(s, j) * coefficient(s, k - j);
    coefficient(s, k) = rest / (2.0 * s[0]);
  }
  return s;
}

// y with y' = p a', where p is made order by order from y and its companion z, z' = q a'.
struct Pair {
  TaylorSeries y{}, z{};
};

// y' = z a', z' = sign y a': exponential functions and their kind.
Pair circular(const TaylorSeries& a, double y0, double z0, double sign, int order) {
  Pair pair;
  pair.y[0] = y0;
  pair.z[0] = z0;
  for (int k = 1; k <= order; ++k) {
    double y = 0.0, z = 0.0;
    for (int j = 1; j <= k; ++j) {
      y += j * coefficient(a, j) * coefficient(pair.z, k - j);
      z += j * coefficient(a, j) * coefficient(pair.y, k - j);
    }
    coefficient(pair.y, k) = y / k;
    coefficient(pair.z, k) = sign * z / k;
  }
  return pair;
}

// y' = (1 - y^2) a'.
TaylorSeries hyperbolic_tangent(const TaylorSeries& a, int order) {
  TaylorSeries y{};
  y[0] = std::tanh(a[0]);
  for (int k = 1; k <= order; ++k) {
    const TaylorSeries p = sum(constant(1.0), -1.0, product(y, y, k - 1), k - 1);
    double rest = 0.0;
    for (int j = 1; j <= k; ++j) rest += j * coefficient(a, j) * coefficient(p, k - j);
    coefficient(y, k) = rest / k;
  }
  return y;
}

// y' = a' / (1 + a^2).
TaylorSeries arc_tangent(const TaylorSeries& a, int order) {
  const TaylorSeries slope = quotient(derivative(a), sum(constant(1.0), 1.0, product(a, a, order), order), order);
  TaylorSeries y{};
  y[0] = std::atan(a[0]);
  for (int k = 1; k <= order; ++k) coefficient(y, k) = coefficient(slope, k - 1) / k;
  return y;
}

TaylorSeries whole_power(const TaylorSeries& a, int exponent, int order) {
  TaylorSeries result = constant(1.0), square = a;
  for (int rest = exponent; rest > 0; rest /= 2) {
    if (rest % 2 == 1) result = product(result, square, order);
    square = product(square, square, order);
  }
  return result;
}

TaylorSeries table_series(const Spline& spline, int table_order, const TaylorSeries& a, int order) {
  TaylorSeries shifted = a, result{};
  double origin = 0.0;
  const std::array<double, 4>& c = spline.piece(a[0], origin);
  shifted[0] -= origin;
  for (int k = 3; k >= table_order; --k) {
    double factor = 1.0;
    for (int j = 0; j < table_order; ++j) factor *= k - j;
    result = product(result, shifted, order);
    result[0] += factor * c[static_cast<std::size_t>(k)];
  }
  return result;
}

TaylorSeries function_series(const Node& node, const TaylorSeries& a, int order) {
  const double a0 = a[0];
  switch (node.operation) {
    case Operation::power: return whole_power(a, node.index, order);
    case Operation::exp: return circular(a, std::exp(a0), std::exp(a0), 1.0, order).y;
    case Operation::sqrt: return root(a, order);
    case Operation::sin: return circular(a, std::sin(a0), std::cos(a0), -1.0, order).y;
    case Operation::cos: return circular(a, std::sin(a0), std::cos(a0), -1.0, order).z;
    case Operation::sinh: return circular(a, std::sinh(a0), std::cosh(a0), 1.0, order).y;
    case Operation::cosh: return circular(a, std::sinh(a0), std::cosh(a0), 1.0, order).z;
    case Operation::tanh: return hyperbolic_tangent(a, order);
    case Operation::atan: return arc_tangent(a, order);
    case Operation::abs: return sum(constant(0.0), a0 < 0.0 ? -1.0 : 1.0, a, order);
    default: return constant(0.0);
  }
}

}  // namespace

void Program::expand(int order, const TaylorSeries& t, const std::vector<TaylorSeries>& x,
                     const std::vector<TaylorSeries>& slopes, std::vector<TaylorSeries>& values) const {
  series_.resize(nodes_.size());
  const auto at = [](const auto& entries, int k) -> const auto& { return entries[static_cast<std::size_t>(k)]; };
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Node& node = nodes_[k];
    const auto a = [&]() -> const TaylorSeries& { return at(series_, node.a); };
    const auto b = [&]() -> const TaylorSeries& { return at(series_, node.b); };
    TaylorSeries& y = series_[k];
    switch (node.operation) {
      case Operation::number: y = constant(node.value); break;
      case Operation::time: y = t; break;
      case Operation::unknown: y = at(x, node.index); break;
      case Operation::slope: y = at(slopes, node.index); break;
      case Operation::add: y = sum(a(), 1.0, b(), order); break;
      case Operation::subtract: y = sum(a(), -1.0, b(), order); break;
      case Operation::multiply: y = product(a(), b(), order); break;
      case Operation::divide: y = quotient(a(), b(), order); break;
      case Operation::minimum: y = a()[0] < b()[0] ? a() : b(); break;
      case Operation::maximum: y = a()[0] < b()[0] ? b() : a(); break;
      case Operation::choose: y = at(series_, a()[0] < b()[0] ? node.c : node.d); break;
      case Operation::opaque: y = b(); break;
      case Operation::table: y = table_series(at(formulas_->splines(), node.index), node.order, a(), order); break;
      default: y = function_series(node, a(), order); break;
    }
  }
  values.resize(roots_.size());
  for (std::size_t i = 0; i < roots_.size(); ++i) values[i] = at(series_, roots_[i]);
}

namespace {

// Derivatives of an opaque function of one argument, each order by its Taylor series.
int call_opaque(int order, const double* arguments, double* derivatives, void* user) {
  const auto& function = *static_cast<const OpaqueFunction*>(user);
  if (order > highest_taylor_order) return SFDAE_ORDER_NOT_AVAILABLE;
  const Program program(*function.formulas, {{function.formulas.get(), function.root}});
  std::vector<TaylorSeries> argument(1), values;
  argument[0] = TaylorSeries{arguments[0], 1.0};
  program.expand(order, constant(0.0), argument, {}, values);
  double factor = 1.0;
  for (int k = 2; k <= order; ++k) factor *= k;
  derivatives[0] = factor * coefficient(values[0], order);
  return 0;
}

using Unary = sfdae_expression (*)(sfdae_expression);

Unary unary_of(Operation operation) {
  switch (operation) {
    case Operation::exp: return sfdae_exp;
    case Operation::sqrt: return sfdae_sqrt;
    case Operation::sin: return sfdae_sin;
    case Operation::cos: return sfdae_cos;
    case Operation::tanh: return sfdae_tanh;
    case Operation::atan: return sfdae_atan;
    case Operation::sinh: return sfdae_sinh;
    case Operation::cosh: return sfdae_cosh;
    default: return sfdae_abs;
  }
}

}  // namespace

std::vector<sfdae_expression> Program::record(sfdae_expression t, const std::vector<sfdae_expression>& x,
                                              const std::vector<sfdae_expression>& slopes) const {
  const auto at = [](const auto& entries, int k) -> const auto& { return entries[static_cast<std::size_t>(k)]; };
  std::vector<sfdae_expression> w;
  for (const Node& node : nodes_) {
    const sfdae_expression a = node.a >= 0 ? at(w, node.a) : t;
    const sfdae_expression b = node.b >= 0 ? at(w, node.b) : t;
    switch (node.operation) {
      case Operation::number: w.push_back(sfdae_number(node.value)); break;
      case Operation::time: w.push_back(t); break;
      case Operation::unknown: w.push_back(at(x, node.index)); break;
      case Operation::slope: w.push_back(at(slopes, node.index)); break;
      case Operation::add: w.push_back(sfdae_add(a, b)); break;
      case Operation::subtract: w.push_back(sfdae_subtract(a, b)); break;
      case Operation::multiply: w.push_back(sfdae_multiply(a, b)); break;
      case Operation::divide: w.push_back(sfdae_divide(a, b)); break;
      case Operation::power: w.push_back(sfdae_power(a, sfdae_number(node.index))); break;
      case Operation::minimum: w.push_back(sfdae_min(a, b)); break;
      case Operation::maximum: w.push_back(sfdae_max(a, b)); break;
      case Operation::choose: w.push_back(sfdae_choose(sfdae_less(a, b), at(w, node.c), at(w, node.d))); break;
      case Operation::table: {
        const Spline& spline = at(formulas_->splines(), node.index);
        w.push_back(
            sfdae_table(a, spline.degree, static_cast<int>(spline.x.size()), spline.x.data(), spline.y.data()));
        break;
      }
      case Operation::opaque: {
        const OpaqueFunction& function = at(formulas_->functions(), node.index);
        w.push_back(
            sfdae_external(function.name.c_str(), call_opaque, 1, &a, const_cast<OpaqueFunction*>(&function)));
        break;
      }
      default: w.push_back(unary_of(node.operation)(a)); break;
    }
  }
  std::vector<sfdae_expression> result;
  for (int k : roots_) result.push_back(at(w, k));
  return result;
}

}  // namespace campaign
