// SPDX-License-Identifier: BSD-3-Clause
#include "kronecker_problem.h"

#include <cmath>
#include <memory>

namespace campaign {

namespace {

constexpr int max_unknowns = 20, max_strangeness = 4;

// The left factor is a Taylor matrix, the right one constant and mostly zeros.
TaylorMatrix product(const TaylorMatrix& a, const DenseMatrix& b, int order) {
  TaylorMatrix result(a.rows, b.columns);
  for (int j = 0; j < b.columns; ++j)
    for (int k = 0; k < b.rows; ++k)
      if (b(k, j) != 0.0)
        for (int i = 0; i < a.rows; ++i) add_multiple(result(i, j), b(k, j), a(i, k), order);
  return result;
}

// sum += sign * a b.
void add_matrix_product(TaylorMatrix& sum, double sign, const TaylorMatrix& a, const TaylorMatrix& b, int order) {
  for (int j = 0; j < b.columns; ++j) {
    for (int k = 0; k < b.rows; ++k) {
      TaylorSeries factor = b(k, j);
      for (double& c : factor) c *= sign;
      for (int i = 0; i < a.rows; ++i) add_product(sum(i, j), factor, a(i, k), order);
    }
  }
}

struct Ingredients {
  KroneckerForm form;
  Transformation P, Q;
};

// With P N and P M, which are sparse products, E = (P N) Q and A = (P M) Q - (P N) Q'.
void write_coefficients(const Ingredients& of, double s, int order, TaylorMatrix& E, TaylorMatrix& A) {
  const TaylorMatrix P = of.P.series(s, order);
  const TaylorMatrix Q = of.Q.series(s, order + 1);
  const TaylorMatrix PN = product(P, of.form.N, order), PM = product(P, of.form.M, order);
  add_matrix_product(E, 1.0, PN, Q, order);
  add_matrix_product(A, 1.0, PM, Q, order);
  if (of.Q.constant()) return;
  TaylorMatrix derivative_of_Q = Q;
  for (TaylorSeries& entry : derivative_of_Q.entries) entry = derivative(entry);
  add_matrix_product(A, -1.0, PN, derivative_of_Q, order);
}

TransformationKind random_kind(bool integers, bool varies, RandomNumbers& random) {
  if (integers) return varies ? TransformationKind::exact_polynomial : TransformationKind::integer;
  if (!varies) return random.chance(0.5) ? TransformationKind::dense : TransformationKind::sparse;
  switch (random.integer(0, 2)) {
    case 0: return TransformationKind::rotating;
    case 1: return TransformationKind::polynomial;
    default: return TransformationKind::mixed;
  }
}

bool mostly_nonzero(const LinearProblem& problem) {
  TaylorMatrix E(problem.m, problem.n), A(problem.m, problem.n);
  problem.coefficients(problem.begin, 0, E, A);
  int count = 0;
  for (const TaylorSeries& entry : E.entries) count += entry[0] != 0.0;
  for (const TaylorSeries& entry : A.entries) count += entry[0] != 0.0;
  return count > problem.m * problem.n;
}

}  // namespace

KroneckerProblem random_kronecker_problem(const Difficulty& difficulty, RandomNumbers& random) {
  return kronecker_problem(random_sizes(max_unknowns, max_strangeness, random), difficulty, random);
}

KroneckerProblem kronecker_problem(const KroneckerSizes& sizes, const Difficulty& difficulty, RandomNumbers& random) {
  const bool integers = random.chance(0.3), varies = random.chance(0.6);
  const double condition = random.log_uniform(1.0, difficulty.condition);
  const double share = random.chance(0.3) ? random.integer(0, 1) : random.uniform();

  KroneckerProblem result;
  if (sizes.differential > 0) result.stiffness = random.log_uniform(1.0, difficulty.stiffness);
  LinearProblem& problem = result.problem;
  problem.m = sizes.equations();
  problem.n = sizes.unknowns();
  problem.values = sizes.values();
  problem.units = Units(problem.m, problem.n);
  problem.begin = random.chance(0.3) ? 0.0 : integers ? 0.5 : random.uniform(-0.5, 0.5);
  problem.end = problem.begin + (random.chance(0.8) ? 1.0 : -1.0) * random.log_uniform(1e-2, 1.0);

  const KroneckerForm form = kronecker_form(sizes, {result.stiffness, integers}, random);
  const TransformationKind kind_of_P = random_kind(integers, varies && random.chance(0.7), random);
  const TransformationKind kind_of_Q = random_kind(integers, varies && random.chance(0.7), random);
  const Transformation P(kind_of_P, problem.m, std::pow(condition, share), random);
  const Transformation Q(kind_of_Q, problem.n, std::pow(condition, 1.0 - share), random);
  const auto ingredients = std::make_shared<const Ingredients>(Ingredients{form, P, Q});
  problem.coefficients = [ingredients](double s, int order, TaylorMatrix& E, TaylorMatrix& A) {
    write_coefficients(*ingredients, s, order, E, A);
  };
  // Constant problems are declared as such, or not.
  problem.constant = P.constant() && Q.constant() && random.chance(0.8);
  result.exact = P.exact() && Q.exact() && integers;
  result.dense = mostly_nonzero(problem);
  result.condition = condition;
  return result;
}

bool determined(const KroneckerProblem& problem) {
  if (problem.exact || !problem.dense) return true;
  return std::pow(problem.stiffness, problem.problem.values.mu + 1) * problem.condition < 1e12;
}

}  // namespace campaign
