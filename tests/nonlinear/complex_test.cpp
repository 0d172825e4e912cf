// SPDX-License-Identifier: BSD-3-Clause
// Complex problems as real ones: every operation against std::complex, and the shapes of matrices.
#include <gtest/gtest.h>

#include <complex>
#include <vector>

#include <sfdae/complex.hpp>
#include <sfdae/sfdae.hpp>

namespace sfdae_test {

namespace {

using Number = std::complex<double>;

// Whatever reads the same for numbers and recorded ones.
template <class Complex>
std::vector<Complex> values(const Complex& a, const Complex& b) {
  using std::abs;
  using std::arg;
  using std::conj;
  using std::cos;
  using std::exp;
  using std::imag;
  using std::log;
  using std::norm;
  using std::real;
  using std::sin;
  Complex sum = a;
  sum += b;
  sum -= a * b;
  sum *= a;
  sum /= b;
  return {a + b,
          a - b,
          a * b,
          a / b,
          -a,
          +b,
          sum,
          conj(a) * b,
          exp(a),
          log(b),
          sin(a),
          cos(b),
          Complex(real(a), imag(b)),
          Complex(abs(a)),
          Complex(norm(b)),
          Complex(arg(b))};
}

}  // namespace

// 0 = x - values(c(t), ...): consistent values are those of the operations.
TEST(Complex, OperationsAreThoseOfStandardNumbers) {
  const Number b(-0.7, 1.3), slope(0.4, -0.9);
  const std::vector<Number> expected = values(slope * 0.8 + 1.0, b);
  const int n = static_cast<int>(expected.size());
  sfdae::NonlinearProblem problem = sfdae::complex_problem(n, n, [&](auto& t, auto& x, auto&, auto& F) {
    const auto found = values<sfdae::ComplexExpression>(slope * sfdae::ComplexExpression(t) + 1.0, b);
    for (std::size_t k = 0; k < found.size(); ++k) F[k] = x[k] - found[k];
  });
  sfdae::Solver solver(problem);
  sfdae::Point point{0.8, std::vector<double>(2 * expected.size()), {}};
  solver.start(point, 1.0);
  const std::vector<Number> x = sfdae::complex_form(point.x);
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_LT(std::abs(x[k] - expected[k]), 1e-14) << k;
  EXPECT_EQ(solver.characteristics().algebraic, 2 * n);
}

TEST(Complex, VectorsGoThereAndBack) {
  const std::vector<Number> x{{1, 2}, {-3, 4}};
  EXPECT_EQ(sfdae::real_form(x), (std::vector<double>{1, 2, -3, 4}));
  EXPECT_EQ(sfdae::complex_form(sfdae::real_form(x)), x);
  EXPECT_THROW(sfdae::complex_form({1, 2, 3}), sfdae::Error);
}

TEST(Complex, RealFormOfAMatrixActsAsTheMatrix) {
  const std::vector<Number> A{{1, 2}, {3, -1}, {0, 1}, {-2, 5}, {1, 1}, {4, 0}}, x{{1, -2}, {0.5, 3}, {-1, 1}};
  sfdae::Matrix real(4, 6);
  sfdae::write_real_form(A, real);
  const std::vector<double> v = sfdae::real_form(x);
  for (int i = 0; i < 2; ++i) {
    Number exact = 0.0;
    double re = 0.0, im = 0.0;
    for (int j = 0; j < 3; ++j) exact += A[std::size_t(i + 2 * j)] * x[std::size_t(j)];
    for (int j = 0; j < 6; ++j)
      re += real(2 * i, j) * v[std::size_t(j)], im += real(2 * i + 1, j) * v[std::size_t(j)];
    EXPECT_LT(std::abs(Number(re, im) - exact), 1e-14);
  }
  sfdae::Matrix odd(3, 6), small(2, 2);
  EXPECT_THROW(sfdae::write_real_form(A, odd), sfdae::Error);
  EXPECT_THROW(sfdae::write_real_form(A, small), sfdae::Error);
}

}  // namespace sfdae_test
