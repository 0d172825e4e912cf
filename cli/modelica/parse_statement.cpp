// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <initializer_list>
#include <utility>

#include "modelica/parser.h"

namespace sfdae::cli {

using syntax::Branch;
using syntax::Form;
using syntax::Statement;
using syntax::StatementForm;

namespace {

bool ends_statements(const TokenStream& tokens) {
  for (const std::string_view word : {"end", "else", "elseif", "elsewhen", "equation", "algorithm", "annotation",
                                      "external", "public", "protected", "partition", "subpartition"})
    if (tokens.at(word)) return true;
  return tokens.at("initial") && !tokens.at("(", 1);
}

class StatementParser {
 public:
  StatementParser(TokenStream& tokens, bool is_algorithm) : in_(tokens), is_algorithm_(is_algorithm) {}

  std::vector<Statement> statements() {
    std::vector<Statement> result;
    while (!ends_statements(in_)) {
      if (in_.accept(";")) continue;
      result.push_back(statement());
      parse_comment(in_);
      in_.expect(";", is_algorithm_ ? "after a statement" : "after an equation");
    }
    return result;
  }

 private:
  Statement statement() {
    const TokenStream::Nesting nesting(in_);
    Statement result;
    result.at = in_.location();
    if (in_.at("if")) {
      branches(result, StatementForm::if_, "elseif");
    } else if (in_.at("when")) {
      branches(result, StatementForm::when, "elsewhen");
    } else if (in_.at("for")) {
      in_.take();
      loop(result);
      close("for");
    } else if (in_.at("while")) {
      while_loop(result);
    } else if (in_.at("break") || in_.at("return")) {
      result.action = in_.take().text == "break" ? StatementForm::break_ : StatementForm::return_;
      if (!is_algorithm_) in_.fail(result.at, "'break' and 'return' stand in algorithms only; remove it");
    } else {
      plain_statement(result);
    }
    return result;
  }

  void plain_statement(Statement& result) {
    if (in_.at_identifier() && in_.peek().text == "connect")
      in_.fail(result.at, "'connect' is not flat; export with omc --baseModelica");
    result.left = parse_expression(in_);
    const std::string_view sign = is_algorithm_ ? ":=" : "=";
    if (in_.accept(sign)) {
      result.action = is_algorithm_ ? StatementForm::assignment : StatementForm::equation;
      result.right = parse_expression(in_);
    } else if (in_.at("=") || in_.at(":=")) {
      in_.fail(in_.location(), is_algorithm_ ? "'=' in an algorithm; assignments are written with ':='"
                                             : "':=' in an equation section; equations are written with '='");
    } else if (result.left->form == Form::call) {
      result.action = StatementForm::call;
    } else {
      in_.fail_here("'" + std::string(sign) + "'", is_algorithm_ ? "in a statement" : "in an equation");
    }
  }

  void branches(Statement& result, StatementForm action, std::string_view next) {
    const std::string word = in_.take().text;  // if, when
    result.action = action;
    for (;;) {
      Branch branch;
      branch.condition = parse_expression(in_);
      in_.expect("then", "after a condition");
      branch.body = statements();
      // Older exports write `elseif true then` for `else`.
      const bool is_else = action == StatementForm::if_ && !result.branches.empty() &&
                           branch.condition->form == Form::truth && branch.condition->number == 1.0 && in_.at("end");
      if (is_else) branch.condition = nullptr;
      result.branches.push_back(std::move(branch));
      if (!in_.accept(next)) break;
    }
    if (action == StatementForm::if_ && in_.accept("else")) {
      Branch branch;
      branch.body = statements();
      result.branches.push_back(std::move(branch));
    }
    close(word);
  }

  // i in 1:3, j in 1:2 loop: nested loops.
  void loop(Statement& result) {
    const TokenStream::Nesting nesting(in_);
    result.action = StatementForm::for_;
    result.at = in_.location();
    result.iterator = in_.expect_identifier("after 'for'").text;
    Branch body;
    if (in_.accept("in")) {
      body.condition = parse_expression(in_);
    } else {
      in_.fail(result.at, "'for' without a range; write 'in' and a range after its iterator");
    }
    if (in_.accept(",")) {
      body.body.emplace_back();
      loop(body.body.back());
    } else {
      in_.expect("loop", "after the range of a for loop");
      body.body = statements();
    }
    result.branches.push_back(std::move(body));
  }

  void while_loop(Statement& result) {
    result.action = StatementForm::while_;
    in_.take();
    if (!is_algorithm_) in_.fail(result.at, "'while' stands in algorithms only; use 'for' in equations");
    Branch body;
    body.condition = parse_expression(in_);
    in_.expect("loop", "after the condition of a while loop");
    body.body = statements();
    result.branches.push_back(std::move(body));
    close("while");
  }

  void close(const std::string& word) {
    in_.expect("end", "to close '" + word + "'");
    in_.expect(word, "after 'end'");
  }

  TokenStream& in_;
  bool is_algorithm_;
};

}  // namespace

std::vector<Statement> parse_statements(TokenStream& tokens, bool is_algorithm) {
  return StatementParser(tokens, is_algorithm).statements();
}

std::string parse_comment(TokenStream& tokens) {
  std::string result;
  while (tokens.peek().kind == TokenKind::text) {
    result += tokens.take().text;
    if (!(tokens.at("+") && tokens.peek(1).kind == TokenKind::text)) break;
    tokens.take();
  }
  if (tokens.accept("annotation")) {
    if (!tokens.at("(")) tokens.fail_here("'('", "after 'annotation'");
    tokens.skip_parentheses();
  }
  return result;
}

}  // namespace sfdae::cli
