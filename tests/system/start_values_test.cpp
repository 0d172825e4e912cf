// SPDX-License-Identifier: BSD-3-Clause
// Start values of linear problems: what is differentiated stays, else it moves least, and units do not matter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "analyzed_problem.h"
#include "linalg/dense.h"
#include "linear/linear_model.h"
#include "matrix_checks.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using sfdae_test::largest;
using sfdae_test::rounding;
using sfdae_test::size;
using Numbers = std::vector<double>;

// Cases of each kind; SFDAE_TEST_CASES raises it.
int num_cases(int usual) {
  const char* cases = std::getenv("SFDAE_TEST_CASES");
  return cases != nullptr ? std::atoi(cases) : usual;
}

// Constant coefficients, f = f0 + f1 t:
//
//     R ( x1' - A11 x1 - A12 x2 - f_1 ;  - A21 x1 - A22 x2 - f_2 ) = 0,   x1: d + c unknowns, x2: n2
//
// with R random. A22 has rank n2 - c, so that c combinations of the algebraic equations constrain x1 alone, and their
// derivatives determine what is left of x2 (strangeness index 1 if c > 0). ker E: coordinates x2, or, turned, not.
struct Circuit {
  Matrix E, A;
  Numbers f0, f1;
  int n = 0;
};

Matrix random_of_rank(int n, int rank, std::uint64_t seed) {
  return sfdae_test::times(sfdae_test::random_matrix(n, rank, seed), sfdae_test::random_matrix(rank, n, seed + 1));
}

Circuit random_circuit(std::uint64_t seed, bool turned) {
  sfdae_test::RandomNumbers numbers(seed);
  const int n2 = 1 + static_cast<int>(numbers.uniform(0.0, 4.0)),
            c = std::min(n2, static_cast<int>(numbers.uniform(0.0, 3.0)));
  const int n1 = 2 + c + static_cast<int>(numbers.uniform(0.0, 3.0)), n = n1 + n2;
  Matrix E(n, n), A = sfdae_test::random_matrix(n, n, seed + 10);
  for (int i = 0; i < n1; ++i) E(i, i) = 1.0;
  const Matrix A22 = random_of_rank(n2, n2 - c, seed + 20);
  copy(A22, A.view().block(n1, n1, n2, n2));
  const Matrix R = sfdae_test::sum(1.0, sfdae_test::random_matrix(n, n, seed + 30), 3.0, sfdae_test::unit_matrix(n));
  Circuit circuit{sfdae_test::times(R, E), sfdae_test::times(R, A), sfdae_test::random_vector(n, seed + 40),
                  sfdae_test::random_vector(n, seed + 50), n};
  if (!turned) return circuit;
  const Matrix T = sfdae_test::sum(1.0, sfdae_test::random_matrix(n, n, seed + 60), 3.0, sfdae_test::unit_matrix(n));
  circuit.E = sfdae_test::times(circuit.E, T);
  circuit.A = sfdae_test::times(circuit.A, T);
  return circuit;
}

// Unknowns in other units: x_j = units_j times the new ones.
Circuit in_units(const Circuit& circuit, const Numbers& units) {
  Circuit other = circuit;
  for (int j = 0; j < circuit.n; ++j)
    for (int i = 0; i < circuit.n; ++i) {
      other.E(i, j) *= units[size(j)];
      other.A(i, j) *= units[size(j)];
    }
  return other;
}

class CircuitModel {
 public:
  CircuitModel(Circuit circuit, const Numbers& atol) : circuit_(std::move(circuit)), model_(functions()) {
    options_.consistency.keeps_differentiated = true;
    options_.tolerances = {Numbers(size(circuit_.n), 1e-6), atol};
  }
  void analyze() {
    std::vector<RankDecision> decisions;
    model_.analyze({t0, t0 + 1.0, nullptr}, options_, decisions);
  }
  ConsistentPoint start(const Numbers& x) { return model_.consistent_point({t0, t0 + 1.0, x.data()}, options_); }
  const Circuit& circuit() const { return circuit_; }
  const LinearPoint& point() { return model_.system()->point(); }
  int undetermined() { return model_.system()->undetermined(); }
  int index() { return model_.system()->analysis().values.mu; }
  double kept() { return point().kept_constraints * point().pivot; }
  Numbers sizes(const Numbers& x) const { return options_.request_at(x.data()).sizes(); }
  static constexpr double t0 = 0.3;

 private:
  LinearFunctions functions() {
    LinearFunctions f;
    f.m = f.n = circuit_.n;
    f.user = &circuit_;
    f.E = [](double, int order, double* matrix, void* user) {
      const Circuit& c = *static_cast<Circuit*>(user);
      if (order == 0) std::copy_n(c.E.data(), c.n * c.n, matrix);
      return 0;
    };
    f.A = [](double, int order, double* matrix, void* user) {
      const Circuit& c = *static_cast<Circuit*>(user);
      if (order == 0) std::copy_n(c.A.data(), c.n * c.n, matrix);
      return 0;
    };
    f.f = [](double t, int order, double* vector, void* user) {
      const Circuit& c = *static_cast<Circuit*>(user);
      for (int i = 0; i < c.n && order <= 1; ++i)
        vector[i] = order == 0 ? c.f0[size(i)] + t * c.f1[size(i)] : c.f1[size(i)];
      return 0;
    };
    f.constant_E = f.constant_A = true;
    return f;
  }

  Circuit circuit_;
  LinearModel model_;
  ModelOptions options_;
};

// Of E with rows of comparable size.
Matrix kernel_of(const Matrix& E) {
  const Svd decomposition = svd(E);
  int rank = 0;
  while (rank < E.cols() && decomposition.s[size(rank)] > 1e-10 * decomposition.s[0]) ++rank;
  return to_matrix(decomposition.V.view().columns(rank, E.cols() - rank));
}

// What of dx moves E x: the least change D (E D)^+ E dx, D the sizes.
Numbers moving_part(const Matrix& E, const Numbers& sizes, const Numbers& dx) {
  Matrix ED = E;
  for (int j = 0; j < E.cols(); ++j)
    for (int i = 0; i < E.rows(); ++i) ED(i, j) *= sizes[size(j)];
  Numbers part = least_squares(ED, sfdae_test::times(E, dx.data()), 1e-10 * svd(ED).s[0]);
  for (std::size_t j = 0; j < part.size(); ++j) part[j] *= sizes[j];
  return part;
}

// T2^T D^-2 v relative to the sizes of its terms.
double along_constraints(ConstView T2, const Numbers& v, const Numbers& sizes) {
  double worst = 0.0;
  for (int j = 0; j < T2.cols; ++j) {
    double sum = 0.0, terms = 0.0;
    for (int i = 0; i < T2.rows; ++i) {
      const double term = T2(i, j) * v[size(i)] / (sizes[size(i)] * sizes[size(i)]);
      sum += term;
      terms += std::fabs(term);
    }
    if (terms > 0.0) worst = std::max(worst, std::fabs(sum) / terms);
  }
  return worst;
}

Numbers plus(Numbers x, double factor, const Numbers& change) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += factor * change[i];
  return x;
}

// A consistent point with all its components about 1.
Numbers some_consistent_point(CircuitModel& model, std::uint64_t seed) {
  return model.start(sfdae_test::random_vector(model.circuit().n, seed)).x;
}

}  // namespace

// x + K c for any c starts at x: with u = 0 there is one consistent point only that has this E x.
TEST(StartValues, WhatIsDifferentiatedStays) {
  int coordinates = 0, with_constraints = 0;
  for (int trial = 0; trial < num_cases(400); ++trial) {
    SCOPED_TRACE(trial);
    const std::uint64_t seed = 1000 * static_cast<std::uint64_t>(trial);
    const bool turned = trial % 2 == 1;
    CircuitModel model(random_circuit(seed, turned), Numbers(20, 1e-6));
    model.analyze();
    if (model.undetermined() > 0 || model.kept() < 1e-3) continue;
    const Numbers exact = some_consistent_point(model, seed + 1);
    const Matrix K = kernel_of(model.circuit().E);
    const double amount = trial % 3 == 0 ? 1e3 : 1.0;
    const Numbers shift = sfdae_test::times(K, sfdae_test::random_vector(K.cols(), seed + 2).data());
    const Numbers given = plus(exact, amount, shift);
    const ConsistentPoint found = model.start(given);
    const double tolerance = 100.0 * rounding(20) * amount * std::max(1.0, largest(exact)) / model.kept();
    EXPECT_LE(sfdae_test::distance(found.x, exact), tolerance);
    EXPECT_FALSE(found.value_change.is_beyond_tolerances()) << found.value_change.in_tolerances;
    coordinates += turned ? 0 : 1;
    with_constraints += model.index() > 0 ? 1 : 0;
    if (turned) continue;
    // In every bit where no constraint is on these unknowns alone, else to rounding.
    for (int i = 0; i < model.circuit().n; ++i) {
      if (max_abs(model.circuit().E.view().column(i), model.circuit().n) == 0.0) continue;
      EXPECT_NEAR(found.x[size(i)], given[size(i)], model.index() == 0 ? 0.0 : tolerance) << i;
    }
  }
  EXPECT_GE(std::min(coordinates, with_constraints), num_cases(400) / 10);
}

// Given values that are off by 30 %: what moves E x has no component along the consistent directions in the norm of the
// tolerances, and the rest of the change lies in the kernel.
TEST(StartValues, WhatHasToMoveMovesLeast) {
  int warned = 0, counted = 0;
  for (int trial = 0; trial < num_cases(400); ++trial) {
    SCOPED_TRACE(trial);
    const std::uint64_t seed = 1000 * static_cast<std::uint64_t>(trial) + 500;
    CircuitModel model(random_circuit(seed, trial % 2 == 1), Numbers(20, 1e-6));
    model.analyze();
    if (model.undetermined() > 0 || model.kept() < 1e-3) continue;
    Numbers given = some_consistent_point(model, seed + 1);
    const Numbers off = sfdae_test::random_vector(model.circuit().n, seed + 2);
    for (std::size_t i = 0; i < given.size(); ++i) given[i] *= 1.0 + 0.3 * off[i];
    const ConsistentPoint found = model.start(given);
    const double conditioned = 1e3 * rounding(20) / model.kept();
    EXPECT_LE(found.change.residual_after, conditioned * std::max(1.0, largest(found.x)));
    const Numbers sizes = model.sizes(given), dx = plus(found.x, -1.0, given);
    const Numbers part = moving_part(model.circuit().E, sizes, dx);
    double in_tolerances = 0.0;
    for (std::size_t i = 0; i < part.size(); ++i)
      in_tolerances = std::max(in_tolerances, std::fabs(part[i]) / sizes[i]);
    EXPECT_EQ(found.value_change.is_beyond_tolerances(), in_tolerances > 1.0) << in_tolerances;
    ++counted;
    if (in_tolerances <= 1.0) continue;
    ++warned;
    EXPECT_NEAR(found.value_change.in_tolerances / in_tolerances, 1.0, conditioned);
    EXPECT_LE(along_constraints(model.point().form.T2(), part, sizes), conditioned);
  }
  EXPECT_GE(warned, counted / 5);
  EXPECT_LE(warned, counted);
}

// Unknowns in units between 1e-4 and 1e4, tolerances likewise: the same point.
TEST(StartValues, DoNotDependOnTheUnitsOfTheUnknowns) {
  for (int trial = 0; trial < num_cases(200); ++trial) {
    SCOPED_TRACE(trial);
    const std::uint64_t seed = 1000 * static_cast<std::uint64_t>(trial) + 700;
    const Circuit circuit = random_circuit(seed, trial % 2 == 1);
    CircuitModel model(circuit, Numbers(20, 1e-6));
    model.analyze();
    if (model.undetermined() > 0 || model.kept() < 1e-3) continue;
    const Numbers given = sfdae_test::random_vector(circuit.n, seed + 2);
    const ConsistentPoint found = model.start(given);
    Numbers units, atol, other_given;
    sfdae_test::RandomNumbers numbers(seed + 3);
    for (int j = 0; j < circuit.n; ++j) {
      units.push_back(std::pow(10.0, numbers.uniform(-4.0, 4.0)));
      atol.push_back(1e-6 / units.back());
      other_given.push_back(given[size(j)] / units.back());
    }
    CircuitModel other(in_units(circuit, units), atol);
    other.analyze();
    if (other.undetermined() > 0 || other.kept() < 1e-5) continue;
    const ConsistentPoint again = other.start(other_given);
    const double tolerance =
        1e5 * rounding(20) * std::max(1.0, largest(found.x)) / std::min(model.kept(), other.kept());
    for (int j = 0; j < circuit.n; ++j)
      EXPECT_NEAR(again.x[size(j)] * units[size(j)], found.x[size(j)], tolerance) << j;
    // What rounding errors may amount to is measured in other units.
    const double in_tolerances = found.value_change.in_tolerances;
    if (in_tolerances > 1e3 || in_tolerances < 1e-3) {
      EXPECT_EQ(again.value_change.is_beyond_tolerances(), in_tolerances > 1.0) << in_tolerances;
    }
  }
}

// Coefficients that depend on time, and kernels that turn with it: E x stays where the values given fit.
TEST(StartValues, KeepWhatIsDifferentiatedInFamiliesToo) {
  using Family = std::shared_ptr<const sfdae_test::LinearFamily>;
  for (const Family& family :
       {Family(sfdae_test::kron(7, 0)), Family(sfdae_test::kron(8, 2)), Family(sfdae_test::kron(9, 1, 0.5, 2)),
        Family(sfdae_test::chain(4, 2)), Family(sfdae_test::nilpotent(3).family)}) {
    SCOPED_TRACE(family->name());
    sfdae_test::AnalyzedProblem p(family, 0.4, 1.4);
    ASSERT_EQ(p.system.move_to(0.4), PointStatus::ok);
    const int n = p.problem.n();
    Matrix E(p.problem.m(), n);
    ASSERT_EQ(p.problem.call('E', 0.4, 0, E.data()).status, SFDAE_OK);
    const Matrix K = kernel_of(E);
    ConsistencyRequest request;
    request.keeps_differentiated = true;
    const Numbers exact = p.exact(0.4), shift = sfdae_test::times(K, sfdae_test::random_vector(K.cols(), 3).data());
    Numbers x = plus(exact, 1.0, shift);
    request.tolerances.assign(size(n), 1e-6);
    const Numbers given = x;
    make_consistent(p.system, request, x);
    const double tolerance =
        rounding(100 * n) / (p.system.quality().smallest_pivot * p.system.quality().kept_constraints);
    const Numbers moved = plus(x, -1.0, exact);
    EXPECT_LE(largest(sfdae_test::times(E, moved.data())), tolerance);
    if (p.system.undetermined() == 0) {
      EXPECT_LE(largest(moved), tolerance);
    }
    EXPECT_FALSE(change_of_differentiated(constraints_of(p.system), request, given, x).is_beyond_tolerances());
  }
}

// Fixed components stay, and among those that do not the same is kept: u' = -i, 0 = i - 10 u with either one fixed.
TEST(StartValues, FollowFixedComponents) {
  Circuit circuit{Matrix(2, 2), Matrix(2, 2), {0.0, 0.0}, {0.0, 0.0}, 2};
  circuit.E(0, 0) = 1.0;
  circuit.A(0, 1) = -1.0;
  circuit.A(1, 0) = -10.0;
  circuit.A(1, 1) = 1.0;
  CircuitModel model(circuit, Numbers(2, 1e-6));
  model.analyze();
  const ConsistentPoint free = model.start({5.0, 0.0});
  EXPECT_EQ(free.x[0], 5.0);
  EXPECT_NEAR(free.x[1], 50.0, 10.0 * rounding(2));
  EXPECT_EQ(free.value_change.component, -1);
}

}  // namespace sfdae::core
