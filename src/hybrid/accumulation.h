// Failures of hybrid runs, accumulation of transitions and modes that lead to each other at once; and error margins of
// transition functions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hybrid/hybrid_system.h"

namespace sfdae::core {

// Throws Failure if a user-supplied function has returned a value other than 0.
void demand_success(const char* what, const HybridRun& run, int returned);
// Value of the function of a transition. Throws Failure.
double function_at(const HybridRun& run, const sfdae_transition& given, double t, const double* x,
                   const double* xdot);
// Change of the function when x moves by its tolerances, or t by some rounding errors. Throws Failure.
double margin_of(const HybridSystem& hybrid, const sfdae_transition& given);
// Time in which x moves by a few tolerances. Shorter visits are counted.
double time_of_short_visit(const HybridRun& run, const Tolerances& tolerances);
void count_short_visit(HybridRun& run);
void note_passage(HybridTransition& transition, double t);
// Throws Failure, SFDAE_ZENO, if transitions accumulate at the last one.
void check_accumulation(HybridSystem& hybrid, const HybridTransition& last);

}  // namespace sfdae::core
