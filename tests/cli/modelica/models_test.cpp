// Whole models in the manner of OpenModelica's exports of the standard library.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "reading.h"

namespace sfdae::cli::testing {

namespace {

int num_unknowns(const FlatModel& model) {
  int result = 0;
  for (const Variable& one : model.variables)
    if (one.variability >= Variability::discrete) ++result;
  return result;
}

// Equations and what when clauses assign.
int num_equations(const FlatModel& model) {
  std::set<int> by_when;
  for (const When& when : model.whens)
    for (const WhenBranch& branch : when.branches)
      for (const Action& action : branch.actions)
        if (action.kind == Action::Kind::assign) by_when.insert(action.variable);
  return static_cast<int>(model.equations.size() + by_when.size());
}

}  // namespace

TEST(Models, HaveAsManyEquationsAsUnknowns) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SFDAE_TEST_MODELS)) {
    if (entry.path().extension() != ".bmo") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const FlatModel model = read_file(entry.path().filename().string());
    EXPECT_EQ(num_equations(model), num_unknowns(model));
    EXPECT_TRUE(model.warnings.empty()) << model.warnings[0];
    EXPECT_TRUE(model.experiment.stop.has_value());
    ++count;
  }
  EXPECT_GE(count, 12);
}

TEST(Models, OrientationsAreRotations) {
  const FlatModel model = read_file("multibody.bmo");
  const double phi = 0.7;
  double T[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      T[i][j] =
          solved(model, "frame.R.T[" + std::to_string(i + 1) + "," + std::to_string(j + 1) + "]", {{"rev.phi", phi}});
  EXPECT_DOUBLE_EQ(T[0][0], std::cos(phi));
  EXPECT_DOUBLE_EQ(T[0][1], std::sin(phi));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double dot = 0;
      for (int k = 0; k < 3; ++k) dot += T[i][k] * T[j][k];
      EXPECT_NEAR(dot, i == j, 1e-15);
    }
}

TEST(Models, MediaHaveTheHeatCapacityOfAir) {
  const FlatModel model = read_file("media.bmo");
  EXPECT_NEAR(solved(model, "cp", {{"T", 300}}), 1005, 1);  // J/(kg K)
  EXPECT_NEAR(solved(model, "cp", {{"T", 1500}}), 1211, 2);
  // cp = dh/dT
  const double h = 1e-2;
  const double slope =
      (solved(model, "h", {{"state.T", 400 + h}}) - solved(model, "h", {{"state.T", 400 - h}})) / (2 * h);
  EXPECT_NEAR(slope, solved(model, "cp", {{"T", 400}}), 1e-3);
  EXPECT_NEAR(solved(model, "d", {{"state.p", 101325}, {"state.T", 273.15}}), 1.292, 1e-3);
}

TEST(Models, FlowNetworksExpandLoopsAndFunctions) {
  const FlatModel model = read_file("flow_network.bmo");
  EXPECT_NEAR(solved(model, "root", {{"level[1]", 1}}), std::sqrt(2.0), 1e-12);
  const double dp = 0.3, delta = 0.02;
  EXPECT_DOUBLE_EQ(solved(model, "m_flow[2]", {{"level[1]", 0.5}, {"level[2]", 0.2}}),
                   dp / std::pow(dp * dp + delta * delta, 0.25));
  EXPECT_EQ(solved(model, "h_flow[1]", {{"m_flow[2]", -2}, {"T[1]", 300}, {"T[2]", 310}}), -620);
}

TEST(Models, StateGraphsUseTablesOfEnumerations) {
  const FlatModel model = read_file("state_graph.bmo");
  EXPECT_EQ(solved(model, "c", {{"a", 4}, {"b", 4}}), 4);
  EXPECT_EQ(solved(model, "c", {{"a", 3}, {"b", 4}}), 3);
  EXPECT_EQ(solved(model, "step2.newActive",
                   {{"step2.inPort.set[1]", 0}, {"step2.inPort.set[2]", 0}, {"step2.active", 1}, {"t2.fire", 0}}),
            1);
}

TEST(Models, TablesAreInterpolated) {
  const FlatModel model = read_file("tables.bmo");
  for (const auto& [u, y1, y2] : {std::tuple{-5.0, 1.0, 0.0},
                                  {-1.0, 1.0, 0.0},
                                  {-0.5, 0.5, 0.5},
                                  {0.25, 0.25, 1.5},
                                  {1.0, 1.0, 3.0},
                                  {2.0, 5.0, 3.5},
                                  {7.0, 9.0, 4.0}}) {
    EXPECT_EQ(solved(model, "y[1]", {{"u", u}}), y1) << u;
    EXPECT_EQ(solved(model, "y[2]", {{"u", u}}), y2) << u;
  }
  EXPECT_EQ(solved(model, "u_max"), 3);
  // 0 before its start, a jump at 1, continued after 2.
  for (const auto& [t, y] : {std::pair{0.25, 0.0}, {0.75, 0.0}, {1.0, 2.0}, {1.5, 3.0}, {2.0, 4.0}, {3.0, 6.0}})
    EXPECT_EQ(solved(model, "source.y", {{"time", t}}), y) << t;
  for (const auto& [t, y] : {std::pair{0.5, 5.0}, {1.0, 6.0}, {2.5, 6.0}, {3.25, 5.0}, {4.5, 6.0}})
    EXPECT_EQ(solved(model, "steps.y", {{"time", t}}), y) << t;
  const Expression& next = model.whens.at(0).branches[0].actions[0].value;
  EXPECT_EQ(value(model, next, {{"time", 0.5}}), 1);
  EXPECT_EQ(value(model, next, {{"time", 1}}), 2);
}

}  // namespace sfdae::cli::testing
