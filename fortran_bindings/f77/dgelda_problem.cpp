// The user's subroutines as a problem of the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/dgelda_problem.h"

#include <algorithm>
#include <cstddef>

#include "linalg/index.h"

namespace sfdae::f77 {

namespace {

std::size_t square(int n) { return core::index(n) * core::index(n); }

}  // namespace

void DgeldaProblem::set_matrices(const double* values) {
  matrices_.assign(values, values + 2 * square(n_));
  has_E_ = has_A_ = true;
}

core::LinearFunctions DgeldaProblem::functions() {
  core::LinearFunctions functions;
  functions.m = functions.n = n_;
  functions.E = callback<'E'>;
  functions.A = callback<'A'>;
  functions.f = callback<'f'>;
  functions.user = this;
  functions.constant_E = functions.constant_A = is_constant_;
  return functions;
}

// The order last: a function that reads it from a table may not survive a negative one.
bool DgeldaProblem::has_other_width(double t, const double*) {
  for (const HighWord high_word : {HighWord::ones_in_dimension, HighWord::ones_in_leading, HighWord::ones_in_order})
    for (const char which : {'E', 'A', 'f'}) {
      const auto call = [&](HighWord given, double* values) { return call_user(which, t, 0, values, given); };
      if (sees(high_word, which == 'f' ? core::index(n_) : square(n_), call)) return true;
    }
  return false;
}

int DgeldaProblem::evaluate(char which, double t, int order, double* values) {
  const bool is_kept = is_constant_ && which != 'f';
  bool& is_known = which == 'E' ? has_E_ : has_A_;
  const std::size_t entries = square(n_), first = which == 'E' ? 0 : entries;
  if (is_kept && order > 0) return 0;  // zero, as it is
  if (is_kept && is_known) {
    std::copy_n(matrices_.data() + first, entries, values);
    return 0;
  }
  count_point(t, which == 'f' && order == 0);
  const int result = result_of(call_user(which, t, order, values));
  if (result == SFDAE_ORDER_NOT_AVAILABLE) return stop_for_missing_derivative();
  if (result != 0) return result;
  if (is_kept) {
    matrices_.resize(2 * entries);
    std::copy_n(values, entries, matrices_.data() + first);
    is_known = true;
  }
  return 0;
}

}  // namespace sfdae::f77
