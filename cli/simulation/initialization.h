// Continuous initial values: equations, initial equations, fixed start values and free parameters together.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulation/conditions.h"
#include "simulation/library_calls.h"
#include "simulation/modes.h"

namespace sfdae::cli {

// Initialization in one mode: damped Newton iterations on the manifold of consistent values, until they yield no
// improvement. Its tangent space has an orthonormal basis B in units of the scales D of the unknowns,
// x = consistent(x + D B z); conditions that are independent there determine z.
class Initialization {
 public:
  // modes: with the free parameters among the unknowns.
  Initialization(const System& system, Modes& modes, LibraryCalls& calls);

  // In: initial guess and discrete values. Out: consistent values that satisfy the conditions. more: conditions from
  // when clauses that act initially. Throws Failure.
  void solve(Values& values, sfdae::Point& point, const std::vector<Condition>& more);

  // Decisions of the last solve().
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Linearization {
    sfdae::Matrix B;                        // n x (d + u)
    std::vector<std::vector<double>> rows;  // one per condition
    std::vector<double> residuals, sizes;   // sizes: magnitudes of the compared quantities
    std::vector<double> roundoff;           // by unknown: level below which entries are rounding errors of T2
    std::vector<double> levels;             // magnitudes relative to which rows are zero
  };
  struct Selection {
    IndependentRows rows;
    std::vector<int> chosen, dropped;  // conditions; those after the given ones are start values that complete them
    std::vector<double> residuals;     // for the chosen ones
  };

  // Describes the first condition that is undefined at a point; empty if all are defined.
  std::string undefined(const Values& values, const sfdae::Point& point);
  void find_start(Mode& mode, Values& values, sfdae::Point& point);
  bool make_consistent(Mode& mode, sfdae::Point& point, const std::vector<int>& fixed);
  // roundoff: see Linearization.
  sfdae::Matrix basis(Mode& mode, const sfdae::Point& point, std::vector<double>& roundoff);
  std::vector<double> residuals(Values values, const sfdae::Point& point, std::vector<double>* sizes = nullptr);
  std::vector<double> row_of(const Condition& condition, const sfdae::Matrix& B) const;
  Linearization linearized(Mode& mode, const Values& values, const sfdae::Point& point);
  std::vector<int> add_exact_rows(Values values, const sfdae::Point& point, Linearization& result);
  void add_difference_rows(Mode& mode, const Values& values, const sfdae::Point& point,
                           const std::vector<int>& conditions, Linearization& result);
  Linearization completed(Mode& mode, const Values& values, const sfdae::Point& point,
                          const Linearization& linearization);
  Selection selected(const Linearization& linearization) const;
  bool improve(Mode& mode, const Values& values, sfdae::Point& point, const Linearization& linearization,
               const Selection& selection, const std::vector<double>& z, int halvings);
  void report(const Linearization& linearization, const Selection& selection);
  double nominal(int unknown) const;
  double scale(int unknown) const;

  const System& system_;
  Modes& modes_;
  LibraryCalls& calls_;
  std::vector<Condition> conditions_, wishes_;
  std::size_t num_given_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace sfdae::cli
