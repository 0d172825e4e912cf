// SPDX-License-Identifier: BSD-3-Clause
// Stages of mechanical systems side by side are those that are solved for one after the other.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "instruction_sets.h"
#include "integrate/radau_method.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "multibody/multibody_system.h"
#include "multibody/problem_of.h"
#include "multibody/recorded.h"

namespace sfdae::core {
namespace {

using namespace sfdae_test;

// The same problem, evaluated at several points at once or not; how often it is evaluated at one, and at several.
class Watched final : public MultibodyProblem {
 public:
  Watched(MultibodyProblem& problem, bool in_lanes)
      : MultibodyProblem(problem.sizes()), problem_(problem), in_lanes_(in_lanes) {}
  bool has_kinematics() const override { return problem_.has_kinematics(); }
  CallbackError constraints(double t, const double* q, double* g) override { return problem_.constraints(t, q, g); }
  CallbackError at_position(double t, const double* q, MultibodyTerms& terms) override {
    return problem_.at_position(t, q, terms);
  }
  CallbackError at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) override {
    ++one_by_one;
    return problem_.at_velocity(t, q, v, terms);
  }
  bool has_lanes() const override { return in_lanes_; }
  void prepare_lanes(MultibodyLaneTerms& terms) override { problem_.prepare_lanes(terms); }
  bool at_velocities(int count, const LaneBlock* t, const LaneBlock* qv, MultibodyLaneTerms& terms) override {
    ++at_once;
    return problem_.at_velocities(count, t, qv, terms);
  }
  CallbackError linearize(const MultibodyState& state, const MultibodyTerms& terms,
                          MultibodyJacobian& jacobian) override {
    return problem_.linearize(state, terms, jacobian);
  }
  int one_by_one = 0, at_once = 0;

 private:
  MultibodyProblem& problem_;
  bool in_lanes_;
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

// Some steps of size h; all stages of the last one.
struct Steps {
  std::vector<double> x;
  long factorizations = 0;
  PointStatus status = PointStatus::ok;
};

Steps solve_steps(MultibodyProblem& problem, const std::vector<double>& start, double t, double h, int stages) {
  constexpr int steps = 3;
  const int nl = problem.sizes().holonomic;
  IndexAnalysis analysis;
  analysis.t = t;
  analysis.values = characteristic_values(problem.sizes(), {nl, nl});
  MultibodySystem system(problem, {{nl, nl}, Coordinates::orthogonal}, analysis, start.data(),
                         start.data() + problem.sizes().positions);
  const std::size_t n = index(problem.sizes().unknowns()), s = index(stages);
  std::vector<double> x = start, w(n * s), guess(n * s);
  x.resize(n, 0.0);
  const std::vector<double> weights(n, 1e10);
  Steps result;
  for (int k = 0; k < steps && result.status == PointStatus::ok; ++k) {
    for (std::size_t i = 0; i < guess.size(); ++i) guess[i] = x[i % n];
    result.x.assign(n * s, 0.0);
    double reached = 0.0;
    const StageEquations equations{radau_method(stages).stages,
                                   t + k * h,
                                   t + (k + 1) * h,
                                   x.data(),
                                   x.data(),
                                   {guess.data(), x.data(), weights.data()}};
    result.status = system.solve_stages(equations, result.x.data(), w.data(), reached);
    if (result.status == PointStatus::ok) system.accept();
    std::copy_n(result.x.end() - static_cast<std::ptrdiff_t>(n), n, x.begin());
  }
  result.factorizations = system.counts().factorizations;
  return result;
}

// The iteration ends by the same decisions: what is left is rounding, which stiff forces amplify in those of the
// constraints.
void expect_close(const Steps& found, const Steps& expected, const std::string& what) {
  ASSERT_EQ(found.status, PointStatus::ok) << what;
  ASSERT_EQ(expected.status, PointStatus::ok) << what;
  const std::size_t n = found.x.size();
  ASSERT_EQ(n, expected.x.size());
  double scale = 0.0;
  for (const double value : expected.x) scale = std::max(scale, std::fabs(value));
  for (std::size_t i = 0; i < n; ++i)
    EXPECT_NEAR(found.x[i], expected.x[i], 1e-11 * std::max(1.0, scale)) << what << ", entry " << i;
  EXPECT_EQ(found.factorizations, expected.factorizations) << what;
}

// A lever with a heavy load: masses that are not diagonal, and more freedom than constraints, so that accelerations
// come from the whole matrix [M C^T; C 0].
struct Lever : MechanicalSystem {
  Lever() : MechanicalSystem({4, 1, 0}) {}
  template <class V>
  void mass(const V&, const V* q, V* M) const {
    using std::cos;
    for (int i = 0; i < 4; ++i) M[5 * i] = V(2.0 + i);
    M[1] = M[4] = 0.5 * cos(q[0]);
    M[11] = M[14] = V(0.25);
  }
  template <class V>
  void force(const V& t, const V* q, const V* v, V* f) const {
    using std::sin;
    for (int i = 0; i < 4; ++i) f[i] = -(1.0 + i) * q[i] - 0.1 * v[i] + sin(t);
  }
  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    using std::sin;
    g[0] = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - 1.0 + q[3] * sin(0.5 * t);
  }
  template <class V>
  void gradient(const V& t, const V* q, V* G) const {
    using std::sin;
    for (int j = 0; j < 3; ++j) G[j] = 2.0 * q[j];
    G[3] = sin(0.5 * t);
  }
};

template <class System>
void expect_same_stages(const System& system, const std::vector<double>& start, double t, double h,
                        const std::string& name) {
  const std::unique_ptr<MultibodyProblem> problem = recorded(system);
  ASSERT_TRUE(problem->has_lanes()) << name;
  for (const int stages : {3, 5, 7}) {
    Watched single(*problem, false);
    const Steps expected = solve_steps(single, start, t, h, stages);
    std::vector<double> portable;
    for_each_instruction_set([&](InstructionSet set) {
      Watched together(*problem, true);
      const Steps found = solve_steps(together, start, t, h, stages);
      const std::string what = name + ", " + std::to_string(stages) + " stages";
      expect_close(found, expected, what);
      // No stage had to be looked at alone; all of an iteration are evaluated at once.
      EXPECT_EQ(together.one_by_one + stages * together.at_once, single.one_by_one) << what;
      EXPECT_GT(together.at_once, 0) << what;
      if (set == InstructionSet::portable) portable = found.x;
      else EXPECT_EQ(found.x, portable) << what;  // the same bits
    });
  }
}

TEST(StagesInLanes, AreThoseOneByOne) {
  for_each_multibody_model([&](const TestProblem& problem, const auto& system) {
    // Short steps, so that no iteration fails.
    const double h = problem.name == "andrews" ? 2e-4 : problem.name == "slider_crank" ? 1e-4 : 0.01;
    expect_same_stages(system, problem.x0, problem.t0, h, problem.name);
  });
}

TEST(StagesInLanes, HaveMassesThatAreNotDiagonal) {
  expect_same_stages(Lever(), {0.6, 0.8, 0.0, 0.1, 0.8, -0.6, 0.3, 0.2}, 0.0, 0.02, "lever");
}

// A force that ceases to exist on the way: where stages are evaluated together the same step fails for the same reason.
struct Fading : MechanicalSystem {
  Fading() : MechanicalSystem({2, 1, 0}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    M[0] = M[3] = V(1.0);
  }
  template <class V>
  void force(const V&, const V* q, const V*, V* f) const {
    using std::sqrt;
    f[0] = V(0.0);
    f[1] = -sqrt(q[1] + 0.5);
  }
  template <class V>
  void constraints(const V&, const V* q, V* g) const {
    g[0] = q[0] * q[0] + q[1] * q[1] - 1.0;
  }
  template <class V>
  void gradient(const V&, const V* q, V* G) const {
    G[0] = 2.0 * q[0];
    G[1] = 2.0 * q[1];
  }
};

TEST(StagesInLanes, ReportTheEquationThatCannotBeEvaluated) {
  const Fading system;
  const std::unique_ptr<MultibodyProblem> problem = recorded(system);
  Watched single(*problem, false);
  const std::vector<double> start = {std::sqrt(1.0 - 0.16), -0.4, -0.4, -std::sqrt(1.0 - 0.16)};
  EXPECT_EQ(solve_steps(*problem, start, 0.0, 0.1, 7).status, PointStatus::callback_error);
  EXPECT_EQ(solve_steps(single, start, 0.0, 0.1, 7).status, PointStatus::callback_error);
  // Through the whole library, in words.
  sfdae_options options = multibody_options(1e-6, SFDAE_METHOD_RADAU);
  MultibodyRun run(system, sfdae_test::MultibodyForm::recorded, options);
  const int status = run.integrate(0.0, 10.0, start);
  EXPECT_LT(status, 0);
  EXPECT_NE(run.text(status).find("sqrt of"), std::string::npos) << run.text(status);
  EXPECT_NE(run.text(status).find("f[1]"), std::string::npos) << run.text(status);
}

}  // namespace
}  // namespace sfdae::core
