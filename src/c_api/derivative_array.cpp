// The blocks of a derivative array: C API.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <vector>

#include "c_api/codes.h"
#include "linalg/format.h"
#include "problem/array_blocks.h"
#include "problem/problem.h"
#include "sfdae/sfdae.h"
#include "solver/status_of.h"

using namespace sfdae::core;

extern "C" {

int sfdae_split_derivative_array(int num_equations, int num_unknowns, int order, const double* jacobian, double* F_x,
                                 double* F_xdot, char* text, size_t length) {
  if (text == nullptr && length > 0) return SFDAE_ILLEGAL_ARGUMENT;
  const auto body = [&] {
    const auto is_size = [](int size) { return size >= 1 && size <= most_dense_unknowns; };
    if (!is_size(num_equations) || !is_size(num_unknowns) || order < 0 || order > max_derivative_order)
      refuse_argument(
          format("num_equations = %d, num_unknowns = %d, order = %d; they must be 1 ... %d, 1 ... %d, "
                 "0 ... %d.",
                 num_equations, num_unknowns, order, most_dense_unknowns, most_dense_unknowns, max_derivative_order));
    if (jacobian == nullptr || F_x == nullptr || F_xdot == nullptr)
      refuse_argument("jacobian, F_x or F_xdot is NULL.");
    const ArrayShape shape{num_equations, num_unknowns, order};
    std::vector<double> of_x(shape.entries()), of_xdot(shape.entries());
    const ArrayFault fault = split_array(shape, jacobian, of_x.data(), of_xdot.data());
    if (fault.exists())
      throw Failure(fault.is_finite() ? SFDAE_WRONG_DERIVATIVES : SFDAE_NOT_FINITE, fault.message(shape, {}, ""));
    std::copy(of_x.begin(), of_x.end(), F_x);
    std::copy(of_xdot.begin(), of_xdot.end(), F_xdot);
  };
  return status_of(body, [=](int status, const char* message) {
    if (length > 0) std::snprintf(text, length, "%s", message);
    return status;
  });
}

}  // extern "C"
