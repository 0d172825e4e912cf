// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <utility>

#include "modelica/parser.h"

namespace sfdae::cli {

using syntax::ExpressionPointer;
using syntax::Form;
using syntax::Operator;

namespace {

ExpressionPointer make(Form form, Location at) {
  auto result = std::make_unique<syntax::Expression>();
  result->form = form;
  result->at = at;
  return result;
}

ExpressionPointer make_unary(Operator op, Location at, ExpressionPointer operand) {
  ExpressionPointer result = make(Form::unary, at);
  result->operators.push_back(op);
  result->operands.push_back(std::move(operand));
  return result;
}

// Levels of binary operators; a higher one binds tighter.
enum Level { kOr, kAnd, kRelation, kSum, kTerm, kFactor };

struct BinaryOperator {
  std::string_view word;
  Level level;
  Operator op;
};

constexpr std::array<BinaryOperator, 18> kBinaryOperators = {{{"or", kOr, Operator::or_},
                                                              {"and", kAnd, Operator::and_},
                                                              {"<", kRelation, Operator::less},
                                                              {"<=", kRelation, Operator::less_equal},
                                                              {">", kRelation, Operator::greater},
                                                              {">=", kRelation, Operator::greater_equal},
                                                              {"==", kRelation, Operator::equal},
                                                              {"<>", kRelation, Operator::not_equal},
                                                              {"+", kSum, Operator::add},
                                                              {"-", kSum, Operator::subtract},
                                                              {".+", kSum, Operator::element_add},
                                                              {".-", kSum, Operator::element_subtract},
                                                              {"*", kTerm, Operator::multiply},
                                                              {"/", kTerm, Operator::divide},
                                                              {".*", kTerm, Operator::element_multiply},
                                                              {"./", kTerm, Operator::element_divide},
                                                              {"^", kFactor, Operator::power},
                                                              {".^", kFactor, Operator::element_power}}};

const BinaryOperator* binary_operator(const Token& token, Level level) {
  for (const BinaryOperator& candidate : kBinaryOperators)
    if (candidate.level == level && token.is(candidate.word)) return &candidate;
  return nullptr;
}

class ExpressionParser {
 public:
  explicit ExpressionParser(TokenStream& tokens) : in_(tokens) {}

  ExpressionPointer expression() {
    const TokenStream::Nesting nesting(in_);
    return in_.at("if") ? choose() : simple();
  }

  std::vector<ExpressionPointer> subscripts() {
    std::vector<ExpressionPointer> result;
    in_.expect("[", "before subscripts");
    do {
      const bool is_all = in_.at(":") && (in_.at(",", 1) || in_.at("]", 1));
      result.push_back(is_all ? make(Form::all, in_.take().at) : expression());
    } while (in_.accept(","));
    in_.expect("]", "after subscripts");
    return result;
  }

 private:
  // if c then v elseif c then v else v; `else if` continues it, so that long chains do not nest.
  ExpressionPointer choose() {
    ExpressionPointer result = make(Form::choose, in_.expect("if", "before a condition"));
    for (;;) {
      result->operands.push_back(expression());
      in_.expect("then", "after the condition of an if-expression");
      result->operands.push_back(expression());
      if (in_.accept("elseif")) continue;
      in_.expect("else", "in an if-expression, which needs a value in every case");
      if (!in_.accept("if")) break;
    }
    result->operands.push_back(expression());
    return result;
  }

  ExpressionPointer simple() {
    ExpressionPointer first = binary(kOr);
    if (!in_.at(":")) return first;
    ExpressionPointer result = make(Form::range, in_.take().at);
    result->operands.push_back(std::move(first));
    result->operands.push_back(binary(kOr));
    if (in_.accept(":")) result->operands.push_back(binary(kOr));
    return result;
  }

  ExpressionPointer operand(Level level) {
    switch (level) {
      case kOr: return binary(kAnd);
      case kAnd: return negation();
      case kRelation: return binary(kSum);
      case kSum: return binary(kTerm);
      case kTerm: return binary(kFactor);
      default: return signed_primary();
    }
  }

  ExpressionPointer negation() {
    if (!in_.at("not")) return binary(kRelation);
    const Location at = in_.take().at;
    const TokenStream::Nesting nesting(in_);
    return make_unary(Operator::not_, at, negation());
  }

  // A sign without the parentheses that the standard requires (a * -b, x ^ -1) belongs to the following operand.
  ExpressionPointer signed_primary() {
    if (!in_.at("-") && !in_.at("+")) return primary();
    const Token sign = in_.take();
    const TokenStream::Nesting nesting(in_);
    ExpressionPointer value = binary(kFactor);
    return make_unary(sign.text == "-" ? Operator::negate : Operator::plus, sign.at, std::move(value));
  }

  // Chains of operators of one level do not nest.
  ExpressionPointer binary(Level level) {
    ExpressionPointer first;
    if (level == kSum && (in_.at("-") || in_.at("+") || in_.at(".-") || in_.at(".+"))) {
      const Token sign = in_.take();
      first = make_unary(sign.text.back() == '-' ? Operator::negate : Operator::plus, sign.at, binary(kTerm));
    } else {
      first = operand(level);
    }
    const BinaryOperator* found = binary_operator(in_.peek(), level);
    if (found == nullptr) return first;
    ExpressionPointer result = make(Form::chain, in_.location());
    result->operands.push_back(std::move(first));
    for (; found != nullptr; found = binary_operator(in_.peek(), level)) {
      if (!result->operators.empty() && (level == kRelation || level == kFactor))
        in_.fail(in_.location(),
                 "'" + in_.peek().text + "' cannot follow another operator of its kind; add parentheses");
      in_.take();
      result->operators.push_back(found->op);
      result->operands.push_back(operand(level));
    }
    return result;
  }

  ExpressionPointer primary() {
    const Token& token = in_.peek();
    switch (token.kind) {
      case TokenKind::integer:
      case TokenKind::real: return number();
      case TokenKind::text: {
        ExpressionPointer result = make(Form::text, token.at);
        result->text = in_.take().text;
        return result;
      }
      case TokenKind::identifier: return reference();
      default: break;
    }
    if (token.is("true") || token.is("false")) {
      ExpressionPointer result = make(Form::truth, token.at);
      result->number = in_.take().text == "true" ? 1.0 : 0.0;
      return result;
    }
    if (token.is("end")) return make(Form::end, in_.take().at);
    if (token.is("(")) return parentheses();
    if (token.is("{")) return list();
    if (token.is("[")) return matrix();
    if (token.is(".")) return reference();
    if ((token.is("initial") || token.is("pure")) && in_.at("(", 1)) {
      const Token name = in_.take();
      return call(name.text, name.at);
    }
    if (token.is("function"))
      in_.fail(token.at, "functions as arguments are not supported; export with --frontendInline");
    in_.fail_here("an expression", "here");
  }

  ExpressionPointer number() {
    const Token token = in_.take();
    ExpressionPointer result = make(Form::number, token.at);
    result->is_integer = token.kind == TokenKind::integer;
    result->number = std::strtod(token.text.c_str(), nullptr);
    return result;
  }

  ExpressionPointer reference() {
    in_.accept(".");
    const Token first = in_.expect_identifier("after '.'");
    std::string dotted = first.text;  // a possible function name
    size_t length = 0;
    while (in_.at(".", 2 * length) && in_.peek(2 * length + 1).kind == TokenKind::identifier) ++length;
    if (in_.at("(", 2 * length)) {
      for (; length > 0; --length) {
        in_.take();
        dotted = "'" + plain(dotted) + "." + plain(in_.take().text);
      }
      return call(dotted, first.at);
    }
    ExpressionPointer result = make(Form::name, first.at);
    result->text = first.text;
    return postfix(std::move(result));
  }

  // .'member' and [subscripts]; each adds a level of nesting.
  ExpressionPointer postfix(ExpressionPointer base) {
    for (int depth = 0; in_.at("[") || in_.at("."); ++depth) {
      if (depth >= TokenStream::kMaxNesting)
        in_.fail(in_.location(), "more than 200 members and subscripts in one name");
      const Location at = in_.location();
      const bool is_member = in_.accept(".");
      ExpressionPointer result = make(is_member ? Form::member : Form::subscripted, at);
      result->operands.push_back(std::move(base));
      if (is_member) {
        result->text = in_.expect_identifier("after '.'").text;
      } else {
        for (ExpressionPointer& subscript : subscripts()) result->operands.push_back(std::move(subscript));
      }
      base = std::move(result);
    }
    return base;
  }

  ExpressionPointer call(const std::string& name, Location at) {
    ExpressionPointer result = make(Form::call, at);
    result->text = name;
    in_.expect("(", "before arguments");
    if (in_.accept(")")) return postfix(std::move(result));
    do {
      std::string argument;
      if (in_.at_identifier() && in_.at("=", 1)) {
        argument = in_.take().text;
        in_.take();
      }
      result->names.push_back(argument);
      result->operands.push_back(expression());
      if (in_.at("for") && result->operands.size() == 1) {
        iterators(*result);
        break;
      }
    } while (in_.accept(","));
    in_.expect(")", "after arguments");
    return postfix(std::move(result));
  }

  // for i in 1:3, j in 1:2: turns a call with one operand into a comprehension.
  void iterators(syntax::Expression& result) {
    result.form = Form::comprehension;
    result.names.clear();
    in_.expect("for", "in a comprehension");
    do {
      result.names.push_back(in_.expect_identifier("as the iterator of a comprehension").text);
      in_.expect("in", "after the iterator of a comprehension");
      result.operands.push_back(expression());
    } while (in_.accept(","));
  }

  ExpressionPointer parentheses() {
    ExpressionPointer result = make(Form::tuple, in_.take().at);
    std::vector<ExpressionPointer>& parts = result->operands;
    bool has_comma = false;
    if (!in_.at(")")) {
      do {
        parts.push_back(in_.at(",") || in_.at(")") ? nullptr : expression());
        has_comma = has_comma || in_.at(",");
      } while (in_.accept(","));
    }
    in_.expect(")", "to close '('");
    if (has_comma || parts.empty()) return result;
    ExpressionPointer inner = std::move(parts[0]);
    return in_.at("[") || in_.at(".") ? postfix(std::move(inner)) : std::move(inner);
  }

  ExpressionPointer list() {
    ExpressionPointer result = make(Form::list, in_.take().at);
    if (in_.accept("}")) return result;
    result->operands.push_back(expression());
    if (in_.at("for")) {
      iterators(*result);
    } else {
      while (in_.accept(",")) result->operands.push_back(expression());
    }
    in_.expect("}", "to close '{'");
    return postfix(std::move(result));
  }

  ExpressionPointer matrix() {
    ExpressionPointer result = make(Form::matrix, in_.take().at);
    do {
      ExpressionPointer row = make(Form::list, in_.location());
      do {
        row->operands.push_back(expression());
      } while (in_.accept(","));
      result->operands.push_back(std::move(row));
    } while (in_.accept(";"));
    in_.expect("]", "to close '['");
    return postfix(std::move(result));
  }

  TokenStream& in_;
};

}  // namespace

ExpressionPointer parse_expression(TokenStream& tokens) { return ExpressionParser(tokens).expression(); }

std::vector<ExpressionPointer> parse_subscripts(TokenStream& tokens) { return ExpressionParser(tokens).subscripts(); }

std::string parse_dotted_name(TokenStream& tokens, std::string_view where) {
  tokens.accept(".");
  std::string result = tokens.expect_identifier(where).text;
  while (tokens.at(".") && tokens.peek(1).kind == TokenKind::identifier) {
    tokens.take();
    result = "'" + plain(result) + "." + plain(tokens.take().text);
  }
  return result;
}

}  // namespace sfdae::cli
