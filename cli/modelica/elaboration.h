// Data shared by all parts of the expansion of a model: its tree, the model under construction, names and limits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "model/flat_model.h"
#include "modelica/expression_pool.h"
#include "modelica/syntax_tree.h"
#include "modelica/value.h"

namespace sfdae::cli {

class Symbols;
struct FunctionMemory;

// The types, records, enumerations and functions of a package, and the predefined ones.
class Definitions {
 public:
  explicit Definitions(const syntax::File& tree);
  // None if there is none of that name. Quotes may be missing, as in older exports.
  const syntax::Definition* find(const std::string& name) const;
  // The same for one kind.
  const syntax::Definition* find(const std::string& name, syntax::DefinitionKind kind) const;
  const syntax::Definition& state_select() const { return *find("StateSelect"); }
  const syntax::Definition& assertion_level() const { return *find("AssertionLevel"); }

 private:
  std::vector<syntax::Definition> built_in_;
  std::unordered_map<std::string, const syntax::Definition*> by_name_;
};

// Scope for the lookup of names: variables of a function, the model, iterators of loops.
class Scope {
 public:
  virtual ~Scope() = default;
  // None: the name is unknown here.
  virtual ValuePointer find(const std::string& name, Location at) = 0;
  // The same scope before assignments by algorithms, for the operands of der and pre.
  virtual Scope& declared() { return *this; }
};

// One more name before those of another scope.
class IteratorScope : public Scope {
 public:
  IteratorScope(Scope& outer, std::string name, Value value)
      : outer_(outer), name_(std::move(name)), value_(std::make_shared<Value>(std::move(value))) {}
  ValuePointer find(const std::string& name, Location at) override {
    return name == name_ ? value_ : outer_.find(name, at);
  }
  Scope& declared() override {
    Scope& outer = outer_.declared();
    if (&outer == &outer_) return *this;
    if (declared_ == nullptr) declared_ = std::make_unique<IteratorScope>(outer, name_, *value_);
    return *declared_;
  }

 private:
  Scope& outer_;
  std::string name_;
  ValuePointer value_;
  std::unique_ptr<IteratorScope> declared_;
};

// A condition of the code being expanded, which applies only while this condition and the outer ones hold.
struct Guard {
  const Guard* outer = nullptr;
  Expression condition;
  bool is_negated = false;
};

// The circumstances in which an expression is expanded.
struct Environment {
  Scope* scope = nullptr;
  bool in_function = false;                      // relations generate no events
  const Guard* guard = nullptr;                  // none: always
  std::vector<Assertion>* assertions = nullptr;  // receives assertions of called functions
  const Value* indexed = nullptr;                // the array of `end`, its size in that dimension
  int indexed_dimension = 0;
};

// Limits that keep files, including malicious ones, from using unbounded time or memory.
struct Limits {
  static constexpr long kMaxSteps = 3'000'000;     // expressions expanded: a few seconds
  static constexpr long kMaxElements = 1'000'000;  // of an array
  static constexpr int kMaxVariables = 300'000;    // scalar ones
  static constexpr int kMaxDepth = 400;            // expressions within expressions, those of functions included
  static constexpr int kMaxRounds = 50;            // for a while loop whose end depends on variables
  static constexpr int kMaxRecursion = 50;         // calls of a function within itself
  long steps = 0;
  int depth = 0;
};

struct Elaboration {
  Elaboration(const syntax::File& file, FlatModel& flat);

  const syntax::File& tree;
  FlatModel& model;
  ExpressionPool pool;
  Definitions definitions;
  Symbols* symbols = nullptr;
  FunctionMemory* functions = nullptr;
  Limits limits;
  // Comparisons of Reals by == outside functions: allowed if they do not vary continuously.
  std::vector<Expression> real_equalities;
  std::vector<Location> real_equality_locations;

  [[noreturn]] void fail(Location at, const std::string& text) const;
  void warn(Location at, const std::string& text);
  void charge(long steps, Location at);
};

// A type with its aliases resolved.
struct ResolvedType {
  Kind kind = Kind::real;
  const syntax::Definition* definition = nullptr;                       // for records, enumerations, functions
  std::vector<const syntax::Expression*> dimensions;                    // from the aliases
  std::vector<const std::vector<syntax::Modification>*> modifications;  // the innermost first
};
ResolvedType resolve_type(const Elaboration& e, const std::string& name, Location at);

Value evaluate(Elaboration& e, const Environment& in, const syntax::Expression& expression);
// All results of a call; a single value for other expressions.
std::vector<Value> evaluate_outputs(Elaboration& e, const Environment& in, const syntax::Expression& expression);
std::vector<Value> evaluate_call(Elaboration& e, const Environment& in, const syntax::Expression& call);
// what: description of the expression, for messages.
Expression evaluate_condition(Elaboration& e, const Environment& in, const syntax::Expression& expression,
                              const std::string& what);
// An integer of constants and parameters, whose values become part of the structure.
int evaluate_integer(Elaboration& e, const Environment& in, const syntax::Expression& expression,
                     const std::string& what);
std::optional<double> constant_value(Elaboration& e, const Expression& expression);
// Conjunction of all guards; the number 1 if there are none.
Expression guard_condition(Elaboration& e, const Guard* guard, Location at);
void add_assertion(Elaboration& e, const Environment& in, Assertion assertion);
// The elements over which a for loop or comprehension runs.
Value evaluate_range(Elaboration& e, const Environment& in, const syntax::Expression& expression);
// array[subscripts]
Value select(Elaboration& e, const Environment& in, const Value& array, const syntax::Expression& subscripted);
Value member_of(const Elaboration& e, const Value& record, const std::string& name, Location at);
std::vector<int> evaluate_dims(Elaboration& e, const Environment& in,
                               const std::vector<const syntax::Expression*>& dimensions);
void check_dims(const Elaboration& e, const std::vector<int>& dims, Location at);

}  // namespace sfdae::cli
