// Coefficients of the Radau IIA methods.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_method.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

using Complex = std::complex<double>;

// Zeros of P_s(2c - 1) - P_(s-1)(2c - 1), P Legendre polynomials; eigenvalues of D. Computed with 60 digits.
struct Constants {
  int s;
  double c[max_stages];
  double gamma;
  Complex lambda[(max_stages - 1) / 2];
};

constexpr Constants constants[] = {
    {1, {1.0}, 1.0, {}},
    {3,
     {0.15505102572168219018, 0.64494897427831780982, 1.0},
     3.63783425274449573221,
     {{2.6810828736277521339, 3.05043019924741056943}}},
    {5,
     {0.0571041961145176821931, 0.27684301363812382768, 0.583590432368916820057, 0.860240135656219447848, 1.0},
     6.28670475172927664517,
     {{5.70095329867178941917, 3.21026560030854988843}, {3.65569432546357225824, 6.54373689936007729402}}},
    {7,
     {0.0293164271597848919721, 0.14807859966848429185, 0.336984690281154299097, 0.558671518771550132081,
      0.769233862030054500917, 0.926945671319741114852, 1.0},
     8.9368327884052163373,
     {{8.51183482510294572305, 3.28101362432505883004},
      {7.14105521918764010577, 6.62304592263927597062},
      {4.37869356150680600252, 10.1696932837950116273}}}};

// Slopes at `at` of the Lagrange polynomials for the nodes 0, c_1, ..., c_s; at is node number `node`.
void slopes_of_lagrange_polynomials(const StageMethod& method, int node, double* slopes) {
  const int s = method.s;
  const auto c = [&](int k) { return k == 0 ? 0.0 : method.c[index(k - 1)]; };
  double own = 0.0;
  for (int k = 0; k <= s; ++k)
    if (k != node) own += 1.0 / (c(node) - c(k));
  for (int j = 1; j <= s; ++j) {
    if (j == node) {
      slopes[j - 1] = own;
      continue;
    }
    double slope = 1.0 / (c(j) - c(node));
    for (int k = 0; k <= s; ++k)
      if (k != j && k != node) slope *= (c(node) - c(k)) / (c(j) - c(k));
    slopes[j - 1] = slope;
  }
}

// Eigenvector of D for lambda by inverse iteration; its largest entry is 1.
void eigenvector(const StageMethod& method, Complex lambda, Complex* v) {
  const int s = method.s;
  Complex matrix[max_stages * max_stages];
  int pivots[max_stages];
  // Slightly shifted eigenvalue, so that the matrix is not quite singular; every iteration then gains about ten digits.
  const Complex shift = lambda * (1.0 + 1e-10);
  for (int j = 0; j < s; ++j) {
    for (int i = 0; i < s; ++i) matrix[i + j * s] = method.D_at(i, j) - (i == j ? shift : 0.0);
    v[j] = 1.0;
  }
  factor_lu(ComplexView{matrix, s, s, s}, pivots);
  for (int iteration = 0; iteration < 4; ++iteration) {
    solve_lu(ComplexView{matrix, s, s, s}, pivots, v);
    Complex largest = v[0];
    for (int i = 1; i < s; ++i)
      if (std::abs(v[i]) > std::abs(largest)) largest = v[i];
    for (int i = 0; i < s; ++i) v[i] /= largest;
  }
}

void build_transformation(StageMethod& method) {
  const int s = method.s;
  Complex v[max_stages];
  eigenvector(method, method.gamma, v);
  for (int i = 0; i < s; ++i) method.T[index(i)] = v[i].real();
  for (int k = 0; 2 * k + 2 < s; ++k) {
    eigenvector(method, method.lambda[index(k)], v);
    for (int i = 0; i < s; ++i) {
      method.T[index(i + (2 * k + 1) * s)] = v[i].real();
      method.T[index(i + (2 * k + 2) * s)] = v[i].imag();
    }
  }
  StageMatrix lu = method.T;
  int pivots[max_stages];
  factor_lu({lu.data(), s, s, s}, pivots);
  for (int j = 0; j < s; ++j) {
    double* column = method.T_inverse.data() + j * s;
    column[j] = 1.0;
    solve_lu({lu.data(), s, s, s}, pivots, column);
  }
}

// Lagrange polynomials and Q, the integral of M / M(0) with M = prod (tau - c_i).
void describe_polynomial(RadauMethod& method) {
  const int s = method.s();
  const auto c = [&](int k) { return k == 0 ? 0.0 : method.stages.c[index(k - 1)]; };
  const auto factor = [&](int j, int last) {
    double product = 1.0;
    for (int k = 0; k <= last; ++k)
      if (k != j) product *= c(j) - c(k);
    return 1.0 / product;
  };
  for (int j = 0; j <= s; ++j) method.lagrange_factors[index(j)] = factor(j, s);
  for (int j = 0; j <= s - 2; ++j) method.lower_factors[index(j)] = factor(j, s - 2);
  std::array<double, max_stages + 2> M{1.0};
  for (int i = 1; i <= s; ++i)
    for (int k = i; k >= 0; --k) M[index(k)] = (k > 0 ? M[index(k - 1)] : 0.0) - c(i) * M[index(k)];
  for (int k = 0; k <= s; ++k) method.correction[index(k + 1)] = M[index(k)] / (M[0] * (k + 1));
  // Fine enough to find the largest values to within a percent.
  constexpr int points = 500;
  for (int i = 1; i < points; ++i) {
    const double tau = static_cast<double>(i) / points;
    double Q = 0.0, remainder = tau;
    for (int k = s + 1; k >= 0; --k) Q = Q * tau + method.correction[index(k)];
    for (int k = 1; k <= s; ++k) remainder *= tau - c(k);
    method.largest_correction = std::max(method.largest_correction, std::fabs(Q));
    method.largest_remainder = std::max(method.largest_remainder, std::fabs(remainder));
  }
}

RadauMethod build(const Constants& given) {
  RadauMethod method;
  StageMethod& stages = method.stages;
  stages.s = given.s;
  for (int i = 0; i < given.s; ++i) stages.c[index(i)] = given.c[i];
  stages.gamma = given.gamma;
  for (int k = 0; k < (given.s - 1) / 2; ++k) stages.lambda[index(k)] = given.lambda[k];
  double slopes[max_stages];
  for (int i = 1; i <= given.s; ++i) {
    slopes_of_lagrange_polynomials(stages, i, slopes);
    for (int j = 0; j < given.s; ++j) stages.D[index(i - 1 + j * given.s)] = slopes[j];
  }
  slopes_of_lagrange_polynomials(stages, 0, method.slope_at_start.data());
  build_transformation(stages);
  describe_polynomial(method);
  // s! (s-1)! / (2s-1)!, from the error R(z) - e^z ~ s! (s-1)! / ((2s-1)! (2s)!) z^(2s) of the stability function,
  // the Pade approximation with numerator of degree s - 1 and denominator of degree s [HW96, IV.3].
  method.error_constant = 1.0;
  for (int k = 1; k < given.s; ++k) method.error_constant *= static_cast<double>(k) / (given.s + k);
  return method;
}

}  // namespace

const RadauMethod& radau_method(int s) {
  static const std::array<RadauMethod, 4> methods = {build(constants[0]), build(constants[1]), build(constants[2]),
                                                     build(constants[3])};
  return methods[index((s - 1) / 2)];
}

}  // namespace sfdae::core
