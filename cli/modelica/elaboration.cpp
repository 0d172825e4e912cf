// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/elaboration.h"

#include <utility>

#include "modelica/lexer.h"

namespace sfdae::cli {

using syntax::Definition;
using syntax::DefinitionKind;

namespace {

Definition enumeration(const std::string& name, const std::vector<std::string>& literals) {
  Definition result;
  result.kind = DefinitionKind::enumeration;
  result.name = name;
  for (const std::string& literal : literals) result.literals.push_back({literal, ""});
  return result;
}

}  // namespace

Definitions::Definitions(const syntax::File& tree) {
  built_in_.push_back(enumeration("StateSelect", {"never", "avoid", "default", "prefer", "always"}));
  built_in_.push_back(enumeration("AssertionLevel", {"warning", "error"}));
  for (const Definition& one : tree.definitions) by_name_.emplace(one.name, &one);
  for (const Definition& one : built_in_) by_name_[one.name] = &one;
}

const Definition* Definitions::find(const std::string& name) const {
  if (const auto found = by_name_.find(name); found != by_name_.end()) return found->second;
  const auto found = by_name_.find(name[0] == '\'' ? name.substr(1) : "'" + name);
  return found != by_name_.end() ? found->second : nullptr;
}

const Definition* Definitions::find(const std::string& name, DefinitionKind kind) const {
  const Definition* result = find(name);
  return result != nullptr && result->kind == kind ? result : nullptr;
}

Elaboration::Elaboration(const syntax::File& file, FlatModel& flat)
    : tree(file), model(flat), pool(flat.file), definitions(file) {}

void Elaboration::fail(Location at, const std::string& text) const { throw ModelError(model.file, at, text); }

void Elaboration::warn(Location at, const std::string& text) {
  model.warnings.push_back(ModelError(model.file, at, text).what());
}

void Elaboration::charge(long steps, Location at) {
  limits.steps += steps;
  if (limits.steps > Limits::kMaxSteps)
    fail(at, "expanding the model takes more than " + std::to_string(Limits::kMaxSteps / 1'000'000) +
                 " million steps; make arrays or loops smaller");
}

ResolvedType resolve_type(const Elaboration& e, const std::string& name, Location at) {
  ResolvedType result;
  std::string next = name;
  for (int k = 0; k < 100; ++k) {
    const Definition* found = e.definitions.find(next);
    if (found == nullptr) {
      if (next == "Real" || next == "'Real") return result.kind = Kind::real, result;
      if (next == "Integer" || next == "'Integer") return result.kind = Kind::integer, result;
      if (next == "Boolean" || next == "'Boolean") return result.kind = Kind::boolean, result;
      if (next == "String" || next == "'String") return result.kind = Kind::string, result;
      if (next == "Clock")
        e.fail(at, "clocks ('Clock') are not supported; replace them by when sample(start, interval) clauses");
      e.fail(at, "unknown type '" + plain(next) + "'; define it in the package");
    }
    if (found->kind != DefinitionKind::alias) {
      result.definition = found;
      result.kind = found->kind == DefinitionKind::enumeration ? Kind::enumeration
                    : found->kind == DefinitionKind::record    ? Kind::record
                                                               : Kind::function;
      return result;
    }
    for (const syntax::ExpressionPointer& dimension : found->alias.dimensions)
      result.dimensions.push_back(dimension.get());
    result.modifications.insert(result.modifications.begin(), &found->alias.modifications);
    next = found->alias.type;
  }
  e.fail(at, "the type '" + plain(name) + "' is defined by itself; end the circle");
}

}  // namespace sfdae::cli
