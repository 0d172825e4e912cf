// Derivatives of the equations of impulses of a recorded problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/impulse_slopes.h"

#include <cmath>
#include <string>
#include <utility>

#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "expression/symbolic_gradient.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// F_x' v - F_x w of one equation.
int directional_derivative(Recorder& recorder, const Record& record, int equation, int residual) {
  const int n = record.n();
  std::vector<int> leaves, factors;
  for (const Entry& entry : record.entries(equation)) {
    const int j = entry.unknown;
    leaves.push_back(entry.derivative ? recorder.derivative(j) : recorder.unknown(j));
    factors.push_back(entry.derivative ? recorder.unknown(n + j)
                                       : recorder.apply(Operation::negate, recorder.unknown(2 * n + j)));
  }
  const std::vector<int> gradient = symbolic_gradient(recorder, residual, leaves);
  int sum = recorder.constant(0.0);
  for (std::size_t k = 0; k < leaves.size(); ++k)
    sum = recorder.apply(Operation::add, sum, recorder.apply(Operation::multiply, gradient[k], factors[k]));
  return sum;
}

}  // namespace

ImpulseSlopes::Formulas ImpulseSlopes::formulas_of(const Record& record, const std::vector<int>& parameters) {
  const int n = record.n();
  Recorder recorder(3 * n);
  const std::vector<int> copies = copy_nodes(record, recorder);
  const int zero = recorder.constant(0.0);
  Formulas result;
  std::vector<int> formulas;
  std::vector<std::string> names;
  for (int i = 0; i < record.m(); ++i) {
    const int along = directional_derivative(recorder, record, i, copies[index(record.residual(i))]);
    std::vector<int> leaves, columns;
    for (const Entry& entry : record.entries(i)) {
      if (entry.derivative) continue;
      leaves.push_back(recorder.unknown(entry.unknown));
      columns.push_back(entry.unknown);
    }
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      if (parameters[j] < 0) continue;
      const Parameter& parameter = record.parameters()[index(parameters[j])];
      leaves.push_back(recorder.parameter(parameter.name, parameter.value));
      columns.push_back(n + static_cast<int>(j));
    }
    const std::vector<int> gradient = symbolic_gradient(recorder, along, leaves);
    for (std::size_t k = 0; k < leaves.size(); ++k) {
      if (gradient[k] == zero) continue;
      result.places.push_back({i, columns[k]});
      formulas.push_back(gradient[k]);
      names.push_back("a second derivative of " + record.name(i));
    }
  }
  result.record = recorder.excerpt(3 * n, std::move(formulas), std::move(names));
  return result;
}

ImpulseSlopes::ImpulseSlopes(const TaylorEvaluator& equations, const std::vector<int>& parameters)
    : ImpulseSlopes(formulas_of(equations.record(), parameters), equations.record().n()) {}

ImpulseSlopes::ImpulseSlopes(Formulas formulas, int n)
    : n_(n), places_(std::move(formulas.places)), evaluator_(std::move(formulas.record)) {}

bool ImpulseSlopes::evaluate(const TaylorEvaluator& equations, const TaylorData& data, const Units& units,
                             ConstView theta, const double* jet, View by_x, View by_parameters) {
  fill(by_x, 0.0);
  fill(by_parameters, 0.0);
  if (places_.empty()) return true;
  for (int i = 0; i < equations.num_parameters(); ++i)
    if (evaluator_.parameter(i) != equations.parameter(i)) evaluator_.set_parameter(i, equations.parameter(i));
  const int mu = theta.cols - 1, m = data.m;
  const std::size_t n = index(n_);
  jet_.assign(3 * n * index(mu + 2), 0.0);
  const auto column = [&](int k) { return jet_.data() + 3 * n * index(k); };
  for (int k = 0; k <= mu + 1; ++k) std::copy_n(jet + n * index(k), n, column(k));
  double power = 1.0;
  for (int j = 0; j <= mu; ++j, power *= data.time_scale)
    for (int i = 0; i < n_; ++i) {
      const double value = power * units[i] * theta(i, j);
      column(mu - j)[n_ + i] = value;
      if (j > 0) column(mu - j + 1)[2 * n_ + i] = value / j;
    }
  values_.resize(places_.size() * index(mu + 1));
  if (!evaluator_.values(data.t, jet_.data(), mu, values_.data())) return false;
  power = 1.0;
  for (int p = 0; p <= mu; ++p, power /= data.time_scale)
    for (std::size_t e = 0; e < places_.size(); ++e) {
      const auto [equation, to] = places_[e];
      const double value = power * data.row_scale[index(equation)] * values_[e + places_.size() * index(mu - p)];
      if (to < n_) by_x(p * m + equation, to) = value * units[to];
      else by_parameters(p * m + equation, to - n_) = value;
    }
  return true;
}

}  // namespace sfdae::core
