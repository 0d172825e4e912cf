// The variables of a model by name: declared, given attributes and bound when they are first needed, so that the order
// in the file does not matter.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "modelica/elaboration.h"
#include "modelica/name_tree.h"

namespace sfdae::cli {

class Symbols : public Scope {
 public:
  explicit Symbols(Elaboration& e);
  ~Symbols() override;

  // Declares all variables with their attributes, then binds them; bindings of variables become equations.
  void declare_all();
  void bind_all();

  ValuePointer find(const std::string& name, Location at) override;
  // The scope of functions: constants of the package.
  Scope& package();

  // The first and second derivative of a variable.
  Expression derivative_of_variable(int index, Location at);
  Expression second_derivative(int index, Location at);

  // The number given by constants and parameters; none if something varies or is computed from initial equations. The
  // parameters used become structural.
  std::optional<double> value_of(const Expression& expression, Location at);
  // Fails if the definitions of parameters are cyclic.
  void check_parameters();

  int add_variable(Variable variable);
  Expression variable_node(int index, Location at);
  const syntax::Declaration* declaration(const std::string& name) const;

 private:
  enum class Stage { none, running, done };
  struct Symbol;
  // Scalars of one declaration in one record: index offset in the enclosing array of records.
  struct Leaf;
  struct Binding;
  struct Instance;

  class PackageScope;

  Symbol* symbol(const std::string& name);
  void declare(Symbol& one);
  void give_attributes(Symbol& one);
  void bind(Symbol& one);
  void bind(Symbol& one, const Binding& binding);
  Value instantiate(Symbol& one, const Instance& instance);
  Value instantiate_scalars(Symbol& one, const Instance& instance, const ResolvedType& type,
                            const std::vector<int>& dims);
  Value instantiate_records(Symbol& one, const Instance& instance, const ResolvedType& type,
                            const std::vector<int>& dims);
  void apply(const Leaf& leaf, const syntax::Modification& modification, const Environment& in);
  void assign(Symbol& one, Value& target, const Value& value, Location at);
  void assign_scalar(Symbol& one, Expression& target, const Expression& value, Location at);
  double value_of_parameter(int index, Location at);
  void settle_constants(Symbol& one);

  Elaboration& e_;
  std::vector<std::unique_ptr<Symbol>> symbols_;
  std::unordered_map<std::string, Symbol*> by_name_;
  std::unordered_map<std::string, int> variable_names_;
  std::vector<Symbol*> symbol_of_variable_;
  std::unordered_map<int, int> derivative_variables_;  // by variable: the one that equals its derivative
  std::unordered_map<const Node*, std::optional<double>> values_;
  std::vector<Stage> parameter_stages_;
  std::unique_ptr<PackageScope> package_;
  NameTree tree_;
};

}  // namespace sfdae::cli
