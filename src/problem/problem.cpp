// Functions common to all problems.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/problem.h"

#include <cmath>

#include "problem/failure.h"

namespace sfdae::core {

std::string CallbackError::where() const {
  if (std::isnan(user_t) || user_t == t) return format("t = %.15g", t);
  return format("the internal point t = %.15g, beside t0 = %.15g", t, user_t);
}

std::string CallbackError::message() const {
  if (!detail.empty()) return detail;
  const std::string place = where();
  switch (status) {
    case SFDAE_CALLBACK_STOPPED:
      return format("%s returned %d (stop) for derivative order %d at %s.", function, code, order, place.c_str());
    case SFDAE_CALLBACK_FAILED:
      return format("%s returned %d (cannot evaluate) for derivative order %d at %s.", function, code, order,
                    place.c_str());
    case SFDAE_NOT_FINITE:
      if (row < 0)
        return format("the coefficients at %s differ so much in size that they overflow: rescale.", place.c_str());
      return format(
          "%s returned NaN, Inf or a number near overflow in %s, column %d of derivative order %d at "
          "%s. Return 1 from the callback to have the step reduced.",
          function, (names != nullptr ? *names : EquationNames()).row(row).c_str(), column, order, place.c_str());
    case SFDAE_ORDER_MISSING:
      return format(
          "%s does not provide derivative order %d, which is needed at %s. Provide it, or set the "
          "option difference_derivatives.",
          function, order, place.c_str());
    case SFDAE_STOPPED: return format("stopped on request at %s; the call can be repeated.", place.c_str());
    default: return "";
  }
}

std::string lacking_entry(const char* matrix, const std::string& row, int column, double value,
                          const std::string& where) {
  return format("%s has the entry %.6g in %s, column %d at %s, which the pattern of %s lacks. Add it to the pattern.",
                matrix, value, row.c_str(), column, where.c_str(), matrix);
}

void CallbackError::raise() const { throw Failure(status, message()); }

}  // namespace sfdae::core
