// Points within steps of mechanical systems: Newton's method on both levels leads to those that terms at every
// iterate lead to, with fewer evaluations (docs/design/iteration_matrices.md).
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "multibody/multibody_system.h"
#include "multibody/problem_of.h"
#include "multibody/recorded.h"

namespace sfdae::core {
namespace {

using namespace sfdae_test;
using Vector = std::vector<double>;

// The same problem with or without an evaluation of both levels; how often what is evaluated.
class Watched final : public MultibodyProblem {
 public:
  Watched(MultibodyProblem& problem, bool has_levels)
      : MultibodyProblem(problem.sizes()), problem_(problem), has_levels_(has_levels) {}
  bool has_kinematics() const override { return problem_.has_kinematics(); }
  CallbackError constraints(double t, const double* q, double* g) override { return problem_.constraints(t, q, g); }
  bool constraints_on_both_levels(const MultibodyLevels& at, CallbackError& error) override {
    ++levels;
    if (!has_levels_ || !problem_.constraints_on_both_levels(at, error)) return false;
    const int nl = sizes().holonomic;
    for (int i = 0; i < nl; ++i) at.residuals[nl + i] += error_of_velocities;
    return true;
  }
  CallbackError at_position(double t, const double* q, MultibodyTerms& terms) override {
    return problem_.at_position(t, q, terms);
  }
  CallbackError at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) override {
    ++all_terms;
    return problem_.at_velocity(t, q, v, terms);
  }
  CallbackError linearize(const MultibodyState& state, const MultibodyTerms& terms,
                          MultibodyJacobian& jacobian) override {
    return problem_.linearize(state, terms, jacobian);
  }
  int levels = 0, all_terms = 0;
  double error_of_velocities = 0.0;

 private:
  MultibodyProblem& problem_;
  bool has_levels_;
};

template <class System>
std::unique_ptr<MultibodyProblem> recorded(const System& system) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = system.sizes.positions;
  problem.num_constraints = system.sizes.holonomic;
  problem.equations = &sfdae_test::RecordedMultibody<System>::multibody;
  problem.user = const_cast<System*>(&system);
  return problem_of(problem);
}

double largest(const double* values, int count) { return max_abs(values, count); }

// The point of the system near x, beside the one that it has been linearized at.
struct Restored {
  Vector x;
  int levels, all_terms;
};

Restored restore(Watched& problem, const TestProblem& given, double part) {
  const int nq = problem.sizes().positions, nl = problem.sizes().holonomic;
  IndexAnalysis analysis;
  analysis.t = given.t0;
  analysis.values = characteristic_values(problem.sizes(), {nl, nl});
  MultibodySystem system(problem, {{nl, nl}, Coordinates::orthogonal}, analysis, given.x0.data(),
                         given.x0.data() + nq);
  Vector rough(given.x0.begin(), given.x0.begin() + 2 * nq), x(index(problem.sizes().unknowns()));
  const double size_q = std::max(1e-3, largest(rough.data(), nq)), size_v = largest(rough.data() + nq, nq);
  for (int i = 0; i < nq; ++i) {
    rough[index(i)] += part * size_q * std::sin(1.0 + 2.3 * i);
    rough[index(nq + i)] += part * (size_v + size_q) * std::cos(1.0 + 1.9 * i);
  }
  problem.levels = problem.all_terms = 0;
  // A later time: some constraints depend on it.
  EXPECT_EQ(system.move_to(given.t0 + part), PointStatus::ok);
  system.restore(nullptr, rough.data(), x.data());
  return {x, problem.levels, problem.all_terms};
}

template <class System>
void expect_same_points(const System& system, const TestProblem& given) {
  const std::unique_ptr<MultibodyProblem> problem = recorded(system);
  const int nq = problem->sizes().positions, nl = problem->sizes().holonomic;
  // From 1e-3 on multipliers of stiff systems are large, and rounding errors of positions with them.
  for (const double part : {1e-13, 1e-10, 1e-7, 1e-5, 1e-4}) {
    Watched newton(*problem, true), other(*problem, false);
    const Restored found = restore(newton, given, part), expected = restore(other, given, part);
    const std::string what = given.name + ", " + std::to_string(part);
    const auto expect_near = [&](int first, int count, double roundings) {
      const double size = std::max(1.0, largest(expected.x.data() + first, count));
      for (std::size_t i = index(first); i < index(first + count); ++i)
        EXPECT_NEAR(found.x[i], expected.x[i], roundings * size) << what << ", entry " << i;
    };
    expect_near(0, nq, 1e-13);
    expect_near(nq, nq, 1e-11);
    expect_near(2 * nq, nl, 1e-8);
    // Outputs are as near as that as a rule; further away stiff systems take some more.
    const bool is_near = part <= 1e-7;
    EXPECT_LE(found.levels, is_near ? 3 : 5) << what;
    EXPECT_LE(found.all_terms, is_near ? 1 : 2) << what;
    EXPECT_GE(expected.all_terms, part > 1e-12 ? 2 : 1) << what;
  }
}

TEST(RestoredPoints, AreTheSameByNewtonsMethodOnBothLevels) {
  for_each_multibody_model([&](const TestProblem& given, const auto& system) { expect_same_points(system, given); });
}

// |q|^2 = t with masses that are not diagonal.
struct Balloon : MechanicalSystem {
  Balloon() : MechanicalSystem({3, 1, 0}) {}
  template <class V>
  void mass(const V&, const V* q, V* M) const {
    for (int i = 0; i < 3; ++i) M[4 * i] = V(2.0 + i);
    M[1] = M[3] = 0.5 * q[0];
  }
  template <class V>
  void force(const V&, const V* q, const V* v, V* f) const {
    for (int i = 0; i < 3; ++i) f[i] = -q[i] - v[i] * v[0];
  }
  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    g[0] = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - t;
  }
  template <class V>
  void gradient(const V&, const V* q, V* G) const {
    for (int j = 0; j < 3; ++j) G[j] = 2.0 * q[j];
  }
};

TestProblem start_of_balloon() {
  TestProblem given;
  given.name = "balloon";
  given.t0 = 1.0;
  given.x0 = {0.6, 0.8, 0.0, 0.3, 0.4, 1.0};  // 2 q v = 1
  return given;
}

TEST(RestoredPoints, MoveWithTime) { expect_same_points(Balloon(), start_of_balloon()); }

// |q|^2 - t and 2 q v - 1.
std::pair<double, double> residuals_of_balloon(const Vector& x, double t) {
  double square = -t, rate = -1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    square += x[i] * x[i];
    rate += 2.0 * x[i] * x[3 + i];
  }
  return {square, rate};
}

// From far away, too, where Newton's method is not as fast and terms at every iterate lead to the point.
TEST(RestoredPoints, FulfilBothLevelsToRounding) {
  const Balloon balloon;
  const std::unique_ptr<MultibodyProblem> problem = recorded(balloon);
  for (double part = 0.3; part > 1e-15; part *= 0.5) {
    Watched newton(*problem, true);
    const auto [square, rate] = residuals_of_balloon(restore(newton, start_of_balloon(), part).x, 1.0 + part);
    EXPECT_NEAR(square, 0.0, 1e-15) << part;
    EXPECT_NEAR(rate, 0.0, 5e-15) << part;
  }
}

// What Newton's method leaves of velocities is corrected in the end, and forces are those of the velocities that are
// found.
TEST(RestoredPoints, HaveVelocitiesCorrectedInTheEnd) {
  const Balloon balloon;
  const std::unique_ptr<MultibodyProblem> problem = recorded(balloon);
  constexpr double part = 1e-6;
  Watched newton(*problem, true), other(*problem, false);
  newton.error_of_velocities = 1e-5;
  const Restored found = restore(newton, start_of_balloon(), part),
                 expected = restore(other, start_of_balloon(), part);
  EXPECT_NEAR(residuals_of_balloon(found.x, 1.0 + part).second, 0.0, 5e-15);
  EXPECT_EQ(found.all_terms, 2);
  // Along Q2, from where the point was given.
  for (std::size_t i = 0; i < found.x.size(); ++i) EXPECT_NEAR(found.x[i], expected.x[i], 1e-9) << i;
}

}  // namespace
}  // namespace sfdae::core
