// Error estimate of the Radau methods.
//
// The divided difference of order 2s of w over the last nodes, with their slopes, times the error constant. It is
// guarded by the embedded formula of order s, gamma0 h (w' - u') at the start of the step with u the collocation
// polynomial, whose error is compared with tol^((s+1)/(2s)) [HW99]. Both are mapped to x (docs/design/radau.md).
//
// [HW99] E. Hairer, G. Wanner: Stiff differential equations solved by Radau methods. J. Comput. Appl. Math. 111
// (1999).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/hermite_table.h"
#include "integrate/radau_control.h"
#include "integrate/radau_history.h"
#include "integrate/radau_stages.h"

namespace sfdae::core {

// Limit of the embedded error in units of tol^((s+1)/(2s)), s > 1.
double embedded_limit(int s, bool beside_difference);

class RadauErrorEstimate {
 public:
  void resize(std::size_t n, std::size_t size_w, int most_stages);
  // Error of a step from the newest node, with the system at its end. Divided differences are stored in the table.
  ErrorTerms estimate(StrangenessFreeSystem& system, const RadauHistory& history, const RadauStep& step,
                      const ErrorWeights& weights, HermiteTable& table);
  // Adds divided differences of orders 1 ... s over the start and the stages, in units of h.
  void add_decay(StrangenessFreeSystem& system, const RadauHistory& history, const RadauStep& step,
                 const ErrorWeights& weights, ErrorTerms& terms);
  // Error of the last step estimated, mapped to x.
  const std::vector<double>& error() const { return error_; }
  // Errors of its polynomial.
  const InteriorErrors& interior() const { return interior_; }

 private:
  void estimate_interior(const RadauNode& start, const RadauStep& step, const ErrorWeights& weights);

  std::vector<double> error_;
  InteriorErrors interior_;
  std::vector<double> difference_;
  std::vector<double> columns_, mapped_;  // in w and in x
};

}  // namespace sfdae::core
