// Backward differentiation formulas with variable step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/bdf_step.h"

#include <algorithm>

namespace sfdae::core {

namespace {

// rest := p'(t) - c p(t).
void rest_of_formula(const BdfHistory::Polynomial& p, double t, double c, double* predicted, double* rest) {
  p.evaluate(t, predicted, rest);
  for (std::size_t i = 0; i < p.size; ++i) rest[i] -= c * predicted[i];
}

}  // namespace

void BdfStep::resize(std::size_t n, std::size_t size_w, bool needs_x) {
  x.assign(n, 0.0);
  x_rest.assign(needs_x ? n : 0, 0.0);
  for (std::vector<double>* v : {&w, &w_rest}) v->assign(std::max(n, size_w), 0.0);
}

void BdfStep::set_formula(const BdfHistory& history, bool is_constant, bool needs_x) {
  has_fixed_leading = is_constant && history.points() > order;
  const int degree = has_fixed_leading ? order : order - 1;
  c = 0.0;
  if (has_fixed_leading) c = bdf_alpha[order] / h;
  else
    for (int i = 0; i < order; ++i) c += 1.0 / (t - history.time(i));
  rest_of_formula(history.polynomial_w(degree), t, c, w.data(), w_rest.data());
  if (needs_x) rest_of_formula(history.polynomial_x(degree), t, c, w.data(), x_rest.data());
}

}  // namespace sfdae::core
