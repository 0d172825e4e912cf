// The strangeness-free system at one point, from stage mu of the derivative array and ranks that are known:
//
//   E = [Z1^T E; 0; 0],   A = [Z1^T A; Z2^T AQ; 0],   f = [Z1^T f; Z2^T FQ; Z3^T FQ]      (d, a, u rows)
//
// Z2^T EQ = 0, Z3^T [EQ AQ] = 0; with T2 a basis of ker Z2^T AQ, Z1 spans the range of E T2.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "f77/derivative_stages.h"
#include "f77/routine.h"
#include "linalg/matrix.h"

namespace sfdae::f77 {

struct StageRanks {
  int n = 0;
  int rows = 0;  // of the derivative array, (mu+1)n
  int d = 0, a = 0, u = 0;
  int rank = 0;  // of EQ

  int kernel() const { return rows - rank; }
  // Whether such ranks can be.
  bool possible() const;
};

// Of an n x n system of which a stage has been found.
StageRanks ranks_of(const StageValues& values, int n);

struct Transformations {
  core::Matrix Z;   // rows x kernel: Z2 in the first a columns, then Z3
  core::Matrix Z1;  // n x d

  bool is_finite() const { return f77::is_finite(Z) && f77::is_finite(Z1); }  // false after an overflow
};

// Z: basis of the left null space of EQ, rows x kernel.
Transformations transformations(const StageRanks& ranks, core::ConstView EQ, core::ConstView AQ, core::ConstView Z);

// Documented length of the work space, not used.
std::int64_t documented_work(const StageRanks& ranks);  // 3 n + 2 rows + 2 rows^2

// Writes Z and Z1 where the caller wants them; rank = rows: identities, as EQ has no left null space then. d = 0
// leaves Z1 alone.
void store(const Transformations& found, const StageRanks& ranks, const Array& Z2Q, const Array& Z1);

struct StageData {
  ConstArray EQ, AQ;
  const double* FQ;
};
struct ReducedSystem {
  Array Z2Q, Z1;  // Z2Q on entry: full left factor of EQ
  Array E, A;
  double* F;
};

// E, A, F, Z2Q, Z1 of one point. Returns 0, argument_error or not_converged (NaN or Inf), nothing changed then.
int reduce(const StageRanks& ranks, const StageData& stage, const ReducedSystem& reduced);

// F alone from f^(0), f^(1), ... in FQ and transformations known.
void reduce_right_side(const StageRanks& ranks, const double* FQ, const ReducedSystem& reduced);

}  // namespace sfdae::f77
