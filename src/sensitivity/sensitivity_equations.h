// The equations of the minimal extension differentiated by parameters p: with S_j^(l) the Taylor coefficients of S =
// dx/dp,
//
//     sum_{j,l} (df_i^(k) / dx_j^(l)) S_j^(l) = -(df_i^(k) / dp),    k = 0, ..., c_i
//
// along a jet of x, one column for each parameter. Only for extensions of the equations as they are recorded: factors
// of combinations may depend on p, and jets do not contain the terms that these cancel.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/jet_lanes.h"
#include "extension/derivative_formulas.h"
#include "extension/minimal_extension.h"
#include "extension/state_matrix.h"
#include "linalg/matrix.h"
#include "problem/parameter_series.h"

namespace sfdae::core {

// Linearized at one jet.
struct SensitivityRows {
  std::vector<double> values;  // df/dx, in the order of the entries of the extension
  std::vector<double> right;   // -df/dp, num_rows() x count
  long version = -1;           // of what is the same everywhere; -1: unknown
};

class SensitivityEquations {
 public:
  // Both arguments must outlive this object. numbers: of the parameters.
  SensitivityEquations(MinimalExtension& extension, ParameterSeries& parameters, const std::vector<int>& numbers);
  // Uses the present values of parameters from now on.
  void take_parameters();

  CallbackError linearize(const Jet& jet, SensitivityRows& rows);
  // Same at the first `count` jets, side by side if possible.
  CallbackError linearize(const std::vector<Jet>& jets, int count, std::vector<SensitivityRows>& rows);
  // Residuals of the total derivatives by t of all rows, with Taylor coefficients of S, n x (jet_order() + 2) for
  // each parameter, those above d_j zero; jet: of x, of one order more. r: num_rows() x count.
  CallbackError slopes(const Jet& jet, const double* S, double* r);

  // Entries whose values differ from those of other rows of the same version.
  const std::vector<int>& varying() const { return varying_; }

  MinimalExtension& extension() const { return extension_; }
  int count() const { return parameters_.count(); }

 private:
  void list_varying();
  void take_parameter_rows(SensitivityRows& rows) const;
  template <class Coefficient>
  void take_formulas(Coefficient coefficient, SensitivityRows& rows) const;
  template <class Coefficient>
  void take_all_formulas(Coefficient coefficient, SensitivityRows& rows) const;
  bool linearize_by_formulas(const Jet& jet, SensitivityRows& rows);
  bool linearize_side_by_side(const std::vector<Jet>& jets, int count, std::vector<SensitivityRows>& rows);
  int row_of(int equation, int order) const { return row_[first_row_[index(equation)] + index(order)]; }

  MinimalExtension& extension_;
  ParameterSeries& parameters_;
  DerivativeFormulas formulas_;
  std::vector<std::size_t> first_row_;
  std::vector<int> row_;
  std::vector<int> slope_limits_;
  // Source of a varying entry: coefficient k of formula e, in `place` among all coefficients, is an entry, or a term of
  // one, or minus one of a right-hand side.
  struct Source {
    int to, e, k;
    std::size_t place;
  };
  struct Term {
    Source source;
    bool is_first;
    double factor;
  };
  Source source_of(std::size_t to, std::size_t e, std::size_t k) const {
    return {static_cast<int>(to), static_cast<int>(e), static_cast<int>(k), e + k * formulas_.count()};
  }
  std::vector<int> varying_;
  std::vector<Source> alone_, right_sources_;
  std::vector<Term> terms_;
  std::vector<double> F_p_, entries_;
  JetLanes lanes_;
};

// Places of the unknowns of steps: slots as in StateChoice, with x_j in place of x_j' for the states.
class SensitivitySlots {
 public:
  void set(const MinimalExtension& extension, const StateChoice& choice);
  // Entry in the column of x_j, or of x_j', of a state j.
  struct Entry {
    int row, state;
    std::size_t entry;
  };
  const std::vector<Entry>& held() const { return held_; }
  const std::vector<Entry>& slopes() const { return slopes_; }
  // Slot of x_j.
  int of_x(int j) const { return of_x_[index(j)]; }

 private:
  std::vector<Entry> held_, slopes_;
  std::vector<int> of_x_;
};

}  // namespace sfdae::core
