// Taylor coefficients of a linear problem at one point, scaled for rank decisions.
//
// E(k) = D E^(k)(t) tau^k / k!,  A(k) = D A^(k)(t) tau^(k+1) / k!,  f(k) = D f^(k)(t) tau^(k+1) / k!
//
// D scales the rows by powers of two so that the largest entry of each row of [E A] lies in [1, 2): a constant row
// factor at a point changes neither ranks nor solutions, but only the joint scaling distinguishes a badly scaled
// equation from a singular perturbation. (A row that is small by cancellation carries the rounding errors of large
// ones, and scaling it up turns them into signals: for doubtful cases there is one common factor for all rows as
// well.) tau is the unit of time in which derivatives are compared.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "linalg/index.h"
#include "linalg/kept_factorizations.h"
#include "linalg/matrix.h"
#include "linalg/room.h"
#include "linalg/units.h"

namespace sfdae::core {

// The highest index that can be requested: a limit for arrays of fixed size, not one of the theory. x' of the solution
// needs derivatives of one order more.
inline constexpr int max_strangeness_index = 12;
inline constexpr int max_derivative_order = max_strangeness_index + 1;

// Highest orders held of each function, -1: none.
struct Orders {
  int E = -1;
  int A = -1;
  int f = -1;
};

// each: rows of [E A] in units of time of the user, or of [E tau A] where tau is longer; common: one factor for all;
// timed: rows of [E tau A]; given: the factors that are preferred, right or not.
enum class RowScaling { each, common, timed, given };
// Validates a number from an archive.
inline bool is_row_scaling(RowScaling rows) { return rows >= RowScaling::each && rows <= RowScaling::timed; }

// Range of the unit of time in which coefficients grow, relative to that of E x' = A x, tau = |E| / |A|, within which
// it is used. By judgement: no figures were recorded.
inline constexpr double shortest_growth = 0.1, longest_growth = 1e3;

// Rows that differ by no more need no factor of their own (docs/design/rank_decisions.md).
inline constexpr double moderate_row_ratio = 4096.0;

class TaylorData {
 public:
  // Allocates all orders up to `orders`; former contents are lost.
  void resize(int m, int n, Orders orders);

  // The coefficients of order k; before scale(), plain derivatives.
  View E(int k) { return {entries_.data() + first(k), m, n, m}; }
  View A(int k) { return {entries_.data() + first_A_ + first(k), m, n, m}; }
  double* f(int k) { return entries_.data() + first_f_ + static_cast<std::ptrdiff_t>(k) * m; }
  ConstView E(int k) const { return {entries_.data() + first(k), m, n, m}; }
  ConstView A(int k) const { return {entries_.data() + first_A_ + first(k), m, n, m}; }
  const double* f(int k) const { return entries_.data() + first_f_ + static_cast<std::ptrdiff_t>(k) * m; }
  // f(0), ..., f(order) one below the other.
  ConstView f_stack(int order) const { return {f(0), m * (order + 1), 1, m * (order + 1)}; }

  // Turns plain derivatives into scaled Taylor coefficients; tau = 0 chooses the time scale. False if entries are so
  // large or differ so much that products would overflow.
  // preferred: factors of rows to use again if they are about right; the range of E T2, and with it the equations that
  // Z1 picks, then depends smoothly on t from one point to the next.
  bool scale(double tau, RowScaling rows = RowScaling::each, const std::vector<double>* preferred = nullptr);
  // Multiplies column j of all E(k), A(k) by factors[j]; before scale().
  void scale_columns(const Units& factors);
  // Multiplies the time scale by `factor` once more.
  void rescale_time(double factor);
  // Smallest time in which one of the coefficients grows as large as that of order 0, in units of the time scale;
  // infinity where nothing grows.
  double growth_time() const;

  // Recomputes norms after entries have been changed.
  void measure();

  // Largest entry over all E(k), A(k) with k <= level.
  double norm(int level) const;
  double norm_E(int level) const;
  double norm_A(int level) const;
  double norm_f(int level) const;
  // Ratio of the largest row to the smallest that scaling evened out.
  double row_scale_ratio() const;
  bool is_zero_E(int k) const { return norms_.E[index(k)] == 0.0; }
  bool is_zero_A(int k) const { return norms_.A[index(k)] == 0.0; }
  double norm_E0() const { return norms_.E[0]; }
  // Rounding errors of the data of level 0 and errors of derivatives, rows scaled, relative to norm().
  double noise(int level) const;
  // Same with the errors of A, which may be larger.
  double noise_A(int level) const { return std::max(noise(level), difference_noise.A); }
  // Rounding errors of f of level 0 and errors of its derivatives, relative to norm_f().
  double noise_f(int level) const;

  // Estimated errors of derivatives by differences, which = 'E', 'A' or 'f': absolute ones of plain derivatives, one
  // for each entry of E(k), A(k) (m x n) or f(k) (m) (docs/design/finite_differences.md). Order 0 has none.
  bool has_errors(char which) const { return !errors_[slot(which)].empty(); }
  bool has_errors() const { return has_errors('E') || has_errors('A') || has_errors('f'); }
  // Memory for these errors, all zero at first.
  double* errors(char which, int order);
  const double* errors(char which, int order) const;
  // Largest error of a row; 0: exact.
  double error_of_row(char which, int order, int row) const;
  // Same for the scaled coefficient: row_scale_i error tau^k / k!, for A and f once more times tau.
  double scaled_error_of_row(char which, int order, int row) const;
  // Same for one entry, numbered as in errors().
  double scaled_error(char which, int order, int entry) const;
  // Changes every scaled coefficient by its error, with random sign.
  void change_by_errors(std::minstd_rand& generator);
  // Takes the errors of f from other data.
  void take_errors_of_f(const TaylorData& other) { errors_[slot('f')] = other.errors_[slot('f')]; }

  int m = 0;
  int n = 0;
  Orders orders;
  double t = 0.0;
  double time_scale = 1.0;
  std::vector<double> row_scale;  // diagonal of D
  std::vector<double> row_norm;   // largest entry of each row of [E A], unscaled
  // Largest number of differentiations of each row: rows of higher levels of the derivative array are left out. Empty:
  // no limit.
  std::vector<int> differentiations;
  bool has_row(int row, int level) const { return differentiations.empty() || level <= differentiations[index(row)]; }
  // Returns whether level i has rows that level i + 1 has not.
  bool has_last_rows(int i) const {
    return std::find(differentiations.begin(), differentiations.end(), i) != differentiations.end();
  }
  // Clears the coefficients that no row of the derivative array uses; before scale().
  void clear_unused_rows();
  // A jet of a nonlinear problem may not fulfil F = 0 exactly, which changes the data by this, relative to norm().
  double residual_noise = 0.0;
  // The Jacobians of a nonlinear problem may be differences. Entries that are not zero have these relative errors.
  struct DifferenceNoise {
    double E = 0.0, A = 0.0;
    double of(char which) const { return which == 'E' ? E : A; }
  };
  DifferenceNoise difference_noise;
  // F_x' of a nonlinear problem was nothing but rounding errors; E(0) is zero.
  bool E0_was_rounding = false;
  // Contradictions of redundant equations are measured by this if it is larger than f.
  double least_norm_f = 0.0;
  // Factorizations of a problem that evaluates the same points repeatedly, where E_0 may have been factored before;
  // else null.
  KeptFactorizations* kept_factorizations() const {
    return kept_ != nullptr && kept_->is_keeping() ? kept_ : nullptr;
  }
  // kept: must outlive this object.
  void set_kept_factorizations(KeptFactorizations* kept) { kept_ = kept; }

 private:
  // Largest entries of the coefficients of each order.
  struct Norms {
    std::array<double, max_derivative_order + 1> E{}, A{}, f{};
  };
  static double growth(const std::array<double, max_derivative_order + 1>& norms, int order);
  static std::size_t slot(char which) { return which == 'E' ? 0u : which == 'A' ? 1u : 2u; }
  std::ptrdiff_t size_of(char which) const { return which == 'f' ? m : static_cast<std::ptrdiff_t>(m) * n; }
  int highest(char which) const { return which == 'E' ? orders.E : which == 'A' ? orders.A : orders.f; }
  double factor_of_order(char which, int order) const;
  double largest_scaled_error(char which, int order) const;
  double choose_time_scale() const;
  void balance_rows();
  std::ptrdiff_t first(int k) const { return static_cast<std::ptrdiff_t>(k) * m * n; }  // entry of order k
  void scale_rows_and_measure(double tau);
  void multiply_all(double factor);

  KeptFactorizations* kept_ = nullptr;
  Room entries_;                           // all E(k), A(k), f(k), and m numbers for scaling
  std::size_t first_A_ = 0, first_f_ = 0;  // where those of A and f begin
  double* row_factor() { return entries_.data() + entries_.size() - index(m); }
  std::array<std::vector<double>, 3> errors_;  // of E, A, f, laid out as they are; empty: none
  Norms norms_;
};

}  // namespace sfdae::core
