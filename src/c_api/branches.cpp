// Singular points of solutions: the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include "sfdae/branches.h"

#include <cstdio>

#include "c_api/solver.h"
#include "c_api/structs.h"

using namespace sfdae::core;

namespace {

static_assert(static_cast<int>(SingularKind::unknown) == SFDAE_SINGULAR_UNDETERMINED &&
              static_cast<int>(SingularKind::fold) == SFDAE_SINGULAR_FOLD &&
              static_cast<int>(SingularKind::crossing) == SFDAE_SINGULAR_CROSSING &&
              static_cast<int>(SingularKind::unbounded) == SFDAE_SINGULAR_UNBOUNDED);
static_assert(static_cast<int>(SingularPart::unknown) == SFDAE_PART_UNDETERMINED &&
              static_cast<int>(SingularPart::constraints) == SFDAE_PART_CONSTRAINTS &&
              static_cast<int>(SingularPart::differential) == SFDAE_PART_DIFFERENTIAL &&
              static_cast<int>(SingularPart::both) == SFDAE_PART_BOTH);

}  // namespace

extern "C" {

int sfdae_singular_point_init(sfdae_singular_point* point, size_t size) {
  return initialize(point, size, sfdae_singular_point{});
}

int sfdae_get_singular_point(const sfdae_solver* solver, sfdae_singular_point* result) {
  if (solver == nullptr || result == nullptr || !is_plausible_size(result->size)) return SFDAE_ILLEGAL_ARGUMENT;
  if (!solver->integration || !solver->integration->singular_point()) {
    if (!solver->message_explains_failure)
      std::snprintf(solver->message, sizeof solver->message, "no singular point has been met since sfdae_start.");
    return SFDAE_NOT_STARTED;
  }
  const SingularPoint& point = *solver->integration->singular_point();
  sfdae_singular_point found{};
  found.t = point.t;
  found.kind = static_cast<int>(point.kind);
  found.part = static_cast<int>(point.part);
  found.component = point.component;
  found.exponent = point.exponent;
  found.passed = point.is_passed ? 1 : 0;
  found.t_before = point.t_before;
  found.t_after = point.t_after;
  found.count = solver->integration->passed_points();
  fill_struct(result, found);
  return SFDAE_OK;
}

int sfdae_pass_singular_points(sfdae_solver* solver, long max_points) {
  return guarded(solver, [&] {
    if (max_points < 0) refuse_argument(format("max_points = %ld; it must be >= 0.", max_points));
    solver->pass_singular_points(max_points);
  });
}

}  // extern "C"
