// Reason why an equation has no value or no derivative at a point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "expression/record.h"

namespace sfdae::core {

struct EvaluationFailure {
  enum class Kind {
    none,
    undefined,   // log of -1, division by 0
    not_smooth,  // derivative of sqrt at 0
    not_finite,  // overflow, or an argument that is not finite
    refused      // by a function of the user's, which returned `code`
  };
  Kind kind = Kind::none;
  int equation = -1;           // -1: none in particular
  const char* operation = "";  // as in name_of
  std::string message;         // such as "log of -1 in equation 3"
  int code = 0;
};

// Values of all slots, of an evaluation that failed.
struct Slots {
  const double* values;
  int stride;
  const double* operator[](int slot) const { return values + static_cast<std::ptrdiff_t>(slot) * stride; }
};

// The equation that failed, and the orders of values and of gradients that were wanted (-1: none).
struct FailedEquation {
  int equation;
  int order, order_of_gradients;
};

// Status of a call that ends with this failure: SFDAE_NOT_FINITE, or the one that the code of a function asks for.
int status_of(const EvaluationFailure& failure);

EvaluationFailure diagnose(const Record& record, Slots slots, FailedEquation failed);

}  // namespace sfdae::core
