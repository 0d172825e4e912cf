// SPDX-License-Identifier: BSD-3-Clause
// Decoupled stages solve the same equations as one dense system of all stages.
#include "system/transformed_stages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "c_api/problems.h"
#include "family_problem.h"
#include "integrate/radau_method.h"
#include "linalg/dense.h"
#include "matrix_checks.h"
#include "problem/linear_problem.h"
#include "random_family.h"

namespace sfdae::core {

namespace {

using sfdae_test::random_matrix;
using sfdae_test::rounding;
using sfdae_test::size;

struct Form {
  TaylorData data;
  Arena arena;
  NullSpaceForm form;

  explicit Form(std::shared_ptr<const sfdae_test::LinearFamily> family) {
    const int mu = family->values().mu;
    sfdae_test::FamilyProblem callbacks(std::move(family));
    LinearProblem problem(functions_of(callbacks.problem));
    EXPECT_EQ(problem.evaluate(0.3, {mu, mu, mu}, 0.0, data).status, SFDAE_OK);
    const Judge::Settings settings;
    Judge judge(data, mu, settings, nullptr);
    const Carried carried = eliminate(data, mu, data.f_stack(mu), 1, judge, arena);
    form.resize(data.m, data.n, 0, carried.rows);
    form.build(data, carried, {}, LeadingTerm::identity, judge, arena);
  }
};

// tau/h sum_j D_ij [G; Uz^T] z_j - [B; 0] z_i, stages one below the other.
Matrix all_stages(const NullSpaceForm& form, double factor, const StageMethod& method) {
  const int q = form.unknowns(), s = method.s;
  Matrix all(s * q, s * q);
  for (int i = 0; i < s; ++i)
    for (int j = 0; j < s; ++j)
      for (int col = 0; col < q; ++col)
        for (int row = 0; row < q; ++row) {
          const bool is_free = row >= form.d;
          const double G = is_free ? form.Uz()(col, row - form.d) : form.G()(row, col);
          const double B = is_free || i != j ? 0.0 : form.B()(row, col);
          all(i * q + row, j * q + col) = factor * method.D_at(i, j) * G - B;
        }
  return all;
}

struct RealMatrix {
  std::vector<double> entries;
  std::vector<int> pivots;
  int q;
  RealMatrix(const NullSpaceForm& form, double c_tau)
      : entries(size(form.unknowns()) * size(form.unknowns()) + 1),
        pivots(size(form.unknowns()) + 1),
        q(form.unknowns()) {
    form.step_matrix(c_tau, View{entries.data(), q, q, std::max(q, 1)});
    EXPECT_TRUE(factor_lu(View{entries.data(), q, q, std::max(q, 1)}, pivots.data()));
  }
  ConstView lu() const { return {entries.data(), q, q, std::max(q, 1)}; }
};

// The largest residual of the dense system relative to its terms.
double relative_residual(TransformedStages& stages, Form& of, int s, double h, long& count) {
  const StageMethod& method = radau_method(s).stages;
  const double tau = of.data.time_scale, c_real = method.gamma / h;
  const int q = of.form.unknowns();
  EXPECT_TRUE(stages.factor(of.form, tau, method, c_real, count));
  const RealMatrix real(of.form, c_real * tau);
  const Matrix r = random_matrix(q, s, 17);
  Matrix z(q, s);
  stages.solve(method, real.lu(), real.pivots.data(), r, z, of.arena);
  const Matrix dense = all_stages(of.form, tau / h, method);
  std::vector<double> stacked(z.data(), z.data() + size(q * s));
  const std::vector<double> left = sfdae_test::times(dense, stacked.data());
  double worst = 0.0;
  for (int k = 0; k < q * s; ++k) worst = std::max(worst, std::fabs(left[size(k)] - r.data()[k]));
  return worst / (1.0 + sfdae_test::largest(dense) * sfdae_test::largest(stacked));
}

std::vector<std::shared_ptr<const sfdae_test::LinearFamily>> families() {
  std::vector<std::shared_ptr<const sfdae_test::LinearFamily>> all;
  for (int mu = 0; mu <= 2; ++mu) all.emplace_back(sfdae_test::kron(8, mu));
  all.emplace_back(sfdae_test::chain(4, 2));
  for (std::uint64_t seed = 1; seed <= 12; ++seed) all.emplace_back(sfdae_test::random_family(seed));
  return all;
}

}  // namespace

// T and its inverse multiply rounding errors by about 1e2 for seven stages.
TEST(TransformedStages, SolveTheSystemOfAllStages) {
  int with_free_components = 0;
  for (const auto& family : families()) {
    Form of(family);
    with_free_components += of.form.u > 0 ? 1 : 0;
    for (int s : {1, 3, 5, 7})
      for (double h : {1e-3, 0.1, -0.02}) {
        TransformedStages stages;
        long count = 0;
        EXPECT_LE(relative_residual(stages, of, s, h, count), 1e3 * rounding(of.form.unknowns() * s))
            << family->name() << ", s = " << s << ", h = " << h;
        EXPECT_EQ(count, of.form.unknowns() > 0 ? (s - 1) / 2 : 0);
      }
  }
  EXPECT_GT(with_free_components, 0);
}

TEST(TransformedStages, FactorAnewOnlyWhereTheStepOrTheFormIsAnother) {
  Form of(std::shared_ptr<const sfdae_test::LinearFamily>(sfdae_test::kron(8, 1)));
  Form other(std::shared_ptr<const sfdae_test::LinearFamily>(sfdae_test::kron(8, 1, 2.0)));
  TransformedStages stages;
  long count = 0;
  const double tolerance = 1e3 * rounding(56);
  EXPECT_LE(relative_residual(stages, of, 5, 0.1, count), tolerance);
  EXPECT_LE(relative_residual(stages, of, 5, 0.1, count), tolerance);
  EXPECT_EQ(count, 2);
  EXPECT_LE(relative_residual(stages, of, 5, 0.05, count), tolerance);
  EXPECT_EQ(count, 4);
  stages.forget();
  EXPECT_LE(relative_residual(stages, other, 5, 0.05, count), tolerance);
  EXPECT_EQ(count, 6);
  EXPECT_LE(relative_residual(stages, other, 7, 0.05, count), tolerance);
  EXPECT_EQ(count, 9);
}

// x' = 0 in one component with c = 0: a zero matrix has no inverse, and the next step starts afresh.
TEST(TransformedStages, TellASingularMatrix) {
  TaylorData data;
  data.resize(1, 1, {0, 0, 0});
  data.E(0)(0, 0) = 1.0;
  data.A(0)(0, 0) = 0.0;
  data.f(0)[0] = 0.0;
  data.measure();
  Arena arena;
  const Judge::Settings settings;
  Judge judge(data, 0, settings, nullptr);
  const Carried carried = eliminate(data, 0, data.f_stack(0), 1, judge, arena);
  NullSpaceForm form;
  form.resize(1, 1, 0, carried.rows);
  form.build(data, carried, {}, LeadingTerm::identity, judge, arena);
  TransformedStages stages;
  long count = 0;
  EXPECT_FALSE(stages.factor(form, 1.0, radau_method(3).stages, 0.0, count));
  EXPECT_TRUE(stages.factor(form, 1.0, radau_method(3).stages, 1.0, count));
}

}  // namespace sfdae::core
