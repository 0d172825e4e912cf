// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/preparation.h"

#include <algorithm>
#include <cmath>

#include "simulation/aliases.h"
#include "simulation/bounds.h"
#include "simulation/classification.h"
#include "simulation/discrete_order.h"
#include "simulation/elimination.h"
#include "simulation/import.h"
#include "simulation/state_elimination.h"
#include "simulation/switch_times.h"
#include "simulation/text.h"
#include "simulation/whens.h"

namespace sfdae::cli {

namespace {

bool is_discrete(const Variable& variable) {
  return variable.type != Type::real || variable.variability == Variability::discrete;
}

std::vector<unsigned> dependences(const FlatModel& model, const Parameters& parameters) {
  std::vector<unsigned> result;
  for (int v = 0; v < static_cast<int>(model.variables.size()); ++v) {
    const Variable& variable = model.variables[at(v)];
    result.push_back(parameters.is_known(v)                              ? on_numbers
                     : is_discrete(variable)                             ? on_discrete
                     : parameters.is_free(v) || parameters.is_derived(v) ? on_free
                                                                         : on_continuous);
  }
  return result;
}

class Preparation {
 public:
  Preparation(System& system, Parameters& parameters, std::vector<std::string>& warnings, int reduce_above)
      : system_(system),
        parameters_(parameters),
        warnings_(warnings),
        reduce_above_(reduce_above),
        import_(system, parameters) {}

  void run() {
    describe_variables();
    import_equations();
    import_whens(system_, import_);
    import_conditions();
    import_assertions();
    reduce();
    finish();
  }

 private:
  const FlatModel& model() const { return system_.model; }
  int num_variables() const { return static_cast<int>(model().variables.size()); }

  void describe_variables() {
    const std::size_t count = model().variables.size();
    system_.sizes.nominal.assign(count, 1.0);
    system_.sizes.scale.assign(count, 1.0);
    system_.starts.numbers.assign(count, 0.0);
    system_.starts.are_given.assign(count, 0);
    system_.is_state.assign(count, 0);
    determined_.assign(count, Determined::elsewhere);
    for (int v = 0; v < num_variables(); ++v) {
      const Variable& variable = model().variables[at(v)];
      if (const auto start = parameters_.start(v)) {
        system_.starts.numbers[at(v)] = *start;
        system_.starts.are_given[at(v)] = 1;
      } else if (variable.type == Type::enumeration) {
        system_.starts.numbers[at(v)] = 1.0;
      }
      const double nominal = variable.nominal ? std::fabs(parameters_.value(variable.nominal)) : 0.0;
      system_.sizes.nominal[at(v)] =
          std::isfinite(nominal) && nominal > 0.0 ? nominal : std::max(1.0, std::fabs(system_.starts.numbers[at(v)]));
      system_.sizes.scale[at(v)] =
          std::isfinite(nominal) && nominal > 0.0 ? nominal : scale_of(system_.starts.numbers[at(v)]);
      if (parameters_.is_free(v) && !is_discrete(variable)) system_.free_parameters.push_back(v);
      add_bounds(system_, parameters_, import_, v, warnings_);
      if (parameters_.is_known(v) || parameters_.is_free(v) || parameters_.is_derived(v)) continue;
      if (variable.is_input) continue;
      determined_[at(v)] = is_discrete(variable) ? Determined::discretely : Determined::continuously;
    }
    for (int v = 0; v < num_variables(); ++v) system_.starts.formulas.push_back(start_formula(v));
    system_.starts.own = system_.starts.formulas;
    for (const When& when : model().whens)
      for (const WhenBranch& branch : when.branches)
        for (const Action& action : branch.actions)
          if (action.kind == Action::Kind::assign) determined_[at(action.variable)] = Determined::elsewhere;
  }

  static double scale_of(double start) { return start != 0.0 ? std::fabs(start) : 1.0; }

  // A number, unless it depends on free parameters.
  Formula start_formula(int v) {
    const Variable& variable = model().variables[at(v)];
    const Expression& start = parameters_.is_free(v) && !variable.start ? variable.binding : variable.start;
    const Formula number = system_.formulas.number(system_.starts.numbers[at(v)]);
    if (!start || parameters_.given_starts().count(v) != 0) return number;
    const Formula formula = import_(start, Context::literal);
    return system_.formulas.depends(formula, on_free | on_discrete) ? formula : number;
  }

  // True if an equation with this side may determine a discrete variable: v, not v, -v.
  bool is_of_discrete(const Expression& side) const {
    const bool has_operand = side->operation == Operation::not_ || side->operation == Operation::negate;
    const Node& node = has_operand ? *side->operands.at(0) : *side;
    return node.operation == Operation::variable && determined_[at(node.index)] == Determined::discretely;
  }

  void import_equations() {
    std::vector<ImportedEquation> equations;
    for (const Equation& equation : model().equations) {
      const bool is_stepwise = is_of_discrete(equation.left) || is_of_discrete(equation.right);
      const Context context = is_stepwise ? Context::stepwise : Context::events;
      const Formula left = import_(equation.left, context), right = import_(equation.right, context);
      equations.push_back({left, right, equation.at});
    }
    ClassifiedEquations classified = classify(system_, equations, determined_);
    residuals_ = std::move(classified.continuous);
    system_.at_events.discrete = std::move(classified.discrete);
  }

  // Initial equations of discrete variables define their pre().
  void import_conditions() {
    const Formulas& formulas = system_.formulas;
    const auto target = [&](Formula side) {
      const FormulaNode& node = formulas[side];
      if (node.operation != Operation::previous && node.operation != Operation::variable) return -1;
      return is_discrete(model().variables[at(node.index)]) ? node.index : -1;
    };
    for (const Equation& equation : model().initial_equations) {
      const Formula left = import_(equation.left, Context::instant),
                    right = import_(equation.right, Context::instant);
      const int of_left = target(left), of_right = target(right);
      const std::string text = to_text(equation.left, model()) + " = " + to_text(equation.right, model());
      if (of_left >= 0) system_.at_events.initial.push_back({of_left, right, equation.at});
      else if (of_right >= 0) system_.at_events.initial.push_back({of_right, left, equation.at});
      else system_.initial_conditions.push_back({left, right, equation.at, text});
    }
    add_discrete_starts();
  }

  // Start values of discrete variables that depend on free parameters.
  void add_discrete_starts() {
    std::vector<char> has_equation(model().variables.size(), 0);
    for (const DiscreteAssignment& assignment : system_.at_events.initial) has_equation[at(assignment.variable)] = 1;
    for (int v = 0; v < num_variables(); ++v) {
      const bool is_number = system_.formulas.is_number(system_.starts.own[at(v)]);
      if (!is_number && is_discrete(model().variables[at(v)]) && has_equation[at(v)] == 0)
        system_.at_events.initial.push_back({v, system_.starts.own[at(v)], model().variables[at(v)].at});
    }
  }

  void import_assertions() {
    for (const Assertion& assertion : model().assertions) {
      Reaction reaction;
      reaction.kind = Action::Kind::assertion;
      reaction.active = system_.formulas.number(1.0);
      reaction.value = import_(assertion.condition, Context::events);
      reaction.message = assertion.message;
      reaction.is_error = assertion.is_error;
      reaction.at = assertion.at;
      system_.reactions.push_back(reaction);
    }
  }

  void find_states() {
    std::vector<Formula> all;
    for (const DiscreteAssignment& assignment : system_.at_events.discrete) all.push_back(assignment.value);
    for (const Switch& it : system_.switches) all.push_back(it.g);
    for (const Reaction& reaction : system_.reactions) all.push_back(reaction.value);
    for (const InitialCondition& condition : system_.initial_conditions) {
      all.push_back(condition.left);
      all.push_back(condition.right);
    }
    system_.formulas.mark_differentiated(all, system_.is_state);
    is_state_outside_ = system_.is_state;
    all.clear();
    for (const Residual& residual : residuals_) all.push_back(residual.formula);
    system_.formulas.mark_differentiated(all, system_.is_state);
  }

  std::vector<int> ranks_of_roots() const {
    std::vector<int> ranks;
    for (int v = 0; v < num_variables(); ++v) {
      const Variable& variable = model().variables[at(v)];
      ranks.push_back((system_.is_state[at(v)] != 0 ? 100 : 0) + 10 * static_cast<int>(variable.state_select) +
                      (variable.is_fixed ? 4 : 0) + (system_.starts.are_given[at(v)] != 0 ? 2 : 0));
    }
    return ranks;
  }

  void reduce() {
    find_states();
    system_.values.assign(model().variables.size(), -1);
    std::vector<char> used(residuals_.size(), 0);
    const std::vector<int> ranks = ranks_of_roots();
    Aliases aliases(ranks);
    while (find_aliases(system_, residuals_, aliases, used, warnings_)) put_in(aliases, used);
    share_attributes(aliases);
    std::vector<SolvedUnknown> definitions = find_definitions(system_, residuals_, used);
    std::vector<ExplicitState> states;
    if (std::count(used.begin(), used.end(), 0) > reduce_above_ + static_cast<std::ptrdiff_t>(definitions.size())) {
      states = eliminate_states({system_, residuals_, used, aliases, ranks, is_state_outside_});
      system_.num_replaced_states += static_cast<int>(states.size());
      definitions = find_definitions(system_, residuals_, used);
    }
    substitute(aliases, states, definitions);
    for (const SolvedUnknown& definition : definitions) used[at(definition.residual)] = 1;
    for (std::size_t i = 0; i < residuals_.size(); ++i)
      if (used[i] == 0) add_residual(residuals_[i]);
  }

  // Substitutes aliases: with constants inserted, products become linear and reveal more aliases.
  void put_in(const Aliases& aliases, const std::vector<char>& used) {
    Formulas& formulas = system_.formulas;
    Substitution by(formulas);
    for (int v = 0; v < num_variables(); ++v) {
      if (determined_[at(v)] != Determined::continuously || aliases.find(v).root == v) continue;
      const Alias alias = aliases.find(v);
      by.replace(v, value_of(alias), slope_of(alias));
    }
    for (std::size_t i = 0; i < residuals_.size(); ++i)
      if (used[i] == 0) residuals_[i].formula = by(residuals_[i].formula);
  }

  // Attributes of an alias apply to its root unless the root has its own.
  void share_attributes(const Aliases& aliases) {
    system_.aliases.assign(model().variables.size(), {});
    std::vector<int> quality(model().variables.size(), -1);
    std::vector<char> has_nominal(model().variables.size(), 0);
    for (int v = 0; v < num_variables(); ++v)
      if (model().variables[at(v)].nominal) has_nominal[at(v)] = 1;
    for (int v = 0; v < num_variables(); ++v) {
      const Alias alias = determined_[at(v)] == Determined::continuously ? aliases.find(v) : Alias{v, 1.0, 0.0};
      system_.aliases[at(v)] = alias;
      if (alias.root == v) continue;
      if (system_.is_state[at(v)] != 0 && (alias.root < 0 || system_.is_state[at(alias.root)] != 0))
        ++system_.num_replaced_states;
      if (alias.root < 0) continue;
      const std::size_t root = at(alias.root);
      if (system_.is_state[at(v)] != 0) system_.is_state[root] = 1;
      if (is_state_outside_[at(v)] != 0) is_state_outside_[root] = 1;
      if (has_nominal[at(v)] != 0 && has_nominal[root] == 0) {
        system_.sizes.nominal[root] = system_.sizes.scale[root] = system_.sizes.nominal[at(v)];
        has_nominal[root] = 1;
      }
      const int own = (model().variables[at(v)].is_fixed ? 2 : 0) + (system_.starts.are_given[at(v)] != 0 ? 1 : 0);
      const int present = std::max(
          quality[root], (model().variables[root].is_fixed ? 2 : 0) + (system_.starts.are_given[root] != 0 ? 1 : 0));
      if (own <= present) continue;
      quality[root] = own;
      system_.starts.numbers[root] = alias.sign * (system_.starts.numbers[at(v)] - alias.offset);
      system_.starts.formulas[root] =
          system_.formulas.is_number(system_.starts.own[at(v)])
              ? system_.formulas.number(system_.starts.numbers[root])
              : with_sign_of(alias, system_.formulas.subtract(system_.starts.own[at(v)],
                                                              system_.formulas.number(alias.offset)));
      system_.starts.are_given[root] = system_.starts.are_given[at(v)];
      if (has_nominal[root] != 0) continue;
      system_.sizes.nominal[root] = std::max(1.0, std::fabs(system_.starts.numbers[root]));
      system_.sizes.scale[root] = scale_of(system_.starts.numbers[root]);
    }
  }

  Formula with_sign_of(const Alias& alias, Formula formula) {
    return alias.sign > 0.0 ? formula : system_.formulas.negate(formula);
  }

  // The value of an alias in terms of its root.
  Formula value_of(const Alias& alias, Formula root) {
    return system_.formulas.add(with_sign_of(alias, root), system_.formulas.number(alias.offset));
  }

  Formula value_of(const Alias& alias) {
    if (alias.root < 0) return system_.formulas.number(alias.offset);
    return value_of(alias, system_.formulas.variable(alias.root));
  }

  Formula slope_of(const Alias& alias) {
    if (alias.root < 0) return system_.formulas.number(0.0);
    return with_sign_of(alias, system_.formulas.derivative(alias.root));
  }

  void substitute(const Aliases& aliases, const std::vector<ExplicitState>& states,
                  const std::vector<SolvedUnknown>& definitions) {
    system_.defined_at.assign(model().variables.size(), {});
    for (const DiscreteAssignment& assignment : system_.at_events.discrete)
      if (at(assignment.variable) < system_.defined_at.size())
        system_.defined_at[at(assignment.variable)] = assignment.at;
    std::vector<std::vector<int>> members(model().variables.size());
    std::vector<char> is_defined(model().variables.size(), 0);
    for (const ExplicitState& state : states) is_defined[at(state.variable)] = 1;
    for (const SolvedUnknown& definition : definitions) is_defined[at(definition.variable)] = 1;
    const auto replace = [&](int v, Formula value, Formula slope) {
      system_.values[at(v)] = value;
      substitution_.replace(v, value, slope);
    };
    for (int v = 0; v < num_variables(); ++v) {
      if (determined_[at(v)] != Determined::continuously) {
        system_.values[at(v)] = other_value(v);
        continue;
      }
      const Alias alias = aliases.find(v);
      if (alias.root >= 0 && is_defined[at(alias.root)] != 0) members[at(alias.root)].push_back(v);
      else replace(v, value_of(alias), slope_of(alias));
      if (alias.root == v && is_defined[at(v)] == 0) system_.unknowns.push_back(v);
      else ++system_.num_eliminated;
    }
    for (const ExplicitState& state : states) {
      const Formula value = substitution_(state.value), slope = substitution_(state.derivative);
      for (int v : members[at(state.variable)])
        replace(v, value_of(aliases.find(v), value), with_sign_of(aliases.find(v), slope));
    }
    for (const SolvedUnknown& definition : definitions) {
      const Formula value = substitution_(definition.value);
      for (int v : members[at(definition.variable)]) {
        replace(v, value_of(aliases.find(v), value), -1);
        system_.defined_at[at(v)] = residuals_[at(definition.residual)].at;
      }
    }
    for (int v = 0; v < num_variables(); ++v)
      if (parameters_.is_derived(v)) system_.values[at(v)] = substitution_(import_(model().variables[at(v)].binding));
  }

  Formula other_value(int v) {
    if (parameters_.is_known(v)) return system_.formulas.number(parameters_.value(v));
    return parameters_.is_derived(v) ? -1 : system_.formulas.variable(v);
  }

  void add_residual(const Residual& residual) {
    const Formula formula = substitution_(residual.formula);
    if (system_.formulas.is_number(formula)) {
      const double value = system_.formulas[formula].value;
      if (value != 0.0)
        throw ModelError(model().file, residual.at,
                         "this equation contradicts others: it says 0 = " + to_text(value));
      warnings_.push_back(place(model(), residual.at) + ": this equation follows from others and determines nothing");
      return;
    }
    system_.residuals.push_back({formula, residual.at});
  }

  void finish() {
    for (DiscreteAssignment& assignment : system_.at_events.discrete)
      assignment.value = substitution_(assignment.value);
    for (DiscreteAssignment& assignment : system_.at_events.initial)
      assignment.value = substitution_(assignment.value);
    for (Formula& condition : system_.at_events.when_conditions) condition = substitution_(condition);
    for (InitialCondition& condition : system_.initial_conditions) {
      condition.left = substitution_(condition.left);
      condition.right = substitution_(condition.right);
    }
    for (Reaction& reaction : system_.reactions) {
      reaction.active = substitution_(reaction.active);
      reaction.value = substitution_(reaction.value);
    }
    for (Switch& it : system_.switches) it.g = substitution_(it.g);
    find_switch_times(system_);
    sort_discrete(system_);
    find_integrals();
    for (const Reaction& reaction : system_.reactions)
      if (reaction.kind == Action::Kind::reinit) check_reinit(reaction);
  }

  void check_reinit(const Reaction& reaction) const {
    const int root = system_.aliases[at(reaction.variable)].root;
    if (root >= 0 && system_.is_state[at(root)] != 0 && system_.is_unknown(root)) return;
    throw ModelError(
        model().file, reaction.at,
        "reinit of " + model().variables[at(reaction.variable)].name + ", whose derivative occurs nowhere");
  }

  // Finds equations with one derivative and no algebraic variables.
  void find_integrals() {
    system_.is_continuous_at_impulses.assign(model().variables.size(), 0);
    for (const Residual& residual : system_.residuals) {
      int differentiated = -1, num_others = 0;
      for (Formula part : system_.formulas.parts({residual.formula})) {
        const FormulaNode& node = system_.formulas[part];
        if (node.operation == Operation::derivative && differentiated < 0) differentiated = node.index;
        else if (node.operation == Operation::derivative) ++num_others;
        else if (node.operation == Operation::variable && system_.formulas.depends(part, on_continuous))
          num_others += system_.is_state[at(node.index)] != 0 ? 0 : 1;
      }
      if (differentiated >= 0 && num_others == 0) system_.is_continuous_at_impulses[at(differentiated)] = 1;
    }
  }

  System& system_;
  Parameters& parameters_;
  std::vector<std::string>& warnings_;
  int reduce_above_;
  Import import_;
  Substitution substitution_{system_.formulas};
  std::vector<Determined> determined_;
  std::vector<Residual> residuals_;
  std::vector<char> is_state_outside_;  // by variable: its derivative occurs outside the residuals
};

}  // namespace

std::unique_ptr<System> prepared(const FlatModel& model, Parameters& parameters, std::vector<std::string>& warnings,
                                 int reduce_above) {
  auto system = std::make_unique<System>(model, dependences(model, parameters));
  Preparation(*system, parameters, warnings, reduce_above).run();
  return system;
}

}  // namespace sfdae::cli
