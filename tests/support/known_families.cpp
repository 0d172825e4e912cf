// SPDX-License-Identifier: BSD-3-Clause
// The families kron, chain, spin and rotated_ode.
#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "formula_family.h"
#include "transformed_pencil.h"

namespace sfdae_test {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

std::string text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%g", value);
  return digits;
}

// Dynamics in the rows 1..d, blocks of size mu+1 with E^ = superdiagonal and A^ = I, E^ = 0 and A^ = 1 for the
// rest of a, zero rows and columns at the end.
CanonicalPencil kronecker_form(int n, int mu, int u, double sigma) {
  const int d = std::min((n - u) / 2, n - u - mu - 1), a = n - u - d;
  if (u < 0 || mu < 0 || d < 0) throw std::invalid_argument("kron: n - u > mu is necessary");
  CanonicalPencil pencil{{mu, d, a, u, u}, std::vector<double>(index(n * n)), std::vector<double>(index(n * n))};
  const auto E = [&](int i, int j) -> double& { return pencil.E[index(i + j * n)]; };
  const auto A = [&](int i, int j) -> double& { return pencil.A[index(i + j * n)]; };

  for (int i = 0; i < d; ++i) E(i, i) = 1.0;
  for (int k = 0; k < d / 2; ++k) {
    const double alpha = 0.2 + 0.2 * (k % 5), beta = 1.0 + k % 3;
    A(2 * k, 2 * k) = A(2 * k + 1, 2 * k + 1) = -sigma * alpha;
    A(2 * k, 2 * k + 1) = sigma * beta;
    A(2 * k + 1, 2 * k) = -sigma * beta;
  }
  if (d % 2 == 1) A(d - 1, d - 1) = -sigma;

  const int blocks = std::max(1, a / (2 * (mu + 1)));
  for (int i = d; i < n - u; ++i) A(i, i) = 1.0;
  for (int b = 0; b < blocks; ++b)
    for (int j = 0; j < mu; ++j) E(d + b * (mu + 1) + j, d + b * (mu + 1) + j + 1) = 1.0;
  return pencil;
}

// Two sweeps over the planes (k, k+1), upwards and back.
template <typename Phase, typename Speed>
SmoothTransformation two_sweeps(int n, Phase phase, Speed speed) {
  SmoothTransformation T;
  for (int k = 1; k < n; ++k) T.rotations.push_back({k - 1, k, phase(k, 1), speed(k, 1)});
  for (int k = n - 1; k >= 1; --k) T.rotations.push_back({k - 1, k, phase(k, 2), speed(k, 2)});
  return T;
}

//   q' = v,  M v' = -K q - D v + G(t)^T lambda + f1,  0 = G(t) q + f3
// for q_i = y_i (transformed_pencil.h), lambda_j = cos(t + j). Row j of G: cos, sin of 0.3 j + omega t at 2j-1, 2j.
class Chain : public LinearFamily {
 public:
  Chain(int m, int c, double omega, double sigma)
      : LinearFamily("chain(" + std::to_string(m) + ", " + std::to_string(c) + ", omega=" + text(omega) +
                         ", sigma=" + text(sigma) + ")",
                     {2, 2 * m - 2 * c, 3 * c, 0, 0}),
        masses_(m),
        constraints_(c),
        omega_(omega),
        sigma_(sigma) {}

  void matrix_coefficients(double t, int order, double* E, double* A) const override;
  void vector_coefficients(double t, int order, double* f) const override;
  bool constant_E() const override { return true; }
  bool constant_A() const override { return omega_ == 0.0; }
  bool has_exact() const override { return true; }
  void exact(double t, double* x, double* xdot) const override;

 private:
  // Numbers of masses, springs and dampers count from 1.
  static double mass(int i) { return 1.0 + 0.5 * std::sin(static_cast<double>(i)); }
  double spring(int i) const { return sigma_ * (10.0 + 5.0 * std::cos(static_cast<double>(i))); }
  static double damper(int i) { return 0.5 + 0.2 * std::sin(static_cast<double>(i)); }
  SineCosine direction(int j, double t, int order) const { return sine_cosine(0.3 * j, omega_, t, order); }
  static Jet multiplier(int j, double t, int order) { return sine_cosine(j, 1.0, t, order).cosine; }

  int masses_, constraints_;
  double omega_, sigma_;
};

void Chain::matrix_coefficients(double t, int order, double* E, double* A) const {
  const int p = masses_;
  std::fill_n(E, m() * n() * (order + 1), 0.0);
  std::fill_n(A, m() * n() * (order + 1), 0.0);
  const auto at = [this](double* M, int i, int j, int k) -> double& { return M[i + j * m() + k * m() * n()]; };

  for (int i = 0; i < p; ++i) {
    E[i + i * m()] = 1.0;
    at(A, i, p + i, 0) = 1.0;
    at(E, p + i, p + i, 0) = mass(i + 1);
    at(A, p + i, i, 0) = -(spring(i + 1) + spring(i + 2));
    at(A, p + i, p + i, 0) = -(damper(i + 1) + damper(i + 2));
    if (i + 1 == p) continue;
    at(A, p + i, i + 1, 0) = at(A, p + i + 1, i, 0) = spring(i + 2);
    at(A, p + i, p + i + 1, 0) = at(A, p + i + 1, p + i, 0) = damper(i + 2);
  }
  for (int j = 0; j < constraints_; ++j) {
    const SineCosine G = direction(j + 1, t, order);
    const int row = 2 * p + j;
    for (int k = 0; k <= order; ++k) {
      at(A, row, 2 * j, k) = at(A, p + 2 * j, row, k) = G.cosine[k];
      at(A, row, 2 * j + 1, k) = at(A, p + 2 * j + 1, row, k) = G.sine[k];
    }
  }
}

void Chain::vector_coefficients(double t, int order, double* f) const {
  const int p = masses_;
  std::fill_n(f, m() * (order + 1), 0.0);
  const auto add = [&](int row, const Jet& jet) {
    for (int k = 0; k <= order; ++k) f[row + k * m()] += jet[k];
  };

  std::vector<Jet> q;
  for (int i = 1; i <= p; ++i) q.push_back(smooth_component(i, t, order + 2));
  for (int i = 0; i < p; ++i) add(p + i, mass(i + 1) * derivative(derivative(q[index(i)])));
  for (int s = 0; s <= p; ++s) {  // spring and damper s + 1 lie between the masses s and s + 1, counted from 1
    const Jet stretch = (s < p ? q[index(s)] : Jet()) - (s > 0 ? q[index(s - 1)] : Jet());
    const Jet force = spring(s + 1) * stretch + damper(s + 1) * derivative(stretch);
    if (s < p) add(p + s, force);
    if (s > 0) add(p + s - 1, -force);
  }
  for (int j = 0; j < constraints_; ++j) {
    const SineCosine G = direction(j + 1, t, order);
    const Jet lambda = multiplier(j + 1, t, order);
    add(2 * p + j, -(G.cosine * q[index(2 * j)] + G.sine * q[index(2 * j + 1)]));
    add(p + 2 * j, -(G.cosine * lambda));
    add(p + 2 * j + 1, -(G.sine * lambda));
  }
}

void Chain::exact(double t, double* x, double* xdot) const {
  const auto put = [&](int i, const Jet& jet) {
    x[i] = jet[0];
    if (xdot) xdot[i] = jet[1];
  };
  for (int i = 0; i < masses_; ++i) {
    const Jet q = smooth_component(i + 1, t, 2);
    put(i, q);
    put(masses_ + i, derivative(q));
  }
  for (int j = 0; j < constraints_; ++j) put(2 * masses_ + j, multiplier(j + 1, t, 1));
}

}  // namespace

std::unique_ptr<LinearFamily> kron(int n, int mu, double w, int u, int seed, double sigma, double scale) {
  SmoothTransformation P = two_sweeps(
      n, [&](int k, int s) { return -0.2 + 0.8 * std::cos(0.9 * k + 1.7 * s + 0.3 * seed); },
      [&](int k, int s) { return w * std::sin(0.6 * k + 1.9 * s); });
  SmoothTransformation Q = two_sweeps(
      n, [&](int k, int s) { return 0.4 + 0.9 * std::sin(1.3 * k + 2.1 * s + 0.7 * seed); },
      [&](int k, int s) { return w * std::cos(0.8 * k + 1.1 * s); });
  std::string name = "kron(" + std::to_string(n) + ", " + std::to_string(mu) + ", w=" + text(w) +
                     ", u=" + std::to_string(u) + ", seed=" + std::to_string(seed) + ", sigma=" + text(sigma) +
                     ", scale=" + text(scale) + ")";
  return std::make_unique<TransformedPencil>(std::move(name), kronecker_form(n, mu, u, sigma), std::move(P),
                                             std::move(Q), std::vector<double>(index(n), scale),
                                             std::vector<double>(index(n), 0.0));
}

std::unique_ptr<LinearFamily> chain(int m, int c, double omega, double sigma) {
  if (c < 1 || 2 * c > m) throw std::invalid_argument("chain: 1 <= c <= m/2 is necessary");
  return std::make_unique<Chain>(m, c, omega, sigma);
}

std::unique_ptr<LinearFamily> spin(double delta, double eta) {
  Formulas p;
  p.E = [=](const Jet& t) -> Entries { return {delta - 1.0, delta * t, 0, 0}; };
  p.A = [=](const Jet& t) -> Entries {
    return {-eta * (delta - 1.0), -eta * delta * t, delta - 1.0, delta * t - 1.0};
  };
  p.exact = [=](const Jet& t) -> Entries {
    const Jet x2 = exp((delta - eta) * t);
    return {x2 * (1.0 - delta * t) / (delta - 1.0), x2};
  };
  return formula_family("spin(" + text(delta) + ", " + text(eta) + ")", {0, 1, 1, 0, 0}, p);
}

std::unique_ptr<LinearFamily> rotated_ode(RowOperation rows, double rate) {
  const auto S = [=](const Jet& t) -> Entries {
    switch (rows) {
      case RowOperation::scaling: return {exp(-rate * t), 0, 0, exp(rate * t)};
      case RowOperation::rotation: return {cos(rate * t), -sin(rate * t), sin(rate * t), cos(rate * t)};
      case RowOperation::none: break;
    }
    return {1, 0, 0, 1};
  };
  Formulas p;
  p.E = S;
  p.A = [=](const Jet& t) -> Entries {  // S J
    const Entries s = S(t);
    return {-0.2 * s[0] - s[1], s[0] - 0.2 * s[1], -0.2 * s[2] - s[3], s[2] - 0.2 * s[3]};
  };
  p.exact = [](const Jet& t) -> Entries {
    const Jet decay = exp(-0.2 * t);
    return {decay * (cos(t) + 0.5 * sin(t)), decay * (0.5 * cos(t) - sin(t))};
  };
  p.constant_E = p.constant_A = rows == RowOperation::none;
  const char* names[] = {"none", "scaling", "rotation"};
  return formula_family(std::string("rotated_ode(") + names[static_cast<int>(rows)] + ", " + text(rate) + ")",
                        {0, 2, 0, 0, 0}, p);
}

}  // namespace sfdae_test
