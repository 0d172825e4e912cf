// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/read_model.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <tuple>
#include <utility>

#include "modelica/elaboration.h"
#include "modelica/equations.h"
#include "modelica/function.h"
#include "modelica/lexer.h"
#include "modelica/parser.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

namespace {

void read_experiment(Elaboration& e, const Environment& in) {
  for (const syntax::Modification& one : e.tree.model.annotation) {
    std::optional<double>* to = one.name == "StartTime"   ? &e.model.experiment.start
                                : one.name == "StopTime"  ? &e.model.experiment.stop
                                : one.name == "Tolerance" ? &e.model.experiment.tolerance
                                : one.name == "Interval"  ? &e.model.experiment.interval
                                                          : nullptr;
    if (to == nullptr || one.value == nullptr) continue;
    const Value value = evaluate(e, in, *one.value);
    if (value.is_scalar() && value.is_numeric()) *to = constant_value(e, value.scalars[0]);
  }
}

// parameter equation guess(x) = value
void read_guesses(Elaboration& e, const Environment& in) {
  for (const syntax::Guess& one : e.tree.model.guesses) {
    const Value variable = evaluate(e, in, *one.variable), value = evaluate(e, in, *one.value);
    if (!variable.has_scalars() || !value.has_scalars() || variable.dims != value.dims)
      e.fail(one.at, "a guess of " + shown_type(variable) + " with " + shown_type(value) + "; make them agree");
    for (size_t k = 0; k < variable.scalars.size(); ++k) {
      if (variable.scalars[k]->operation != Operation::variable)
        e.fail(one.at, "a guess of something that is no variable");
      if (e.pool.varies(value.scalars[k])) e.fail(one.at, "a guess that varies; use constants and parameters");
      e.model.variables[static_cast<size_t>(variable.scalars[k]->index)].start = value.scalars[k];
    }
  }
}

void read_sections(Elaboration& e, const Environment& in) {
  const Expression initial = e.pool.leaf(Operation::initial, {});
  const Guard guard{nullptr, initial, false};
  Environment in_initial = in;
  in_initial.guard = &guard;
  for (const syntax::Section& section : e.tree.model.sections) {
    std::vector<Equation>& equations = section.is_initial ? e.model.initial_equations : e.model.equations;
    const Environment& here = section.is_initial ? in_initial : in;
    if (section.is_algorithm) expand_algorithm(e, here, section.body, equations);
    else expand_equations(e, here, section.body, equations);
  }
}

}  // namespace

FlatModel read_model(const std::string& text, const std::string& file) {
  FlatModel model;
  model.file = file;
  const syntax::File tree = parse_file(text, file);
  model.name = plain(tree.model.name);
  model.description = tree.model.comment;
  Elaboration e(tree, model);
  for (const syntax::Warning& one : tree.warnings) e.warn(one.at, one.text);
  Symbols symbols(e);
  FunctionMemory functions;
  e.symbols = &symbols;
  e.functions = &functions;
  Environment in;
  in.scope = &symbols;
  in.assertions = &model.assertions;
  symbols.declare_all();
  read_guesses(e, in);
  symbols.bind_all();
  read_sections(e, in);
  read_experiment(e, in);
  finish_model(e);
  return model;
}

FlatModel read_model_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ModelError(path, {}, "cannot be opened; check its name and rights");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad()) throw ModelError(path, {}, "cannot be read");
  return read_model(text, path);
}

}  // namespace sfdae::cli
