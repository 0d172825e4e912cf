// A point of a linear problem, reduced: its Taylor coefficients, its null-space form, and how clear its ranks are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>

#include "linalg/arena.h"
#include "problem/taylor_data.h"
#include "reduction/index_analysis.h"
#include "reduction/null_space_form.h"

namespace sfdae::core {

// Form of all points, known from the analysis: their ranks, and the W that they are reduced for.
struct KnownForm {
  const IndexAnalysis& analysis;
  LeadingTerm leading;
  bool needs_E1;  // W varies with E: E'(t) is needed even for mu = 0
  Orders orders() const {
    const int mu = analysis.values.mu;
    return {std::max(mu, needs_E1 ? 1 : 0), mu, mu};
  }
};

struct LinearPoint {
  TaylorData data;
  NullSpaceForm form;
  double t = std::numeric_limits<double>::quiet_NaN();  // until it is complete
  int rank_E = 0;
  // Smallest values kept in the decisions on A^ and E T2, and smallest pivot of the elimination; relative.
  double kept_constraints = 1.0, kept_differential = 1.0, pivot = 1.0;
  int det_sign = 1;  // once the point is accepted, for u = 0: its sign()
  // Sign of NullSpaceForm::orientation(), or of det G in the bases of the point.
  int sign() const { return form.orientation() != 0 ? form.orientation() : form.sign_of_G(); }

  // kept_differential, which is relative to E, times the size of E: of its largest row, relative to that of [E A].
  double kept_of_rows() const;

  void forget() { t = std::numeric_limits<double>::quiet_NaN(); }
};

// The current point and the one accepted last, to which the current one is compared.
class LinearPoints {
 public:
  LinearPoint& current() { return points_[current_]; }
  const LinearPoint& current() const { return points_[current_]; }
  // The point accepted before the current one.
  LinearPoint& reference() { return points_[1 - current_]; }
  LinearPoint& last_accepted() { return is_accepted_ ? current() : reference(); }

  // The current point becomes another one; the one accepted last stays.
  void start_next() {
    if (is_accepted_) current_ = 1 - current_;
    is_accepted_ = false;
  }
  void accept() { is_accepted_ = true; }
  // The point accepted last is the current one again.
  void return_to_accepted() {
    current_ = 1 - current_;
    is_accepted_ = true;
  }
  void resize(int m, int n, int num_prescribed, int carried) {
    for (LinearPoint& point : points_) point.form.resize(m, n, num_prescribed, carried);
  }

 private:
  LinearPoint points_[2];
  int current_ = 0;
  bool is_accepted_ = false;  // the current point is: the next one has to fill the other
};

// Contradiction of redundant equations; 0 if rounding errors or errors of finite differences explain it.
double inconsistency(const LinearPoint& point, int mu);

// False if the sign of det[E1; A2] changed from one accepted point to another, bases aligned: a singular point lies
// between (or the bases turned too far to decide). For u = 0.
bool orientation_kept(const LinearPoint& then, const LinearPoint& now, Arena& arena);

}  // namespace sfdae::core
