// The extension as a square sparse matrix, d of the unknowns x_j being states.
//
// With x_j' = c x_j + ... for the states j the unknowns of a step are all x_j^(l) except the x_j of states. A change of
// such an x_j is 1 / c times that of x_j': column x_j' becomes that of x_j' plus epsilon times that of x_j, epsilon = 1
// / c. With epsilon = 0 states are held; complex epsilon: transformed stages of Runge-Kutta methods. The matrix with
// the states held has a pattern of its own, without their columns x_j: it is block triangular by stages, and its
// factors are much smaller than those of the others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "extension/minimal_extension.h"
#include "linalg/archive.h"
#include "linalg/listed_factors.h"
#include "linalg/sparse_lu.h"

namespace sfdae::core {

// Derivatives of the rows of an extension at some jet.
struct ExtensionDerivatives {
  const MinimalExtension& extension;
  const std::vector<double>& values;
};

// Choice of states, and places of the columns of the extension in the square matrix.
class StateChoice {
 public:
  // As many states as the freedom of the extension; x_j' of each is among its columns.
  void set(const MinimalExtension& extension, std::vector<int> states);

  const std::vector<int>& states() const { return states_; }
  bool is_state(int unknown) const { return is_state_[index(unknown)] != 0; }
  // Unknown of the square matrix for a column of the extension. x_j of a state j has that of x_j'.
  int slot(int column) const { return slot_[index(column)]; }
  // True for x_j of a state.
  bool is_held(int column) const { return is_held_[index(column)] != 0; }
  // True for x_j' of a state.
  bool is_slope(int column) const { return is_slope_[index(column)] != 0; }
  // Columns that a step changes: all but x_j' of states.
  const std::vector<int>& changed() const { return changed_; }
  // Entries of the extension in columns of x_j of states, if these are few among its entries; else there are none.
  struct HeldEntry {
    int row, unknown, entry;
  };
  bool has_held_entries() const { return has_held_entries_; }
  const std::vector<HeldEntry>& held_entries() const { return held_entries_; }
  // Converts changes of x_j' of the states, by slots, to those of x_j.
  template <class Number>
  void to_states(Number epsilon, Number* z) const {
    for (int slot : state_slots_) z[slot] *= epsilon;
  }
  int size() const { return size_; }
  // holds_states: see StateMatrix.
  const std::shared_ptr<const SparsePattern>& shared_pattern(bool holds_states) const {
    return holds_states ? held_pattern_ : pattern_;
  }
  const SparsePattern& pattern(bool holds_states) const { return *shared_pattern(holds_states); }
  // Places of the entries of the extension in the pattern of a step.
  const std::vector<int>& places() const { return places_; }
  // Entries of the extension in the order of the pattern with the states held: there is one for each place.
  const std::vector<int>& entries_of_held() const { return entries_of_held_; }
  // to: in the order of the pattern.
  template <class Number>
  void assemble(bool holds_states, const ExtensionDerivatives& from, Number epsilon, Number* to) const;

 private:
  void lay_out(const MinimalExtension& extension);
  void lay_out_held(const MinimalExtension& extension);
  void list_held_entries(const MinimalExtension& extension);

  std::vector<int> states_;
  std::vector<char> is_state_, is_held_, is_slope_;
  std::vector<int> slot_, state_slots_, changed_;
  bool has_held_entries_ = false;
  std::vector<HeldEntry> held_entries_;
  int size_ = 0;
  std::shared_ptr<const SparsePattern> pattern_, held_pattern_;
  std::vector<int> places_, entries_of_held_;
};

template <class Number>
void StateChoice::assemble(bool holds_states, const ExtensionDerivatives& from, Number epsilon, Number* to) const {
  const double* const own = from.values.data();
  if (holds_states) {
    // 0: not -0
    for (int e : entries_of_held_) *to++ = Number(0.0 + own[e]);
    return;
  }
  std::fill_n(to, pattern_->row.size(), Number(0));
  const int* const columns = from.extension.column().data();
  const char* const held = is_held_.data();
  const int* const places = places_.data();
  const std::size_t entries = places_.size();
  for (std::size_t e = 0; e < entries; ++e)
    to[places[e]] += held[columns[e]] != 0 ? epsilon * own[e] : Number(own[e]);
}

// Matrix factored for one epsilon at a time. Those that are not too large are factored by a list of operations
// (linalg/listed_factors.h), whose pivots outlive the linearization (docs/design/sparse_algebra.md).
template <class Number>
class StateMatrix {
 public:
  // holds_states: for epsilon = 0 alone.
  explicit StateMatrix(bool holds_states = false) : holds_states_(holds_states) {}
  // The pattern is analyzed at the first factorization: not all matrices are factored.
  void set_choice() {
    is_analyzed_ = false;
    list_.reset();
    forget();
  }
  // Takes the ordering of a matrix of the same choice and kind.
  void set_choice_of(const StateMatrix& other) {
    lu_ = other.lu_;
    list_ = other.list_;
    is_analyzed_ = other.is_analyzed_;
    forget();
  }
  // Forgets the factors: later ones depend only on the pivots of the list.
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
    is_listed_ = factor_listed(from, choice, epsilon);
    return is_listed_ || factor_unlisted(from, choice, epsilon);
  }
  // Archives the pivots of the list. Reading precedes all factorizations.
  void archive_list(Archive& archive, const StateChoice& choice) {
    list_.archive(choice.pattern(holds_states_), archive);
  }
  // Archives the factors. Reading needs the same values, choice and list. False: singular.
  bool archive(Archive& archive, const ExtensionDerivatives& from, const StateChoice& choice) {
    bool is_factored = is_valid();
    archive.small(is_factored, is_listed_);
    if (!is_factored) return true;
    Number now = epsilon_.value_or(Number(0)), pivots = is_listed_ ? now : epsilon_of_pivots_;
    archive.reals(parts(pivots), sizeof(Number) / sizeof(double));
    archive.reals(parts(now), sizeof(Number) / sizeof(double));
    if (!archive.is_reading()) return true;
    if (is_listed_) return factor(from, choice, now) && is_listed_;
    return factor_unlisted(from, choice, pivots) && (now == pivots || factor_unlisted(from, choice, now));
  }
  void solve(Number* b, int count = 1) {
    if (!is_listed_) return lu_.solve(b, count);
    const std::size_t size = list_.elimination().size();
    for (int k = 0; k < count; ++k) list_.solve(b + index(k) * size);
  }
  double reciprocal_condition() {
    return is_listed_ ? list_.reciprocal_condition(values_.data()) : lu_.reciprocal_condition();
  }
  // The elimination used by the factorization, or null.
  const RecordedElimination* elimination() const { return is_valid() && is_listed_ ? &list_.elimination() : nullptr; }
  std::size_t fill() const { return is_listed_ ? list_.elimination().fill() : lu_.fill(); }
  double factorization_in_solutions() const {
    return is_listed_ ? list_.elimination().factorization_in_solutions() : lu_.factorization_in_solutions();
  }

 private:
  bool factor_listed(const ExtensionDerivatives& from, const StateChoice& choice, Number epsilon) {
    const SparsePattern& pattern = choice.pattern(holds_states_);
    if (!list_.may_factor(pattern)) return false;
    values_.resize(pattern.row.size());
    choice.assemble(holds_states_, from, epsilon, values_.data());
    if (!list_.factor(pattern, values_.data())) return false;
    epsilon_ = epsilon;
    return true;
  }
  bool factor_unlisted(const ExtensionDerivatives& from, const StateChoice& choice, Number epsilon) {
    epsilon_.reset();
    if (!is_analyzed_) lu_.analyze(choice.shared_pattern(holds_states_));
    is_analyzed_ = true;
    Number* const values = lu_.own_values();
    choice.assemble(holds_states_, from, epsilon, values);
    if (!lu_.factor(values)) return false;
    if (lu_.has_new_pivots()) epsilon_of_pivots_ = epsilon;
    epsilon_ = epsilon;
    return true;
  }
  static double* parts(Number& number) { return reinterpret_cast<double*>(&number); }

  SparseLu<Number> lu_;
  ListedFactors<Number> list_;
  bool holds_states_, is_analyzed_ = false, is_listed_ = false;
  std::vector<Number> values_;  // of the list
  std::optional<Number> epsilon_;
  Number epsilon_of_pivots_{};
};

}  // namespace sfdae::core
