// What a call of DGELDA or SFNDAE writes to its arguments beside INFO(1) and IERR.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "f77/call_options.h"
#include "integrate/integration.h"
#include "reduction/index_analysis.h"

namespace sfdae::f77 {

// Before the first step: counts are 0, nothing has been integrated at t.
void clear_outputs(const Arguments& arguments, const Options& options, double t);
// CVAL.
void publish_characteristics(const Arguments& arguments, const core::CharacteristicValues& values);
// T, X, XPRIME, CVAL.
void publish_point(const Arguments& arguments, const core::IndexAnalysis& analysis, double t,
                   const std::vector<double>& x, const std::vector<double>& xdot);
// Steps before this call.
void publish_steps_before(const Arguments& arguments, long steps);
// points: at which the equations were evaluated in this call.
void publish_counts(const Arguments& arguments, const core::Integration& integration, long points);

bool has_zero_weight(const Arguments& arguments, const double* x);
// By 100 eps |X| in the weighted norm, or somewhat more if it takes more for all components to fit.
void enlarge_tolerances(const Arguments& arguments, const double* x);

}  // namespace sfdae::f77
