// The backward sweep: adjoints follow the edges of a tape.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "expression/series.h"
#include "expression/tape.h"

namespace sfdae::core {

template <bool is_first>
inline void put(double& to, double value) {
  if constexpr (is_first) to = value;
  else to += value;
}

// to (+)= sign from factor
template <bool is_first, class Order>
inline void put_product(const double* from, const double* factor, double sign, double* __restrict to, Order K) {
  for (int k = 0; k <= K; ++k) {
    double sum = from[0] * factor[k];
    for (int j = 1; j <= k; ++j) sum += from[j] * factor[k - j];
    put<is_first>(to[k], sign * sum);
  }
}

// to (+)= c a
template <bool is_first, class Order>
inline void put_multiple(double c, const double* a, double* __restrict to, Order K) {
  for (int k = 0; k <= K; ++k) put<is_first>(to[k], c * a[k]);
}

template <bool is_first, class Order>
inline void follow(const Edge& edge, const double* factor, double* adjoints, Order K) {
  const double* const from = adjoints + edge.from;
  double* const to = adjoints + edge.to;
  switch (edge.code) {
    case EdgeCode::pass: return put_multiple<is_first>(1.0, from, to, K);
    case EdgeCode::negate: return put_multiple<is_first>(-1.0, from, to, K);
    case EdgeCode::multiply:
      if (edge.from_number) return put_multiple<is_first>(from[0], factor, to, K);
      return put_product<is_first>(from, factor, 1.0, to, K);
    case EdgeCode::multiply_negated:
      if (edge.from_number) return put_multiple<is_first>(-from[0], factor, to, K);
      return put_product<is_first>(from, factor, -1.0, to, K);
    case EdgeCode::scale: return put_multiple<is_first>(factor[0], from, to, K);
    case EdgeCode::pass_if_positive:
      return put_multiple<is_first>(series::is_positive(factor[0]) ? 1.0 : 0.0, from, to, K);
    case EdgeCode::pass_otherwise:
      return put_multiple<is_first>(series::is_positive(factor[0]) ? 0.0 : 1.0, from, to, K);
  }
}

template <class Order>
inline bool is_zero(const double* a, Order K) {
  for (int k = 0; k <= K; ++k)
    if (a[k] != 0.0) return false;
  return true;
}

// with_choices: a value of a branch that was not chosen has the adjoint 0, and its derivatives may not exist.
template <bool with_choices, class Order>
inline void follow(const Tape::EdgesOfEquation& edges, const double* slots, double* adjoints, Order K) {
  for (const Edge* edge = edges.first; edge != edges.last; ++edge) {
    const double* const factor = slots + edges.factors[edge->factor];
    if constexpr (with_choices) {
      if (is_zero(adjoints + edge->from, K)) {
        if (edge->is_first) series::copy(adjoints + edge->from, adjoints + edge->to, K);
        continue;
      }
    }
    if (edge->is_first) follow<true>(*edge, factor, adjoints, K);
    else follow<false>(*edge, factor, adjoints, K);
  }
}

}  // namespace sfdae::core
