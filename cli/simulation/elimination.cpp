// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/elimination.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <set>
#include <utility>

#include "simulation/linear_form.h"

namespace sfdae::cli {

namespace {

// Coefficients beyond these limits are not safe divisors.
constexpr double smallest_divisor = 1e-100, largest_divisor = 1e100;

struct Candidate {
  std::vector<int> open;      // variables in it that are neither known nor defined
  std::vector<int> solvable;  // variables that it can define
};

// Sorting with tearing [CK06]: an equation with one open variable defines it; if there is none, a variable of an
// equation with few open variables remains an unknown.
class Sorting {
 public:
  Sorting(const System& system, const std::vector<Residual>& residuals, const std::vector<char>& used)
      : system_(system), residuals_(residuals) {
    candidates_.resize(residuals.size());
    equations_of_.resize(system.values.size());
    is_closed_.assign(system.values.size(), 0);
    for (std::size_t v = 0; v < system.values.size(); ++v) is_closed_[v] = system.is_state[v];
    for (int i = 0; i < static_cast<int>(residuals.size()); ++i)
      if (used[at(i)] == 0) add(i);
  }

  // keeps: tears if no equation has exactly one open variable.
  std::vector<SolvedUnknown> run(bool keeps) {
    while (!queue_.empty()) {
      const auto [count, equation] = queue_.top();
      queue_.pop();
      Candidate& candidate = candidates_[at(equation)];
      forget_closed(candidate.open);
      forget_closed(candidate.solvable);
      if (candidate.solvable.empty()) continue;
      if (candidate.open.size() != static_cast<std::size_t>(count))
        queue_.emplace(static_cast<int>(candidate.open.size()), equation);
      else if (count == 1) define(equation, candidate.open.front());
      else if (keeps) tear(equation);
      else break;  // all others have more
    }
    return std::move(definitions_);
  }

 private:
  void add(int equation) {
    const Formula formula = residuals_[at(equation)].formula;
    const Formulas& formulas = system_.formulas;
    if (formulas.depends(formula, on_derivative)) return;
    const LinearForm form = linear_form(formulas, formula);
    if (!form.is_whole) return;
    std::set<int> nonlinear;
    std::vector<Formula> others;
    for (const auto& [factor, other] : form.others) others.push_back(other);
    for (Formula part : formulas.parts(others))
      if (formulas[part].operation == Operation::variable && formulas.depends(part, on_continuous))
        nonlinear.insert(formulas[part].index);
    Candidate candidate;
    std::set<int> all = nonlinear;
    for (const auto& [variable, coefficient] : form.coefficients) {
      const double size = std::fabs(coefficient);
      all.insert(variable);
      if (nonlinear.count(variable) == 0 && size > smallest_divisor && size < largest_divisor)
        candidate.solvable.push_back(variable);
    }
    candidate.open.assign(all.begin(), all.end());
    forget_closed(candidate.open);
    forget_closed(candidate.solvable);
    if (candidate.solvable.empty()) return;
    for (int variable : candidate.open) equations_of_[at(variable)].push_back(equation);
    queue_.emplace(static_cast<int>(candidate.open.size()), equation);
    candidates_[at(equation)] = std::move(candidate);
  }

  void forget_closed(std::vector<int>& variables) const {
    std::erase_if(variables, [&](int v) { return is_closed_[at(v)] != 0; });
  }

  void define(int equation, int variable) {
    definitions_.push_back({variable, -1, equation});
    candidates_[at(equation)].solvable.clear();
    close(variable);
  }

  // Tears a variable: first those that the equation cannot define, then the one in the most equations.
  void tear(int equation) {
    const Candidate& candidate = candidates_[at(equation)];
    const auto weight = [&](int v) {
      const bool is_solvable =
          std::find(candidate.solvable.begin(), candidate.solvable.end(), v) != candidate.solvable.end();
      return std::make_pair(is_solvable ? 0 : 1, equations_of_[at(v)].size());
    };
    int best = candidate.open.front();
    for (int v : candidate.open)
      if (weight(v) > weight(best)) best = v;
    close(best);
    queue_.emplace(static_cast<int>(candidate.open.size()), equation);
  }

  void close(int variable) {
    is_closed_[at(variable)] = 1;
    for (int equation : equations_of_[at(variable)]) {
      Candidate& candidate = candidates_[at(equation)];
      if (candidate.solvable.empty()) continue;
      forget_closed(candidate.open);
      queue_.emplace(static_cast<int>(candidate.open.size()), equation);
    }
  }

  using Entry = std::pair<int, int>;  // open variables, equation

  const System& system_;
  const std::vector<Residual>& residuals_;
  std::vector<Candidate> candidates_;
  std::vector<std::vector<int>> equations_of_;
  std::vector<char> is_closed_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::vector<SolvedUnknown> definitions_;
};

std::vector<SolvedUnknown> with_values(std::vector<SolvedUnknown> definitions, Formulas& formulas,
                                       const std::vector<Residual>& residuals) {
  for (SolvedUnknown& definition : definitions) {
    LinearForm form = linear_form(formulas, residuals[at(definition.residual)].formula);
    const double coefficient = form.coefficients.extract(definition.variable).mapped();
    definition.value = solved(formulas, form, coefficient);
  }
  return definitions;
}

}  // namespace

std::vector<SolvedUnknown> find_definitions(System& system, const std::vector<Residual>& residuals,
                                            const std::vector<char>& used) {
  return with_values(Sorting(system, residuals, used).run(true), system.formulas, residuals);
}

std::vector<SolvedUnknown> find_explicit(System& system, const std::vector<Residual>& residuals,
                                         const std::vector<char>& used) {
  return with_values(Sorting(system, residuals, used).run(false), system.formulas, residuals);
}

}  // namespace sfdae::cli
