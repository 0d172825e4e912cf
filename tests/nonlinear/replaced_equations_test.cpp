// SPDX-License-Identifier: BSD-3-Clause
// Systems whose structure misleads: combinations of equations take the place of those that depend on others.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "checkpoint_of.h"
#include "family_run.h"
#include "nonlinear_run.h"
#include "sparse_run.h"

namespace sfdae_test {

namespace {

sfdae_options structure_required(int method = SFDAE_METHOD_BDF) {
  return options_of(SFDAE_STRUCTURE_REQUIRED, method);
}

// Nodal equations of a random network: resistors of kilo-ohms, capacitors of nanofarads, most of them between nodes,
// and a source of voltage at the first node, whose current is the last unknown. Time constants are microseconds.
class Network {
 public:
  explicit Network(unsigned seed) {
    RandomNumbers numbers(seed);
    const auto below = [&numbers](int bound) { return static_cast<int>(numbers.uniform(0.0, bound - 1e-9)); };
    nodes_ = 3 + below(10);
    const auto element = [&](int from, int to, double low, double high) {
      return Element{from, to, low * std::pow(high / low, numbers.uniform(0.0, 1.0))};
    };
    for (int k = 0; k < nodes_; ++k) resistors_.push_back(element(k, k == 0 ? -1 : below(k), 1e2, 1e5));
    for (int count = below(nodes_); count > 0; --count) {
      const int from = below(nodes_), to = below(nodes_ + 1) - 1;
      if (from != to) resistors_.push_back(element(from, to, 1e2, 1e5));
    }
    for (int count = 1 + below(nodes_); count > 0; --count) {
      const int from = below(nodes_), to = below(nodes_ + 1) - 1;
      if (from != to) capacitors_.push_back(element(from, to, 1e-11, 1e-9));
    }
    varies_ = below(2) == 1;
  }

  int n() const { return nodes_ + 1; }
  static constexpr double end = 3e-6;

  template <class V>
  void residual(const V& t, const V* x, const V* xdot, V* F) const {
    using std::sin;
    for (int i = 0; i < nodes_; ++i) F[i] = 0.0 * t;
    for (const Element& e : resistors_) {
      const V current = (voltage(x, e.from) - voltage(x, e.to)) / e.value;
      add(e, current, F);
    }
    for (const Element& e : capacitors_) {
      const V across = voltage(x, e.from) - voltage(x, e.to);
      const V slope = voltage(xdot, e.from) - voltage(xdot, e.to);
      add(e, varies_ ? e.value * (1.0 + 0.1 * sin(across)) * slope : e.value * slope, F);
    }
    F[0] = F[0] + x[nodes_];
    F[nodes_] = x[0] - sin(1e6 * t);
  }

 private:
  struct Element {
    int from, to;  // to = -1: ground
    double value;
  };
  template <class V>
  static V voltage(const V* x, int node) {
    return node < 0 ? 0.0 * x[0] : 1.0 * x[node];
  }
  template <class V>
  static void add(const Element& e, const V& current, V* F) {
    F[e.from] = F[e.from] + current;
    if (e.to >= 0) F[e.to] = F[e.to] - current;
  }

  int nodes_ = 0;
  bool varies_ = false;
  std::vector<Element> resistors_, capacitors_;
};

NonlinearEquations equations_of(const Network& network) {
  return sfdae_test::equations_of(
      network.n(), network.n(),
      [&network](const auto& t, const auto* x, const auto* xdot, auto* F) { network.residual(t, x, xdot, F); });
}

// [Currents i, voltages v, currents j of a load in delta]: the sum of the nodes is a constraint that no equation shows.
template <class V>
void delta_load(const V& t, const V* x, const V* xdot, V* F) {
  using std::sin;
  const V *i = x, *v = x + 3, *j = x + 6;
  for (int k = 0; k < 3; ++k) {
    F[k] = 1e-3 * xdot[k] + 5.0 * i[k] + v[k] - (100.0 + 10.0 * k) * sin(314.0 * t + 2.0 * k);
    F[3 + k] = i[k] - j[k] + j[(k + 2) % 3];
    F[6 + k] = v[k] - v[(k + 1) % 3] - (10.0 + 5.0 * k) * j[k];
  }
}

}  // namespace

// With constant factors: whatever cancels is seen, unless it depends on x which equations depend on which.
TEST(ReplacedEquations, SeeThroughSums) {
  const int count = scaled_count(1000, 40);
  int confirmed = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const SparseSystem system(static_cast<unsigned>(trial + 5001), SparseSystem::Mixing::constant);
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      NonlinearRun run(sfdae_test::equations_of(system), structure_required(method));
      const int status = run.start(0.2, 1.5, system.exact(0.2));
      if (!is_known(status)) {
        EXPECT_TRUE(status == SFDAE_RANK_UNCLEAR || status == SFDAE_NO_CONSISTENT_VALUES) << run.message();
        continue;
      }
      ++confirmed;
      EXPECT_EQ(run.values(), system.values());
      if (!is_known(run.advance(1.5))) continue;
      EXPECT_LT(error_in_tolerances(run.x, system.exact(1.5)), 10.0);
    }
  }
  EXPECT_GT(confirmed, 2 * count * 85 / 100);
}

// Entries of the system Jacobian that vanish at the solution and nowhere else: rounding errors of zeros are no pivots.
TEST(ReplacedEquations, AreNotConfirmedByRoundingErrors) {
  for (const unsigned seed : {4894u, 5010u, 7114u, 10090u, 11572u, 14442u, 14884u, 20374u, 127136u}) {
    SCOPED_TRACE(seed);
    const SparseSystem system(seed, SparseSystem::Mixing::any);
    NonlinearRun run(sfdae_test::equations_of(system), structure_required());
    EXPECT_LT(run.analyze(0.2, 1.0, system.exact(0.2)), 0);
    NonlinearRun whole(sfdae_test::equations_of(system), options_of(SFDAE_STRUCTURE_AUTOMATIC));
    ASSERT_EQ(whole.analyze(0.2, 1.0, system.exact(0.2)), SFDAE_OK) << whole.message();
    EXPECT_EQ(whole.values(), system.values());
  }
}

// Nodal equations of networks give what the whole array gives.
TEST(ReplacedEquations, AreThoseOfFloatingCapacitors) {
  const int count = scaled_count(300);
  int compared = 0, confirmed = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const Network network(static_cast<unsigned>(trial + 1));
    NonlinearRun run(equations_of(network), structure_required()),
        whole(equations_of(network), options_of(SFDAE_STRUCTURE_OFF));
    const std::vector<double> guess(static_cast<std::size_t>(network.n()), 0.0);
    const int status = run.integrate(0.0, Network::end, guess);
    confirmed += is_known(status) ? 1 : 0;
    if (!is_known(status) || !is_known(whole.integrate(0.0, Network::end, guess))) continue;
    ++compared;
    EXPECT_EQ(run.values(), whole.values());
    EXPECT_LT(error_in_tolerances(run.x, whole.x), 20.0);
  }
  EXPECT_EQ(confirmed, count);
  EXPECT_GT(compared, 9 * count / 10);
}

TEST(ReplacedEquations, FindTheConstraintOfADeltaLoad) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    const auto equations = sfdae_test::equations_of(
        9, 9, [](const auto& t, const auto* x, const auto* xdot, auto* F) { delta_load(t, x, xdot, F); });
    NonlinearRun run(equations, structure_required(method)),
        whole(equations, options_of(SFDAE_STRUCTURE_OFF, method));
    const std::vector<double> guess = {3.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    ASSERT_TRUE(is_known(run.integrate(0.0, 0.02, guess))) << run.message();
    ASSERT_TRUE(is_known(whole.integrate(0.0, 0.02, guess))) << whole.message();
    EXPECT_EQ(run.values(), (CharacteristicValues{1, 2, 7, 0, 0}));
    EXPECT_EQ(run.values(), whole.values());
    EXPECT_NEAR(run.x[0] + run.x[1] + run.x[2], 0.0, 1e-12);
    EXPECT_LT(error_in_tolerances(run.x, whole.x), 20.0);
  }
}

// x0' - x0' has no slope of x0 in it; nor has 2 x0' - (x0' + x0'), once it is multiplied out.
TEST(ReplacedEquations, LeaveOutWhatIsZero) {
  NonlinearRun run(sfdae_test::equations_of(3, 3,
                                            [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                              using std::sin;
                                              F[0] = xdot[0] - xdot[0] + x[1] - sin(t);
                                              F[1] = x[1] * (2.0 * xdot[2] - (xdot[2] + xdot[2])) + x[0] - xdot[1];
                                              F[2] = xdot[2] + x[2] * x[0];
                                            }),
                   structure_required());
  ASSERT_TRUE(is_known(run.integrate(0.0, 1.0, {1.0, 0.0, 1.0}))) << run.message();
  EXPECT_EQ(run.values(), (CharacteristicValues{1, 1, 2, 0, 0}));
  EXPECT_NEAR(run.x[0], std::cos(1.0), 1e-5);
  EXPECT_NEAR(run.x[2], std::exp(-std::sin(1.0)), 1e-4);
}

// Two equations are the same derivatives up to x0 = 1 only: what is done there has a name.
TEST(ReplacedEquations, AreGivenUpWhereNothingCancelsAnyMore) {
  const auto equations = NonlinearEquations{
      2, 2, [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
        const Expression slope = xdot[0] + xdot[1];
        F[0] = slope - 1.0;
        F[1] = slope + max(x[0] - 1.0, 0.0 * t) * xdot[0] - 1.0 + (x[1] - 0.5 * x[0]);
      }};
  NonlinearRun run(equations, structure_required());
  const int start = run.start(0.0, 4.0, {0.0, 0.0});
  ASSERT_TRUE(is_known(start)) << run.message();
  EXPECT_EQ(run.values(), (CharacteristicValues{0, 1, 1, 0, 0}));
  // x0 = 2 t / 3 to begin with.
  ASSERT_TRUE(is_known(run.advance(1.0))) << run.message();
  EXPECT_NEAR(run.x[0], 2.0 / 3.0, 1e-5);
  const int status = run.advance(4.0);
  EXPECT_TRUE(status == SFDAE_CHARACTERISTICS_CHANGED || status == SFDAE_STEP_TOO_SMALL ||
              status == SFDAE_RANK_UNCLEAR)
      << run.message();
  EXPECT_NEAR(run.t, 1.5, 0.1);
}

TEST(ReplacedEquations, GoOnFromCheckpoints) {
  const auto equations = sfdae_test::equations_of(
      9, 9, [](const auto& t, const auto* x, const auto* xdot, auto* F) { delta_load(t, x, xdot, F); });
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun first(equations, structure_required(method)), second(equations, structure_required(method));
    ASSERT_TRUE(is_known(first.integrate(0.0, 0.005, std::vector<double>(9, 0.0)))) << first.message();
    const std::vector<double> checkpoint = checkpoint_of(first.solver());
    ASSERT_EQ(sfdae_restore_checkpoint(second.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
        << second.message();
    second.x.resize(9);
    ASSERT_TRUE(is_known(first.advance(0.02)));
    ASSERT_TRUE(is_known(second.advance(0.02))) << second.message();
    EXPECT_EQ(std::memcmp(first.x.data(), second.x.data(), 9 * sizeof(double)), 0);
    for (std::size_t k = 0; k < checkpoint.size(); k += 7) {
      std::vector<double> damaged(checkpoint);
      damaged[k] = damaged[k] == 0.0 ? 3.0 : -damaged[k];
      NonlinearRun third(equations, structure_required(method));
      EXPECT_LT(sfdae_restore_checkpoint(third.solver(), damaged.data(), damaged.size()), 0) << k;
    }
  }
}

}  // namespace sfdae_test
