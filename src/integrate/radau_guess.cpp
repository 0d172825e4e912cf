// Predicted stages of a Radau step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_guess.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

void RadauPredictor::taylor(double t, int order, double* coefficients) const {
  if (polynomial != nullptr) return polynomial->taylor(t, order, coefficients);
  const RadauNode& newest = history.newest();
  const std::size_t n = newest.x.size();
  std::fill_n(coefficients, n * index(order + 1), 0.0);
  for (std::size_t r = 0; r < n; ++r) coefficients[r] = newest.x[r] + (t - newest.t) * newest.xdot[r];
  if (order > 0) std::copy_n(newest.xdot.data(), n, coefficients + n);
}

Guess RadauGuess::predict(const RadauPredictor& predictor, const StageMethod& method, double t_start, double t_end,
                          int order) {
  const RadauHistory& history = predictor.history;
  const int s = method.s;
  const std::size_t block = history.newest().x.size() * index(order + 1);
  if (stages_.size() < block * index(s)) stages_.resize(block * index(s));
  for (std::vector<double>* v : {&before_, &start_})
    if (v->size() < block) v->resize(block);
  for (int i = 0; i < s; ++i)
    predictor.taylor(i == s - 1 ? t_end : t_start + method.c[index(i)] * (t_end - t_start), order,
                     stages_.data() + block * index(i));
  predictor.taylor(history.newest().t, order, before_.data());
  Guess guess;
  guess.taylor = stages_.data();
  guess.taylor_before = before_.data();
  return guess;
}

const double* RadauGuess::at_start(const RadauPredictor& predictor, int order) {
  predictor.taylor(predictor.history.node(1).t, order, start_.data());
  return start_.data();
}

}  // namespace sfdae::core
