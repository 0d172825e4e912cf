// The formulas of a mechanical system, as nodes of a recorder.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_formulas.h"

#include <utility>

#include "expression/symbolic_gradient.h"
#include "expression/taylor_evaluator.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

bool is_number(const Recorder& recorder, int node) { return recorder.node(node).operation == Operation::constant; }

bool is_identity(const Recorder& recorder, const std::vector<int>& S, int rows, int cols) {
  if (rows != cols) return false;
  int known_zero = -1;
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i) {
      const int node = S[index(i) + index(j) * index(rows)];
      if (i != j && node == known_zero) continue;
      if (!is_number(recorder, node) || recorder.number(node) != (i == j ? 1.0 : 0.0)) return false;
      if (i != j) known_zero = node;
    }
  return true;
}

std::vector<std::string> numbered(const char* name, int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back(format("%s[%d]", name, i));
  return names;
}

std::vector<int> row_of(const std::vector<int>& matrix, int rows, int row) {
  std::vector<int> entries;
  for (std::size_t entry = index(row); entry < matrix.size(); entry += index(rows)) entries.push_back(matrix[entry]);
  return entries;
}

std::vector<int> column_of(const std::vector<int>& matrix, int rows, int column) {
  return {matrix.begin() + column * rows, matrix.begin() + (column + 1) * rows};
}

int combination(Recorder& recorder, const std::vector<int>& coefficients, const std::vector<int>& factors) {
  const int zero = recorder.constant(0.0);
  int sum = zero;
  // Most coefficients of large systems are zero.
  for (std::size_t j = 0; j < factors.size(); ++j)
    if (coefficients[j] != zero)
      sum = recorder.apply(Operation::add, sum, recorder.apply(Operation::multiply, coefficients[j], factors[j]));
  return sum;
}

std::shared_ptr<const Record> first_order_equations(Recorder& recorder, const MultibodyFormulas& formulas) {
  const auto [nq, nv, nl, nk] = formulas.sizes;
  const auto unknowns = [&recorder](int first, int count) {
    std::vector<int> nodes;
    for (int j = 0; j < count; ++j) nodes.push_back(recorder.unknown(first + j));
    return nodes;
  };
  const std::vector<int> v = unknowns(nq, nv), kappa = unknowns(nq + nv + nl, nk);
  std::vector<int> vdot, residuals;
  for (int j = 0; j < nv; ++j) vdot.push_back(recorder.derivative(nq + j));
  for (int i = 0; i < nq; ++i)
    residuals.push_back(recorder.apply(Operation::subtract, recorder.derivative(i),
                                       combination(recorder, row_of(formulas.S, nq, i), v)));
  const int potential = combination(recorder, formulas.g, unknowns(nq + nv, nl));
  const std::vector<int> reactions = symbolic_gradient(recorder, potential, nq);  // g_q^T lambda
  for (int i = 0; i < nv; ++i) {
    const int inertia = combination(recorder, row_of(formulas.M, nv, i), vdot);
    int force = combination(recorder, column_of(formulas.S, nq, i), reactions);
    if (nk > 0)
      force = recorder.apply(Operation::add, force, combination(recorder, column_of(formulas.H, nk, i), kappa));
    residuals.push_back(
        recorder.apply(Operation::add, recorder.apply(Operation::subtract, inertia, formulas.f[index(i)]), force));
  }
  residuals.insert(residuals.end(), formulas.g.begin(), formulas.g.end());
  for (int i = 0; i < nk; ++i)
    residuals.push_back(
        recorder.apply(Operation::add, combination(recorder, row_of(formulas.H, nk, i), v), formulas.h[index(i)]));
  std::vector<std::string> names = numbered("q'", nq);
  for (const auto& [name, count] : {std::pair{"f", nv}, std::pair{"g", nl}, std::pair{"H v + h", nk}})
    for (std::string& numbered_name : numbered(name, count)) names.push_back(std::move(numbered_name));
  return recorder.excerpt(formulas.sizes.unknowns(), residuals, names);
}

bool report_failure(const TaylorEvaluator& evaluator, CallbackError& error) {
  error.status = status_of(evaluator.failure());
  error.row = evaluator.failure().equation;
  error.detail = "the formulas cannot be evaluated at " + error.where() + ": " + evaluator.failure().message + ".";
  return false;
}

}  // namespace sfdae::core
