// Consistent initial values of a linear problem: A2 x + f2 = 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "system/least_change.h"
#include "system/linear_system.h"
#include "system/tolerances.h"
#include "system/value_change.h"

namespace sfdae::core {

// keep_differential: x changes in the null space of E1 = Z1^T E only, Z1 the range of E T2 with rows as the user
// scaled them; exactly one such point is consistent where u = 0, and at least one always, as E1 T2 has full row rank.
enum class InitialValues { nearest, fixed, accept, keep_differential };

struct ConsistencyRequest {
  InitialValues kind = InitialValues::nearest;
  std::vector<char> fixed;      // kind fixed: n flags
  std::vector<double> weights;  // empty or n positive weights
  // nearest, fixed: unknowns whose derivative occurs move only where the others cannot make x consistent. Weights
  // take precedence.
  bool keeps_differentiated = false;
  bool differentiated_stay() const {
    return keeps_differentiated && weights.empty() &&
           (kind == InitialValues::nearest || kind == InitialValues::fixed);
  }
  // The sum of all changes, weighted, is to be least.
  bool is_weighted() const {
    return !weights.empty() && (kind == InitialValues::nearest || kind == InitialValues::fixed);
  }
  // Whether a change of theirs is to be reported: with fixed components the user has said what is to stay.
  bool reports_changes() const { return differentiated_stay() && kind == InitialValues::nearest; }
  // Changes that count as one where differentiated_stay(): the tolerances. If digits are trusted, as they are until
  // that leads beyond what they explain, absolute parts count a millionth: published values are off by their last
  // digit. Where neither a value nor its tolerance says anything the largest size has to do.
  bool trusts_digits = false;
  std::vector<double> sizes() const;
  // The same request for values whose digits are trusted. Its tolerances are what their last digits explain.
  ConsistencyRequest trusting_digits(const double* x) const;
  // Fixed components fit the constraints if the rest is small against this.
  double least_size = 0.0;
  // n of them. accept: largest |change_i| to the nearest consistent point that passes.
  std::vector<double> tolerances;
  std::vector<double> digits;  // the same with a small absolute part
  void set_tolerances(const Tolerances& of, const double* x) {
    constexpr double absolute_part = 1e-6;
    tolerances.resize(of.rtol.size());
    digits.resize(of.rtol.size());
    for (std::size_t i = 0; i < of.rtol.size(); ++i) {
      const double relative = of.rtol[i] * (x[i] < 0.0 ? -x[i] : x[i]);
      tolerances[i] = relative + of.atol[i];
      digits[i] = relative + absolute_part * of.atol[i];
    }
  }
};

struct ConsistencyResult {
  double residual_before = 0.0;  // 2-norm of A2 x + f2, rows of A2 orthonormal: distance to the constraints
  double residual_after = 0.0;
  double largest_change = 0.0;
  int component = -1;  // of the largest change
};

// The constraints at a point: x = xp + T2 z in the unknowns x_j / unit_j.
struct ConstrainedPoint {
  const NullSpaceForm& form;
  const TaylorData& data;
  const Units& units;
  int rank_E;
  double kept;  // smallest relative value that the decisions behind T2 kept
  // Components that have to have the values given, as far as the form does not know of them; null: none.
  const std::vector<int>* prescribed = nullptr;
  // An orthonormal basis of ker E; empty: not known.
  ConstView known_kernel = {};
  // Of E, found once.
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

// What a change dx of x, in the user's units, means for E x: least_change.h.
std::vector<double> differentiated_change(const ConstrainedPoint& point, const ConsistencyRequest& request,
                                          const std::vector<double>& dx);

// The largest change among what was to stay, from the values given to those found; none where the request does not ask
// for that, or rounding errors explain it.
ValueChange change_of_differentiated(const ConstrainedPoint& point, const ConsistencyRequest& request,
                                     const std::vector<double>& given, const std::vector<double>& found);

// largest_change and component of the result; what is more than tolerances allow is refused for
// InitialValues::accept.
void report_change(const ConsistencyRequest& request, double t, const std::vector<double>& given,
                   const std::vector<double>& consistent, ConsistencyResult& result);

ConstrainedPoint constraints_of(LinearSystem& system);

// Makes x (n values) consistent at the point the system was moved to. Throws Failure SFDAE_INCONSISTENT_VALUES or
// SFDAE_FIXED_VALUES and leaves x as it was then.
ConsistencyResult make_consistent(LinearSystem& system, const ConsistencyRequest& request, std::vector<double>& x);
// The same with the constraints of the system at hand.
ConsistencyResult make_consistent(LinearSystem& system, const ConstrainedPoint& constraints,
                                  const ConsistencyRequest& request, std::vector<double>& x);

}  // namespace sfdae::core
