// The extension linearized at a jet, its states, and the factored matrices for steps, stages and outputs nearby.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "extension/minimal_extension.h"
#include "extension/state_matrix.h"
#include "linalg/matrix.h"
#include "system/dae_system.h"
#include "system/jet.h"
#include "system/stage_method.h"

namespace sfdae::core {

class ExtensionLinearization {
 public:
  // counts: reductions and factorizations are added to it.
  ExtensionLinearization(MinimalExtension& extension, SystemCounts& counts)
      : extension_(extension), counts_(counts) {}

  // Linearizes at the jet. The states may stay if they determine all other unknowns about as well as at their choice;
  // otherwise new ones are chosen there. singular: no choice determines the others.
  enum class States { may_stay, chosen_there };
  PointStatus renew(const Jet& jet, CallbackError& error, States states = States::may_stay);
  // Like renew(), with these states only, and the archived lists.
  PointStatus restore(const Jet& jet, const std::vector<int>& states, Archive& archive, CallbackError& error);
  void archive_lists(Archive& archive) {
    held_.archive_list(archive, choice_);
    step_.archive_list(archive, choice_);
    for (auto& pair : pairs_) pair.archive_list(archive, choice_);
  }
  // Forbids its use before renew() or restore().
  void forget() { is_usable_ = false; }
  bool is_usable() const { return is_usable_; }
  const Jet& origin() const { return origin_; }
  // Derivatives at the origin.
  ExtensionDerivatives derivatives() const { return {extension_, values_}; }
  // Counts another linearization and its factors, made elsewhere.
  void count_local() {
    ++counts_.reductions;
    ++counts_.factorizations;
  }
  // Change of the unknowns that could be states, in their sizes, if the states change by theirs; tangents: derivatives
  // of the others by the states, by slots.
  double sensitivity(ConstView tangents) const { return sensitivity_to(changes_by(tangents).data()); }
  // True if states with that sensitivity determine the other unknowns about as well as at their choice.
  bool is_harmless(double sensitivity) const;
  // Lowers the reference: sizes of unknowns that begin to move are small, and sensitivities too large.
  void note_sensitivity(double sensitivity) {
    sensitivity_of_choice_ = std::min(sensitivity_of_choice_, sensitivity);
  }
  const StateChoice& choice() const { return choice_; }
  // Changes whenever the states do.
  long choice_number() const { return choice_number_; }
  // When reading, after restore(): restores the factored matrices. False if they cannot have been factored.
  bool archive_matrices(Archive& archive);
  // The matrix with the states held.
  const StateMatrix<double>& held() const { return held_; }
  // Number of entries in its factors.
  std::size_t fill() const { return held_.fill(); }
  // Archives the data besides the point that the choice of states depends on.
  void archive_choice(Archive& archive) {
    archive.real(sensitivity_of_choice_);
    archive.reals(sizes_, index(extension_.n()));
  }
  // Effects of rounding errors of f and of the unknowns on the unknowns, by columns of the extension.
  const std::vector<double>& noise() const { return noise_; }
  // In the layout of the jet; empty if unknown.
  std::vector<double> noise_of_jet() const;
  // By columns, at another jet.
  std::vector<double> noise_at(const Jet& jet);

  // The unit of time of the equations, a power of two.
  int time_exponent() const;

  // Factors the matrix for x' = c x + ... of the states, unless it is available.
  bool factor_step(double c);
  void forget_step_matrix() { step_.forget(); }
  bool has_step_matrix() const { return step_.is_valid(); }
  double c() const { return 1.0 / step_.epsilon(); }
  // Cost of factoring it again, in iterations: each has a solution, and an evaluation that takes about as long.
  double cost_of_step_matrix() const { return 1.0 + 0.5 * step_.factorization_in_solutions(); }
  // Factors all matrices of the stages of a step h that are not available.
  bool factor_stages(const StageMethod& method, double h);

  // r, by rows, becomes the changes by slots that remove r: of a step or of pair k of the stages, with those of the
  // states x_j in place of x_j'; or with the states held.
  void solve_step(double* r, int count = 1) { solve(step_, r, count); }
  void solve_pair(std::size_t k, std::complex<double>* r, int count = 1) { solve(pairs_[k], r, count); }
  void solve_held(double* r, int count = 1) { held_.solve(r, count); }
  // Derivatives by the states, by slots, a column for each state; no columns if there are many states.
  ConstView tangents() const {
    return {tangents_.data(), choice_.size(), num_tangents_, std::max(choice_.size(), 1)};
  }
  // r -= (derivatives by the states) changes; changes: n values.
  void subtract_states(const double* changes, double* r) const;

 private:
  template <class Number>
  void solve(StateMatrix<Number>& matrix, Number* r, int count) {
    matrix.solve(r, count);
    for (int k = 0; k < count; ++k, r += choice_.size()) choice_.to_states(matrix.epsilon(), r);
  }
  PointStatus linearize(const Jet& jet, CallbackError& error);
  bool choose_states();
  std::optional<std::vector<int>> states_by_stages(const std::vector<double>& values) const;
  std::optional<std::vector<int>> states_of_all(const std::vector<double>& values) const;
  bool may_be_state(int column) const;
  std::vector<double> scaled(std::vector<double> values) const;
  std::vector<double> values_in_own_time() const;
  bool factor_held();
  void set_states(std::vector<int> states);
  void note_sizes();
  std::vector<double> random_changes() const;
  double sensitivity_to(const double* changes) const;
  void make_tangents();
  std::vector<double> changes_by(ConstView tangents) const;
  void measure_sensitivity();
  void measure_noise() { noise_ = noise_at(origin_); }

  static constexpr std::size_t max_pairs = (max_stages - 1) / 2;

  MinimalExtension& extension_;
  SystemCounts& counts_;
  Jet origin_;
  bool is_usable_ = false;
  long choices_ = 0, choice_number_ = 0;
  // Change of the other unknowns x_j in their sizes if the states change by theirs; its value when these were chosen,
  // or the least noted since.
  double sensitivity_ = 0.0, sensitivity_of_choice_ = 0.0;
  std::vector<double> sizes_;  // of x
  StateChoice choice_;
  StateMatrix<double> step_, held_{true};
  std::array<StateMatrix<std::complex<double>>, max_pairs> pairs_;
  // Derivatives of the rows at the origin: the extension may have been linearized elsewhere since.
  std::vector<double> values_;
  std::vector<double> noise_, work_, tangents_;
  int num_tangents_ = 0;
};

}  // namespace sfdae::core
