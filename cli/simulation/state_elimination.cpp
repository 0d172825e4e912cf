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

// Each round lowers the index by one where all constraints are explicit.
constexpr int max_rounds = 20;
// A state is eliminated by its coefficient only if it is no smaller than this part of the largest one, in nominal values.
constexpr double safe_pivot = 1e-3;
// Formulas of more parts are left to the library.
constexpr std::size_t most_parts = 100000;

class StateElimination {
 public:
  explicit StateElimination(const Reducible& it)
      : system_(it.system),
        formulas_(it.system.formulas),
        it_(it),
        derivative_(it.ranks.size(), -1),
        is_kept_(it.ranks.size(), 0) {
    for (const Reaction& reaction : system_.reactions)
      if (reaction.kind == Action::Kind::reinit)
        if (const int root = it.aliases.find(reaction.variable).root; root >= 0) is_kept_[at(root)] = 1;
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
    for (std::size_t i = 0; i < it_.residuals.size(); ++i)
      if (it_.used[i] == 0) it_.residuals[i].formula = by(it_.residuals[i].formula);
  }

  // x' = k v + c: elsewhere k v + c stands for x', so that x' occurs once.
  void define_derivatives() {
    std::vector<std::pair<int, int>> found;  // state, residual
    for (std::size_t i = 0; i < it_.residuals.size(); ++i) {
      const Formula formula = it_.residuals[i].formula;
      if (it_.used[i] != 0 || !formulas_.depends(formula, on_derivative)) continue;
      const LinearForm form = linear_form(formulas_, formula);
      if (!form.is_whole || form.others.size() != 1 || form.coefficients.size() > 1) continue;
      const auto [factor, other] = form.others.front();
      const FormulaNode node = formulas_[other];
      if (node.operation != Operation::derivative || derivative_[at(node.index)] >= 0) continue;
      Formula value = formulas_.number(-form.constant / factor);
      for (const auto& [v, coefficient] : form.coefficients)
        value =
            formulas_.add(formulas_.multiply(formulas_.number(-coefficient / factor), formulas_.variable(v)), value);
      derivative_[at(node.index)] = value;
      found.emplace_back(node.index, static_cast<int>(i));
    }
    if (found.empty()) return;
    Substitution by(formulas_);
    std::vector<Formula> kept;
    for (const auto& [state, residual] : found) {
      by.replace(state, formulas_.variable(state), derivative_[at(state)]);
      kept.push_back(it_.residuals[at(residual)].formula);
    }
    rewrite(by);
    for (std::size_t k = 0; k < found.size(); ++k) it_.residuals[at(found[k].second)].formula = kept[k];
  }

  // Of what constraints are made of: states and time alone.
  bool is_of_states(const std::vector<Formula>& parts) const {
    return std::all_of(parts.begin(), parts.end(), [&](Formula part) {
      const FormulaNode& node = formulas_[part];
      return node.operation != Operation::variable || system_.is_state[at(node.index)] != 0;
    });
  }

  // x = value where the constraint 0 = g gives it; x: -1 if it gives none.
  ExplicitState solved(Formula g) {
    const LinearForm form = linear_form(formulas_, g);
    if (!form.is_whole) return {};
    std::vector<Formula> others;
    for (const auto& [factor, other] : form.others) others.push_back(other);
    std::unordered_map<int, char> occurs;
    for (Formula part : formulas_.parts(others))
      if (formulas_[part].operation == Operation::variable) occurs[formulas_[part].index] = 1;
    const auto size = [&](int v, double coefficient) { return std::fabs(coefficient) * system_.nominal[at(v)]; };
    double largest = 0.0;
    for (const auto& [v, coefficient] : form.coefficients) largest = std::max(largest, size(v, coefficient));
    int best = -1;
    for (const auto& [v, coefficient] : form.coefficients) {
      if (occurs.count(v) != 0 || is_kept_[at(v)] != 0 || size(v, coefficient) < safe_pivot * largest) continue;
      if (coefficient == 0.0 || !std::isfinite(coefficient)) continue;
      if (best < 0 || it_.ranks[at(v)] < it_.ranks[at(best)]) best = v;
    }
    if (best < 0) return {};
    const double scale = -1.0 / form.coefficients.at(best);
    Formula value = formulas_.number(form.constant * scale);
    for (const auto& [v, coefficient] : form.coefficients)
      if (v != best)
        value =
            formulas_.add(value, formulas_.multiply(formulas_.number(coefficient * scale), formulas_.variable(v)));
    for (const auto& [factor, other] : form.others)
      value = formulas_.add(value, formulas_.multiply(formulas_.number(factor * scale), other));
    return {best, value, -1};
  }

  // Constraints of this round, each with those before it put in.
  std::vector<ExplicitState> found_in_constraints() {
    Substitution algebraic(formulas_);
    std::vector<char> defines(it_.residuals.size(), 0);
    for (const SolvedUnknown& one : find_explicit(system_, it_.residuals, it_.aliases, it_.used)) {
      algebraic.replace(one.variable, algebraic(one.value), -1);
      defines[at(one.residual)] = 1;
    }
    TimeDerivative derivative(formulas_, [&](int v) { return formulas_.derivative(v); });
    std::vector<ExplicitState> found;
    std::unordered_map<int, Formula> values;
    for (std::size_t i = 0; i < it_.residuals.size(); ++i) {
      if (it_.used[i] != 0 || defines[i] != 0) continue;
      if (formulas_.depends(it_.residuals[i].formula, on_derivative | on_discrete | on_free)) continue;
      const Formula g = with(values, algebraic(it_.residuals[i].formula));
      const std::vector<Formula> parts = formulas_.parts({g});
      // What jumps is left to the library, which reports what it does to states.
      if (formulas_.depends(g, on_discrete | on_free) || parts.size() > most_parts || !is_of_states(parts)) continue;
      const ExplicitState one = solved(g);
      if (one.variable < 0 || derivative(one.value) < 0) continue;
      it_.used[i] = 1;
      values[one.variable] = one.value;
      found.push_back(one);
    }
    return found;
  }

  // The values may need each other, those found later those found before never.
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
    for (std::size_t i = 0; i < it_.residuals.size(); ++i)
      if (it_.used[i] == 0) all.push_back(it_.residuals[i].formula);
    system_.is_state = it_.is_state_outside;
    for (const ExplicitState& one : result_) system_.is_state[at(one.variable)] = 0;
    for (Formula part : formulas_.parts(all))
      if (formulas_[part].operation == Operation::derivative) system_.is_state[at(formulas_[part].index)] = 1;
  }

  System& system_;
  Formulas& formulas_;
  const Reducible& it_;
  std::vector<Formula> derivative_;  // of states: what stands for them; -1: they stand for themselves
  std::vector<char> is_kept_;        // of variables: reinit sets them
  std::vector<ExplicitState> result_;
};

}  // namespace

std::vector<ExplicitState> eliminate_states(const Reducible& reducible) { return StateElimination(reducible).run(); }

}  // namespace sfdae::cli
