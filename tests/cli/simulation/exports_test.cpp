// Models in the manner of exports of the standard library, read and solved; each exercises one part of the language.
// Expected values: exact ones where a formula is given, else ordinary differential equations written by hand for the
// same physics, solved by an explicit method of order 8 with tolerance 1e-12.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>

#include "modelica/read_model.h"

#include "model_builder.h"

namespace sfdae::cli::test {

namespace {

// With all states that can be eliminated, or none.
constexpr int all = 0, none = 1'000'000;

Result solved(const std::string& name, int reduce_above = 12) {
  const FlatModel model = read_model_file(SFDAE_TEST_MODELS "/" + name + ".bmo");
  EXPECT_TRUE(model.warnings.empty());
  Settings settings;
  settings.reduce_above = reduce_above;
  return solve(model, settings);
}

double at(const Result& result, const std::string& name, double t) {
  const std::vector<std::string>& names = result.trajectory.names;
  const auto place = std::find(names.begin(), names.end(), name);
  EXPECT_TRUE(place != names.end()) << name;
  std::size_t row = 0;
  while (row + 1 < result.trajectory.t.size() && result.trajectory.t[row + 1] <= t + 1e-9) ++row;
  return result.trajectory.values[row * names.size() + static_cast<std::size_t>(place - names.begin())];
}

TEST(Exports, PiecewiseLinearCircuit) {
  const Result result = solved("piecewise_circuit");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "L.i"), 0.289748681836, 1e-5);
  EXPECT_NEAR(last(result, "C1.v"), -1.267397659092, 1e-5);
  EXPECT_NEAR(last(result, "C2.v"), 0.042370503085, 1e-5);
}

// A gear joins inertias by a constraint whose coefficients are not 1; states are eliminated, or the index is 3.
TEST(Exports, GearTrainWithAndWithoutEliminatedStates) {
  for (const int reduce_above : {all, none}) {
    const Result result = solved("gear_train", reduce_above);
    EXPECT_SOLVED(result);
    EXPECT_EQ(result.characteristics.strangeness_index, reduce_above == all ? 0 : 2);
    EXPECT_EQ(result.num_replaced_states > 1, reduce_above == all);  // two angles are one either way
    EXPECT_NEAR(last(result, "inertia2.w"), -0.112249309204, 1e-6);
    EXPECT_NEAR(last(result, "inertia3.phi"), 0.16286164288, 1e-6);
  }
}

TEST(Exports, EnumerationsDecideHowAControllerStarts) {
  const Result result = solved("limited_pid");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "x"), 1.000000020824, 1e-7);
  EXPECT_NEAR(last(result, "PI.I.y"), 0.20000048932, 1e-6);
}

TEST(Exports, SlicesAndSteadyStates) {
  const Result result = solved("transfer_function");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "tf.y"), 2.522624613145, 1e-7);
}

TEST(Exports, TimersEdgesAndDelaysOfBooleans) {
  const Result result = solved("timers");
  EXPECT_SOLVED(result);
  EXPECT_EQ(last(result, "trig.y"), 9);
  EXPECT_EQ(last(result, "p.count"), 3);
  EXPECT_EQ(at(result, "onDelay.y", 3.1), 0);  // the pulse begins at 3, the delay is 0.2
  EXPECT_EQ(at(result, "onDelay.y", 3.3), 1);
}

// Frames with orientations, bodies with accelerations in their frames: an ordinary differential equation remains.
TEST(Exports, TreesOfBodiesLoseTheirConstraints) {
  const Result result = solved("double_pendulum");
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.characteristics.strangeness_index, 0);
  EXPECT_LE(result.num_unknowns, 12);
  EXPECT_EQ(result.num_replaced_states, 18);
  EXPECT_NEAR(last(result, "rev1.phi"), -2.583029660969, 1e-5);
  EXPECT_NEAR(last(result, "rev2.phi"), -0.640729164875, 1e-5);
  EXPECT_NEAR(last(result, "rev1.w"), 4.066946955639, 1e-5);
}

TEST(Exports, QuaternionsAsStates) {
  const Result result = solved("quaternions");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "body.w_a[1]"), -1.629257049586, 1e-6);
  EXPECT_NEAR(last(result, "body.Q[1]"), 0.146067654743, 1e-6);
  EXPECT_NEAR(last(result, "body.Q[4]"), 0.111287868569, 1e-6);
  EXPECT_NEAR(last(result, "body.r_0[2]"), 2.0 * 5.0 - 9.81 * 12.5, 1e-6);
}

// No forces but those of the constraints: the energy stays.
TEST(Exports, KinematicLoops) {
  const Result result = solved("planar_loop");
  EXPECT_SOLVED(result);
  const auto energy = [&](double t) {
    const double w1 = at(result, "w[1]", t), w2 = at(result, "w[2]", t), w3 = at(result, "w[3]", t);
    return 0.05 * w1 * w1 + 0.1 * w2 * w2 + 0.075 * w3 * w3;
  };
  EXPECT_NEAR(at(result, "w[1]", 0.0), 8.0, 1e-9);
  EXPECT_NEAR(energy(2.0), energy(0.0), 1e-6 * energy(0.0));
}

// i = V / (R + j (w L - 1 / (w C))) at w = 300: 100 / (10 - 3.333 j).
TEST(Exports, ComplexNumbersAsRecords) {
  const Result result = solved("complex_phasors");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "len"), 100.0 / std::hypot(10.0, 10.0 / 3.0), 1e-8);
  EXPECT_NEAR(last(result, "arg"), std::atan2(1.0, 3.0), 1e-8);
  EXPECT_NEAR(last(result, "par[2].re"), 4.0, 1e-12);
}

TEST(Exports, FunctionsOfMaterials) {
  const Result result = solved("magnetic_saturation");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "r.Phi"), -3.41112544561e-5, 1e-9);
}

TEST(Exports, FunctionsThatIterateAndBranch) {
  const Result result = solved("water_functions");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "T"), 303.0, 1e-6);
  EXPECT_NEAR(last(result, "root"), std::sqrt(303.0), 1e-7);
}

// Fixed levels and temperatures are conditions for masses and energies, which have no start values.
TEST(Exports, FixedValuesOfWhatIsNoState) {
  const Result result = solved("flow_reversal");
  EXPECT_SOLVED(result);
  EXPECT_NEAR(at(result, "T[2]", 0.0), 350.0, 1e-9);
  EXPECT_NEAR(last(result, "level[1]"), 0.601927335308, 1e-7);
  EXPECT_NEAR(last(result, "T[2]"), 310.03869586598, 1e-5);
}

// pre(x[i - 1]) in a loop is what x[i - 1] was before the event, whatever the algorithm has assigned.
TEST(Exports, AlgorithmsShiftRegisters) {
  const Result result = solved("shift_register");
  EXPECT_SOLVED(result);
  EXPECT_EQ(last(result, "n"), 5);
  for (int k = 1; k <= 5; ++k) EXPECT_EQ(last(result, "hist[" + std::to_string(k) + "]"), (6 - k) * (6 - k));
}

// a = 1 in [1, 3), b = 1 in [0.5, 2); rising after 0.2, falling after 0.1.
TEST(Exports, LogicOfNineValues) {
  const Result result = solved("digital_logic");
  EXPECT_SOLVED(result);
  for (const auto& [t, value] : {std::pair{1.1, 3}, {1.3, 4}, {2.05, 4}, {2.2, 3}})
    EXPECT_EQ(at(result, "id.y_auto", t), value) << t;
}

// Six ideal diodes and three inductors whose currents add up to zero.
TEST(Exports, BridgesSwitchWhetherOrNotStatesAreEliminated) {
  for (const int reduce_above : {all, none}) {
    const Result result = solved("diode_bridge", reduce_above);
    EXPECT_SOLVED(result);
    EXPECT_NEAR(last(result, "L1.i") + last(result, "L2.i") + last(result, "L3.i"), 0.0, 1e-6);
    EXPECT_LT(result.events.size(), 100u);
  }
}

}  // namespace
}  // namespace sfdae::cli::test
