// Stored pivoted QR factorizations that are requested again: found by comparing all entries, so that results are the
// same bits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "linalg/arena.h"
#include "linalg/matrix.h"

namespace sfdae::core {

// Stores the factorizations of the last two matrices, while it keeps any.
class KeptFactorizations {
 public:
  bool is_keeping() const { return memory_ != nullptr; }
  // In memory that lives until stop_keeping().
  void start_keeping(Arena& memory) { memory_ = &memory; }
  void stop_keeping() { *this = {}; }

  // Result of factor_qr_pivoted() for A, in `a`, copied if a factorization with the same A and `negligible` is stored.
  void factor(ConstView A, double negligible, View a, int* pivots, double* tau, Arena& scratch);
  // The same if a factorization of A with these first `count` reflections is stored; else false.
  bool find_first(ConstView A, int count, View a, int* pivots, double* tau) const;
  // form_q() for the matrix factored last.
  void form_q(ConstView factors, int count, const double* tau, View q, Arena& scratch);

 private:
  struct Factorization {
    View original, factors, q;
    int* pivots = nullptr;
    double* tau = nullptr;
    double negligible = 0.0;
    int reflections_of_q = -1;  // none: there is no q
    void copy_to(View a, int* to_pivots, double* to_tau) const;
  };
  bool find(ConstView A, double negligible);

  Arena* memory_ = nullptr;
  std::array<Factorization, 2> kept_;  // in usual and in balanced units
  std::size_t last_ = 0, next_ = 0;
};

}  // namespace sfdae::core
