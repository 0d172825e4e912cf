// Sparse systems of linear equations A x = b with real or complex entries, 100 to 50,000 unknowns.
//
// Rows and columns are scaled by powers of two first, as units differ (equilibration.h). Three methods: a band of
// LAPACK after reordering (band_order.h), KLU of SuiteSparse in builds with it (klu_factors.h), and a full matrix if a
// band would not be narrower. Diagonal matrices need none of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "linalg/band_factors.h"
#include "linalg/dense_factors.h"
#include "linalg/determinant.h"
#include "linalg/diagonal_factors.h"
#include "linalg/equilibration.h"
#include "linalg/klu_factors.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

// diagonal: for real diagonal matrices, never forced.
enum class SparseMethod { dense, band, klu, diagonal };

// Instances for double and std::complex<double>. Copies continue with the same bits and share only the pattern, which
// never changes.
// Without memory std::bad_alloc is thrown, and analyze() or factor() has to be called again. With a band or a full
// matrix factor() and solve() with the same number of right-hand sides allocate nothing after their first call.
template <class Number>
class SparseLu {
 public:
  // Once for any pattern: chooses the method by its estimated time, or takes `forced` (klu needs klu_is_available()).
  void analyze(const SparsePattern& pattern, std::optional<SparseMethod> forced = {}) {
    analyze(std::make_shared<const SparsePattern>(pattern), forced);
  }
  void analyze(std::shared_ptr<const SparsePattern> pattern, std::optional<SparseMethod> forced = {});
  // Values in the order of the pattern, zeros allowed. False: A is singular to working precision (a pivot vanishes), or
  // a value is not finite; nothing may be solved then. Raises no floating-point exception.
  bool factor(const Number* values);
  // Storage for values that factor() accepts and overwrites: large matrices need no other.
  Number* own_values();
  // Pivots of the previous factorization are reused if they are good enough. True: the last one has chosen its own, so
  // that it does not depend on earlier ones.
  bool has_new_pivots() const;
  // The next factorization will choose its own.
  void forget_pivots();
  // B := A^-1 B, column-major, size x count. An overflow of x itself raises the usual exception.
  void solve(Number* b, int count = 1) { solve(Op::plain, b, count); }
  // B := A^-T B, A not conjugated.
  void solve_transposed(Number* b, int count = 1) { solve(Op::transposed, b, count); }
  // Estimate of 1 / (|S| |S^-1|), 1-norm, S: the equilibrated matrix, seldom more than three times too large
  // (condition.h). Three to eleven solves. 0 if that overflows or nothing was factored; 1 for size 0.
  double reciprocal_condition();
  // Determinant of A, which factor() has factored.
  Determinant<Number> determinant() const;
  // Number of entries of the factors.
  std::size_t fill() const;
  // Cost of a factorization with known pivots, in solutions: estimated by analyze() from counts of operations, so that
  // it is the same in every run.
  double factorization_in_solutions() const { return times_.factorization / times_.solution; }
  SparseMethod method() const { return static_cast<SparseMethod>(factors_.index()); }

 private:
  struct Times {  // only their ratios mean something
    double factorization = 1.0, solution = 1.0;
    double of_both() const;
  };
  static Times dense_times(double n);
  static Times band_times(const BandOrder& order);
  static Times klu_times(double n, double fill, double flops);
  void choose(const SparsePattern& pattern, std::optional<SparseMethod> forced);
  void solve(Op op, Number* b, int count);

  std::shared_ptr<const SparsePattern> pattern_;  // null until analyze()
  bool may_be_regular_ = false;                   // the pattern
  bool is_factored_ = false;
  Times times_;
  Equilibration scales_;
  std::vector<Number> scaled_;  // S, values in the order of the pattern
  double norm_ = 0.0;           // |S|
  std::vector<int> shifts_;     // of right-hand sides
  // Factors of S; ordered as in SparseMethod.
  std::variant<DenseFactors<Number>, BandFactors<Number>, KluFactors<Number>, DiagonalFactors<Number>> factors_;
};

extern template class SparseLu<double>;
extern template class SparseLu<std::complex<double>>;

}  // namespace sfdae::core
