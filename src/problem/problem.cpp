// What all problems have in common.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem.h"

#include "problem/failure.h"

namespace sfdae::core {

std::string CallbackError::message() const {
  if (!detail.empty()) return detail;
  switch (status) {
    case SFDAE_CALLBACK_STOPPED:
      return format("%s returned %d (stop) for derivative order %d at t = %.15g.", function, code, order, t);
    case SFDAE_CALLBACK_FAILED:
      return format("%s returned %d (cannot evaluate) for derivative order %d at t = %.15g.", function, code, order,
                    t);
    case SFDAE_NOT_FINITE:
      if (row < 0)
        return format("the coefficients at t = %.15g differ so much in size that they overflow: rescale.", t);
      return format(
          "%s returned NaN, Inf or a number near overflow in row %d, column %d of derivative order %d at "
          "t = %.15g. Return 1 from the callback to have the step reduced.",
          function, row, column, order, t);
    case SFDAE_ORDER_MISSING:
      return format(
          "%s does not provide derivative order %d, which is needed at t = %.15g. Provide it, or set the "
          "option difference_derivatives.",
          function, order, t);
    case SFDAE_STOPPED: return format("stopped on request at t = %.15g; the call can be repeated.", t);
    default: return "";
  }
}

void CallbackError::raise() const { throw Failure(status, message()); }

}  // namespace sfdae::core
