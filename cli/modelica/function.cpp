// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/function.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/assign.h"
#include "modelica/built_in.h"
#include "modelica/executor.h"
#include "modelica/lexer.h"
#include "modelica/symbols.h"
#include "modelica/tables.h"

namespace sfdae::cli {

using syntax::Declaration;
using syntax::Definition;
using syntax::Direction;

namespace {

// A value of a type, with nothing assigned.
Value unassigned(Elaboration& e, const ResolvedType& type, std::vector<int> dims, int depth, Location at) {
  if (depth > 50) e.fail(at, "records within records beyond 50 levels; end the circle");
  std::replace(dims.begin(), dims.end(), -1, 0);
  Value result;
  result.kind = type.kind;
  result.definition = type.definition;
  result.dims = std::move(dims);
  const size_t count = product(result.dims);
  e.charge(static_cast<long>(count), at);
  if (type.kind == Kind::string) result.texts.resize(count);
  else if (type.kind != Kind::record) result.scalars.resize(count);
  else
    for (size_t k = 0; k < count; ++k) {
      result.records.emplace_back();
      for (const Declaration& field : type.definition->elements) {
        const ResolvedType inner = resolve_type(e, field.type, field.type_at);
        std::vector<const syntax::Expression*> dimensions;
        for (const syntax::ExpressionPointer& one : field.dimensions) dimensions.push_back(one.get());
        dimensions.insert(dimensions.end(), inner.dimensions.begin(), inner.dimensions.end());
        Environment in;
        in.scope = &e.symbols->package();
        result.records.back().fields.emplace_back(
            field.name, unassigned(e, inner, evaluate_dims(e, in, dimensions), depth + 1, at));
      }
    }
  return result;
}

// The variables of a function: inputs, outputs, locals; keys are their indices among its elements.
class FunctionStore : public Store {
 public:
  FunctionStore(Elaboration& e, const Definition& function, Environment in)
      : e_(e), function_(function), in_(in), stages_(function.elements.size(), 0) {
    in_.scope = this;
  }

  ValuePointer find(const std::string& name, Location at) override {
    const int k = number_of(name);
    if (k < 0) return e_.symbols->package().find(name, at);
    return value(k, at);
  }

  std::shared_ptr<Value> value(int k, Location at) {
    const auto found = state_.find(k);
    return found != state_.end() ? found->second : state_[k] = initialize(k, at);
  }

  void bind_input(int k, const Value& argument, Location at) {
    const Declaration& input = function_.elements[static_cast<size_t>(k)];
    const ResolvedType type = resolve_type(e_, input.type, input.type_at);
    if (type.kind == Kind::function && argument.kind != Kind::function)
      e_.fail(at, what(k) + " is a function but gets " + shown_type(argument));
    Value converted =
        type.kind == Kind::function ? argument : convert(e_, argument, type.kind, type.definition, what(k), at);
    state_[k] = std::make_shared<Value>(std::move(converted));
    stages_[static_cast<size_t>(k)] = 2;
  }

  // Call after all inputs are known.
  void check_input_sizes(Location at) {
    for (size_t k = 0; k < function_.elements.size(); ++k) {
      if (function_.elements[k].direction != Direction::input) continue;
      const std::vector<int> wanted = dims_of(static_cast<int>(k));
      const std::vector<int> dims = value(static_cast<int>(k), at)->dims;
      for (size_t d = 0; d < dims.size() && d < wanted.size(); ++d)
        if (wanted[d] >= 0 && wanted[d] != dims[d])
          e_.fail(at, what(static_cast<int>(k)) + " has the size " + shown_dims(wanted) + " but gets " +
                          shown_dims(dims));
    }
  }

  void assign(const Environment& in, const syntax::Expression& left, const Value& value,
              const Expression& active) override {
    const syntax::Expression& name = name_of(e_, left);
    const int k = number_of(name.text);
    if (k < 0)
      e_.fail(name.at, "'" + plain(name.text) + "' is not declared in the function '" + plain(function_.name) + "'");
    if (function_.elements[static_cast<size_t>(k)].direction == Direction::input)
      e_.fail(name.at, "'" + plain(name.text) + "' is an input of the function; assign to a local variable");
    const std::shared_ptr<Value> old = this->value(k, left.at);
    if (&name == &left) {
      const std::vector<int> wanted = dims_of(k);
      bool fits = wanted.size() == value.dims.size();
      for (size_t d = 0; fits && d < wanted.size(); ++d) fits = wanted[d] < 0 || wanted[d] == value.dims[d];
      if (!fits)
        e_.fail(left.at, "'" + plain(name.text) + "' is " + shown_type(*old) + " but gets " + shown_type(value) +
                             "; make the sizes agree");
      Value converted = convert(e_, value, old->kind, old->definition, "'" + plain(name.text) + "'", left.at);
      if (!is_number(active)) converted = choose(e_, active, converted, *old, left.at);
      state_[k] = std::make_shared<Value>(std::move(converted));
      return;
    }
    std::shared_ptr<Value>& slot = state_[k];
    if (slot.use_count() > 2) slot = std::make_shared<Value>(*old);  // slot and old
    e_.charge(slot == old ? 0 : static_cast<long>(slot->size()), left.at);
    assign_part(e_, in, *slot, left, value, active);
  }

  std::shared_ptr<Value> initial_value(int) override { return nullptr; }

  bool act(const Environment&, const syntax::Expression&) override { return false; }

  void when(const Environment&, const syntax::Statement& statement) override {
    e_.fail(statement.at, "'when' in a function; functions have no events");
  }

 private:
  std::string what(int k) const {
    return "'" + plain(function_.elements[static_cast<size_t>(k)].name) + "' of the function '" +
           plain(function_.name) + "'";
  }

  int number_of(const std::string& name) const {
    for (size_t k = 0; k < function_.elements.size(); ++k)
      if (function_.elements[k].name == name) return static_cast<int>(k);
    return -1;
  }

  // -1: any size.
  std::vector<int> dims_of(int k) {
    const Declaration& one = function_.elements[static_cast<size_t>(k)];
    const ResolvedType type = resolve_type(e_, one.type, one.type_at);
    std::vector<const syntax::Expression*> dimensions;
    for (const syntax::ExpressionPointer& dimension : one.dimensions) dimensions.push_back(dimension.get());
    dimensions.insert(dimensions.end(), type.dimensions.begin(), type.dimensions.end());
    return evaluate_dims(e_, in_, dimensions);
  }

  std::shared_ptr<Value> initialize(int k, Location at) {
    const Declaration& one = function_.elements[static_cast<size_t>(k)];
    int& stage = stages_[static_cast<size_t>(k)];
    if (stage == 1) e_.fail(one.at, what(k) + " depends on itself; end the circle");
    if (one.direction == Direction::input && one.binding == nullptr) e_.fail(at, what(k) + " is not given");
    stage = 1;
    const ResolvedType type = resolve_type(e_, one.type, one.type_at);
    std::vector<int> dims = dims_of(k);
    Value result;
    if (one.binding != nullptr) {
      const Value binding = evaluate(e_, in_, *one.binding);
      bool fits = binding.dims.size() == dims.size();
      for (size_t d = 0; fits && d < dims.size(); ++d) fits = dims[d] < 0 || dims[d] == binding.dims[d];
      if (!fits) e_.fail(one.binding->at, what(k) + " gets " + shown_type(binding) + ", a value of another size");
      result = convert(e_, binding, type.kind, type.definition, what(k), one.binding->at);
    } else {
      if (type.kind == Kind::function) e_.fail(one.at, what(k) + " is a function or an external object");
      result = unassigned(e_, type, std::move(dims), 0, one.at);
    }
    stage = 2;
    return std::make_shared<Value>(std::move(result));
  }

  Elaboration& e_;
  const Definition& function_;
  Environment in_;
  std::vector<int> stages_;  // 0: not initialized, 1: being initialized, 2: done
};

// The argument for each element of the function; null: not given.
std::vector<const Argument*> match(const Elaboration& e, const Definition& function,
                                   const std::vector<Argument>& arguments, Location at) {
  std::vector<const Argument*> result(function.elements.size(), nullptr);
  size_t position = 0;
  for (const Argument& argument : arguments) {
    size_t k = 0;
    if (argument.name.empty()) {
      while (position < result.size() && function.elements[position].direction != Direction::input) ++position;
      k = position++;
    } else {
      while (k < result.size() && !(function.elements[k].direction == Direction::input &&
                                    plain(function.elements[k].name) == plain(argument.name)))
        ++k;
    }
    if (k >= result.size())
      e.fail(argument.at,
             argument.name.empty()
                 ? "more arguments than the function '" + plain(function.name) + "' has inputs"
                 : "the function '" + plain(function.name) + "' has no input '" + plain(argument.name) + "'");
    if (result[k] != nullptr)
      e.fail(argument.at, "the input '" + plain(function.elements[k].name) + "' is given twice");
    result[k] = &argument;
  }
  (void)at;
  return result;
}

// Computes an external function of the C library or of the language.
void run_external(Elaboration& e, const Environment& in, const Definition& function, FunctionStore& store) {
  const syntax::External& external = *function.external;
  const std::string name = external.name.empty() ? plain(function.name) : plain(external.name);
  Call call{name, {}, external.at};
  Environment inside = in;
  inside.scope = &store;
  int output = -1;
  for (size_t k = 0; k < function.elements.size(); ++k)
    if (function.elements[k].direction == Direction::output) output = static_cast<int>(k);
  if (name == "ModelicaError") {
    Assertion assertion;
    assertion.condition = e.pool.truth(false, external.at);
    assertion.message = "an error that the model reports";
    if (external.arguments.size() == 1) {
      const Value text = evaluate(e, inside, *external.arguments[0]);
      if (text.kind == Kind::string) assertion.message = text.texts[0].text;
    }
    assertion.at = external.at;
    return add_assertion(e, inside, std::move(assertion));
  }
  if (output < 0 && only_shows_text(name)) return e.warn(external.at, "'" + name + "' is ignored");
  if (external.name.empty()) {
    for (size_t k = 0; k < function.elements.size(); ++k)
      if (function.elements[k].direction == Direction::input)
        call.arguments.push_back({"", *store.value(static_cast<int>(k), external.at), external.at});
  } else {
    for (const syntax::ExpressionPointer& argument : external.arguments)
      call.arguments.push_back({"", evaluate(e, inside, *argument), argument->at});
  }
  std::optional<Value> result = call_table_function(e, inside, call);
  if (!result) result = call_string_function(e, call);
  if (const std::optional<std::string> known = built_in_of_external(name); known && !result) {
    call.name = *known;
    result = call_mathematics(e, inside, call);
  }
  if (!result || output < 0)
    e.fail(external.at, "the external function '" + name + "' is not supported; replace '" + plain(function.name) +
                            "' by a formula");
  syntax::Expression left;
  left.form = syntax::Form::name;
  left.text = function.elements[static_cast<size_t>(output)].name;
  left.at = external.at;
  store.assign(inside, left, *result, e.pool.truth(true));
}

// Appends the value to the key of a call, its function and arguments. Strings and functions make the key unusable.
void append_key(const Value& value, std::vector<const void*>& key, bool& is_known) {
  if (value.kind == Kind::string || value.kind == Kind::function) is_known = false;
  key.push_back(value.definition);
  key.push_back(std::bit_cast<const void*>(static_cast<std::uintptr_t>(value.dims.size())));
  for (const int n : value.dims) key.push_back(std::bit_cast<const void*>(static_cast<std::uintptr_t>(n)));
  for (const Expression& x : value.scalars) key.push_back(x.get());
  for (const RecordValue& record : value.records)
    for (const auto& [name, field] : record.fields) append_key(field, key, is_known);
}

FunctionMemory::Result expand(Elaboration& e, const Definition& function, FunctionStore& store,
                              const Environment& outer, Location at) {
  FunctionMemory::Result result;
  Environment in = outer;
  in.in_function = true;
  in.guard = nullptr;
  in.assertions = &result.assertions;
  if (std::count(e.functions->active.begin(), e.functions->active.end(), &function) >= Limits::kMaxRecursion)
    e.fail(at, "the function '" + plain(function.name) + "' calls itself more than " +
                   std::to_string(Limits::kMaxRecursion) + " times within each other");
  e.functions->active.push_back(&function);
  for (size_t k = 0; k < function.elements.size(); ++k)
    store.value(static_cast<int>(k), at);  // before the first statement
  if (function.external) {
    run_external(e, in, function, store);
  } else {
    Executor(e, store, in).run(function.body);
  }
  for (size_t k = 0; k < function.elements.size(); ++k)
    if (function.elements[k].direction == Direction::output)
      result.outputs.push_back(*store.value(static_cast<int>(k), at));
  e.functions->active.pop_back();
  return result;
}

std::vector<Value> call_once(Elaboration& e, const Environment& in, const Definition& function,
                             const std::vector<const Argument*>& arguments, Location at) {
  std::vector<Assertion> of_defaults;
  Environment inside = in;
  inside.in_function = true;
  inside.guard = nullptr;
  inside.assertions = &of_defaults;
  FunctionStore store(e, function, inside);
  std::vector<const void*> key{&function};
  bool is_known = true;
  for (size_t k = 0; k < arguments.size(); ++k)
    if (arguments[k] != nullptr) store.bind_input(static_cast<int>(k), arguments[k]->value, arguments[k]->at);
  store.check_input_sizes(at);
  for (size_t k = 0; k < arguments.size(); ++k)
    if (function.elements[k].direction == Direction::input)
      append_key(*store.value(static_cast<int>(k), at), key, is_known);
  const auto found = is_known ? e.functions->results.find(key) : e.functions->results.end();
  FunctionMemory::Result fresh;
  if (found == e.functions->results.end()) fresh = expand(e, function, store, inside, at);
  fresh.assertions.insert(fresh.assertions.end(), of_defaults.begin(), of_defaults.end());
  const FunctionMemory::Result& result = found == e.functions->results.end() ? fresh : found->second;
  for (const Assertion& assertion : result.assertions) add_assertion(e, in, assertion);
  std::vector<Value> outputs = result.outputs;
  if (is_known && found == e.functions->results.end()) e.functions->results.emplace(std::move(key), std::move(fresh));
  return outputs;
}

// True if each output has a value by its declaration: then no algorithm is needed.
bool binds_outputs(const Definition& function) {
  int outputs = 0, bound = 0;
  for (const Declaration& element : function.elements) {
    if (element.direction != Direction::output) continue;
    ++outputs;
    bound += element.binding != nullptr ? 1 : 0;
  }
  return outputs > 0 && bound == outputs;
}

// The number of dimensions that an argument has in addition to those of its input.
size_t extra_dims(const Elaboration& e, const Declaration& input, const Value& argument) {
  const size_t wanted = input.dimensions.size() + resolve_type(e, input.type, input.type_at).dimensions.size();
  return argument.dims.size() > wanted ? argument.dims.size() - wanted : 0;
}

}  // namespace

std::vector<Value> call_function(Elaboration& e, const Environment& in, const Definition& function,
                                 const std::vector<Argument>& arguments, Location at) {
  const std::string name = "'" + plain(function.name) + "'";
  if (function.is_partial || (!function.has_body && !function.external && !binds_outputs(function)))
    e.fail(at, "the function " + name + " has no algorithm; export with --frontendInline");
  const std::vector<const Argument*> matched = match(e, function, arguments, at);
  std::vector<int> outer;
  for (size_t k = 0; k < matched.size(); ++k) {
    if (matched[k] == nullptr) continue;
    const std::vector<int>& dims = matched[k]->value.dims;
    const size_t extra = extra_dims(e, function.elements[k], matched[k]->value);
    if (dims.size() < function.elements[k].dimensions.size())
      e.fail(matched[k]->at, "'" + plain(function.elements[k].name) + "' of the function " + name + " gets " +
                                 shown_type(matched[k]->value) + ", which has too few dimensions");
    if (extra == 0) continue;
    const std::vector<int> leading(dims.begin(), dims.begin() + static_cast<std::ptrdiff_t>(extra));
    if (!outer.empty() && outer != leading) e.fail(at, "arguments of the function " + name + " differ in size");
    outer = leading;
  }
  if (outer.empty()) return call_once(e, in, function, matched, at);
  std::vector<std::vector<Value>> results;
  for (size_t i = 0; i < product(outer); ++i) {
    std::vector<Argument> parts;
    parts.reserve(matched.size());
    std::vector<const Argument*> here = matched;
    for (size_t k = 0; k < matched.size(); ++k) {
      if (matched[k] == nullptr || extra_dims(e, function.elements[k], matched[k]->value) == 0) continue;
      const Value& whole = matched[k]->value;
      Value part =
          empty_like(whole, {whole.dims.begin() + static_cast<std::ptrdiff_t>(outer.size()), whole.dims.end()});
      const size_t count = product(part.dims);
      for (size_t j = 0; j < count; ++j) append_elements(part, element(whole, i * count + j));
      parts.push_back({"", std::move(part), matched[k]->at});
      here[k] = &parts.back();
    }
    results.push_back(call_once(e, in, function, here, at));
  }
  if (results.empty()) e.fail(at, "a call of the function " + name + " for an array without elements");
  Value result;
  std::vector<Value> firsts;
  for (const std::vector<Value>& one : results) firsts.push_back(one.at(0));
  result = array_of(e, firsts, at);
  result.dims.erase(result.dims.begin());
  result.dims.insert(result.dims.begin(), outer.begin(), outer.end());
  return {result};
}

}  // namespace sfdae::cli
