// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/aliases.h"

#include <cmath>
#include <deque>

#include "simulation/linear_form.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Sums of numbers that cancel up to roundoff are zero.
constexpr double rounding = 1e-14;

class Search {
 public:
  Search(const System& system, const std::vector<Residual>& residuals, Aliases& aliases, std::vector<char>& used,
         std::vector<std::string>& warnings)
      : aliases_(aliases), system_(system), residuals_(residuals), used_(used), warnings_(warnings) {
    forms_.reserve(residuals.size());
    equations_of_.resize(system.model.variables.size());
    for (const Residual& residual : residuals) {
      LinearForm form = linear_form(system.formulas, residual.formula);
      if (!form.is_whole || !form.others.empty()) form.coefficients.clear(), form.is_whole = false;
      const int equation = static_cast<int>(forms_.size());
      for (const auto& [variable, coefficient] : form.coefficients) equations_of_[at(variable)].push_back(equation);
      forms_.push_back(std::move(form));
      open_.push_back(equation);
    }
  }

  void run() {
    while (!open_.empty()) {
      const int equation = open_.front();
      open_.pop_front();
      if (used_[at(equation)] == 0 && forms_[at(equation)].is_whole) examine(equation);
    }
  }

  bool has_found() const { return has_found_; }

 private:
  void examine(int equation) {
    std::map<int, double> coefficients;
    double constant = forms_[at(equation)].constant, size = std::fabs(constant);
    for (const auto& [variable, coefficient] : forms_[at(equation)].coefficients) {
      const Alias alias = aliases_.find(variable);
      constant += coefficient * alias.offset;
      size += std::fabs(coefficient * alias.offset);
      if (alias.root >= 0) coefficients[alias.root] += coefficient * alias.sign;
    }
    std::erase_if(coefficients, [](const auto& entry) { return entry.second == 0.0; });
    if (coefficients.size() > 2) return;
    if (coefficients.empty()) return follows(equation, constant, size);
    const auto [a, ka] = *coefficients.begin();
    if (coefficients.size() == 1) {
      if (!std::isfinite(constant / ka)) return;
      aliases_.set_constant(a, std::fabs(constant) <= rounding * size ? 0.0 : -constant / ka);
      return use(equation, {a});
    }
    const auto [b, kb] = *coefficients.rbegin();
    if (std::fabs(ka) != std::fabs(kb)) return;
    const double offset = std::fabs(constant) <= rounding * size ? 0.0 : constant / std::fabs(ka);
    aliases_.unite(a, ka > 0.0 ? 1.0 : -1.0, b, kb > 0.0 ? 1.0 : -1.0, offset);
    use(equation, {a, b});
  }

  // Marks the equation as used and revisits equations with a changed root, which may have become simpler.
  void use(int equation, const std::vector<int>& changed) {
    used_[at(equation)] = 1;
    has_found_ = true;
    for (int root : changed) {
      if (aliases_.find(root).root == root) continue;
      std::vector<int> affected = std::move(equations_of_[at(root)]);
      const int new_root = aliases_.find(root).root;
      for (int other : affected) {
        open_.push_back(other);
        if (new_root >= 0) equations_of_[at(new_root)].push_back(other);
      }
    }
  }

  void follows(int equation, double constant, double size) {
    const std::string where = place(system_.model, residuals_[at(equation)].at);
    if (std::fabs(constant) > rounding * size)
      throw ModelError(system_.model.file, residuals_[at(equation)].at,
                       "this equation contradicts others: it says 0 = " + to_text(constant));
    used_[at(equation)] = 1;
    warnings_.push_back(where + ": this equation follows from others and determines nothing");
  }

  Aliases& aliases_;
  bool has_found_ = false;
  const System& system_;
  const std::vector<Residual>& residuals_;
  std::vector<char>& used_;
  std::vector<std::string>& warnings_;
  std::vector<LinearForm> forms_;
  std::vector<std::vector<int>> equations_of_;
  std::deque<int> open_;
};

}  // namespace

Aliases::Aliases(const std::vector<int>& rank) : parents_(rank.size()), rank_(rank) {
  for (std::size_t i = 0; i < rank.size(); ++i) parents_[i].root = static_cast<int>(i);
}

Alias Aliases::find(int variable) const {
  std::vector<int> path;
  int v = variable;
  while (v >= 0 && parents_[at(v)].root != v) {
    path.push_back(v);
    v = parents_[at(v)].root;
  }
  if (path.empty()) return parents_[at(variable)];
  Alias result = parents_[at(path.back())];
  for (std::size_t k = path.size() - 1; k-- > 0;) {  // path compression
    const Alias step = parents_[at(path[k])];
    result = {result.root, step.sign * result.sign, step.sign * result.offset + step.offset};
    parents_[at(path[k])] = result;
  }
  return parents_[at(variable)];
}

void Aliases::unite(int a, double sign_a, int b, double sign_b, double constant) {
  if (rank_[at(a)] < rank_[at(b)] || (rank_[at(a)] == rank_[at(b)] && a > b)) {
    std::swap(a, b);
    std::swap(sign_a, sign_b);
  }
  parents_[at(b)] = {a, -sign_a * sign_b, -sign_b * constant};
}

bool find_aliases(const System& system, const std::vector<Residual>& residuals, Aliases& aliases,
                  std::vector<char>& used, std::vector<std::string>& warnings) {
  Search search(system, residuals, aliases, used, warnings);
  search.run();
  return search.has_found();
}

}  // namespace sfdae::cli
