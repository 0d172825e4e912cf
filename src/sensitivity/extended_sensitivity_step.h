// BDF steps of sensitivities by the minimal extension of recorded equations.
//
// If the structural analysis of the equations is confirmed numerically, with offsets c_i and d_j, equation i
// differentiated up to c_i times determines the Taylor coefficients up to d_j of all x_j from d of the x_j, the states.
// The derivative by p is linear, with states discretized as x is:
//
//     sum_{j,l} (dF_i,k / dx_j,l) S_j,l = -(F_p)_i,k,  k = 0 ... c_i,      S_s,1 = c S_s,0 + rest_s,  s a state
//
// one sparse matrix in place of an elimination of the derivative array. The jets of x have all derivatives that these
// equations contain: they fulfil the equations, which determine them. A new choice of states is made when they move
// other unknowns much more than when they were chosen.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/analyzed_equations.h"
#include "linalg/archive.h"
#include "linalg/known_pivots.h"
#include "linalg/planned_lu.h"
#include "linalg/sparse_lu.h"
#include "problem/parameter_series.h"
#include "system/jet.h"

namespace sfdae::core {

// The equations of the extension differentiated: the coefficients (i, k) of each equation, k <= limits[i], and (j, l)
// of each unknown.
struct ExtendedEquations {
  // Term of a matrix entry: factor times a Taylor coefficient of a derivative of an equation.
  struct Term {
    int row, column;
    std::size_t coefficient;
    double factor;
    int position;
  };
  int num_rows() const { return first_row.back(); }
  int num_columns() const { return first_column.back(); }
  int num_states() const { return static_cast<int>(states.size()); }

  int order = 0;                             // of the equation differentiated most
  std::vector<int> limits;                   // c
  std::vector<int> first_row, first_column;  // of (i, 0), of (j, 0); one more at the end
  std::vector<Term> terms;
  std::vector<int> states;
  std::vector<int> state_positions;  // of S_s,0 and S_s,1 in the last rows
};

class ExtendedSensitivityStep {
 public:
  // Both arguments must outlive this object.
  ExtendedSensitivityStep(RecordedProblem& problem, ParameterSeries& parameters)
      : problem_(problem), parameters_(parameters) {}

  // At a jet that fulfils F_mu = 0: returns whether this method can solve steps.
  bool prepare(const AnalyzedEquations& equations, const Jet& jet);
  bool is_possible() const { return is_possible_; }
  // Reading restores the prepared state, states and pivots included. Throws DamagedArchive.
  void archive(Archive& archive, const AnalyzedEquations& equations);

  // rest, S: n x count, in the user's units. PointStatus "not possible" means that no states determine the rest; S is
  // then unchanged.
  PointStatus solve(const Jet& jet, double c, const double* rest, double* S);
  // Solutions that the constraints admit, in the user's units: S = xp + T2 z with the states of S for z. T2: n x
  // num_states(), xp: n x count. Not possible any more: as solve().
  PointStatus find_tangents(const Jet& jet, View T2, View xp);
  int num_states() const { return equations_.num_states(); }

  // For callers that find tangents of several jets at once. The list is null if find_tangents() has to be called first.
  const ExtendedEquations& equations() const { return equations_; }
  std::size_t num_entries() const { return pattern_.row.size(); }
  const EliminationList* list() const { return has_pattern_ ? planned_.list() : nullptr; }
  // sizes(): largest sizes of the unknowns so far, which the caller updates; the next function tells whether states are
  // suitable that move unknowns by so much of these.
  std::vector<double>& sizes() { return sizes_; }
  bool are_good_states(double move) const;
  const CallbackError& callback_error() const { return callback_error_; }

 private:
  bool fits(const AnalyzedEquations& equations) const;
  void prepare_equations(const AnalyzedEquations& equations);
  void find_terms();
  bool linearize(const Jet& jet);
  bool choose_states();
  void set_states(const std::vector<int>& states);
  void set_values(double state, double slope);
  bool solve_system(int count);
  void set_right_hand_sides(double c, const double* rest);
  double largest_move() const;
  void set_right_hand_sides_of_tangents();
  double largest_move_of_tangents() const;
  PointStatus evaluate(const Jet& jet);
  template <class Solve, class Move>
  bool solve_with_good_states(Solve solve, Move move);
  int num_rows() const { return equations_.num_rows(); }
  int num_columns() const { return equations_.num_columns(); }

  RecordedProblem& problem_;
  ParameterSeries& parameters_;
  bool is_possible_ = false, has_pattern_ = false;
  double time_scale_ = 1.0, move_of_choice_ = 0.0;
  ExtendedEquations equations_;
  std::vector<double> coefficients_, values_, F_p_, right_, sizes_;
  std::vector<double> solution_;
  SparsePattern pattern_;
  PlannedLu planned_;
  SparseLu<double> lu_;  // where that is of no use
  bool has_lu_ = false;
  KnownPivots pivots_;  // of these
  CallbackError callback_error_;
};

}  // namespace sfdae::core
