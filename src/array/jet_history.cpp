// The jets of the last two accepted points.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/jet_history.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

void JetHistory::resize(int n, int order) {
  for (Jet* jet : {&accepted_, &before_}) {
    jet->n = n;
    jet->set_order(order);
  }
}

void JetHistory::accept(const Jet& jet) {
  if (jet.t != accepted_.t) std::swap(before_, accepted_);
  accepted_ = jet;
}

const Jet& JetHistory::nearest(double t) const {
  return std::fabs(t - before_.t) < std::fabs(t - accepted_.t) ? before_ : accepted_;
}

void JetHistory::interpolate(double t, Jet& jet) const {
  const double span = accepted_.t - before_.t;
  const double weight = span != 0.0 ? (t - before_.t) / span : 1.0;
  for (std::size_t i = 0; i < jet.x.size(); ++i) jet.x[i] = before_.x[i] + weight * (accepted_.x[i] - before_.x[i]);
  jet.t = t;
}

void JetHistory::predict(const Guess& guess, int block, const std::vector<char>& determined, const Units& units,
                         Jet& jet) const {
  const std::size_t size = jet.x.size();
  const double* taylor = guess.taylor + size * index(block);
  const std::size_t n = index(jet.n);
  std::copy_n(taylor, n, jet.x.data());
  if (guess.taylor_at_start != nullptr && has_two()) {
    predict_between(guess, taylor, determined, jet);
    return;
  }
  // y: its last value plus the change of the polynomial. Components that no equation determines are not changed: errors
  // of the polynomial's derivatives would accumulate there, to 1e24 within hundreds of steps, and swamp the rest with
  // roundoff (docs/design/derivative_array.md). Derivatives that change by more than their size are pure errors.
  for (std::size_t k = n; k < size; k += n) {
    double change = 0.0, before = 0.0;
    for (std::size_t i = k; i < k + n; ++i) {
      const double unit = units[i - k];
      jet.x[i] = determined[i - n] != 0 ? taylor[i] - guess.taylor_before[i] : 0.0;
      change = std::max(change, std::fabs(jet.x[i]) / unit);
      before = std::max(before, std::fabs(accepted_.x[i]) / unit);
    }
    const double trust = change <= before ? 1.0 : 0.0;
    for (std::size_t i = k; i < k + n; ++i) jet.x[i] = accepted_.x[i] + trust * jet.x[i];
  }
}

// y within the last step: the values at both ends, each with the change of the polynomial since then, weighted.
void JetHistory::predict_between(const Guess& guess, const double* taylor, const std::vector<char>& determined,
                                 Jet& jet) const {
  const std::size_t n = index(jet.n);
  const double weight = (jet.t - before_.t) / (accepted_.t - before_.t);
  for (std::size_t i = n; i < jet.x.size(); ++i) {
    const double is_known = determined[i - n] != 0 ? 1.0 : 0.0;
    jet.x[i] = (1.0 - weight) * (before_.x[i] + is_known * (taylor[i] - guess.taylor_at_start[i])) +
               weight * (accepted_.x[i] + is_known * (taylor[i] - guess.taylor_before[i]));
  }
}

void JetHistory::archive(Archive& archive) {
  for (Jet* jet : {&accepted_, &before_}) {
    archive.real(jet->t);
    archive.reals(jet->x, jet->x.size());
  }
}

}  // namespace sfdae::core
