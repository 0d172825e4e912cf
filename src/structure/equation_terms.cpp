// Terms of equations that take the place of recorded ones.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/equation_terms.h"

namespace sfdae::core {

SeriesTerm series_term(const EquationTerm& term, bool of_derivative, int s) {
  const int m = term.order, chosen = of_derivative ? s - 1 : s, order = m - chosen;
  if (chosen < 0 || order < 0) return {-1, 0.0};
  // binomial(m, chosen) order! = m! / chosen!
  double factor = term.factor;
  for (int k = chosen + 1; k <= m; ++k) factor *= k;
  return {order, factor};
}

}  // namespace sfdae::core
