// Consistent values under constraints A2 x + f2 = 0: of linear problems, and of linearized ones.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "linalg/units.h"
#include "problem/taylor_data.h"
#include "reduction/null_space_form.h"
#include "starts/least_change.h"
#include "system/consistency_request.h"
#include "system/value_change.h"

namespace sfdae::core {

// The constraints at a point: x = xp + T2 z in the unknowns x_j / unit_j.
struct ConstrainedPoint {
  const NullSpaceForm& form;
  const TaylorData& data;
  const Units& units;
  int rank_E;
  double kept;  // smallest relative value that the decisions behind T2 kept
  // Components that must have the given values but are unknown to the form; null: none.
  const std::vector<int>* prescribed = nullptr;
  // An orthonormal basis of ker E; empty: not known.
  ConstView known_kernel = {};
  // The kernel of E, found once.
  const LeadingKernel& kernel() const {
    if (!found_kernel) found_kernel = std::make_shared<const LeadingKernel>(data.E(0), rank_E, known_kernel);
    return *found_kernel;
  }
  mutable std::shared_ptr<const LeadingKernel> found_kernel = nullptr;
  bool is_prescribed(int i) const {
    return prescribed != nullptr && std::find(prescribed->begin(), prescribed->end(), i) != prescribed->end();
  }
};

// The consistent x chosen as requested for the given x, both in the user's units. Throws Failure SFDAE_FIXED_VALUES.
std::vector<double> consistent_point(const ConstrainedPoint& point, const ConsistencyRequest& request,
                                     const std::vector<double>& x);

// The part of a change dx of x, in the user's units, that changes E x: least_change.h.
std::vector<double> differentiated_change(const ConstrainedPoint& point, const ConsistencyRequest& request,
                                          const std::vector<double>& dx);

// The largest change of values that were to stay, from those given to those found; none if the request does not ask for
// that, or if rounding errors explain it.
ValueChange change_of_differentiated(const ConstrainedPoint& point, const ConsistencyRequest& request,
                                     const std::vector<double>& given, const std::vector<double>& found);

// (I - T2 T2^T) x - xp: the violation of the constraints as a vector; its length is that of A2 x + f2.
std::vector<double> violation(const NullSpaceForm& form, const std::vector<double>& x);

// Sets largest_change and component of the result; InitialValues::accept refuses changes beyond the tolerances.
void report_change(const ConsistencyRequest& request, double t, const std::vector<double>& given,
                   const std::vector<double>& consistent, ConsistencyResult& result);

}  // namespace sfdae::core
