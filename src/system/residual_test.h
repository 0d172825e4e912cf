// Whether residuals say that a change has solved the equations.
//
// A matrix M that is too large by a factor g, as one that is kept from where the problem was much stiffer, makes changes
// too small by g: they look converged. Residuals become smaller by the factor 1 - 1/g then. With r- before a change dx,
// r+ after it and rho_i = r+_i / r-_i in row i, rho_i / (1 - rho_i) times what the row has to do with dx is the error
// that is left: rho_i near 1 says that the change was far too small, rho_i < 0 that it was too large. A row has to do
// with the part |r-_i| / sum_j |M_ij dx_j| of dx.
//
// Rows say nothing where r+ is roundoff, or |r+_i| <= 1e-2 sum_j |M_ij dx_j|: what F changes by along dx is M dx, but
// for errors of the entries of M that are as small [OP64] (docs/decisions/104-residuals-are-asked.md).
//
// [OP64] W. Oettli, W. Prager: Compatibility of approximate solution of linear equations with given error bounds for
//        coefficients and right-hand sides. Numer. Math. 6 (1964), 405-409.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sfdae::core {

// Sums over the terms of each row, sum_j |M_ij| size_j: of what is added up in the residual, as large as the unknowns
// are or as their tolerances; and of the last change.
enum class RowSums { of_values, of_tolerances, of_change };

class ResidualTest {
 public:
  void begin() { largest_ = 0.0; }
  // Rows of the residuals that are evaluated next, for the caller to fill: `count` numbers.
  double* next(std::size_t count);
  // After they were filled.
  void note();
  const double* residuals() const { return now_.data(); }
  // What the change between the last two residuals may leave: an error of `error` times that change, by rows with
  // rho_i <= largest_ratio. add(RowSums, double* rows) adds sums of terms, and is called where they matter.
  // is_trusted: the matrix is not the one of a guess.
  struct Allowed {
    double error, largest_ratio;
  };
  template <class Add>
  bool allows(const Allowed& allowed, bool is_trusted, Add add) {
    if (allows(allowed)) return true;
    const auto sum = [&](RowSums kind) -> const std::vector<double>& {
      std::fill(sums_.begin(), sums_.end(), 0.0);
      add(kind, sums_.data());
      return sums_;
    };
    take_change(sum(RowSums::of_change));
    if (allows(allowed)) return true;
    if (is_trusted) excuse_rounding(sum(RowSums::of_values));
    excuse_zeros(sum(RowSums::of_tolerances));
    return allows(allowed);
  }

 private:
  bool allows(const Allowed& allowed, std::size_t row) const;
  bool allows(const Allowed& allowed) const;
  void take_change(const std::vector<double>& sums);
  void excuse_rounding(const std::vector<double>& sums);
  void excuse_zeros(const std::vector<double>& sums);

  std::vector<double> before_, now_;
  std::vector<double> excused_,
      moved_;  // residuals that say nothing; sums of the change, or |r-| where it is not known
  std::vector<double> sums_;
  double largest_ = 0.0;  // of all since begin()
};

}  // namespace sfdae::core
