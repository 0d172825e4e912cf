// Recording of the user's equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "expression/record.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// Calls the user's function once. Throws Failure, with a public status, for mistakes in the use of expressions,
// equations that were not set, and errors that the function returned. F(t, x, x') has m entries, there are n unknowns.
std::shared_ptr<const Record> record_equations(sfdae_equations_function F, int m, int n, void* user,
                                               const EquationNames& names = {});

// Records E x' - A x - f from its coefficients: calls the function once, with the same failures.
std::shared_ptr<const Record> record_linear_equations(sfdae_linear_equations_function coefficients, int m, int n,
                                                      void* user, const EquationNames& names = {});

}  // namespace sfdae::core
