// The parsed file: names are not resolved, nothing is expanded.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/expression.h"

namespace sfdae::cli::syntax {

enum class Operator {
  add,
  subtract,
  multiply,
  divide,
  power,
  element_add,
  element_subtract,
  element_multiply,
  element_divide,
  element_power,
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  not_equal,
  and_,
  or_,
  not_,
  plus,
  negate
};

enum class Form {
  number,         // is_integer tells 1 from 1.0
  text,           // a string
  truth,          // number is 1 or 0
  name,           // text
  member,         // operands[0] . text
  subscripted,    // operands[0] [ the others ]
  call,           // text ( operands ), names of named arguments
  comprehension,  // text ( operands[0] for names[k] in operands[1 + k] ); no text: { }
  chain,          // operands[0] operators[0] operands[1] operators[1] ..., from the left
  unary,          // operators[0] operands[0]
  choose,         // condition, value, condition, value, ..., value
  list,           // { operands }
  matrix,         // [ rows ], each a list
  range,          // first : last or first : step : last
  tuple,          // ( operands ), at least two or none; null for an omitted one
  end,            // the last index
  all             // : as a subscript or dimension
};

struct Expression;
using ExpressionPointer = std::unique_ptr<Expression>;

struct Expression {
  Form form = Form::number;
  Location at;
  bool is_integer = false;
  double number = 0.0;
  std::string text;
  std::vector<ExpressionPointer> operands;
  std::vector<std::string> names;
  std::vector<Operator> operators;
};

// name(nested) = value
struct Modification {
  std::string name;
  std::vector<Modification> nested;
  ExpressionPointer value;
  Location at;
};

enum class Prefix { none, discrete, parameter, constant };
enum class Direction { none, input, output };

struct Declaration {
  Prefix prefix = Prefix::none;
  Direction direction = Direction::none;
  std::string type;                           // dotted
  std::vector<ExpressionPointer> dimensions;  // after the name, then those after the type
  std::string name, comment;
  std::vector<Modification> modifications;
  ExpressionPointer binding;
  Location at, type_at;
};

// Equations and statements.
enum class StatementForm { equation, assignment, call, if_, for_, when, while_, break_, return_ };

struct Statement;

// A branch of if or when; the body of for or while.
struct Branch {
  ExpressionPointer condition;  // none: else; the range of a for loop
  std::vector<Statement> body;
};

struct Statement {
  StatementForm action = StatementForm::equation;
  Location at;
  ExpressionPointer left, right;  // of an equation or assignment; only left: a call
  std::string iterator;           // for a for loop
  std::vector<Branch> branches;
};

struct Section {
  bool is_initial = false, is_algorithm = false;
  std::vector<Statement> body;
};

// external "language" left = name(arguments)
struct External {
  std::string language, name;
  ExpressionPointer left;
  std::vector<ExpressionPointer> arguments;
  Location at;
};

struct Literal {
  std::string name, comment;
};

enum class DefinitionKind { alias, enumeration, record, function, external_object };

struct Definition {
  DefinitionKind kind = DefinitionKind::alias;
  std::string name;
  Location at;
  Declaration alias;                  // type name = alias.type[dimensions](modifications)
  std::vector<Literal> literals;      // for an enumeration
  std::vector<Declaration> elements;  // for a record or function
  std::vector<Statement> body;        // for a function
  bool has_body = false, is_partial = false, is_impure = false;
  std::optional<External> external;
};

// parameter equation guess(variable) = value
struct Guess {
  ExpressionPointer variable, value;
  Location at;
};

struct Model {
  std::string name, comment;
  Location at;
  std::vector<Declaration> elements;
  std::vector<Guess> guesses;
  std::vector<Section> sections;
  std::vector<Modification> annotation;
};

struct Warning {
  Location at;
  std::string text;
};

struct File {
  std::vector<Definition> definitions;
  std::vector<Declaration> constants;
  Model model;
  std::vector<Warning> warnings;
};

}  // namespace sfdae::cli::syntax
