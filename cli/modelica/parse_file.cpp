// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <initializer_list>
#include <string>
#include <utility>

#include "modelica/parser.h"

namespace sfdae::cli {

using syntax::Declaration;
using syntax::Definition;
using syntax::DefinitionKind;
using syntax::File;
using syntax::Model;
using syntax::Modification;
using syntax::Prefix;

namespace {

constexpr const char* kNotFlat = " is not flat; export with omc --baseModelica";

void reject_what_is_not_flat(const TokenStream& tokens) {
  for (const std::string_view word : {"flow", "stream", "extends"})
    if (tokens.at(word)) tokens.fail(tokens.location(), "'" + std::string(word) + "'" + kNotFlat);
  if (!tokens.at_identifier()) return;
  for (const std::string_view word : {"import", "inner", "outer", "replaceable", "redeclare", "constrainedby",
                                      "encapsulated", "expandable", "connector", "block"})
    if (tokens.peek().text == word) tokens.fail(tokens.location(), "'" + std::string(word) + "'" + kNotFlat);
}

void parse_end(TokenStream& tokens, const std::string& name) {
  tokens.expect("end", "of '" + plain(name) + "'");
  const Token end = tokens.expect_identifier("after 'end'");
  if (end.text != name)
    tokens.fail(end.at, "'end " + plain(end.text) + "' closes '" + plain(name) + "'; the names have to agree");
}

Declaration parse_prefixes(TokenStream& tokens) {
  Declaration result;
  for (;; tokens.take()) {
    reject_what_is_not_flat(tokens);
    if (tokens.at("final")) continue;
    if (tokens.at("discrete")) result.prefix = Prefix::discrete;
    else if (tokens.at("parameter")) result.prefix = Prefix::parameter;
    else if (tokens.at("constant")) result.prefix = Prefix::constant;
    else if (tokens.at("input")) result.direction = syntax::Direction::input;
    else if (tokens.at("output")) result.direction = syntax::Direction::output;
    else return result;
  }
}

// One name of an element; the dimensions of the type remain in the element for the following names.
void parse_declarator(TokenStream& tokens, Declaration& result) {
  const Token name = tokens.expect_identifier("in a declaration");
  result.name = name.text;
  result.at = name.at;
  if (tokens.at("[")) result.dimensions = parse_subscripts(tokens);
  if (tokens.at("(")) result.modifications = parse_modifications(tokens);
  if (tokens.accept("=") || tokens.accept(":=")) result.binding = parse_expression(tokens);
  if (tokens.at("if"))
    tokens.fail(tokens.location(), "a conditional declaration of '" + plain(name.text) + "'" + kNotFlat);
  result.comment = parse_comment(tokens);
}

syntax::ExpressionPointer copy(const syntax::Expression& from) {
  auto result = std::make_unique<syntax::Expression>();
  result->form = from.form;
  result->at = from.at;
  result->is_integer = from.is_integer;
  result->number = from.number;
  result->text = from.text;
  result->names = from.names;
  result->operators = from.operators;
  for (const syntax::ExpressionPointer& operand : from.operands)
    result->operands.push_back(operand ? copy(*operand) : nullptr);
  return result;
}

}  // namespace

void parse_element(TokenStream& tokens, std::vector<Declaration>& declarations) {
  const Declaration prefixes = parse_prefixes(tokens);
  const Location type_at = tokens.location();
  const std::string type = parse_dotted_name(tokens, "as the type of a declaration");
  std::vector<syntax::ExpressionPointer> type_dimensions;
  if (tokens.at("[")) type_dimensions = parse_subscripts(tokens);
  do {
    Declaration one;
    one.prefix = prefixes.prefix;
    one.direction = prefixes.direction;
    one.type = type;
    one.type_at = type_at;
    parse_declarator(tokens, one);
    for (const syntax::ExpressionPointer& dimension : type_dimensions) one.dimensions.push_back(copy(*dimension));
    declarations.push_back(std::move(one));
  } while (tokens.accept(","));
}

std::vector<Modification> parse_modifications(TokenStream& tokens) {
  const TokenStream::Nesting nesting(tokens);
  std::vector<Modification> result;
  tokens.expect("(", "before modifications");
  if (tokens.accept(")")) return result;
  do {
    Modification one;
    while (tokens.accept("each") || tokens.accept("final")) {
    }
    reject_what_is_not_flat(tokens);
    one.at = tokens.location();
    one.name = parse_dotted_name(tokens, "of an attribute");
    if (tokens.at("(")) one.nested = parse_modifications(tokens);
    if (tokens.accept("=") || tokens.accept(":=")) one.value = parse_expression(tokens);
    parse_comment(tokens);
    result.push_back(std::move(one));
  } while (tokens.accept(","));
  tokens.expect(")", "after modifications");
  return result;
}

namespace {

void parse_external(TokenStream& tokens, Definition& function) {
  syntax::External result;
  result.at = tokens.expect("external", "in a function");
  result.language = tokens.peek().kind == TokenKind::text ? tokens.take().text : "C";
  if (tokens.at_identifier()) {
    syntax::ExpressionPointer first = parse_expression(tokens);
    if (tokens.accept("=")) {
      result.left = std::move(first);
      first = parse_expression(tokens);
    }
    if (first->form != syntax::Form::call) tokens.fail(first->at, "expected the call of an external function");
    result.name = first->text;
    result.arguments = std::move(first->operands);
  }
  parse_comment(tokens);
  tokens.expect(";", "after 'external'");
  function.external = std::move(result);
}

void parse_function(TokenStream& tokens, Definition& result) {
  while (!tokens.at("end")) {
    if (tokens.accept("public") || tokens.accept("protected") || tokens.accept(";")) continue;
    if (tokens.accept("algorithm")) {
      result.has_body = true;
      for (syntax::Statement& statement : parse_statements(tokens, true)) result.body.push_back(std::move(statement));
    } else if (tokens.at("external")) {
      parse_external(tokens, result);
    } else if (tokens.at("annotation")) {
      parse_comment(tokens);
      tokens.expect(";", "after an annotation");
    } else {
      parse_element(tokens, result.elements);
      tokens.expect(";", "after a declaration");
    }
  }
}

// class 'X' extends ExternalObject; function constructor ... end constructor; ... end 'X'. The inputs of the
// constructor become its elements.
void parse_external_object(TokenStream& tokens, Definition& result) {
  tokens.expect("extends", "in a class, which can only be an external object here");
  const Token base = tokens.expect_identifier("after 'extends'");
  if (base.text != "ExternalObject") tokens.fail(base.at, std::string("a class") + kNotFlat);
  parse_comment(tokens);
  tokens.expect(";", "after 'ExternalObject'");
  while (!tokens.at("end")) {
    Definition function = parse_definition(tokens);
    if (plain(function.name) == "constructor") result.elements = std::move(function.elements);
    tokens.expect(";", "after a definition");
  }
}

void parse_type(TokenStream& tokens, Definition& result) {
  tokens.expect("=", "in a type definition");
  result.alias.at = result.alias.type_at = tokens.location();
  if (tokens.at("enumeration") && tokens.at("(", 1)) {
    result.kind = DefinitionKind::enumeration;
    tokens.take(), tokens.take();
    do {
      const std::string name = tokens.expect_identifier("as a literal of an enumeration").text;
      result.literals.push_back({name, parse_comment(tokens)});
    } while (tokens.accept(","));
    tokens.expect(")", "after the literals of an enumeration");
  } else {
    result.alias.type = parse_dotted_name(tokens, "of a type");
    if (tokens.at("[")) result.alias.dimensions = parse_subscripts(tokens);
    if (tokens.at("(")) result.alias.modifications = parse_modifications(tokens);
  }
  parse_comment(tokens);
}

}  // namespace

bool at_definition(const TokenStream& tokens) {
  for (const std::string_view word : {"type", "record", "function", "pure", "impure", "partial", "operator", "class"})
    if (tokens.at(word)) return true;
  return false;
}

syntax::Definition parse_definition(TokenStream& tokens) {
  const TokenStream::Nesting nesting(tokens);
  Definition result;
  while (tokens.at("pure") || tokens.at("impure") || tokens.at("partial") || tokens.at("operator")) {
    const std::string word = tokens.take().text;
    if (word == "impure") result.is_impure = true;
    if (word == "partial") result.is_partial = true;
    if (word == "pure") tokens.accept("constant");
  }
  const Token word = tokens.take();
  const Token name = tokens.expect_identifier("of a definition");
  result.name = name.text;
  result.at = name.at;
  if (word.is("type")) {
    parse_type(tokens, result);
    return result;
  }
  parse_comment(tokens);
  if (word.is("record")) {
    result.kind = DefinitionKind::record;
    while (!tokens.at("end")) {
      if (tokens.accept("public") || tokens.accept("protected") || tokens.accept(";")) continue;
      if (tokens.at("annotation")) parse_comment(tokens);
      else parse_element(tokens, result.elements);
      tokens.expect(";", "after a declaration");
    }
  } else if (word.is("function")) {
    result.kind = DefinitionKind::function;
    parse_function(tokens, result);
  } else if (word.is("class")) {
    result.kind = DefinitionKind::external_object;
    parse_external_object(tokens, result);
  } else {
    tokens.fail(word.at,
                "expected a definition (type, record, function, constant or model), found '" + word.text + "'");
  }
  parse_end(tokens, result.name);
  return result;
}

namespace {

// annotation(..., experiment(...), ...) of the model: reads the contents of experiment.
void parse_model_annotation(TokenStream& tokens, Model& model) {
  tokens.expect("annotation", "in a model");
  const Location begin = tokens.expect("(", "after 'annotation'");
  int depth = 1;
  while (depth > 0) {
    const Token& token = tokens.peek();
    if (token.kind == TokenKind::end) tokens.fail(begin, "this '(' is not closed; add ')'");
    if (token.kind == TokenKind::invalid) tokens.fail_here("", "");
    if (depth == 1 && token.kind == TokenKind::identifier && token.text == "experiment" && tokens.at("(", 1)) {
      tokens.take();
      for (Modification& one : parse_modifications(tokens)) model.annotation.push_back(std::move(one));
      continue;
    }
    if (token.is("(") || token.is("{") || token.is("[")) ++depth;
    if (token.is(")") || token.is("}") || token.is("]")) --depth;
    tokens.take();
  }
}

// parameter equation guess('x') = 1.5
void parse_guess(TokenStream& tokens, Model& model) {
  syntax::Guess result;
  tokens.take(), tokens.take();
  result.at = tokens.location();
  syntax::ExpressionPointer left = parse_expression(tokens);
  if (left->form != syntax::Form::call || left->text != "guess" || left->operands.size() != 1)
    tokens.fail(result.at, "expected guess('x') = value after 'parameter equation'");
  result.variable = std::move(left->operands[0]);
  tokens.expect("=", "after guess(...)");
  result.value = parse_expression(tokens);
  parse_comment(tokens);
  model.guesses.push_back(std::move(result));
}

void parse_section(TokenStream& tokens, Model& model) {
  syntax::Section section;
  section.is_initial = tokens.accept("initial");
  if (tokens.at("algorithm")) section.is_algorithm = true;
  else if (!tokens.at("equation")) tokens.fail_here("'equation' or 'algorithm'", "after 'initial'");
  tokens.take();
  section.body = parse_statements(tokens, section.is_algorithm);
  model.sections.push_back(std::move(section));
}

void parse_model(TokenStream& tokens, Model& model) {
  tokens.take();
  const Token name = tokens.expect_identifier("of the model");
  model.name = name.text;
  model.at = name.at;
  model.comment = parse_comment(tokens);
  while (!tokens.at("end")) {
    if (tokens.accept("public") || tokens.accept("protected") || tokens.accept(";")) continue;
    if (tokens.at("partition") || tokens.at("subpartition"))
      tokens.fail(tokens.location(),
                  "clocked partitions are not supported; replace them by when sample(...) clauses");
    if (tokens.at("external")) tokens.fail(tokens.location(), "'external' in a model; it belongs into functions");
    if (tokens.at("equation") || tokens.at("algorithm") || tokens.at("initial")) {
      parse_section(tokens, model);
      continue;
    }
    if (tokens.at("annotation")) parse_model_annotation(tokens, model);
    else if (tokens.at("parameter") && tokens.at("equation", 1)) parse_guess(tokens, model);
    else parse_element(tokens, model.elements);
    tokens.expect(";", "after a declaration");
  }
  parse_end(tokens, model.name);
}

// class 'X' "comment" extends ExternalObject
bool at_external_object(const TokenStream& tokens) {
  return tokens.at("extends", tokens.peek(2).kind == TokenKind::text ? 3 : 2);
}

void parse_package(TokenStream& tokens, File& result) {
  bool has_model = false;
  while (!tokens.at("end")) {
    if (tokens.accept(";")) continue;
    const Location at = tokens.location();
    if (tokens.at("model") || (tokens.at("class") && !at_external_object(tokens))) {
      if (has_model) tokens.fail(at, "a second model in the package; keep one");
      has_model = true;
      parse_model(tokens, result.model);
    } else if (at_definition(tokens)) {
      result.definitions.push_back(parse_definition(tokens));
    } else if (tokens.at("annotation")) {
      parse_comment(tokens);
    } else if (tokens.at("constant") || tokens.at("final") || tokens.at("parameter")) {
      parse_element(tokens, result.constants);
    } else {
      reject_what_is_not_flat(tokens);
      tokens.fail_here("a definition (type, record, function, constant or model)", "in the package");
    }
    tokens.expect(";", "after a definition");
  }
  if (!has_model) tokens.fail(tokens.location(), "the package has no model; add model ... end ...;");
}

// OpenModelica writes its messages after the model: "Notification: ...", "[file.mo:1:2] Warning: ...".
bool at_message_of_compiler(const TokenStream& tokens) {
  if (tokens.at("[")) return true;
  if (!tokens.at_identifier() || !tokens.at(":", 1)) return false;
  const std::string& word = tokens.peek().text;
  return word == "Notification" || word == "Warning" || word == "Error";
}

}  // namespace

File parse_file(const std::string& text, const std::string& file) {
  Tokens lexed = tokenize(text);
  const std::string version = lexed.version;
  TokenStream tokens(file, std::move(lexed));
  if (version.empty())
    tokens.warn({1, 1}, "the first line is not '//! base 0.1.0'; read as flat Modelica of that version");
  else if (version != "0.1.0" && version != "0.1r0")
    tokens.warn({1, 1}, "version " + version + " of flat Modelica is read as 0.1.0");
  File result;
  if (tokens.accept("package")) {
    const std::string name = tokens.expect_identifier("of the package").text;
    parse_comment(tokens);
    parse_package(tokens, result);
    parse_end(tokens, name);
  } else if (tokens.at("model") || tokens.at("class")) {
    tokens.warn(tokens.location(), "a model without a package around it");
    parse_model(tokens, result.model);
  } else {
    reject_what_is_not_flat(tokens);
    tokens.fail_here("'package'", "at the beginning");
  }
  if (!tokens.accept(";")) tokens.fail_here("';'", "after the last end");
  if (tokens.at("package") || tokens.at("model"))
    tokens.warn(tokens.location(), "another package after the first one is ignored; put each into its own file");
  else if (tokens.peek().kind != TokenKind::end && !at_message_of_compiler(tokens))
    tokens.fail_here("the end of the file", "after the last end");
  result.warnings = std::move(tokens.warnings());
  return result;
}

}  // namespace sfdae::cli
