// The map from residuals to changes is what the elimination does with them.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/residual_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "array/nonlinear_system.h"
#include "instruction_sets.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "nonlinear_examples.h"

namespace sfdae::core {
namespace {

using namespace sfdae_test;
using Vector = std::vector<double>;

// Of these residuals, by the elimination.
Vector changes_of(const ArrayLinearization& linearization, const Vector& f, Arena& arena) {
  const NullSpaceForm& form = linearization.form();
  const std::size_t n = index(form.n);
  const int level = linearization.elimination().level();
  Vector transformed(f.size() + 1), changes(n * index(level + 2)), image(index(form.m)), q(index(form.d) + 1),
      z(index(form.unknowns()) + 1), xp(n);
  linearization.elimination().transform(f.data(), transformed.data(), arena);
  form.constraints().solve(transformed.data(), 1.0, xp.data(), arena);
  multiply(1.0, Op::plain, linearization.data().E(0), xp.data(), 0.0, image.data());
  multiply(-1.0, Op::transposed, form.Z1(), image.data(), 0.0, q.data());
  form.solve_G(q.data(), z.data(), arena);
  std::copy(xp.begin(), xp.end(), changes.begin());
  multiply(1.0, Op::plain, form.T2(), z.data(), 1.0, changes.data());
  linearization.elimination().recover(linearization.data(), {f.data(), transformed.data()}, changes.data(),
                                      changes.data() + n, arena);
  return changes;
}

void expect_same(const NonlinearExample& e, ResidualMap& map, Arena& arena) {
  const ArrayLinearization& linearization = e.system->linearization();
  const AnalyzedEquations& problem = e.system->analyzed_equations();
  ASSERT_TRUE(map.make(problem, linearization, arena));
  Vector f(index(problem.array_rows()));
  for (std::size_t i = 0; i < f.size(); ++i) f[i] = std::sin(1.0 + 2.3 * static_cast<double>(i));
  const Vector expected = changes_of(linearization, f, arena);
  Vector found(expected.size());
  map.apply(f.data(), found.data());
  double size = 1.0;
  for (const double value : expected) size = std::max(size, std::fabs(value));
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12 * size) << "entry " << i;
}

// The constraint of the pendulum is the end of a chain of derivatives; the hyperbola has one of order 0.
TEST(ResidualMap, IsWhatTheEliminationDoes) {
  for_each_instruction_set([](InstructionSet) {
    for (const bool is_pendulum : {true, false}) {
      NonlinearExample e(is_pendulum ? record_of_pendulum() : record_of_hyperbola());
      const double c = std::cos(0.6), s = std::sin(0.6);
      e.analyze(0.0, 1.0, is_pendulum ? Vector{s, -c, 0.7 * c, 0.7 * s, 1.0} : Vector{1.0, 1.0});
      ResidualMap map;
      Arena arena;
      map.resize(e.system->analyzed_equations());
      expect_same(e, map, arena);
    }
  });
}

// A renewal at another point asks for another map.
TEST(ResidualMap, FollowsTheLinearization) {
  NonlinearExample e(record_of_hyperbola());
  e.analyze(0.0, 1.0, {1.0, 1.0});
  ResidualMap map;
  Arena arena;
  map.resize(e.system->analyzed_equations());
  expect_same(e, map, arena);
  Jet jet = e.system->jet();
  jet.x[0] = jet.x[1] = 0.25;
  jet.column(1)[0] = jet.column(1)[1] = -0.0625;
  ASSERT_EQ(e.system->set_point(jet), PointStatus::ok);
  expect_same(e, map, arena);
}

// Where equations are redundant it is by the elimination that contradictions are seen. Free components and large
// arrays are left to it, too.
TEST(ResidualMap, IsLeftToTheEliminationElsewhere) {
  Arena arena;
  for (const RecordPointer& record : {record_with_redundant_equation(), record_with_free_component()}) {
    NonlinearExample e(record);
    e.analyze(0.0, 1.0, Vector(index(record->n()), 1.0));
    ASSERT_GT(e.analysis.v_hat + e.analysis.values.u, 0);
    ResidualMap map;
    map.resize(e.system->analyzed_equations());
    EXPECT_FALSE(map.make(e.system->analyzed_equations(), e.system->linearization(), arena));
  }
  Recording r(30);
  std::vector<Term> F;
  for (int i = 0; i < 30; ++i) F.push_back(r.xdot[index(i)] + r.x[index(i)]);
  NonlinearExample e(r.finish(F));
  e.analyze(0.0, 1.0, Vector(30, 1.0));
  ResidualMap map;
  map.resize(e.system->analyzed_equations());
  EXPECT_FALSE(map.make(e.system->analyzed_equations(), e.system->linearization(), arena));
}

}  // namespace
}  // namespace sfdae::core
