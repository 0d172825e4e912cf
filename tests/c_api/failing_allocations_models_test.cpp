// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that is missing where models are written as source text, singular points are passed, and mechanical systems
// are solved with sparse matrices.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "calls_on_a_handle.h"
#include "sfdae/branches.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {
namespace {

class Models : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, Models, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// A pendulum by positions: mu = 2.
int pendulum_by_positions(sfdae_record* record, sfdae_expression, const sfdae_expression* x,
                          const sfdae_expression* xdot, sfdae_expression* F, void*) {
  for (int i = 0; i < 2; ++i) {
    F[i] = sfdae_subtract(xdot[i], x[i + 2]);
    F[i + 2] = sfdae_add(xdot[i + 2], sfdae_multiply(x[i], x[4]));
  }
  // The same number and the same product again and again.
  const sfdae_expression squares = sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1]));
  F[3] = sfdae_add(F[3], sfdae_multiply(sfdae_number(3.0), sfdae_parameter(record, "g", 2.0)));
  F[4] = sfdae_subtract(sfdae_multiply(sfdae_number(3.0), squares), sfdae_number(3.0));
  F[4] = sfdae_add(F[4], sfdae_subtract(sfdae_multiply(x[1], x[1]), sfdae_multiply(x[1], x[1])));
  return 0;
}
int create_recorded_pendulum(sfdae_solver** solver, const sfdae_options& options) {
  return create_recorded(solver, options, 5, pendulum_by_positions);
}

// sin t, cos t, through the singular point at pi / 2.
int circle(sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
           sfdae_expression* F, void*) {
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1.0));
  return 0;
}
int create_circle(sfdae_solver** solver, const sfdae_options& options) {
  return create_recorded(solver, options, 2, circle);
}

Call export_source(int language) {
  return {"export", [language](Session& s) {
            static std::vector<char> text(100000);
            text[0] = 'x';
            std::size_t needed = 7;
            const int status = armed(
                [&] { return sfdae_export_source(s.solver, language, "model", text.data(), text.size(), &needed); });
            if (status < 0) {
              EXPECT_EQ(text[0], 'x');
              EXPECT_EQ(needed, 7u);
              return status;
            }
            double sum = 0.0;
            for (std::size_t k = 0; k + 1 < needed; ++k) sum += static_cast<double>(text[k]);
            s.result = {static_cast<double>(needed), sum};
            return status;
          }};
}

// Every allocation of a recording fails once: what is recorded after that has lost nothing that it refers to.
TEST_P(Models, AreRecorded) {
  const std::vector<double> x = {1.0, 0.0, 0.0, 0.0, 0.0};
  Sequence sequence{
      "recording", x, {create_call(create_recorded_pendulum, options_of(GetParam(), 1e-4)), start("start", x)}, 1e-3};
  sequence.density = 10000;
  run_with_faults(sequence);
}

TEST_P(Models, AreWritten) {
  const std::vector<double> x = {1.0, 0.0, 0.0, 0.0, 0.0};
  run_with_faults({"source text",
                   x,
                   {create_call(create_recorded_pendulum, options_of(GetParam(), 1e-4)), start("start", x),
                    export_source(SFDAE_SOURCE_C), advance("advance", 0.5), export_source(SFDAE_SOURCE_FORTRAN),
                    advance("to the end", 1.0)},
                   1e-2});
}

// With BDF: Radau's few steps before the point may be too few to go on from once one has been lost, which is said.
TEST(FailingAllocationsOfBranches, PassSingularPoints) {
  const std::vector<double> x = {0.0, 1.0};
  run_with_faults({"singular point",
                   x,
                   {create_call(create_circle, options_of(SFDAE_METHOD_BDF, 1e-6)),
                    {"pass singular points",
                     [](Session& s) { return armed([&] { return sfdae_pass_singular_points(s.solver, 3); }); }},
                    start("start", x),
                    advance("advance", 1.0),
                    advance("across", 2.5)},
                   1e-2});
}

// Two hanging links by joints and multipliers.
int links(sfdae_record*, sfdae_expression, const sfdae_expression* q, const sfdae_expression*,
          const sfdae_multibody_formulas* out, void*) {
  for (int i = 0; i < 4; ++i) out->M[5 * i] = sfdae_number(1.0 + 0.1 * i);
  for (int k = 0; k < 2; ++k) {
    out->f[2 * k + 1] = sfdae_number(-9.81);
    const sfdae_expression x = k == 0 ? q[0] : sfdae_subtract(q[2], q[0]);
    const sfdae_expression y = k == 0 ? q[1] : sfdae_subtract(q[3], q[1]);
    out->g[k] = sfdae_subtract(sfdae_add(sfdae_multiply(x, x), sfdae_multiply(y, y)), sfdae_number(1.0));
  }
  return 0;
}
int create_links(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = 4;
  problem.num_constraints = 2;
  problem.equations = links;
  return sfdae_create_multibody(solver, &problem, &options);
}

TEST_P(Models, OfMechanicalSystemsAreSparse) {
  const std::vector<double> x = {1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  sfdae_options options = options_of(GetParam(), 1e-4);
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  run_with_faults(
      {"links",
       x,
       {create_call(create_links, options), start("start", x), advance("advance", 0.3), advance("to the end", 0.6)},
       1e-2});
}

}  // namespace
}  // namespace sfdae::test
