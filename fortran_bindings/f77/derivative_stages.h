// Derivatives of the user's functions at one point, the stages of the derivative array made of them, and what the
// stages say: strangeness index and characteristic values.
//
//   EQ z' = AQ z + FQ,   EQ(i,j) = C(i,j) E^(i-j) - C(i,j+1) A^(i-j-1),   AQ(i,0) = A^(i),   FQ(i) = f^(i)
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "f77/routine.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "reduction/index_analysis.h"

namespace sfdae::f77 {

// E^(k), A^(k), f^(k) at one point: each asked for once, in the order E^(0), A^(0), f^(0), E^(1), ...
class PointDerivatives {
 public:
  // which: 'E', 'A' or 'f'; values: n x n without padding, or n. Returns a code of user_functions.h.
  using Function = std::function<int(char which, int order, double* values)>;

  PointDerivatives(int n, Function function) : n_(n), function_(std::move(function)) {}

  int n() const { return n_; }
  // The first error of a function, 0: none. NaN and Inf are errors.
  int code() const { return code_; }
  // All orders up to `order`; returns code(). After a failure no function is called any more.
  int fetch(int order);
  core::ConstView E(int k) const { return {E_[core::index(k)].data(), n_, n_, n_}; }
  core::ConstView A(int k) const { return {A_[core::index(k)].data(), n_, n_, n_}; }
  const double* f(int k) const { return f_[core::index(k)].data(); }

 private:
  void fetch(char which, int order, int count, std::vector<std::vector<double>>& values);

  int n_;
  Function function_;
  int code_ = 0;
  std::vector<std::vector<double>> E_, A_, f_;
};

// PointDerivatives that ask the user's functions at t.
template <class Functions>
PointDerivatives derivatives_at(const Functions& functions, int n, double t) {
  return {n, [=](char which, int order, double* values) { return functions.call(which, n, t, order, values, n); }};
}

// Adds block row and block column `level` to EQ, given E^(0..level) and A^(0..level) as block rows of E and A.
void append_stage(int n, int level, core::ConstView E, core::ConstView A, core::View EQ);

// Where the caller wants stage mu to be.
struct StageStorage {
  Array AH, EQ, AQ;
  double* FQ;
  Array ZQ;

  bool holds(std::int64_t rows) const { return AH.holds(rows) && EQ.holds(rows) && AQ.holds(rows) && ZQ.holds(rows); }
};

struct StageValues {
  core::CharacteristicValues characteristic;  // mu = -1: no stage up to max_level is strangeness-free
  int rank = 0;                               // of EQ
};

// Where the caller wants the values.
template <class Integer>
struct ValueArguments {
  Integer *mu, *d, *a, *u, *rank;

  // rank only if there is a stage.
  void set(const StageValues& values) const {
    *mu = values.characteristic.mu;
    *d = values.characteristic.d;
    *a = values.characteristic.a;
    *u = values.characteristic.u;
    if (values.characteristic.mu >= 0) *rank = values.rank;
  }
};

// The work space that the caller has to provide although it is not used.
std::int64_t documented_work(std::int64_t rows);  // 3 rows^2 + 6 rows

struct SearchLimits {
  int max_level;        // LMAX
  std::int64_t lrwork;  // provided
};

// Strangeness index and characteristic values at the point alone, as the core finds them; stage mu is stored unless
// mu = -1. Checks its arguments. Returns 0, a code of the user's functions or one of routine.h.
int find_stage(PointDerivatives& point, double t, const SearchLimits& limits, const StageStorage& storage,
               StageValues& values);

// Characteristic values of a pair (EQ, AQ), nothing but its entries known.
struct PairValues {
  int r = 0, a = 0, s = 0, d = 0, u = 0;
  core::Matrix ZQ;  // left factor of EQ, the left null space last
};
PairValues pair_values(core::ConstView EQ, core::ConstView AQ);

}  // namespace sfdae::f77
