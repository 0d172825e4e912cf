// The finite eigenvalues of a matrix pencil lambda E - A of any index, m x n, regular or singular.
//
// E x' = A x is a linear problem: its strangeness-free system has the same solutions, and so the same finite
// eigenvalues, without chains at infinity. On the kernel of A2, with x = T2 z, this leaves  Z1^T E T2 z' = Z1^T A T2 z,
// d x (d + u), with a first matrix of full row rank [KM06, theorem 3.32]. QZ for the original pencil would turn chains
// at infinity of length k into large numbers, eps^(-1/k), which cannot be distinguished from eigenvalues.
//
// If u > 0 the transposed pencil is reduced once more: its L blocks are L^T blocks, which have no solutions but 0 (Van
// Dooren [VD79] does both by staircases). The result is the regular part.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006.
// [VD79] P. Van Dooren: The computation of Kronecker's canonical form of a singular pencil. Linear Algebra Appl. 27
// (1979)
//        103-140.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "linalg/eigenvalues.h"
#include "linalg/matrix.h"
#include "reduction/index_analysis.h"

namespace sfdae::core {

struct PencilSpectrum {
  CharacteristicValues values;     // of E x' = A x
  std::vector<Eigenvalue> finite;  // sorted by size
  bool is_regular() const { return values.u == 0 && values.v == 0; }
};

// rank_tol: as in AnalysisSettings. name: of the pencil in messages. Throws Failure: SFDAE_RANK_UNCLEAR,
// SFDAE_INDEX_TOO_HIGH.
PencilSpectrum spectrum_of_pencil(ConstView E, ConstView A, double rank_tol, const std::string& name);

}  // namespace sfdae::core
