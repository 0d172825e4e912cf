// The extension as a square sparse matrix, d of the unknowns x_j being states.
//
// With x_j' = c x_j + ... for the states j the unknowns of a step are all x_j^(l) but the x_j of states, a change of which is
// 1 / c times that of x_j': column x_j' becomes that of x_j' plus epsilon times that of x_j, epsilon = 1 / c. With epsilon =
// 0 states are held. Complex epsilon: stages of Runge-Kutta methods, transformed. The matrix with the states held has a pattern of its
// own, without their columns x_j: it is block triangular by stages, and its factors are much smaller than those of the others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "extension/minimal_extension.h"
#include "linalg/archive.h"
#include "linalg/sparse_lu.h"

namespace sfdae::core {

// Derivatives of the rows of an extension, which were its values at some jet.
struct ExtensionDerivatives {
  const MinimalExtension& extension;
  const std::vector<double>& values;
};

// Which unknowns are states, and where the columns of the extension stand in the square matrix.
class StateChoice {
 public:
  // As many states as the freedom of the extension; x_j' is among its columns for each.
  void set(const MinimalExtension& extension, std::vector<int> states);

  const std::vector<int>& states() const { return states_; }
  bool is_state(int unknown) const { return is_state_[index(unknown)] != 0; }
  // Of a column of the extension: its unknown in the square matrix. x_j of a state j has that of x_j'.
  int slot(int column) const { return slot_[index(column)]; }
  // x_j of a state.
  bool is_held(int column) const { return is_held_[index(column)] != 0; }
  // x_j' of a state.
  bool is_slope(int column) const { return is_slope_[index(column)] != 0; }
  // Changes of x_j' of the states, by slots, become those of x_j.
  template <class Number>
  void to_states(Number epsilon, Number* z) const {
    for (int slot : state_slots_) z[slot] *= epsilon;
  }
  int size() const { return size_; }
  struct Layout {
    SparsePattern pattern;
    std::vector<int> place;  // in the pattern, of the entries of the extension; -1: left out
  };
  const Layout& layout(bool holds_states) const { return holds_states ? held_layout_ : layout_; }
  // values: to, in the order of the pattern.
  template <class Number>
  void assemble(const Layout& layout, const ExtensionDerivatives& from, Number epsilon,
                std::vector<Number>& values) const;

 private:
  Layout layout_of(const MinimalExtension& extension, bool holds_states) const;

  std::vector<int> states_;
  std::vector<char> is_state_, is_held_, is_slope_;
  std::vector<int> slot_, state_slots_;
  int size_ = 0;
  Layout layout_, held_layout_;
};

template <class Number>
void StateChoice::assemble(const Layout& layout, const ExtensionDerivatives& from, Number epsilon,
                           std::vector<Number>& values) const {
  values.assign(layout.pattern.row.size(), Number(0));
  for (std::size_t e = 0; e < layout.place.size(); ++e) {
    if (layout.place[e] < 0) continue;
    const bool held = is_held(from.extension.column()[e]);
    values[index(layout.place[e])] += held ? epsilon * from.values[e] : Number(from.values[e]);
  }
}

// Factored for one epsilon at a time.
template <class Number>
class StateMatrix {
 public:
  // holds_states: for epsilon = 0 alone.
  explicit StateMatrix(bool holds_states = false) : holds_states_(holds_states) {}
  // The pattern is analyzed when it is factored first: not all matrices are.
  void set_choice() {
    is_analyzed_ = false;
    forget();
  }
  // Ordered as that one, which is of the same choice and kind.
  void set_choice_of(const StateMatrix& other) {
    lu_ = other.lu_;
    is_analyzed_ = other.is_analyzed_;
    forget();
  }
  // As after set_choice(): what comes depends on nothing before.
  void forget() {
    epsilon_.reset();
    lu_.forget_pivots();
  }
  bool is_valid() const { return epsilon_.has_value(); }
  Number epsilon() const { return *epsilon_; }
  bool is_for(Number epsilon) const { return epsilon_ == epsilon; }
  // False: singular.
  bool factor(const ExtensionDerivatives& from, const StateChoice& choice, Number epsilon) {
    epsilon_.reset();
    analyze(choice);
    std::vector<Number> values;
    choice.assemble(choice.layout(holds_states_), from, epsilon, values);
    if (!lu_.factor(values.data())) return false;
    if (lu_.has_new_pivots()) epsilon_of_pivots_ = epsilon;
    epsilon_ = epsilon;
    return true;
  }
  // Reading: of the same values and choice. False: singular.
  bool archive(Archive& archive, const ExtensionDerivatives& from, const StateChoice& choice) {
    bool is_factored = is_valid();
    archive.small(is_factored);
    if (!is_factored) return true;
    Number pivots = epsilon_of_pivots_, now = epsilon_.value_or(Number(0));
    archive.reals(parts(pivots), sizeof(Number) / sizeof(double));
    archive.reals(parts(now), sizeof(Number) / sizeof(double));
    return !archive.is_reading() || (factor(from, choice, pivots) && (now == pivots || factor(from, choice, now)));
  }
  void solve(Number* b, int count = 1) { lu_.solve(b, count); }
  double reciprocal_condition() { return lu_.reciprocal_condition(); }
  std::size_t fill() const { return lu_.fill(); }
  double factorization_in_solutions() const { return lu_.factorization_in_solutions(); }

 private:
  void analyze(const StateChoice& choice) {
    if (!is_analyzed_) lu_.analyze(choice.layout(holds_states_).pattern);
    is_analyzed_ = true;
  }
  static double* parts(Number& number) { return reinterpret_cast<double*>(&number); }

  SparseLu<Number> lu_;
  bool holds_states_, is_analyzed_ = false;
  std::optional<Number> epsilon_;
  Number epsilon_of_pivots_{};
};

}  // namespace sfdae::core
