// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/state_elimination.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "simulation/elimination.h"
#include "simulation/linear_form.h"
#include "simulation/time_derivative.h"

namespace sfdae::cli {

namespace {

// Each round lowers the index by one if all constraints are explicit, and the last finds nothing: 12 is the highest
// strangeness index that the library could solve otherwise. Systems of bodies take three rounds.
constexpr int max_rounds = 13;
// A state is eliminated only if its coefficient is at least this part of the largest one, in nominal values: errors of
// the others are amplified by at most its inverse, which leaves 13 of 16 digits.
constexpr double safe_pivot = 1e-3;
// Formulas with more parts are left to the library; the last link of a chain of 20 pendulums has 122.
constexpr std::size_t most_parts = 100000;

class StateElimination {
 public:
  explicit StateElimination(const Reducible& reducible)
      : system_(reducible.system),
        formulas_(reducible.system.formulas),
        reducible_(reducible),
        derivative_(reducible.ranks.size(), -1),
        is_kept_(reducible.ranks.size(), 0) {
    for (const Reaction& reaction : system_.reactions)
      if (reaction.kind == Action::Kind::reinit)
        if (const int root = reducible.aliases.find(reaction.variable).root; root >= 0) is_kept_[at(root)] = 1;
  }

  std::vector<ExplicitState> run() {
    for (int round = 0; round < max_rounds; ++round) {
      define_derivatives();
      if (!define_states()) break;
    }
    TimeDerivative derivative(formulas_, [&](int v) { return formulas_.derivative(v); });
    for (ExplicitState& one : result_) one.derivative = derivative(one.value);
    return std::move(result_);
  }

 private:
  void rewrite(Substitution& by) {
    for (std::size_t i = 0; i < reducible_.residuals.size(); ++i)
      if (reducible_.used[i] == 0) reducible_.residuals[i].formula = by(reducible_.residuals[i].formula);
  }

  // x' = k v + c: substitutes k v + c for x' elsewhere, so that x' occurs once.
  void define_derivatives() {
    std::vector<std::pair<int, int>> found;  // state, residual
    for (std::size_t i = 0; i < reducible_.residuals.size(); ++i) {
      const Formula formula = reducible_.residuals[i].formula;
      if (reducible_.used[i] != 0 || !formulas_.depends(formula, on_derivative)) continue;
      LinearForm form = linear_form(formulas_, formula);
      if (!form.is_whole || form.others.size() != 1 || form.coefficients.size() > 1) continue;
      const auto [factor, other] = form.others.front();
      const FormulaNode node = formulas_[other];
      if (node.operation != Operation::derivative || derivative_[at(node.index)] >= 0) continue;
      form.others.clear();
      derivative_[at(node.index)] = solved(formulas_, form, factor);
      found.emplace_back(node.index, static_cast<int>(i));
    }
    if (found.empty()) return;
    Substitution by(formulas_);
    std::vector<Formula> kept;
    for (const auto& [state, residual] : found) {
      by.replace(state, formulas_.variable(state), derivative_[at(state)]);
      kept.push_back(reducible_.residuals[at(residual)].formula);
    }
    rewrite(by);
    for (std::size_t k = 0; k < found.size(); ++k) reducible_.residuals[at(found[k].second)].formula = kept[k];
  }

  // A constraint contains only states and time.
  bool is_of_states(const std::vector<Formula>& parts) const {
    return std::all_of(parts.begin(), parts.end(), [&](Formula part) {
      const FormulaNode& node = formulas_[part];
      return node.operation != Operation::variable || system_.is_state[at(node.index)] != 0;
    });
  }

  // Solves the constraint 0 = g for a state x, if possible; variable: -1 if not.
  ExplicitState explicit_state(Formula g) {
    LinearForm form = linear_form(formulas_, g);
    if (!form.is_whole) return {};
    std::vector<Formula> others;
    for (const auto& [factor, other] : form.others) others.push_back(other);
    std::unordered_map<int, char> occurs;
    for (Formula part : formulas_.parts(others))
      if (formulas_[part].operation == Operation::variable) occurs[formulas_[part].index] = 1;
    const auto size = [&](int v, double coefficient) {
      return std::fabs(coefficient) * system_.sizes.nominal[at(v)];
    };
    double largest = 0.0;
    for (const auto& [v, coefficient] : form.coefficients) largest = std::max(largest, size(v, coefficient));
    int best = -1;
    for (const auto& [v, coefficient] : form.coefficients) {
      if (occurs.count(v) != 0 || is_kept_[at(v)] != 0 || size(v, coefficient) < safe_pivot * largest) continue;
      if (coefficient == 0.0 || !std::isfinite(coefficient)) continue;
      if (best < 0 || reducible_.ranks[at(v)] < reducible_.ranks[at(best)]) best = v;
    }
    if (best < 0) return {};
    const double coefficient = form.coefficients.extract(best).mapped();
    return {best, solved(formulas_, form, coefficient), -1};
  }

  // Constraints of this round, with the results of the previous ones substituted.
  std::vector<ExplicitState> found_in_constraints() {
    Substitution algebraic(formulas_);
    std::vector<char> defines(reducible_.residuals.size(), 0);
    for (const SolvedUnknown& one : find_explicit(system_, reducible_.residuals, reducible_.used)) {
      algebraic.replace(one.variable, algebraic(one.value), -1);
      defines[at(one.residual)] = 1;
    }
    std::vector<ExplicitState> found;
    std::unordered_map<int, Formula> values;
    for (std::size_t i = 0; i < reducible_.residuals.size(); ++i) {
      if (reducible_.used[i] != 0 || defines[i] != 0) continue;
      if (formulas_.depends(reducible_.residuals[i].formula, on_derivative | on_discrete | on_free)) continue;
      const Formula g = with(values, algebraic(reducible_.residuals[i].formula));
      const std::vector<Formula> parts = formulas_.parts({g});
      // Discontinuous constraints are left to the library, which reports jumps of states.
      if (formulas_.depends(g, on_discrete | on_free) || parts.size() > most_parts || !is_of_states(parts)) continue;
      const ExplicitState one = explicit_state(g);
      if (one.variable < 0) continue;
      reducible_.used[i] = 1;
      values[one.variable] = one.value;
      found.push_back(one);
    }
    return found;
  }

  // Repeats the substitution, because a value may contain variables that were found later, but never earlier ones.
  Formula with(const std::unordered_map<int, Formula>& values, Formula g) {
    for (;;) {
      Substitution by(formulas_);
      bool has_any = false;
      for (Formula part : formulas_.parts({g})) {
        const FormulaNode& node = formulas_[part];
        const auto value = node.operation == Operation::variable ? values.find(node.index) : values.end();
        if (value == values.end()) continue;
        by.replace(node.index, value->second, -1);
        has_any = true;
      }
      if (!has_any) return g;
      g = by(g);
    }
  }

  bool define_states() {
    std::vector<ExplicitState> found = found_in_constraints();
    if (found.empty()) return false;
    Substitution values(formulas_);
    for (auto one = found.rbegin(); one != found.rend(); ++one) {
      one->value = values(one->value);
      values.replace(one->variable, one->value, -1);
    }
    for (const ExplicitState& one : found) derivative_[at(one.variable)] = -1;
    for (Formula& value : derivative_) value = values(value);
    for (ExplicitState& one : result_) one.value = values(one.value);
    TimeDerivative derivative(
        formulas_, [&](int v) { return derivative_[at(v)] >= 0 ? derivative_[at(v)] : formulas_.derivative(v); });
    Substitution by(formulas_);
    for (const ExplicitState& one : found) by.replace(one.variable, one.value, derivative(one.value));
    rewrite(by);
    result_.insert(result_.end(), found.begin(), found.end());
    find_states();
    return true;
  }

  void find_states() {
    std::vector<Formula> all;
    for (std::size_t i = 0; i < reducible_.residuals.size(); ++i)
      if (reducible_.used[i] == 0) all.push_back(reducible_.residuals[i].formula);
    system_.is_state = reducible_.is_state_outside;
    for (const ExplicitState& one : result_) system_.is_state[at(one.variable)] = 0;
    formulas_.mark_differentiated(all, system_.is_state);
  }

  System& system_;
  Formulas& formulas_;
  const Reducible& reducible_;
  std::vector<Formula> derivative_;  // by state: its replacement; -1: none
  std::vector<char> is_kept_;        // by variable: set by reinit
  std::vector<ExplicitState> result_;
};

}  // namespace

std::vector<ExplicitState> eliminate_states(const Reducible& reducible) { return StateElimination(reducible).run(); }

}  // namespace sfdae::cli
