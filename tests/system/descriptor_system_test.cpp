// SPDX-License-Identifier: BSD-3-Clause
// Poles, zeros and transfer functions of descriptor systems whose structure is known by construction.
#include "linear/descriptor_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "linalg/dense.h"
#include "problem/failure.h"
#include "random.h"

namespace sfdae::core {
namespace {

using Complex = std::complex<double>;
using sfdae_test::Random;

constexpr double roundoff = std::numeric_limits<double>::epsilon() / 2;

// A multiple of 1/32: products of three such numbers, and sums of these, are exact.
double dyadic(double low, double high, Random& random) { return std::round(32.0 * random.real(low, high)) / 32.0; }

double nonzero(Random& random) {
  const double value = dyadic(-1.0, 1.0, random);
  return value != 0.0 ? value : 1.0;
}

Matrix random_matrix(int rows, int cols, Random& random) {
  Matrix a(rows, cols);
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i) a(i, j) = nonzero(random);
  return a;
}

double frobenius(ConstView a) {
  double sum = 0.0;
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) sum += a(i, j) * a(i, j);
  return std::sqrt(sum);
}

Matrix random_regular_matrix(int n, Random& random, double smallest = 1e-3) {
  for (;;) {
    Matrix a = random_matrix(n, n, random);
    if (singular_values(a).back() > smallest) return a;
  }
}

Matrix inverse(ConstView a) {
  Matrix lu = to_matrix(a), result = identity(a.rows);
  std::vector<int> pivots(index(a.rows));
  EXPECT_TRUE(factor_lu(lu, pivots.data()));
  solve_lu(lu, pivots.data(), result.view());
  return result;
}

// Weierstrass form: J with known eigenvalues, chains at infinity, and inputs and outputs for it.
struct Weierstrass {
  DescriptorSystem form;
  std::vector<Complex> eigenvalues;  // those of complex pairs with positive imaginary parts first
  std::vector<int> first;            // where the block of an eigenvalue begins
  int index = 0;                     // length of the longest chain
};

Weierstrass random_form(Random& random, int most_unknowns) {
  Weierstrass result;
  std::vector<int> chains;
  const int real = random.integer(0, 3), pairs = random.integer(0, 2);
  int n = real + 2 * pairs;
  while (n < most_unknowns && (n == 0 || random.real(0.0, 1.0) < 0.6)) {
    const int length = random.integer(1, std::min(4, most_unknowns - n));
    chains.push_back(length);
    result.index = std::max(result.index, length);
    n += length;
  }
  const int q = random.integer(1, 2), p = random.integer(1, 2);
  Matrix E(n, n), A(n, n);
  int at = 0;
  // Apart by construction, so that conditions are those of the transformations.
  for (int k = 0; k < real; ++k, ++at) {
    const double value = -1.0 - 2.0 * k + dyadic(-0.5, 0.5, random);
    E(at, at) = 1.0;
    A(at, at) = value;
    result.eigenvalues.push_back(value);
    result.first.push_back(at);
  }
  for (int k = 0; k < pairs; ++k, at += 2) {
    const double re = dyadic(-1.0, 1.0, random), im = 1.0 + 2.0 * k + dyadic(0.0, 1.0, random);
    E(at, at) = E(at + 1, at + 1) = 1.0;
    A(at, at) = A(at + 1, at + 1) = re;
    A(at, at + 1) = im;
    A(at + 1, at) = -im;
    result.eigenvalues.push_back({re, im});
    result.eigenvalues.push_back({re, -im});
    result.first.push_back(at);
    result.first.push_back(at);
  }
  for (int length : chains) {
    for (int i = 0; i < length; ++i) A(at + i, at + i) = 1.0;
    for (int i = 0; i + 1 < length; ++i) E(at + i, at + i + 1) = 1.0;
    at += length;
  }
  result.form = {std::move(E), std::move(A), random_matrix(n, q, random), random_matrix(p, n, random),
                 random_matrix(p, q, random)};
  return result;
}

DescriptorSystem transformed(const DescriptorSystem& form, ConstView P, ConstView Q) {
  return {product(P, product(form.E, Q)), product(P, product(form.A, Q)), product(P, form.B), product(form.C, Q),
          form.D};
}

// The nearest one, which is not taken again.
double distance_to_nearest(Complex wanted, std::vector<Eigenvalue>& found, double& error) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < found.size(); ++k)
    if (std::abs(found[k].value - wanted) < std::abs(found[best].value - wanted)) best = k;
  const double distance = std::abs(found[best].value - wanted);
  error = found[best].error;
  found.erase(found.begin() + static_cast<std::ptrdiff_t>(best));
  return distance;
}

// Of an eigenvalue of the transformed form: |x| |y| (|A| + |lambda| |E|) / |y^T E x|, with blocks of size 1 or 2 and
// E = I there.
double condition(const Weierstrass& form, const DescriptorSystem& system, std::size_t k, ConstView P_inverse,
                 ConstView Q_inverse) {
  const int first = form.first[k], size = form.eigenvalues[k].imag() == 0.0 ? 1 : 2;
  const double x = frobenius(Q_inverse.columns(first, size)),
               y = frobenius(P_inverse.block(first, 0, size, P_inverse.cols));
  return x * y * (frobenius(system.A) + std::abs(form.eigenvalues[k]) * frobenius(system.E));
}

Complex entry_of_inverse(const DescriptorSystem& form, Complex s, int input, int output) {
  ShiftedPencil pencil(form.E, form.A);
  EXPECT_TRUE(pencil.factor(s));
  ShiftedPencil::Vector x(index(form.unknowns()));
  for (int i = 0; i < form.unknowns(); ++i)
    x[index(i)] = times_power_of_two(form.B(i, input), pencil.row_exponents()[index(i)]);
  pencil.solve(Op::plain, x);
  Complex sum = form.D(output, input);
  for (int j = 0; j < form.unknowns(); ++j)
    sum += form.C(output, j) * times_power_of_two(x[index(j)], pencil.column_exponents()[index(j)]);
  return sum;
}

// E = P E^ Q, A = P A^ Q for random P, Q, without rounding errors: eigenvalues may be wrong by what some roundings of
// the entries do to them. Chains of length k would turn these into eps^(1/k).
TEST(RandomDescriptorSystems, HaveTheEigenvaluesTheyWereBuiltWith) {
  Random random(1);
  int named = 0, eigenvalues = 0, too_large = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Weierstrass form = random_form(random, 12);
    const int n = form.form.unknowns();
    const Matrix P = random_regular_matrix(n, random), Q = random_regular_matrix(n, random);
    const DescriptorSystem system = transformed(form.form, P, Q);
    PencilSpectrum found;
    try {
      found = poles(system, 0.0);
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.status(), SFDAE_RANK_UNCLEAR) << failure.what();
      ++named;
      continue;
    }
    ASSERT_EQ(found.finite.size(), form.eigenvalues.size());
    EXPECT_EQ(found.values.mu, std::max(form.index - 1, 0));
    const Matrix P_inverse = inverse(P), Q_inverse = inverse(Q);
    for (std::size_t k = 0; k < form.eigenvalues.size(); ++k) {
      double error = 0.0;
      const double distance = distance_to_nearest(form.eigenvalues[k], found.finite, error);
      const double bound = 10 * n * roundoff * condition(form, system, k, P_inverse, Q_inverse);
      EXPECT_LE(distance, bound);
      EXPECT_LE(distance, 1e-8 * condition(form, system, k, P_inverse, Q_inverse));
      EXPECT_LE(distance, 10 * n * error) << "the estimate is too small";
      ++eigenvalues;
      if (error > 100 * n * bound) ++too_large;
    }
  }
  // Named errors are allowed, but rare; measured: none with this seed and three others.
  EXPECT_LE(named, 5);
  EXPECT_LE(100 * too_large, eigenvalues) << "estimates of errors are too large";
}

TEST(RandomDescriptorSystems, HaveTheTransferFunctionOfTheirForm) {
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Weierstrass form = random_form(random, 12);
    const int n = form.form.unknowns(), p = form.form.outputs(), q = form.form.inputs();
    const Matrix P = random_regular_matrix(n, random), Q = random_regular_matrix(n, random);
    const DescriptorSystem system = transformed(form.form, P, Q);
    const Complex s(random.real(2.0, 3.0), random.real(-3.0, 3.0));  // right of all eigenvalues
    std::vector<Complex> H(index(p) * index(q));
    TransferFunction function(system);
    function.evaluate(s, H.data());
    // |C| |X| |dS| |X| |B|, X = Q^-1 (s E^ - A^)^-1 P^-1 with |(s E^ - A^)^-1| <= n max(1, |s|)^3.
    const double X = frobenius(inverse(P)) * frobenius(inverse(Q)) * n * std::pow(std::abs(s), 3.0);
    const double S = frobenius(system.A) + std::abs(s) * frobenius(system.E);
    const double bound = 10 * n * roundoff * frobenius(system.C) * X * S * X * frobenius(system.B);
    for (int k = 0; k < q; ++k)
      for (int i = 0; i < p; ++i)
        EXPECT_LE(std::abs(H[index(k * p + i)] - entry_of_inverse(form.form, s, k, i)), bound);
  }
}

// lambda = -2 beside a chain at infinity of length 4, hidden by transformations: QZ makes numbers of the size
// eps^(-1/4) = 1e4 of the chain, which nothing distinguishes from eigenvalues.
TEST(QzOfThePencilAsItIs, MakesEigenvaluesOfChainsAtInfinity) {
  Random random(3);
  const int n = 5;
  DescriptorSystem form{Matrix(n, n), identity(n), Matrix(n, 0), Matrix(0, n), Matrix(0, 0)};
  form.E(0, 0) = 1.0;
  form.A(0, 0) = -2.0;
  form.E(1, 2) = form.E(2, 3) = form.E(3, 4) = 1.0;
  int with_false_ones = 0;
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const DescriptorSystem system =
        transformed(form, random_regular_matrix(n, random, 0.1), random_regular_matrix(n, random, 0.1));
    int below = 0;
    for (const Eigenvalue& value : generalized_eigenvalues(system.E, system.A))
      if (std::abs(value.value) < 1e8) ++below;
    if (below > 1) ++with_false_ones;
    const PencilSpectrum found = poles(system, 0.0);
    ASSERT_EQ(found.finite.size(), 1u);
    EXPECT_EQ(found.values, (CharacteristicValues{3, 1, 4, 0, 0}));
    EXPECT_NEAR(found.finite[0].value.real(), -2.0, 1e-10);
    EXPECT_EQ(found.finite[0].value.imag(), 0.0);
  }
  EXPECT_GE(with_false_ones, 10);  // where rounding errors happen to be zero there are none
}

// Time constants of 1 ns and 1000 s with picofarads and megohms in SI units, coupled, beside an index 2 part: C1 v1'
// = -g1 v1 + c v2, C2 v2' = -g2 v2 + c v1, v2 = x3, i = 1e-12 x3'. Exact values of the 2 x 2 matrix [-1e9 k; k'
// -1e-3] by its characteristic polynomial, in the order that does not cancel.
TEST(BadlyScaledSystems, KeepSmallEigenvaluesBesideLargeOnes) {
  const double C1 = 1e-12, g1 = 1e-3, C2 = 1e-3, g2 = 1e-6, c = 1e-8;
  DescriptorSystem system{Matrix(4, 4), Matrix(4, 4), Matrix(4, 0), Matrix(0, 4), Matrix(0, 0)};
  system.E(0, 0) = C1;
  system.A(0, 0) = -g1;
  system.A(0, 1) = c;
  system.E(1, 1) = C2;
  system.A(1, 0) = c;
  system.A(1, 1) = -g2;
  system.A(2, 1) = 1.0;
  system.A(2, 2) = -1.0;
  system.E(3, 2) = 1e-12;
  system.A(3, 3) = 1.0;
  const double trace = -g1 / C1 - g2 / C2, det = (g1 * g2 - c * c) / (C1 * C2);
  const double fast = (trace - std::sqrt(trace * trace - 4 * det)) / 2, slow = det / fast;
  const PencilSpectrum found = poles(system, 0.0);
  ASSERT_EQ(found.finite.size(), 2u);
  EXPECT_EQ(found.values.mu, 1);
  EXPECT_NEAR(found.finite[0].value.real() / slow, 1.0, 1e-14);
  EXPECT_NEAR(found.finite[1].value.real() / fast, 1.0, 1e-14);
}

// Eigenvalues are those of the same system in other units of equations, unknowns and time.
TEST(BadlyScaledSystems, DoNotDependOnUnits) {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Weierstrass form = random_form(random, 8);
    const int n = form.form.unknowns();
    DescriptorSystem system =
        transformed(form.form, random_regular_matrix(n, random), random_regular_matrix(n, random));
    const PencilSpectrum expected = poles(system, 0.0);
    const double time = std::exp2(random.integer(-30, 30));
    for (int i = 0; i < n; ++i) {
      const double row = std::exp2(random.integer(-20, 20));
      for (int j = 0; j < n; ++j) {
        system.E(i, j) *= row * time;
        system.A(i, j) *= row;
      }
    }
    for (int j = 0; j < n; ++j) {
      const double column = std::exp2(random.integer(-20, 20));
      for (int i = 0; i < n; ++i) {
        system.E(i, j) *= column;
        system.A(i, j) *= column;
      }
    }
    const PencilSpectrum found = poles(system, 0.0);
    ASSERT_EQ(found.finite.size(), expected.finite.size());
    EXPECT_EQ(found.values, expected.values);
    for (std::size_t k = 0; k < found.finite.size(); ++k) {
      std::vector<Eigenvalue> candidates = found.finite;
      double error = 0.0;
      EXPECT_LE(distance_to_nearest(expected.finite[k].value / time, candidates, error) * time,
                10 * n * (expected.finite[k].error + time * error));
    }
  }
}

// (s + 1)(s - 2) / ((s + 3)(s + 4)(s + 5)) as a companion form with its output as an unknown, transformed.
DescriptorSystem companion() {
  DescriptorSystem form{Matrix(4, 4), Matrix(4, 4), Matrix(4, 1), Matrix(1, 4), Matrix(1, 1)};
  for (int i = 0; i < 3; ++i) form.E(i, i) = 1.0;
  form.A(0, 1) = form.A(1, 2) = 1.0;
  form.A(2, 0) = -60.0;
  form.A(2, 1) = -47.0;
  form.A(2, 2) = -12.0;
  form.B(2, 0) = 1.0;
  form.A(3, 0) = -2.0;
  form.A(3, 1) = -1.0;
  form.A(3, 2) = 1.0;
  form.A(3, 3) = -1.0;
  form.C(0, 3) = 1.0;
  return form;
}

TEST(InvariantZeros, AreThoseOfTheTransferFunction) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const DescriptorSystem system =
        transformed(companion(), random_regular_matrix(4, random), random_regular_matrix(4, random));
    const PencilSpectrum zeros = invariant_zeros(system, 0.0);
    EXPECT_TRUE(zeros.is_regular());
    ASSERT_EQ(zeros.finite.size(), 2u);
    EXPECT_NEAR(zeros.finite[0].value.real(), -1.0, 1e-9);
    EXPECT_NEAR(zeros.finite[1].value.real(), 2.0, 1e-9);
  }
}

// Without outputs what is left are eigenvalues that inputs do not reach, without inputs those that outputs do not
// show; with more outputs than inputs zeros are those that all have in common.
TEST(InvariantZeros, OfSystemsThatAreNotSquareComeFromTheRegularPart) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    Weierstrass form = random_form(random, 9);
    const int n = form.form.unknowns();
    if (form.eigenvalues.empty()) continue;
    const int first = form.first[0], size = form.eigenvalues[0].imag() == 0.0 ? 1 : 2;
    DescriptorSystem blind = form.form, uncontrolled = form.form;
    for (int i = first; i < first + size; ++i) {
      for (int j = 0; j < form.form.inputs(); ++j) uncontrolled.B(i, j) = 0.0;
      for (int j = 0; j < form.form.outputs(); ++j) blind.C(j, i) = 0.0;
    }
    uncontrolled.C = Matrix(0, n);
    uncontrolled.D = Matrix(0, form.form.inputs());
    blind.B = Matrix(n, 0);
    blind.D = Matrix(form.form.outputs(), 0);
    for (const DescriptorSystem* system : {&blind, &uncontrolled}) {
      const PencilSpectrum zeros = invariant_zeros(
          transformed(*system, random_regular_matrix(n, random), random_regular_matrix(n, random)), 0.0);
      EXPECT_FALSE(zeros.is_regular());
      ASSERT_EQ(zeros.finite.size(), index(size));
      EXPECT_LE(std::abs(zeros.finite[0].value - form.eigenvalues[0]), 10 * n * zeros.finite[0].error);
    }
  }
}

TEST(SingularPencils, AreNamed) {
  DescriptorSystem system{identity(2), Matrix(2, 2), Matrix(2, 1), Matrix(1, 2), Matrix(1, 1)};
  system.E(1, 1) = 0.0;
  system.A(0, 0) = 1.0;
  try {
    poles(system, 0.0);
    FAIL() << "0 = 0 is no equation";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status(), SFDAE_SINGULAR);
    EXPECT_NE(std::string(failure.what()).find("u = 1, v = 1"), std::string::npos) << failure.what();
  }
  TransferFunction function(system);
  Complex H = 7.0;
  EXPECT_THROW(function.evaluate({0.0, 1.0}, &H), Failure);
  EXPECT_EQ(H, 7.0);
}

// 1 / (s^2 + 1) in coordinates where its pole is not hit exactly.
TEST(TransferFunctions, HaveNoValueAtPoles) {
  Random random(6);
  DescriptorSystem form{identity(2), Matrix(2, 2), Matrix(2, 1), Matrix(1, 2), Matrix(1, 1)};
  form.A(0, 1) = 1.0;
  form.A(1, 0) = -1.0;
  form.B(1, 0) = form.C(0, 0) = 1.0;
  const DescriptorSystem system =
      transformed(form, random_regular_matrix(2, random), random_regular_matrix(2, random));
  TransferFunction function(system);
  Complex H;
  EXPECT_THROW(function.evaluate({0.0, 1.0}, &H), Failure);
  function.evaluate({0.0, 2.0}, &H);
  EXPECT_NEAR(std::abs(H - Complex(-1.0 / 3.0)), 0.0, 1e-12);
}

}  // namespace
}  // namespace sfdae::core
