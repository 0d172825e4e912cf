// BDF steps of sensitivities by the minimal extension of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/extended_sensitivity_step.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "linalg/column_basis.h"
#include "linalg/index.h"
#include "structure/structure.h"

namespace sfdae::core {

namespace {

// Limits for a new choice of states, as for the extension of x (extension/extension_linearization.cpp): states move
// some unknown by so much more than when they were chosen, and by so many of its sizes if they change by theirs.
constexpr double worth_a_choice = 3.0, harmless_move = 30.0;

}  // namespace

bool ExtendedSensitivityStep::prepare(const AnalyzedEquations& equations, const Jet& jet) {
  is_possible_ = has_pattern_ = false;
  if (!fits(equations)) return false;
  Certificate certificate;
  if (!certify_structure(*problem_.structure(), problem_.evaluator(), {jet.t, jet.x.data()},
                         equations.settings().rank_tol, certificate) ||
      !certificate.is_given())
    return false;
  prepare_equations(equations);
  is_possible_ = linearize(jet) && choose_states();
  return is_possible_;
}

void ExtendedSensitivityStep::prepare_equations(const AnalyzedEquations& equations) {
  time_scale_ = equations.analysis().time_scale;
  find_terms();
  sizes_.assign(index(problem_.n()), 0.0);
  equations_.states.clear();
  move_of_choice_ = 0.0;
}

void ExtendedSensitivityStep::archive(Archive& archive, const AnalyzedEquations& equations) {
  bool has_pattern = has_pattern_, has_lu = has_lu_;
  archive.small(is_possible_, has_pattern, has_lu);
  if (!is_possible_) return;
  if (archive.is_reading()) {
    if (!fits(equations)) throw DamagedArchive();
    prepare_equations(equations);
    equations_.states.resize(index(equations.analysis().values.d));
  }
  archive.real(move_of_choice_);
  archive.reals(sizes_.data(), sizes_.size());
  archive.small(equations_.states.data(), equations_.states.size());
  std::vector<char> is_met(index(problem_.n()), 0);
  for (int state : equations_.states) {
    if (state < 0 || state >= problem_.n() || problem_.structure()->offsets.d[index(state)] == 0 ||
        is_met[index(state)] != 0)
      throw DamagedArchive();
    is_met[index(state)] = 1;
  }
  if (!has_pattern) return;
  if (archive.is_reading()) {
    set_states(equations_.states);
    if (has_lu) lu_.analyze(pattern_);
    has_lu_ = has_lu;
  }
  planned_.archive(archive);
  if (has_lu_) pivots_.archive(archive, lu_, values_.size());
}

// Returns whether the jets have the derivatives that the extension contains, and fulfil its equations.
bool ExtendedSensitivityStep::fits(const AnalyzedEquations& equations) const {
  const CharacteristicValues& values = equations.analysis().values;
  const Structure* structure = problem_.structure();
  if (structure == nullptr || values.mu == 0 || values.d + values.a != problem_.n() || equations.analysis().v_hat > 0)
    return false;
  const Offsets& offsets = structure->offsets;
  if (offsets.freedom() != values.d) return false;
  const std::vector<int>& most = problem_.differentiations();
  for (std::size_t i = 0; i < offsets.c.size(); ++i)
    if (offsets.c[i] > values.mu || (!most.empty() && offsets.c[i] > most[i])) return false;
  return *std::max_element(offsets.d.begin(), offsets.d.end()) <= equations.jet_order();
}

// F_i,k contains x_j,l with the coefficients (F_x)_{k-l} and, as those of x' are (l + 1) x_{l+1}, l (F_x')_{k-l+1}.
void ExtendedSensitivityStep::find_terms() {
  const Offsets& offsets = problem_.structure()->offsets;
  const Tape& tape = problem_.evaluator().tape();
  equations_.limits = offsets.c;
  equations_.order = *std::max_element(equations_.limits.begin(), equations_.limits.end());
  equations_.first_row.assign(1, 0);
  equations_.first_column.assign(1, 0);
  for (int c : offsets.c) equations_.first_row.push_back(equations_.first_row.back() + c + 1);
  for (int d : offsets.d) equations_.first_column.push_back(equations_.first_column.back() + d + 1);
  equations_.terms.clear();
  for (std::size_t i = 0; i < equations_.limits.size(); ++i)
    for (std::size_t e = tape.first_target[i]; e < tape.first_target[i + 1]; ++e) {
      const int unknown = tape.targets[e].unknown, shift = tape.targets[e].derivative ? 1 : 0;
      for (int k = 0; k <= equations_.limits[i]; ++k)
        for (int l = shift; l <= std::min(k + shift, offsets.d[index(unknown)]); ++l)
          equations_.terms.push_back({equations_.first_row[i] + k, equations_.first_column[index(unknown)] + l,
                                      e * index(equations_.order + 1) + index(k - l + shift),
                                      shift == 1 ? double(l) : 1.0, -1});
    }
  coefficients_.assign(tape.targets.size() * index(equations_.order + 1), 0.0);
  F_p_.assign(index(problem_.m()) * index(equations_.order + 1) * index(parameters_.count()), 0.0);
  right_.assign(index(num_columns()) * index(parameters_.count() + 1), 0.0);
  solution_ = right_;
}

bool ExtendedSensitivityStep::linearize(const Jet& jet) {
  callback_error_ =
      problem_.gradient_entries(jet.t, jet.x.data(), equations_.order, equations_.limits, coefficients_.data());
  for (std::size_t j = 0; j < sizes_.size(); ++j) sizes_[j] = std::max(sizes_[j], std::fabs(jet.x[j]));
  return callback_error_.status == SFDAE_OK;
}

// States must be x_j that have an x_j' in the extension: the others have to be determined by them.
bool ExtendedSensitivityStep::choose_states() {
  std::vector<int> unknown_of(index(num_columns())), order_of(index(num_columns())), order_of_row(index(num_rows()));
  BasisSettings settings;
  settings.classes.assign(index(num_columns()), 0);
  for (std::size_t j = 0; j + 1 < equations_.first_column.size(); ++j)
    for (int column = equations_.first_column[j]; column < equations_.first_column[j + 1]; ++column) {
      unknown_of[index(column)] = static_cast<int>(j);
      order_of[index(column)] = column - equations_.first_column[j];
      if (column == equations_.first_column[j] && equations_.first_column[j + 1] > column + 1)
        settings.classes[index(column)] = 1;
    }
  for (std::size_t i = 0; i + 1 < equations_.first_row.size(); ++i)
    for (int row = equations_.first_row[i]; row < equations_.first_row[i + 1]; ++row)
      order_of_row[index(row)] = row - equations_.first_row[i];
  SparseRows rows;
  rows.columns = num_columns();
  rows.first.assign(1, 0);
  std::vector<int> entry_of(index(num_columns()), -1);
  // Terms are grouped by equations, not by rows.
  std::vector<std::vector<std::size_t>> of_row(index(num_rows()));
  for (std::size_t e = 0; e < equations_.terms.size(); ++e) of_row[index(equations_.terms[e].row)].push_back(e);
  for (std::size_t row = 0; row < of_row.size(); ++row) {
    for (std::size_t e : of_row[row]) {
      const ExtendedEquations::Term& term = equations_.terms[e];
      int& entry = entry_of[index(term.column)];
      if (entry < rows.first.back()) {
        entry = static_cast<int>(rows.column.size());
        rows.column.push_back(term.column);
        rows.value.push_back(0.0);
      }
      rows.value[index(entry)] += term.factor * coefficients_[term.coefficient] *
                                  std::pow(time_scale_, order_of_row[row] - order_of[index(term.column)]);
    }
    rows.first.push_back(static_cast<int>(rows.column.size()));
  }
  const ColumnBasis basis = column_basis(rows, settings);
  if (basis.rank != num_rows() || !basis.has_all_of_class_0) return false;
  std::vector<int> states;
  for (int column : basis.left_over) states.push_back(unknown_of[index(column)]);
  std::sort(states.begin(), states.end());
  if (states != equations_.states) {
    has_pattern_ = false;
    equations_.states = std::move(states);
  }
  return true;
}

// The matrix has the equations of the extension in its first rows, those of the states in its last.
void ExtendedSensitivityStep::set_states(const std::vector<int>& states) {
  std::vector<std::pair<int, int>> places;  // column, row
  for (const ExtendedEquations::Term& term : equations_.terms) places.emplace_back(term.column, term.row);
  for (std::size_t s = 0; s < states.size(); ++s)
    for (int l = 0; l < 2; ++l)
      places.emplace_back(equations_.first_column[index(states[s])] + l, num_rows() + static_cast<int>(s));
  std::vector<std::pair<int, int>> entries = places;
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  const auto position_of = [&](std::size_t e) {
    return static_cast<int>(std::lower_bound(entries.begin(), entries.end(), places[e]) - entries.begin());
  };
  for (std::size_t e = 0; e < equations_.terms.size(); ++e) equations_.terms[e].position = position_of(e);
  equations_.state_positions.clear();
  for (std::size_t e = equations_.terms.size(); e < places.size(); ++e)
    equations_.state_positions.push_back(position_of(e));
  pattern_.size = num_columns();
  pattern_.row.clear();
  pattern_.first.assign(index(pattern_.size) + 1, 0);
  for (const auto& [column, row] : entries) {
    pattern_.row.push_back(row);
    ++pattern_.first[index(column) + 1];
  }
  std::partial_sum(pattern_.first.begin(), pattern_.first.end(), pattern_.first.begin());
  values_.assign(entries.size(), 0.0);
  planned_.analyze(pattern_);
  has_lu_ = false;
  has_pattern_ = true;
}

// state S_s,0 + slope S_s,1 in the last rows.
void ExtendedSensitivityStep::set_values(double state, double slope) {
  if (!has_pattern_) set_states(equations_.states);
  std::fill(values_.begin(), values_.end(), 0.0);
  for (const ExtendedEquations::Term& term : equations_.terms)
    values_[index(term.position)] += term.factor * coefficients_[term.coefficient];
  for (std::size_t s = 0; s < equations_.states.size(); ++s) {
    values_[index(equations_.state_positions[2 * s])] = state;
    values_[index(equations_.state_positions[2 * s + 1])] = slope;
  }
}

// Solves for the first `count` right-hand sides. Sparse factors replace a list of operations that is too long.
bool ExtendedSensitivityStep::solve_system(int count) {
  if (planned_.is_suitable() && planned_.solve(values_.data(), right_.data(), count, solution_.data())) return true;
  if (!has_lu_) {
    lu_.analyze(pattern_);
    pivots_.forget();
  }
  has_lu_ = true;
  if (!pivots_.factor(lu_, values_)) return false;
  std::copy(right_.begin(), right_.end(), solution_.begin());
  lu_.solve(solution_.data(), count);
  return all_finite(solution_.data(), index(num_columns()) * index(count));
}

// Right-hand sides of S, and one that changes only the states, by their sizes.
void ExtendedSensitivityStep::set_right_hand_sides(double c, const double* rest) {
  const int count = parameters_.count(), m = problem_.m(), n = problem_.n();
  std::fill(right_.begin(), right_.end(), 0.0);
  double* to = right_.data();
  for (int j = 0; j < count; ++j, to += num_columns()) {
    const double* F_p = F_p_.data() + index(m) * index(equations_.order + 1) * index(j);
    for (std::size_t i = 0; i < index(m); ++i)
      for (int k = 0; k <= equations_.limits[i]; ++k) to[equations_.first_row[i] + k] = -F_p[i + index(m) * index(k)];
    for (std::size_t s = 0; s < equations_.states.size(); ++s)
      to[index(num_rows()) + s] = -rest[index(equations_.states[s]) + index(n) * index(j)];
  }
  for (std::size_t s = 0; s < equations_.states.size(); ++s)
    to[index(num_rows()) + s] = (s % 2 == 0 ? c : -c) * sizes_[index(equations_.states[s])];
}

double ExtendedSensitivityStep::largest_move() const {
  const double* moves = solution_.data() + index(num_columns()) * index(parameters_.count());
  double largest = 0.0;
  for (std::size_t j = 0; j < sizes_.size(); ++j)
    if (sizes_[j] > 0.0) largest = std::max(largest, std::fabs(moves[equations_.first_column[j]]) / sizes_[j]);
  return largest;
}

PointStatus ExtendedSensitivityStep::evaluate(const Jet& jet) {
  if (!linearize(jet)) return PointStatus::callback_error;
  const int rows = problem_.m() * (equations_.order + 1), count = parameters_.count();
  callback_error_ = parameters_.values(jet.t, jet.x.data(), equations_.order, View{F_p_.data(), rows, count, rows});
  return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
}

bool ExtendedSensitivityStep::are_good_states(double move) const {
  return move <= std::max(harmless_move, worth_a_choice * move_of_choice_);
}

// Chooses other states if the present ones no longer determine the rest. move: by how many of their sizes unknowns move
// if states do by theirs, in the last solution. False: there are no states.
template <class Solve, class Move>
bool ExtendedSensitivityStep::solve_with_good_states(Solve solve, Move move) {
  const bool is_solved = solve();
  if (is_solved && are_good_states(move())) return true;
  is_possible_ = choose_states() && ((is_solved && has_pattern_) || solve());
  if (is_possible_) move_of_choice_ = move();
  return is_possible_;
}

PointStatus ExtendedSensitivityStep::solve(const Jet& jet, double c, const double* rest, double* S) {
  const int n = jet.n, count = parameters_.count();
  const PointStatus status = evaluate(jet);
  if (status != PointStatus::ok) return status;
  const auto solve_with_states = [&] {
    set_values(c, -1.0);
    set_right_hand_sides(c, rest);
    return solve_system(count + 1);
  };
  if (!solve_with_good_states(solve_with_states, [&] { return largest_move(); })) return PointStatus::ok;
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i)
      S[i + j * n] = solution_[index(num_columns()) * index(j) + index(equations_.first_column[index(i)])];
  return PointStatus::ok;
}

// ---- Tangents --------------------------------------------------------------------------------------------------

// Right-hand sides of xp, with fixed states, and one for each state.
void ExtendedSensitivityStep::set_right_hand_sides_of_tangents() {
  const std::size_t columns = index(num_columns()), count = index(parameters_.count());
  right_.resize(std::max(right_.size(), columns * (count + equations_.states.size())));
  solution_.resize(right_.size());
  std::fill(right_.begin(), right_.end(), 0.0);
  const int m = problem_.m();
  for (std::size_t j = 0; j < count; ++j) {
    const double* const F_p = F_p_.data() + index(m) * index(equations_.order + 1) * j;
    for (std::size_t i = 0; i < index(m); ++i)
      for (int k = 0; k <= equations_.limits[i]; ++k)
        right_[columns * j + index(equations_.first_row[i] + k)] = -F_p[i + index(m) * index(k)];
  }
  for (std::size_t s = 0; s < equations_.states.size(); ++s)
    right_[columns * (count + s) + index(num_rows()) + s] = 1.0;
}

double ExtendedSensitivityStep::largest_move_of_tangents() const {
  const std::size_t columns = index(num_columns()), count = index(parameters_.count());
  double largest = 0.0;
  for (std::size_t j = 0; j < sizes_.size(); ++j) {
    if (sizes_[j] == 0.0) continue;
    double sum = 0.0;
    for (std::size_t s = 0; s < equations_.states.size(); ++s)
      sum += (s % 2 == 0 ? 1.0 : -1.0) * solution_[columns * (count + s) + index(equations_.first_column[j])] *
             sizes_[index(equations_.states[s])];
    largest = std::max(largest, std::fabs(sum) / sizes_[j]);
  }
  return largest;
}

PointStatus ExtendedSensitivityStep::find_tangents(const Jet& jet, View T2, View xp) {
  const PointStatus status = evaluate(jet);
  if (status != PointStatus::ok) return status;
  const auto solve_with_states = [&] {
    set_values(1.0, 0.0);
    set_right_hand_sides_of_tangents();
    return solve_system(parameters_.count() + num_states());
  };
  if (!solve_with_good_states(solve_with_states, [&] { return largest_move_of_tangents(); })) return PointStatus::ok;
  const double* from = solution_.data();
  for (View to : {xp, T2})
    for (int j = 0; j < to.cols; ++j, from += num_columns())
      for (int i = 0; i < jet.n; ++i) to(i, j) = from[equations_.first_column[index(i)]];
  return PointStatus::ok;
}

}  // namespace sfdae::core
