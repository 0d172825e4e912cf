// Linkages that meet a singular configuration say so, whatever their coordinates; others do not.
//
// SFDAE_LINKAGES is the number of linkages of each kind; a campaign takes 500.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "family_run.h"
#include "multibody/linkage.h"
#include "multibody_run.h"

namespace sfdae::test {
namespace {

using sfdae_test::Linkage;
using sfdae_test::LinkageKind;
using Vector = std::vector<double>;
using Points = std::vector<Linkage::Point>;

constexpr LinkageKind plane_kinds[] = {LinkageKind::particles, LinkageKind::plane_bodies, LinkageKind::angles};
constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};

int count_of_linkages() {
  const char* text = std::getenv("SFDAE_LINKAGES");
  return text != nullptr ? std::atoi(text) : std::max(2, sfdae_test::scaled_count(6));
}

struct Draw {
  explicit Draw(unsigned seed) : engine(seed) {}
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); }
  std::mt19937 engine;
};

// At rest, or with velocities that the constraints do not allow as they are.
Vector start_of(const Linkage& linkage, double speed, Draw& draw) {
  Vector x = linkage.q0;
  for (int i = 0; i < linkage.velocities(); ++i) x.push_back(speed > 0.0 ? draw.number(-speed, speed) : 0.0);
  x.resize(x.size() + static_cast<std::size_t>(linkage.holonomic() + linkage.nonholonomic()), 0.0);
  return x;
}

double change_of(const MultibodyRun& run) {
  sfdae_change change;
  sfdae_change_init(&change, sizeof change);
  EXPECT_EQ(sfdae_get_change(run.solver.get(), &change), SFDAE_OK);
  EXPECT_GT(change.new_differential, change.old_differential);
  return change.t;
}

void expect_named(const MultibodyRun& run) {
  for (const char* words :
       {"The configuration is singular", "holonomic constraint", "the condition of the constraints"})
    EXPECT_NE(run.message().find(words), std::string::npos) << run.message();
}

// An anchor moves away until the chain is straight, beyond which there is no solution.
double time_of_straight_chain(const Linkage& linkage, const Points& p) {
  double length = 0.0;
  for (const double bar : linkage.lengths) length += bar;
  const auto slack = [&](double t) {
    const double x = p.front()[0] + linkage.drive * std::sin(linkage.frequency * t) - p.back()[0];
    return length - std::hypot(x, p.front()[1] - p.back()[1]);
  };
  double before = 0.0, after = 0.0;
  while (slack(after) > 0.0) before = after, after += 0.01;
  while (after - before > 1e-14) (slack(0.5 * (before + after)) > 0.0 ? before : after) = 0.5 * (before + after);
  return after;
}

TEST(DeadPoints, EndChainsThatAreStretched) {
  // Of the time, as what is left of a chain swings faster and faster before it is straight.
  constexpr double near = 1e-2;
  Draw draw(1);
  int runs = 0, unnamed = 0;
  for (int k = 0; k < count_of_linkages(); ++k)
    for (const LinkageKind kind : plane_kinds)
      for (const int method : methods) {
        SCOPED_TRACE(testing::Message() << k << ", kind " << static_cast<int>(kind) << ", method " << method);
        const double a = draw.number(0.3, 1.0), phi = draw.number(0.4, 1.2);
        Points p = {{0.0, 0.0, 0.0}, {a * std::cos(phi), a * std::sin(phi), 0.0}};
        if (k % 2 == 0) p.push_back({p[1][0] + draw.number(0.5, 1.0), p[1][1] + draw.number(-0.2, 0.3), 0.0});
        p.push_back({draw.number(1.0, 1.5), draw.number(-0.3, -0.1), 0.0});
        Linkage linkage = plane_chain(kind, p, draw.engine);
        linkage.drive = -4.0;
        linkage.frequency = 0.5;
        if (k % 3 == 0) linkage.gravity = 0.0;
        MultibodyRun run(linkage.problem(), options_of(method, std::pow(10.0, -draw.number(3.0, 9.0))));
        ASSERT_GE(run.start(0.0, 3.0, start_of(linkage, 3.0, draw)), SFDAE_OK) << run.message();
        ++runs;
        // What swings fastest may hide the singular configuration: one of 600.
        if (run.advance(3.0) == SFDAE_STEP_TOO_SMALL && ++unnamed <= runs / 100) continue;
        ASSERT_EQ(run.status, SFDAE_CHARACTERISTICS_CHANGED) << run.message();
        expect_named(run);
        const double end = time_of_straight_chain(linkage, p);
        EXPECT_LE(run.t, end);
        EXPECT_NEAR(run.t, end, near * end);
        EXPECT_NEAR(change_of(run), end, near * end);
        EXPECT_EQ(run.advance(3.0), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
      }
}

// A four-bar linkage with a crank of length a from (0, 0) and a rocker of length stretch a.
struct FourBar {
  Linkage linkage;
  double turned = 0.0;  // the crank against its body
  double height_of_crank(const Vector& x) const {
    if (linkage.kind == LinkageKind::particles) return x[1];
    return linkage.kind == LinkageKind::angles ? std::sin(x[0]) : std::sin(x[2] + turned);
  }
};

FourBar parallelogram(LinkageKind kind, double stretch, Draw& draw) {
  const double a = draw.number(0.3, 1.0), b = draw.number(1.2, 2.0), phi = draw.number(0.4, 1.2);
  const double x = a * std::cos(phi), y = a * std::sin(phi);
  FourBar result{
      plane_chain(kind, {{0, 0, 0}, {x, y, 0}, {b + stretch * x, stretch * y, 0}, {b, 0, 0}}, draw.engine)};
  if (kind == LinkageKind::plane_bodies) result.turned = phi - result.linkage.q0[2];
  return result;
}

// All bars of a parallelogram in one line: another motion, with bars crossed, branches off.
TEST(DeadPoints, OfParallelogramsAreNotPassedSilently) {
  Draw draw(2);
  int named = 0, silent = 0, runs = 0;
  for (int k = 0; k < count_of_linkages(); ++k)
    for (const LinkageKind kind : plane_kinds)
      for (const int method : methods) {
        SCOPED_TRACE(testing::Message() << k << ", kind " << static_cast<int>(kind) << ", method " << method);
        FourBar bars = parallelogram(kind, 1.0, draw);
        Linkage& linkage = bars.linkage;
        if (k % 2 == 0) linkage.gravity = 0.0;
        sfdae_options options = options_of(method, std::pow(10.0, -draw.number(3.0, 9.0)));
        options.max_steps = 2000;
        MultibodyRun run(linkage.problem(), options);
        ASSERT_GE(run.start(0.0, 3.0, start_of(linkage, 3.0, draw)), SFDAE_OK) << run.message();
        bool is_passed = false;
        for (int i = 1; i <= 60 && run.status >= 0; ++i) {
          run.advance(0.05 * i);
          is_passed = is_passed || (run.status == SFDAE_OK && bars.height_of_crank(run.x) <= 0.0);
        }
        ++runs;
        silent += is_passed ? 1 : 0;
        if (is_passed) continue;
        if (run.status == SFDAE_OK || run.status == SFDAE_MAX_STEPS) continue;
        ++named;
        EXPECT_EQ(run.status, SFDAE_CHARACTERISTICS_CHANGED) << run.message();
        expect_named(run);
        EXPECT_NEAR(bars.height_of_crank(run.x), 0.0, 1e-2);
        EXPECT_NEAR(change_of(run), run.t, 1e-2);
      }
  EXPECT_GE(named, runs / 2);
  // One of 600, with a tolerance of 1e-3.
  EXPECT_LE(silent, runs / 100);
}

TEST(DeadPoints, ThatAreNearlyMetArePassed) {
  Draw draw(3);
  int runs = 0, passed = 0;
  for (int k = 0; k < count_of_linkages(); ++k)
    for (const LinkageKind kind : {LinkageKind::particles, LinkageKind::angles})
      for (const int method : methods) {
        SCOPED_TRACE(testing::Message() << k << ", kind " << static_cast<int>(kind) << ", method " << method);
        const Linkage linkage = parallelogram(kind, 1.0 + draw.number(0.001, 0.03), draw).linkage;
        sfdae_options options = options_of(method, std::pow(10.0, -draw.number(4.0, 8.0)));
        options.max_steps = 10000;
        MultibodyRun run(linkage.problem(), options);
        ASSERT_GE(run.start(0.0, 3.0, start_of(linkage, 3.0, draw)), SFDAE_OK) << run.message();
        run.advance(3.0);
        EXPECT_NE(run.status, SFDAE_CHARACTERISTICS_CHANGED) << run.message();
        ++runs;
        passed += run.status == SFDAE_OK ? 1 : 0;
      }
  EXPECT_GE(passed, runs * 9 / 10);
}

// Anchors that jump away stop integrations for another reason. Not those of particles: bars to an anchor so far away
// turn over, which is what singular configurations look like.
TEST(DeadPoints, AreNotToBlameWhereDataJump) {
  Draw draw(4);
  int stopped = 0, blamed = 0;
  for (int k = 0; k < count_of_linkages(); ++k)
    for (const LinkageKind kind : plane_kinds)
      for (const int method : methods) {
        if (kind == LinkageKind::particles) continue;
        Points p = {{0.0, 0.0, 0.0}};
        for (int i = 0; i < 3; ++i)
          p.push_back({p.back()[0] + draw.number(-1.0, 1.0), p.back()[1] + draw.number(-1.0, 1.0), 0.0});
        Linkage linkage = plane_chain(kind, p, draw.engine);
        linkage.jump = 100.0;  // too far for any chain
        linkage.jump_at = draw.number(0.1, 0.5);
        sfdae_options options = options_of(method, 1e-6);
        options.max_steps = 5000;
        MultibodyRun run(linkage.problem(), options);
        if (run.start(0.0, 1.0, start_of(linkage, 0.3, draw)) < 0) continue;
        run.advance(1.0);
        stopped += run.status < 0 && run.status != SFDAE_CHARACTERISTICS_CHANGED ? 1 : 0;
        blamed += run.status == SFDAE_CHARACTERISTICS_CHANGED ? 1 : 0;
      }
  RecordProperty("stopped", stopped);
  RecordProperty("blamed", blamed);
  EXPECT_GT(stopped, 0);
  EXPECT_LE(blamed, stopped / 20);
}

TEST(DeadPoints, AreNotMetByLinkagesInGeneral) {
  std::mt19937 engine(5);
  int finished = 0;
  for (int k = 0; k < 5 * count_of_linkages(); ++k) {
    SCOPED_TRACE(k);
    Linkage linkage = sfdae_test::random_linkage(engine);
    if (linkage.drive != 0.0) continue;
    Draw draw(static_cast<unsigned>(k));
    sfdae_options options = options_of(k % 2, 1e-5);
    options.max_steps = 1000;
    MultibodyRun run(linkage.problem(), options);
    if (run.start(0.0, 1.0, start_of(linkage, 1.0, draw)) < 0) continue;
    run.advance(1.0);
    finished += run.status == SFDAE_OK ? 1 : 0;
    EXPECT_NE(run.status, SFDAE_CHARACTERISTICS_CHANGED) << run.message();
  }
  EXPECT_GT(finished, 0);
}

}  // namespace
}  // namespace sfdae::test
