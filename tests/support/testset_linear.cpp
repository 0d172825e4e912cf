// SPDX-License-Identifier: BSD-3-Clause
#include "testset_linear.h"

#include <cstdio>
#include <string>
#include <utility>

#include "formula_family.h"

namespace sfdae_test {

namespace {

std::string named(const char* name, double parameter) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%g", parameter);
  return std::string(name) + "_" + digits;
}

// Starts at the exact solution.
LinearTestProblem problem(std::string name, CharacteristicValues values, Formulas formulas, double t0, double tf) {
  LinearTestProblem p{formula_family(std::move(name), values, std::move(formulas)), t0, tf, {}};
  p.x0.resize(static_cast<std::size_t>(p.family->n()));
  p.family->exact(t0, p.x0.data(), nullptr);
  return p;
}

// E and A are constant.
Formulas constant(Entries E, Entries A) {
  Formulas p;
  p.E = [E = std::move(E)](const Jet&) { return E; };
  p.A = [A = std::move(A)](const Jet&) { return A; };
  p.constant_E = p.constant_A = true;
  return p;
}

}  // namespace

LinearTestProblem km_ex31_underdet() {
  Formulas p;
  p.E = [](const Jet& t) -> Entries { return {-t, t * t, -1, t}; };
  p.A = [](const Jet&) -> Entries { return {-1, 0, 0, -1}; };
  p.exact = [](const Jet& t) -> Entries { return {t * sin(t), sin(t)}; };
  p.constant_A = true;
  return problem("km_ex31_underdet", {1, 0, 1, 1, 1}, p, 0.5, 2.0);
}

LinearTestProblem km_ex32_gelda_demo() {
  Formulas p;
  p.E = [](const Jet& t) -> Entries { return {0, 0, 1, -t}; };
  p.A = [](const Jet& t) -> Entries { return {-1, t, 0, 0}; };
  p.f = [](const Jet& t) -> Entries { return {exp(-t), 0}; };
  p.exact = [](const Jet& t) -> Entries { return {(1 + t) * exp(-t), exp(-t)}; };
  return problem("km_ex32_gelda_demo", {1, 0, 2, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem gear_petzold(double eta) {
  Formulas p;
  p.E = [=](const Jet& t) -> Entries { return {0, 0, 1, eta * t}; };
  p.A = [=](const Jet& t) -> Entries { return {-1, -eta * t, 0, -(1 + eta)}; };
  p.f = [](const Jet& t) -> Entries { return {exp(-t), 0}; };
  p.exact = [=](const Jet& t) -> Entries { return {(1 - eta * t) * exp(-t), exp(-t)}; };
  return problem(named("gear_petzold_eta", eta), {1, 0, 2, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem rankdrop_t() {
  Formulas p;
  p.E = [](const Jet& t) -> Entries { return {0, t, 0, 0}; };
  p.A = [](const Jet&) -> Entries { return {1, 0, 0, 1}; };
  p.f = [](const Jet& t) -> Entries { return {t - 1, -t}; };
  p.exact = [](const Jet& t) -> Entries { return {1, t}; };
  p.constant_A = true;
  return problem("rankdrop_t", {1, 0, 2, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem nilpotent(int n) {
  const auto size = static_cast<std::size_t>(n);
  Entries E(size * size), A(size * size);
  for (std::size_t i = 0; i < size; ++i) {
    A[i * size + i] = 1;
    if (i + 1 < size) E[i * size + i + 1] = 1;
  }
  Formulas p = constant(E, A);
  p.f = [=](const Jet& t) { return Entries(size, -sin(t)); };
  // x_n = sin t, x_i = x_{i+1}' + sin t: x_i is the sum of the derivatives 0..n-i of the sine.
  p.exact = [=](const Jet& t) {
    const SineCosine y = sine_cosine(t);
    const Jet derivatives[] = {y.sine, y.cosine, -y.sine, -y.cosine};
    Entries x(size);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t k = 0; k < size - i; ++k) x[i] = x[i] + derivatives[k % 4];
    return x;
  };
  return problem("nilpotent_" + std::to_string(n), {n - 1, 0, n, 0, 0}, p, 0.3, 2.0);
}

LinearTestProblem index4_indigo() {
  Formulas p = constant({1, 0, 0, 0, 0, 0,  //
                         0, 1, 0, 0, 0, 0,  //
                         0, 0, 1, 0, 0, 0,  //
                         0, 0, 0, 1, 0, 0,  //
                         0, 0, 0, 0, 1, 0,  //
                         0, 0, 0, 0, 0, 0},
                        {0, -1, 1,  0,  0,  0,   //
                         0, 0,  -1, 1,  0,  0,   //
                         0, 0,  0,  -1, 1,  0,   //
                         0, 0,  0,  0,  -1, 1,   //
                         0, 0,  0,  0,  0,  -1,  //
                         1, 1,  1,  1,  1,  0});
  p.f = [](const Jet& t) -> Entries {
    const auto [s, c] = sine_cosine(t);
    return {c, c, c, c, c + s, -5 * s};
  };
  p.exact = [](const Jet& t) { return Entries(6, sin(t)); };
  return problem("index4_indigo", {3, 2, 4, 0, 0}, p, 0.0, 10.0);
}

LinearTestProblem brenan_index1() {
  Formulas p;
  p.E = [](const Jet& t) -> Entries { return {1, -t, 0, 0}; };
  p.A = [](const Jet& t) -> Entries { return {-1, 1 + t, 0, 1}; };
  p.f = [](const Jet& t) -> Entries { return {0, -sin(t)}; };
  p.exact = [](const Jet& t) -> Entries { return {exp(-t) + t * sin(t), sin(t)}; };
  return problem("brenan_index1", {0, 1, 1, 0, 0}, p, 0.0, 10.0);
}

LinearTestProblem ascher_petzold_ind2(double b) {
  Formulas p = constant({1, 0, 0, 0, 1, 0, 0, 0, 0}, {});
  p.constant_A = false;
  p.A = [=](const Jet& t) -> Entries {
    return {b - 1 / (2 - t),
            0,
            b * (2 - t),  //
            (b - 1) / (2 - t),
            -1,
            b - 1,  //
            2 + t,
            t * t - 4,
            0};
  };
  p.f = [](const Jet& t) -> Entries { return {(3 - t) / (2 - t) * exp(t), 2 * exp(t), -(t * t + t - 2) * exp(t)}; };
  p.exact = [](const Jet& t) -> Entries { return {exp(t), exp(t), -exp(t) / (2 - t)}; };
  return problem(named("ascher_petzold_ind2", b), {1, 1, 2, 0, 0}, p, 0.0, 1.0);
}

// x1 + x2 = s + c leaves x1' = -2 x1 + s + c (s = sin t, c = cos t), x1(0) = 0.
LinearTestProblem lin_overdet_consistent() {
  Formulas p = constant({1, 0, 0, 0, 1, 1}, {-1, 1, 1, 1, 0, 0});
  p.f = [](const Jet& t) -> Entries {
    const auto [s, c] = sine_cosine(t);
    return {0, -(s + c), c - s};
  };
  p.exact = [](const Jet& t) -> Entries {
    const auto [s, c] = sine_cosine(t);
    const Jet x1 = 0.6 * s + 0.2 * c - 0.2 * exp(-2 * t);
    return {x1, s + c - x1};
  };
  return problem("lin_overdet_consistent", {1, 1, 1, 0, 1}, p, 0.0, 1.0);
}

LinearTestProblem lin_underdet() {
  Formulas p = constant({1, 0, 0, 0, 0, 0}, {0, 1, 1, 1, 0, 0});
  p.f = [](const Jet& t) -> Entries { return {0, -sin(t)}; };
  p.exact = [](const Jet& t) -> Entries { return {sin(t), cos(t) - t, t}; };
  return problem("lin_underdet", {1, 0, 2, 1, 0}, p, 0.0, 1.0);
}

// m1 x1'' = k (x2 - x1 - l) + F,  m2 x2'' = -k (x2 - x1 - l),  x2 = g(t);  x = (x1, x2, v1, v2, F).
// Hence x1 = g - l + (m2/k) g'',  F = m1 x1'' + m2 g''. g goes from 1/2 to 5/2 for 1 <= t <= 3.
LinearTestProblem crane_mass_spring() {
  constexpr double m1 = 2.0, m2 = 1.0, k = 1.0, l = 0.5, g0 = 0.5, gf = 2.5;
  const auto path = [](const Jet& t) {
    const Jet s = (t - 1) / 2;
    const Jet s2 = s * s, s4 = s2 * s2;
    const Jet p = 1716 + s * (-9009 + s * (20020 + s * (-24024 + s * (16380 + s * (-6006 + s * 924)))));
    return g0 + (gf - g0) * (s * s2 * s4 * p);
  };
  Formulas p = constant({1, 0, 0,  0,  0,  //
                         0, 1, 0,  0,  0,  //
                         0, 0, m1, 0,  0,  //
                         0, 0, 0,  m2, 0,  //
                         0, 0, 0,  0,  0},
                        {0,  0,  1, 0, 0,  //
                         0,  0,  0, 1, 0,  //
                         -k, k,  0, 0, 1,  //
                         k,  -k, 0, 0, 0,  //
                         0,  1,  0, 0, 0});
  p.f = [=](const Jet& t) -> Entries { return {0, 0, -k * l, k * l, -path(t)}; };
  p.exact = [=](const Jet& t) -> Entries {
    const Jet g = path(Jet::variable(t[0], t.order() + 4));
    const Jet g_dd = derivative(derivative(g));
    const Jet x1 = g - l + m2 / k * g_dd;
    return {x1, g, derivative(x1), derivative(g), m1 * derivative(derivative(x1)) + m2 * g_dd};
  };
  return problem("crane_mass_spring", {4, 0, 5, 0, 0}, p, 1.7, 2.3);
}

// R(w t + 1) times the rows x1' = -x1 + x2,  0 = x1 + x2 - e^-t, R a rotation. x1' = -2 x1 + e^-t.
LinearTestProblem dense_rows(double w) {
  Formulas p;
  p.E = [=](const Jet& t) -> Entries {
    const auto [s, c] = sine_cosine(1 + w * t);
    return {c, 0, s, 0};
  };
  p.A = [=](const Jet& t) -> Entries {
    const auto [s, c] = sine_cosine(1 + w * t);
    return {-c - s, c - s, -s + c, s + c};
  };
  p.f = [=](const Jet& t) -> Entries {
    const auto [s, c] = sine_cosine(1 + w * t);
    return {s * exp(-t), -c * exp(-t)};
  };
  p.exact = [](const Jet& t) -> Entries {
    const Jet x1 = exp(-t) - 0.5 * exp(-2 * t);
    return {x1, exp(-t) - x1};
  };
  p.constant_E = p.constant_A = w == 0.0;
  return problem(named("dense_rows", w), {0, 1, 1, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem free_component() {
  Formulas p = constant({0, 0, 0, 1}, {0, 0, 0, -1});
  p.exact = [](const Jet& t) -> Entries { return {1, exp(-t)}; };
  return problem("free_component", {0, 1, 0, 1, 1}, p, 0.0, 1.0);
}

// x1' = 0 and 0 = x1: one of them is redundant. x4 and x5 appear nowhere.
LinearTestProblem singular_pencil_5() {
  Entries E(25), A(25);
  E[0] = 1;
  A[5 * 1 + 1] = A[5 * 2 + 2] = A[5 * 3 + 0] = 1;
  Formulas p = constant(E, A);
  p.f = [](const Jet& t) -> Entries { return {0, -sin(t), -cos(t), 0, 0}; };
  p.exact = [](const Jet& t) -> Entries { return {0, sin(t), cos(t), 1, 2}; };
  return problem("singular_pencil_5", {1, 0, 3, 2, 2}, p, 0.0, 1.0);
}

LinearTestProblem purely_algebraic() {
  Formulas p = constant({0, 0, 0, 0}, {1, 0, 0, 0});
  p.f = [](const Jet& t) -> Entries { return {-sin(t), 0}; };
  p.exact = [](const Jet& t) -> Entries { return {sin(t), 1}; };
  return problem("purely_algebraic", {0, 0, 1, 1, 1}, p, 0.0, 1.0);
}

LinearTestProblem no_equations() {
  Formulas p = constant({0, 0, 0, 0}, {0, 0, 0, 0});
  p.exact = [](const Jet&) -> Entries { return {1, 2}; };
  return problem("no_equations", {0, 0, 0, 2, 2}, p, 0.0, 1.0);
}

// x1' = -x1 + x3,  x2' = -2 x2 (times factor),  0 = x1 + x3 - sin t. x1' = -2 x1 + sin t, x1(0) = 1.
LinearTestProblem scaled_row(double factor) {
  Formulas p = constant({1, 0, 0, 0, factor, 0, 0, 0, 0}, {-1, 0, 1, 0, -2 * factor, 0, 1, 0, 1});
  p.f = [](const Jet& t) -> Entries { return {0, 0, -sin(t)}; };
  p.exact = [](const Jet& t) -> Entries {
    const Jet x1 = 0.4 * sin(t) - 0.2 * cos(t) + 1.2 * exp(-2 * t);
    return {x1, exp(-2 * t), sin(t) - x1};
  };
  return problem(named("scaled_row", factor), {0, 2, 1, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem redundant_row(double rho) {
  Formulas p = constant({1, 0, 0, 0, 0, 0}, {-1, 0, 0, 1, 0, 1});
  p.f = [=](const Jet& t) -> Entries { return {0, -sin(t), (rho - 1) * sin(t)}; };
  if (rho == 0.0) p.exact = [](const Jet& t) -> Entries { return {exp(-t), sin(t)}; };
  return {formula_family(named("redundant_row", rho), {0, 1, 1, 0, 1}, p), 0.0, 1.0, {1.0, 0.0}};
}

LinearTestProblem singular_perturbation(double eps) {
  Formulas p = constant({1, 0, 0, eps}, {-1, 0, 0, -1});
  p.exact = [=](const Jet& t) -> Entries { return {exp(-t), exp(-t / eps)}; };
  return problem(named("singular_perturbation", eps), {0, 2, 0, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem badly_scaled_ode(double eps) {
  Formulas p = constant({1, 0, 0, eps}, {-1, 0, 0, -eps});
  p.exact = [](const Jet& t) -> Entries { return {exp(-t), 2 * exp(-t)}; };
  return problem(named("badly_scaled_ode", eps), {0, 2, 0, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem vanishing_E(double a22) {
  Formulas p = constant({}, {-1, 0, 0, a22});
  p.constant_E = false;
  p.E = [](const Jet& t) -> Entries { return {1, 0, 0, t - 0.5}; };
  p.f = [=](const Jet& t) -> Entries { return {0, -(t - 0.5) * sin(t) - a22 * cos(t)}; };
  p.exact = [](const Jet& t) -> Entries { return {exp(-t), cos(t)}; };
  return problem(named("vanishing_E", a22), {0, 2, 0, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem vanishing_A() {
  Formulas p = constant({1, 0, 0, 0}, {});
  p.constant_A = false;
  p.A = [](const Jet& t) -> Entries { return {-1, 0, 0, t - 0.5}; };
  p.f = [](const Jet& t) -> Entries { return {0, -(t - 0.5) * cos(t)}; };
  p.exact = [](const Jet& t) -> Entries { return {exp(-t), cos(t)}; };
  return problem("vanishing_A", {0, 1, 1, 0, 0}, p, 0.0, 1.0);
}

LinearTestProblem changing_structure(double t_change) {
  Formulas p = constant({}, {-1, 0, 0, -1});
  p.constant_E = false;
  p.E = [=](const Jet& t) -> Entries { return {1, 0, 0, t[0] < t_change ? 1.0 : 0.0}; };
  p.f = [=](const Jet& t) -> Entries { return {0, t[0] < t_change ? cos(t) - sin(t) : cos(t)}; };
  p.exact = [](const Jet& t) -> Entries { return {exp(-t), cos(t)}; };
  return problem(named("changing_structure", t_change), {0, 2, 0, 0, 0}, p, 0.0, 1.0);
}

// Source between ground and node 1, R = 3 between 1 and 2, L = 1 between 2 and 3, C = 1/2 between 3 and ground;
// x = (e1, e2, e3, current of L, current of the source). e3'' + 3 e3' + 2 e3 = 2 sin t, e3(0) = e3'(0) = 0.
LinearTestProblem rlc_circuit() {
  constexpr double G = 1.0 / 3.0, L = 1.0, C = 0.5;
  Formulas p = constant({0, 0, 0, 0, 0,  //
                         0, 0, 0, 0, 0,  //
                         0, 0, C, 0, 0,  //
                         0, 0, 0, L, 0,  //
                         0, 0, 0, 0, 0},
                        {G,  -G, 0,  0, 1,  //
                         -G, G,  0,  1, 0,  //
                         0,  0,  0,  1, 0,  //
                         0,  1,  -1, 0, 0,  //
                         1,  0,  0,  0, 0});
  p.f = [](const Jet& t) -> Entries { return {0, 0, 0, 0, -sin(t)}; };
  p.exact = [](const Jet& t) -> Entries {
    const Jet e3 = 0.2 * sin(t) - 0.6 * cos(t) + exp(-t) - 0.4 * exp(-2 * t);
    const Jet current = C * (0.2 * cos(t) + 0.6 * sin(t) - exp(-t) + 0.8 * exp(-2 * t));
    return {sin(t), sin(t) - current / G, e3, current, -current};
  };
  return problem("rlc_circuit", {0, 2, 3, 0, 0}, p, 0.0, 10.0);
}

// C e' + i = 0, e = sin t, C = 1/2.
LinearTestProblem capacitor_loop() {
  constexpr double C = 0.5;
  Formulas p = constant({C, 0, 0, 0}, {0, -1, 1, 0});
  p.f = [](const Jet& t) -> Entries { return {0, -sin(t)}; };
  p.exact = [](const Jet& t) -> Entries { return {sin(t), -C * cos(t)}; };
  return problem("capacitor_loop", {1, 0, 2, 0, 0}, p, 0.0, 10.0);
}

std::vector<LinearTestProblem> linear_testset() {
  std::vector<LinearTestProblem> all;
  all.push_back(km_ex31_underdet());
  all.push_back(km_ex32_gelda_demo());
  for (double eta : {-2.0, -1.0, 0.5}) all.push_back(gear_petzold(eta));
  all.push_back(rankdrop_t());
  for (int n = 2; n <= 6; ++n) all.push_back(nilpotent(n));
  all.push_back(index4_indigo());
  all.push_back(brenan_index1());
  all.push_back(ascher_petzold_ind2());
  all.push_back(lin_overdet_consistent());
  all.push_back(lin_underdet());
  all.push_back(crane_mass_spring());
  for (double w : {0.0, 1.0}) all.push_back(dense_rows(w));
  all.push_back(free_component());
  all.push_back(singular_pencil_5());
  all.push_back(purely_algebraic());
  all.push_back(no_equations());
  all.push_back(scaled_row());
  all.push_back(redundant_row(0.0));
  all.push_back(singular_perturbation(1e-3));
  all.push_back(badly_scaled_ode());
  all.push_back(vanishing_E());
  all.push_back(vanishing_A());
  all.push_back(changing_structure());
  all.push_back(rlc_circuit());
  all.push_back(capacitor_loop());
  return all;
}

}  // namespace sfdae_test
