// Public codes and the enumerations of the core that mirror them: the same numbers, checked here.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integration.h"
#include "linalg/rank.h"
#include "multibody/multibody_partition.h"
#include "reduction/null_space_form.h"
#include "sfdae/sfdae.h"
#include "starts/consistent_values.h"
#include "system/model.h"

namespace sfdae::core {

template <class Enum>
constexpr int code_of(Enum value) {
  return static_cast<int>(value);
}

static_assert(code_of(StructureUse::off) == SFDAE_STRUCTURE_OFF);
static_assert(code_of(StructureUse::automatic) == SFDAE_STRUCTURE_AUTOMATIC);
static_assert(code_of(StructureUse::required) == SFDAE_STRUCTURE_REQUIRED);
static_assert(code_of(LeadingTerm::automatic) == SFDAE_LEADING_AUTOMATIC);
static_assert(code_of(LeadingTerm::projector) == SFDAE_LEADING_PROJECTOR);
static_assert(code_of(LeadingTerm::matrix) == SFDAE_LEADING_MATRIX);
static_assert(code_of(LeadingTerm::identity) == SFDAE_LEADING_IDENTITY);
inline StructureUse structure_use_of(int code) { return static_cast<StructureUse>(code); }
inline LeadingTerm leading_term_of(int code) { return static_cast<LeadingTerm>(code); }

// InitialValues::keep_differential has no public code.
static_assert(code_of(InitialValues::nearest) == SFDAE_INITIAL_NEAREST);
static_assert(code_of(InitialValues::fixed) == SFDAE_INITIAL_FIXED);
static_assert(code_of(InitialValues::accept) == SFDAE_INITIAL_ACCEPT);
inline InitialValues initial_values_of(int code) { return static_cast<InitialValues>(code); }

static_assert(code_of(Method::bdf) == SFDAE_METHOD_BDF);
static_assert(code_of(Method::radau) == SFDAE_METHOD_RADAU);
static_assert(code_of(Method::automatic) == SFDAE_METHOD_AUTOMATIC);
inline Method method_of(int code) { return static_cast<Method>(code); }

static_assert(code_of(Subject::stage) == SFDAE_DECISION_STAGE);
static_assert(code_of(Subject::constraints) == SFDAE_DECISION_A2);
static_assert(code_of(Subject::differential) == SFDAE_DECISION_ET2);
static_assert(code_of(Subject::array) == SFDAE_DECISION_ARRAY);
static_assert(code_of(Subject::block) == SFDAE_DECISION_BLOCK);

static_assert(code_of(Verdict::clear) == SFDAE_VERDICT_CLEAR);
static_assert(code_of(Verdict::confirmed) == SFDAE_VERDICT_CONFIRMED);
static_assert(code_of(Verdict::unclear) == SFDAE_VERDICT_UNCLEAR);
static_assert(code_of(Verdict::user) == SFDAE_VERDICT_USER);

static_assert(code_of(Coordinates::orthogonal) == SFDAE_COORDINATES_ORTHOGONAL);
static_assert(code_of(Coordinates::permutation) == SFDAE_COORDINATES_PERMUTATION);
inline Coordinates coordinates_of(int code) { return static_cast<Coordinates>(code); }

}  // namespace sfdae::core
