// Comparison of derivatives that callbacks of a mechanical system supply with differences.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_callbacks.h"
#include "problem/difference_comparison.h"

namespace sfdae::core {

// The worst mismatch of g_q ('G'), g_t ('T'), gamma ('C') and eta ('H') near (t, q, v). Throws Failure if a callback
// fails.
DerivativeMismatch check_multibody_derivatives(CallbackMultibody& problem, double t, const double* q,
                                               const double* v);

}  // namespace sfdae::core
