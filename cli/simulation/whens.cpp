// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/whens.h"

#include <map>
#include <utility>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

class WhenImport {
 public:
  WhenImport(System& system, Import& import) : system_(system), import_(import) {}

  void add(const When& when) {
    Formulas& formulas = system_.formulas;
    std::map<int, std::vector<std::pair<Formula, Formula>>> values;  // by variable: branch condition and value
    Formula none_before = formulas.number(1.0);
    for (const WhenBranch& branch : when.branches) {
      const Formula rises = rises_of(branch), active = formulas.both(none_before, rises);
      none_before = formulas.both(none_before, formulas.inverse(rises));
      for (const Action& action : branch.actions) {
        if (action.kind == Action::Kind::assign)
          values[action.variable].emplace_back(active, import_(action.value, Context::instant));
        else add_reaction(action, active);
      }
      add_text(branch, active, when.at);
    }
    for (const auto& [variable, choices] : values) {
      Formula value = formulas.previous(variable);
      for (auto choice = choices.rbegin(); choice != choices.rend(); ++choice)
        value = formulas.apply(Operation::choose, choice->first, choice->second, value);
      system_.at_events.discrete.push_back({variable, value, when.at});
    }
  }

 private:
  // Initially only conditions with initial() act (Modelica Language Specification 3.6, section 8.6).
  Formula rises_of(const WhenBranch& branch) {
    Formulas& formulas = system_.formulas;
    Formula rises = formulas.number(0.0);
    for (const Expression& condition : branch.conditions) {
      const Formula value = import_(condition, Context::events);
      const int memory = formulas.add_variable(on_discrete);
      system_.at_events.when_conditions.push_back(value);
      system_.at_events.discrete.push_back({memory, value, condition->at});
      bool has_initial = false;
      for (Formula part : formulas.parts({value}))
        has_initial = has_initial || formulas[part].operation == Operation::initial;
      const Formula initial = formulas.flag(Operation::initial);
      const Formula edge = formulas.both(formulas.variable(memory), formulas.inverse(formulas.previous(memory)));
      const Formula at_start = has_initial ? formulas.variable(memory) : formulas.number(0.0);
      rises = formulas.either(rises, formulas.apply(Operation::choose, initial, at_start, edge));
    }
    return rises;
  }

  void add_reaction(const Action& action, Formula active) {
    Reaction reaction;
    reaction.kind = action.kind;
    reaction.active = action.guard ? system_.formulas.both(active, import_(action.guard, Context::instant)) : active;
    reaction.variable = action.variable;
    reaction.message = action.message;
    reaction.is_error = action.is_error;
    reaction.at = action.at;
    if (action.value) reaction.value = import_(action.value, Context::instant);
    system_.reactions.push_back(reaction);
  }

  // Adds an assignment to no variable, so that the action can be reported.
  void add_text(const WhenBranch& branch, Formula active, Location at) {
    Reaction reaction;
    reaction.kind = Action::Kind::assign;
    reaction.active = active;
    reaction.at = at;  // the condition may be on another line, since a variable has the position of its first use
    const Location of_condition = branch.conditions.empty() ? at : branch.conditions.front()->at;
    if (of_condition.line > at.line) reaction.at = of_condition;
    for (const Expression& condition : branch.conditions)
      reaction.message += (reaction.message.empty() ? "when " : ", ") + to_text(condition, system_.model);
    system_.reactions.push_back(reaction);
  }

  System& system_;
  Import& import_;
};

}  // namespace

void import_whens(System& system, Import& import) {
  WhenImport when_import(system, import);
  for (const When& when : system.model.whens) when_import.add(when);
}

}  // namespace sfdae::cli
