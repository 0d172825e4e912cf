// SPDX-License-Identifier: BSD-3-Clause
#include "nodal_equations.h"

#include <memory>

namespace campaign {

namespace {

// The ground has neither row nor column.
void stamp_column(DenseMatrix& matrix, int node, int column, double value) {
  if (node > 0) matrix(node - 1, column) += value;
}
void stamp_row(DenseMatrix& matrix, int row, int node, double value) {
  if (node > 0) matrix(row, node - 1) += value;
}

void stamp_between(DenseMatrix& matrix, const Branch& branch, double value) {
  if (branch.from > 0) {
    stamp_row(matrix, branch.from - 1, branch.from, value);
    stamp_row(matrix, branch.from - 1, branch.to, -value);
  }
  if (branch.to > 0) {
    stamp_row(matrix, branch.to - 1, branch.to, value);
    stamp_row(matrix, branch.to - 1, branch.from, -value);
  }
}

}  // namespace

NodalEquations nodal_equations(const Circuit& circuit) {
  const int n = unknowns(circuit);
  NodalEquations equations{DenseMatrix(n, n), DenseMatrix(n, n), {}};
  int next = circuit.nodes;
  for (const Branch& branch : circuit.branches) {
    switch (branch.kind) {
      case BranchKind::resistor: stamp_between(equations.A, branch, -1.0 / branch.value); break;
      case BranchKind::capacitor: stamp_between(equations.E, branch, branch.value); break;
      case BranchKind::inductor:
      case BranchKind::voltage_source:
        stamp_column(equations.A, branch.from, next, -1.0);
        stamp_column(equations.A, branch.to, next, 1.0);
        stamp_row(equations.A, next, branch.from, 1.0);
        stamp_row(equations.A, next, branch.to, -1.0);
        if (branch.kind == BranchKind::inductor) equations.E(next, next) = branch.value;
        if (branch.kind == BranchKind::voltage_source)
          equations.sources.push_back({next, -branch.value, branch.phase});
        ++next;
        break;
      case BranchKind::current_source:
        if (branch.from > 0) equations.sources.push_back({branch.from - 1, -branch.value, branch.phase});
        if (branch.to > 0) equations.sources.push_back({branch.to - 1, branch.value, branch.phase});
        break;
    }
  }
  return equations;
}

LinearProblem nodal_problem(const Circuit& circuit, const CharacteristicValues& values) {
  const auto equations = std::make_shared<const NodalEquations>(nodal_equations(circuit));
  LinearProblem problem;
  problem.m = problem.n = unknowns(circuit);
  problem.values = values;
  problem.units = Units(problem.m, problem.n);
  problem.constant = true;
  problem.end = circuit.duration;
  problem.coefficients = [equations](double, int, TaylorMatrix& E, TaylorMatrix& A) {
    for (std::size_t k = 0; k < E.entries.size(); ++k) {
      E.entries[k][0] = equations->E.entries[k];
      A.entries[k][0] = equations->A.entries[k];
    }
  };
  problem.inhomogeneity = [equations, omega = circuit.omega](double t, int order, std::vector<TaylorSeries>& f) {
    for (const auto& source : equations->sources)
      add_multiple(f[static_cast<std::size_t>(source.row)], 1.0, sine(source.amplitude, omega, source.phase, t),
                   order);
  };
  return problem;
}

}  // namespace campaign
