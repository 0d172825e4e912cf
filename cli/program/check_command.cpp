// sfdae check: reads a model, counts variables and equations, and reports errors.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>

#include "program/commands.h"
#include "program/interruption.h"
#include "program/names.h"
#include "program/numbers.h"
#include "program/output_file.h"
#include "program/presentation.h"
#include "program/run.h"
#include "program/structure.h"

namespace sfdae::cli {

namespace {

std::string kind_of(const Variable& variable) {
  if (variable.is_input) return "input";
  switch (variable.variability) {
    case Variability::constant: return "constant";
    case Variability::parameter: return "parameter";
    case Variability::discrete: return "discrete";
    case Variability::continuous: return "continuous";
  }
  return "";
}

std::string counts_text(const FlatModel& model) {
  const auto count = [&model](const std::string& kind) {
    return static_cast<std::size_t>(std::count_if(model.variables.begin(), model.variables.end(),
                                                  [&kind](const Variable& v) { return kind_of(v) == kind; }));
  };
  std::string text = model.name + (model.description.empty() ? "" : ": " + model.description) + "\n";
  text += "  " + counted(count("continuous"), "continuous variable", "continuous variables") + ", " +
          std::to_string(count("discrete")) + " discrete, " + counted(count("parameter"), "parameter", "parameters");
  if (count("constant") > 0) text += ", " + counted(count("constant"), "constant", "constants");
  if (count("input") > 0) text += ", " + counted(count("input"), "input", "inputs");
  text += "\n  " + counted(model.equations.size(), "equation", "equations");
  if (!model.initial_equations.empty())
    text += ", " + counted(model.initial_equations.size(), "initial equation", "initial equations");
  if (!model.whens.empty()) text += ", " + counted(model.whens.size(), "when clause", "when clauses");
  if (!model.assertions.empty()) text += ", " + counted(model.assertions.size(), "assertion", "assertions");
  return text + "\n";
}

std::string names_text(const FlatModel& model) {
  std::string text;
  for (const Variable& variable : model.variables) {
    text += "  " + kind_of(variable) + "\t" + variable.name + "\t" + variable.unit + "\t" + variable.description;
    text.erase(text.find_last_not_of('\t') + 1);
    text += "\n";
  }
  return text;
}

// Reports a structural index that is too low because numbers cancel: purely structural tools reduce the index wrongly.
std::string structure_text(const FlatModel& model, const Result& result) {
  const std::optional<int> structural = structural_index(model), index = differentiation_index(result);
  if (!structural || !index || result.outcome != Outcome::solved) return "";
  if (*structural > *index && result.num_replaced_states > 0)
    return "  By their pattern the equations as they stand have index " + std::to_string(*structural) + ".\n";
  if (*structural >= *index) return "";
  return "  The pattern of the equations alone says index " + std::to_string(*structural) +
         ", which is too low: here numbers cancel, and tools that go by the pattern go wrong.\n";
}

}  // namespace

int check_command(const Arguments& arguments) {
  const FlatModel model = read_model_of(arguments);
  print_warnings(arguments, model.warnings);
  Settings settings = arguments.settings;
  settings.values = single_values(parse_assignments(arguments.assignments, model));
  std::unique_ptr<OutputFile> json;
  if (!arguments.json.empty()) json = std::make_unique<OutputFile>(arguments.json);
  note_interruptions();
  settings.progress = [](double, double, int) { return !was_interrupted(); };
  const Result result = analyze(model, settings);
  print_warnings(arguments, result.warnings);
  if (json) json->commit(json_text({model, result, {}, settings.values}));
  print_reason(model, result);
  if (!arguments.is_quiet && arguments.json != "-")
    write_to_standard_output(counts_text(model) + (arguments.lists_names ? names_text(model) : std::string()) +
                             index_text(result) + structure_text(model, result));
  return exit_code_of(result.outcome);
}

}  // namespace sfdae::cli
