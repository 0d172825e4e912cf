// The theory's objects of a mechanical system with everything in it.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "../multibody/multibody_example.h"
#include "theory_check.h"

namespace {

using namespace sfdae_test;

// Constraints on positions and velocities that depend on t, q' = S v, at the point of the analysis.
template <bool with_S>
void check_example(Source source) {
  double mass = 1.3, x[9] = {0.4, 0.3, -0.5, 0.2, -0.1, 0.3, 0.0, 0.0, 0.0};
  const sfdae_multibody_problem problem = example<with_S>(source, mass);
  sfdae_solver* solver = nullptr;
  ASSERT_EQ(sfdae_create_multibody(&solver, &problem, nullptr), SFDAE_OK);
  const enum theory_kind kind = source == Source::recorded ? THEORY_MULTIBODY : THEORY_MULTIBODY_CALLBACKS;
  const theory_subject subject{"example", kind, 9, 9, solver};
  ASSERT_GE(sfdae_analyze_at(solver, 0.3, 1.0, x, nullptr), 0) << sfdae_message(solver);
  EXPECT_EQ(theory_check(&subject, 0.3), 0);
  sfdae_destroy(&solver);
}

TEST(ObjectsOfGeneralMultibody, HaveTheirProperties) {
  for (const Source source : {Source::recorded, Source::callbacks, Source::callbacks_with_curvature}) {
    check_example<false>(source);
    check_example<true>(source);
  }
}

}  // namespace
