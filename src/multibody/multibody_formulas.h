// The formulas of a mechanical system, as nodes of a recorder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "expression/recorder.h"
#include "multibody/multibody_problem.h"

namespace sfdae::core {

class TaylorEvaluator;

// The unknowns of the recorder are (q, v); matrices column by column. All except f depend on t and q alone.
struct MultibodyFormulas {
  MultibodySizes sizes;
  std::vector<int> M, f, g, S, H, h;
};

bool is_number(const Recorder& recorder, int node);
// Returns whether S is the identity.
bool is_identity(const Recorder& recorder, const std::vector<int>& S, int rows, int cols);
// name[0], name[1], ...
std::vector<std::string> numbered(const char* name, int count);
// A row or a column of a matrix of nodes.
std::vector<int> row_of(const std::vector<int>& matrix, int rows, int row);
std::vector<int> column_of(const std::vector<int>& matrix, int rows, int column);
// sum_j coefficients_j factors_j, zeros left out.
int combination(Recorder& recorder, const std::vector<int>& coefficients, const std::vector<int>& factors);

// The equations in first-order form, in x = (q, v, lambda, kappa): q' - S v, M v' - f + G^T lambda + H^T kappa, g, H v
// + h.
std::shared_ptr<const Record> first_order_equations(Recorder& recorder, const MultibodyFormulas& formulas);

// Describes in `error` why formulas could not be evaluated at error.t; returns false.
bool report_failure(const TaylorEvaluator& evaluator, CallbackError& error);

}  // namespace sfdae::core
