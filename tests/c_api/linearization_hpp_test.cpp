// SPDX-License-Identifier: BSD-3-Clause
// Linearization at a point, through the C++ interface: problems of all kinds whose poles, zeros and transfer
// functions are known.
#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

namespace {

using Complex = std::complex<double>;
using sfdae::Descriptor;
using sfdae::Linearization;
using sfdae::Matrix;
using sfdae::Spectrum;

constexpr double length = 0.4, gravity = 9.81, mass = 0.3;

int status_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const sfdae::Error& error) {
    EXPECT_STRNE(error.what(), "");
    return error.status();
  }
  return SFDAE_OK;
}

// x1' = x3, x2' = x4, m x3' = -x1 x5 + force, m x4' = -x2 x5 - m g, 0 = x1^2 + x2^2 - l^2: strangeness index 2. SI
// units.
sfdae::NonlinearProblem pendulum() {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const auto& record_of, auto x, auto xdot, auto F) {
    const sfdae::Expression m = sfdae::parameter(record_of, "mass", mass);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = m * xdot[2] + x[0] * x[4] - sfdae::parameter(record_of, "force", 0.0);
    F[3] = m * xdot[3] + x[1] * x[4] + m * gravity;
    F[4] = x[0] * x[0] + x[1] * x[1] - length * length;
  };
  return problem;
}

sfdae::MultibodyProblem mechanical_pendulum() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [](const auto& t, auto q, auto, auto to) {
    const sfdae::Expression m = sfdae::parameter(t, "mass", mass);
    to.M(0, 0) = to.M(1, 1) = m;
    to.f[0] = sfdae::parameter(t, "force", 0.0);
    to.f[1] = -m * gravity;
    to.g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - length * length);
  };
  return problem;
}

sfdae::MultibodyProblem pendulum_by_callbacks() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.mass = [](double, sfdae::ConstVectorRef, sfdae::MatrixRef M) { M(0, 0) = M(1, 1) = mass; };
  problem.forces = [](double, sfdae::ConstVectorRef, sfdae::ConstVectorRef, sfdae::VectorRef f) {
    f[1] = -mass * gravity;
  };
  problem.constraints = [](double, sfdae::ConstVectorRef q, sfdae::VectorRef g) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - length * length);
  };
  problem.constraint_jacobian = [](double, sfdae::ConstVectorRef q, sfdae::MatrixRef g_q) {
    g_q(0, 0) = q[0], g_q(0, 1) = q[1];
  };
  return problem;
}

// lambda (-l) + m g = 0 at the lower equilibrium, for the constraint (q^2 - l^2) / 2 and for twice that with x5 (-l)
// = -m g.
std::vector<double> lower_equilibrium() { return {0, -length, 0, 0, mass * gravity / length}; }

void expect_pendulum(Descriptor& descriptor, double tolerance) {
  const double omega = std::sqrt(gravity / length);
  const Spectrum poles = descriptor.poles();
  ASSERT_EQ(poles.values.size(), 2u);
  EXPECT_EQ(poles.summary.num_infinite, descriptor.num_unknowns() - 2);
  EXPECT_EQ(poles.summary.strangeness_index, 2);
  EXPECT_NEAR(poles.values[0].real(), 0.0, tolerance * omega);
  EXPECT_NEAR(poles.values[0].imag(), omega, tolerance * omega);
  EXPECT_EQ(poles.values[1], std::conj(poles.values[0]));
}

// x(s) = force / (m s^2 + m g / l)
void expect_response(Descriptor& descriptor) {
  for (const Complex s : {Complex(0.0, 1.0), Complex(2.0, -3.0), Complex(0.0, 0.0)}) {
    const Complex expected = 1.0 / (mass * (s * s + gravity / length));
    EXPECT_LE(std::abs(descriptor.transfer(s)[0] - expected), 1e-13 * std::abs(expected));
  }
  EXPECT_TRUE(descriptor.zeros().values.empty());
}

TEST(Pendulum, AtItsLowerEquilibriumSwingsWithTheRootOfGravityByLength) {
  sfdae::Solver solver(pendulum());
  sfdae::Point point{0.0, lower_equilibrium(), {}};
  solver.start(point, 1.0);
  Linearization choice;
  choice.input_parameters = {"force"};
  choice.output_unknowns = {0};
  Descriptor descriptor = solver.linearize(choice);
  expect_pendulum(descriptor, 1e-14);
  expect_response(descriptor);
  const Matrix B = descriptor.B();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(B(i, 0), i == 2 ? 1.0 : 0.0);
}

TEST(Pendulum, HasTheSamePolesAsAMechanicalSystem) {
  for (const bool recorded : {true, false}) {
    SCOPED_TRACE(recorded ? "recorded" : "callbacks");
    sfdae::Solver solver(recorded ? mechanical_pendulum() : pendulum_by_callbacks());
    sfdae::Point point{0.0, lower_equilibrium(), {}};
    solver.start(point, 1.0);
    Linearization choice;
    choice.output_unknowns = {0};
    if (recorded) choice.input_parameters = {"force"};
    else {
      choice.input_columns = Matrix(5, 1);
      choice.input_columns(2, 0) = 1.0;
    }
    Descriptor descriptor = solver.linearize(choice);
    expect_pendulum(descriptor, recorded ? 1e-14 : 1e-9);
    if (recorded) expect_response(descriptor);
  }
}

// Before any analysis where x and x' are given; at the upper equilibrium one pole is unstable.
TEST(Pendulum, NeedsNoAnalysisWhereThePointIsGiven) {
  sfdae::Solver solver(pendulum());
  Linearization choice;
  EXPECT_EQ(status_of([&] { solver.linearize(choice); }), SFDAE_NOT_STARTED);
  choice.x = {0, length, 0, 0, -mass * gravity / length};
  choice.xdot.assign(5, 0.0);
  const Spectrum poles = solver.linearize(choice).poles();
  const double omega = std::sqrt(gravity / length);
  ASSERT_EQ(poles.values.size(), 2u);
  EXPECT_NEAR(std::max(poles.values[0].real(), poles.values[1].real()), omega, 1e-13 * omega);
  EXPECT_NEAR(std::min(poles.values[0].real(), poles.values[1].real()), -omega, 1e-13 * omega);
}

// F_p by the parameter "mass" depends on x' and x: (0, 0, x3', x4' + g, 0).
TEST(Pendulum, MayHaveParametersThatMultiplyUnknownsAsInputs) {
  sfdae::Solver solver(pendulum());
  Linearization choice;
  choice.x = {0.3, 0.2, 0.1, 0.4, 0.5};
  choice.xdot = {1, 2, 3, 4, 0};
  choice.input_parameters = {"force", "mass"};
  const Matrix B = solver.linearize(choice).B();
  const double expected[] = {0, 0, -3, -4 - gravity, 0};
  for (int i = 0; i < 5; ++i) EXPECT_EQ(B(i, 1), expected[i]);
}

// An exponent, a number that is linear in time, and a table's argument.
TEST(Parameters, AreDifferentiatedWhereverTheyStand) {
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - pow(x[0], sfdae::parameter(t, "p", 1.5)) * t + sin(sfdae::parameter(t, "q", 2.0) * x[0]);
  };
  sfdae::Solver solver(problem);
  solver.set_parameter("p", 2.5);
  Linearization choice;
  choice.t = 3.0;
  choice.x = {1.7};
  choice.xdot = {0.0};
  choice.input_parameters = {"q", "p"};
  const Matrix B = solver.linearize(choice).B();
  EXPECT_NEAR(B(0, 0), -1.7 * std::cos(2.0 * 1.7), 1e-15);
  EXPECT_NEAR(B(0, 1), 3.0 * std::pow(1.7, 2.5) * std::log(1.7), 1e-14);
}

// E = [0 t; 0 0], A = I with a moving point: mu = 1, d = 0; x1 = -u2' t - u1 is frozen as x1 = -t u2' - u1.
TEST(LinearProblems, NeedNoSolution) {
  sfdae::LinearProblem problem(2, 2);
  problem.E = [](double t, int order, sfdae::MatrixRef E) { E(0, 1) = order == 0 ? t : order == 1 ? 1.0 : 0.0; };
  problem.A = [](double, int order, sfdae::MatrixRef A) {
    if (order == 0) A(0, 0) = A(1, 1) = 1.0;
  };
  sfdae::Solver solver(problem);
  Linearization choice;
  choice.t = 2.0;
  choice.input_columns = Matrix(2, 2);
  choice.input_columns(0, 0) = choice.input_columns(1, 1) = 1.0;
  choice.output_rows = Matrix(1, 2);
  choice.output_rows(0, 0) = 3.0;
  Descriptor descriptor = solver.linearize(choice);
  EXPECT_TRUE(descriptor.poles().values.empty());
  const Complex s(0.5, 4.0);
  const std::vector<Complex> H = descriptor.transfer(s);
  EXPECT_LE(std::abs(H[0] + 3.0), 1e-15);
  EXPECT_LE(std::abs(H[1] + 3.0 * 2.0 * s), 1e-14);
}

// x1' = -x1 + x2, x2 prescribed, without an equation: an input or held. x1 / x2 = 1 / (s + 1).
TEST(PrescribedUnknowns, AreInputsOrHeld) {
  sfdae::NonlinearProblem problem(1, 2);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) { F[0] = xdot[0] + x[0] - x[1]; };
  problem.prescribed = {1};
  problem.prescribed_values = [](double t, int, sfdae::VectorRef values) { values[0] = std::sin(t); };
  sfdae::Solver solver(problem);
  Linearization choice;
  choice.output_unknowns = {0};
  Descriptor held = solver.linearize(choice);
  EXPECT_EQ(held.num_equations(), 2);
  EXPECT_EQ(held.num_inputs(), 0);
  EXPECT_NEAR(held.poles().values.at(0).real(), -1.0, 1e-15);
  choice.input_unknowns = {1};
  Descriptor driven = solver.linearize(choice);
  EXPECT_LE(std::abs(driven.transfer({0.0, 1.0}).at(0) - 1.0 / Complex(1.0, 1.0)), 1e-15);
  EXPECT_EQ(driven.poles().values.size(), 1u);
}

// RCL ladder with 5 sections, r = 1/5, c = l = 1, a capacitor beside the source of voltage (a loop, index 2) and a
// resistor at the end; n = 2 * 5 + 1 potentials, 5 currents of inductors, 1 of the source. Admittance: Y = s c + 1 /
// (r + s l + 1 / Y'), from the end on. At s = 1 that is a rational number.
TEST(RclLadder, HasTheAdmittanceOfItsContinuedFraction) {
  constexpr int sections = 5, n = 3 * sections + 2;
  constexpr double r = 0.2, c = 1.0, l = 1.0;
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    const auto current = [&](int k) { return x[2 * sections + 1 + k]; };
    const sfdae::Expression source = x[n - 1];
    F[0] = x[0] - sfdae::parameter(t, "u", 0.0);
    for (int k = 0; k < sections; ++k) {
      const int node = 2 * k, middle = node + 1, next = node + 2;
      const sfdae::Expression through = (x[node] - x[middle]) / r;
      F[1 + 3 * k] = c * xdot[node] + through - (k == 0 ? source : current(k - 1));
      F[2 + 3 * k] = through - current(k);
      F[3 + 3 * k] = l * xdot[2 * sections + 1 + k] - x[middle] + x[next];
    }
    F[n - 1] = x[2 * sections] / r - current(sections - 1);
  };
  sfdae::Solver solver(problem);
  Linearization choice;
  choice.input_parameters = {"u"};
  choice.output_unknowns = {n - 1};
  Descriptor descriptor = solver.linearize(choice);
  const Spectrum poles = descriptor.poles();
  EXPECT_EQ(poles.summary.strangeness_index, 1);
  EXPECT_EQ(poles.values.size(), 9u);
  for (const Complex& pole : poles.values) EXPECT_LT(pole.real(), 0.0);
  EXPECT_NEAR(descriptor.transfer(1.0)[0].real(), 481132.0 / 312247.0, 1e-15 * n);
  for (const double omega : {1e-3, 1.0, 30.0}) {
    const Complex s(0.0, omega);
    Complex Y = 1.0 / r;
    for (int k = 0; k < sections; ++k) Y = s * c + 1.0 / (r + s * l + 1.0 / Y);
    EXPECT_LE(std::abs(descriptor.transfer(s)[0] - Y), 1e-14 * std::abs(Y));
  }
  // Y has a pole at infinity, and as many zeros as poles + 1.
  EXPECT_EQ(descriptor.zeros().values.size(), 10u);
}

// Gear and Petzold's pencil is singular wherever it is frozen, although x1 = t x2 and x2 = 0 are determined.
TEST(FrozenPencils, AreNamedWhereTheyAreSingularOrOthers) {
  sfdae::LinearProblem gear_petzold(2, 2);
  gear_petzold.E = [](double t, int order, sfdae::MatrixRef E) {
    if (order == 0) E(1, 0) = 1.0, E(1, 1) = -t;
    if (order == 1) E(1, 1) = -1.0;
  };
  gear_petzold.A = [](double t, int order, sfdae::MatrixRef A) {
    if (order == 0) A(0, 0) = -1.0, A(0, 1) = t;
    if (order == 1) A(0, 1) = 1.0;
  };
  sfdae::Solver solver(gear_petzold);
  Linearization choice;
  choice.t = 0.5;
  Descriptor singular = solver.linearize(choice);
  EXPECT_EQ(status_of([&] { singular.poles(); }), SFDAE_SINGULAR);

  // x1' + t x2' = -x2 + x3, 0 = x1 + t x2, x3' = x2: as x1' + t x2' + x2 = 0, x3 = 0 and all else is 0. Frozen, x3 =
  // x2.
  sfdae::NonlinearProblem rotating(3, 3);
  rotating.equations = [](const auto& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + t * xdot[1] + x[1] - x[2];
    F[1] = x[0] + t * x[1];
    F[2] = xdot[2] - x[1];
  };
  sfdae::Solver other(rotating);
  other.analyze(0.0, 1.0);
  EXPECT_EQ(other.characteristics().differential, 0);
  Descriptor descriptor = other.linearize(choice);
  EXPECT_EQ(status_of([&] { descriptor.poles(); }), SFDAE_CHARACTERISTICS_CHANGED);
  const Spectrum frozen = Descriptor(descriptor.E(), descriptor.A()).poles();
  ASSERT_EQ(frozen.values.size(), 1u);
  EXPECT_NEAR(std::abs(frozen.values[0] - 1.0), 0.0, 1e-14);
}

// A rod between two supports that both hold it along its axis: one multiplier is not determined, and neither is the
// pencil.
TEST(RedundantConstraints, MakeAPencilSingular) {
  sfdae::MultibodyProblem problem(2, 2);
  problem.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[1] = -q[1];
    to.g[0] = q[0];
    to.g[1] = 2.0 * q[0];
  };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {0, 0, 0, 0, 0, 0}, {}};
  solver.start(point, 1.0);
  Descriptor descriptor = solver.linearize({});
  EXPECT_EQ(status_of([&] { descriptor.poles(); }), SFDAE_SINGULAR);
}

// Total derivatives by a callback: x1' = -x1^3 + x2, 0 = x2 - x1, at x1 = 1: pole -3 + 1.
TEST(Callbacks, HaveRightHandSidesAsInputs) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.total_derivative = [](double, int order, sfdae::ConstMatrixRef x, sfdae::TotalDerivatives to) -> int {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    to.F[0] = x(0, 1) + x(0, 0) * x(0, 0) * x(0, 0) - x(1, 0);
    to.F[1] = x(1, 0) - x(0, 0);
    if (to.F_x) to.F_x(0, 0) = 3 * x(0, 0) * x(0, 0), to.F_x(0, 1) = to.F_x(1, 0) = -1, to.F_x(1, 1) = 1;
    if (to.F_xdot) to.F_xdot(0, 0) = 1;
    return SFDAE_OK;
  };
  sfdae::Solver solver(problem);
  Linearization choice;
  choice.x = choice.xdot = {1.0, 1.0};
  choice.input_columns = Matrix(2, 1);
  choice.input_columns(0, 0) = 5.0;
  choice.output_unknowns = {1};
  Descriptor descriptor = solver.linearize(choice);
  EXPECT_NEAR(descriptor.poles().values.at(0).real(), -2.0, 1e-14);
  EXPECT_NEAR(descriptor.transfer(1.0)[0].real(), 5.0 / 3.0, 1e-14);
  choice.input_parameters = {"u"};
  EXPECT_EQ(status_of([&] { solver.linearize(choice); }), SFDAE_ILLEGAL_ARGUMENT);
}

// Large recorded equations are solved by their minimal extension: 20 pendula, coupled with the one before, at rest.
TEST(MinimalExtension, IsLinearizedAlongTheSolution) {
  constexpr int pendula = 20;
  sfdae::NonlinearProblem problem(5 * pendula, 5 * pendula);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    for (int k = 0; k < 5 * pendula; k += 5) {
      F[k] = xdot[k] - x[k + 2];
      F[k + 1] = xdot[k + 1] - x[k + 3];
      F[k + 2] = xdot[k + 2] + x[k] * x[k + 4] - (k > 0 ? x[k - 5] : sfdae::Expression(0.0));
      F[k + 3] = xdot[k + 3] + x[k + 1] * x[k + 4] + (1.0 + k);
      F[k + 4] = x[k] * x[k] + x[k + 1] * x[k + 1] - 1.0;
    }
  };
  sfdae::Options options;
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, std::vector<double>(5 * pendula, 0.0), {}};
  for (std::size_t k = 0; k < 5 * pendula; k += 5)
    point.x[k + 1] = -1.0, point.x[k + 4] = 1.0 + static_cast<double>(k);
  solver.start(point, 1.0);
  solver.advance(0.5, point);
  Linearization choice;
  choice.t = 0.5;
  const Spectrum poles = solver.linearize(choice).poles();
  ASSERT_EQ(poles.values.size(), 2u * pendula);
  for (std::size_t k = 0; k < pendula; ++k)
    EXPECT_NEAR(poles.values[2 * k].imag(), std::sqrt(1.0 + 5.0 * static_cast<double>(k)), 1e-9);
}

TEST(Choices, AreChecked) {
  sfdae::Solver solver(pendulum());
  const auto status_with = [&](auto change) {
    Linearization choice;
    choice.x = lower_equilibrium();
    choice.xdot.assign(5, 0.0);
    change(choice);
    return status_of([&] { solver.linearize(choice); });
  };
  EXPECT_EQ(status_with([](Linearization&) {}), SFDAE_OK);
  EXPECT_EQ(status_with([](Linearization& c) { c.input_parameters = {"none"}; }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.input_parameters = {"force", "force"}; }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.input_unknowns = {5}; }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.input_unknowns = {1, 1}; }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.output_unknowns = {-1}; }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.x.clear(); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.x[0] = NAN; }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.t = NAN; }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_with([](Linearization& c) { c.xdot.clear(); }), SFDAE_NOT_STARTED);
}

// An integration goes on to the last bit as if nobody had asked.
TEST(Linearization, LeavesAnIntegrationAlone) {
  std::vector<double> ends[2];
  for (const bool asks : {false, true}) {
    sfdae::Solver solver(pendulum());
    sfdae::Point point{0.0, {0.24, -0.32, 0, 0, 1}, {}};
    solver.start(point, 1.0);
    for (const double t : {0.3, 0.7, 1.0}) {
      solver.advance(t, point);
      if (!asks) continue;
      Linearization choice;
      choice.t = t;
      choice.input_parameters = {"mass"};
      EXPECT_EQ(solver.linearize(choice).poles().values.size(), 2u);
    }
    ends[asks ? 1 : 0] = point.x;
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(DescriptorsOfMatrices, AreCheckedAndCopied) {
  Matrix E(1, 1), A(1, 1), B(1, 1), C(1, 1);
  E(0, 0) = B(0, 0) = C(0, 0) = 1.0;
  A(0, 0) = -2.0;
  Descriptor descriptor(E, A, B, C);
  EXPECT_EQ(descriptor.poles().values, std::vector<Complex>{-2.0});
  EXPECT_TRUE(descriptor.zeros().values.empty());
  EXPECT_EQ(descriptor.transfer({1.0, 0.0})[0], Complex(1.0 / 3.0));
  EXPECT_EQ(status_of([&] { descriptor.transfer({-2.0, 0.0}); }), SFDAE_SINGULAR);
  EXPECT_EQ(status_of([&] { Descriptor(E, Matrix(2, 1)); }), SFDAE_ILLEGAL_ARGUMENT);
  A(0, 0) = INFINITY;
  EXPECT_EQ(status_of([&] { Descriptor(E, A); }), SFDAE_ILLEGAL_ARGUMENT);
}

}  // namespace
