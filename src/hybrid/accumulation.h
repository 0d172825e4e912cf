// Where a hybrid system cannot go on: transitions that accumulate, modes that lead to each other at once; and how
// well the functions of transitions are known.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hybrid/hybrid_system.h"

namespace sfdae::core {

// Throws Failure where a function of the user's has returned another value than 0.
void demand_success(const char* what, const HybridRun& run, int returned);
// The function of a transition. Throws Failure.
double function_at(const HybridRun& run, const sfdae_transition& given, double t, const double* x,
                   const double* xdot);
// How much it changes when x moves by its tolerances, or t by some roundings. Throws Failure.
double margin_of(const HybridSystem& hybrid, const sfdae_transition& given);
// The time in which x moves by a few tolerances. Visits that end before are counted.
double time_of_short_visit(const HybridRun& run, const Tolerances& tolerances);
void count_short_visit(HybridRun& run);
void note_passage(HybridTransition& transition, double t);
// Throws Failure, SFDAE_ZENO, after a transition that is one of too many.
void check_accumulation(HybridSystem& hybrid, const HybridTransition& last);

}  // namespace sfdae::core
