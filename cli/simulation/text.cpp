// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/text.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace sfdae::cli {

namespace {

constexpr std::size_t longest = 70;  // characters of a formula in a message

const char* name_of(Operation operation) {
  switch (operation) {
    case Operation::derivative: return "der";
    case Operation::previous: return "pre";
    case Operation::abs: return "abs";
    case Operation::sign: return "sign";
    case Operation::sqrt: return "sqrt";
    case Operation::exp: return "exp";
    case Operation::log: return "log";
    case Operation::log10: return "log10";
    case Operation::sin: return "sin";
    case Operation::cos: return "cos";
    case Operation::tan: return "tan";
    case Operation::asin: return "asin";
    case Operation::acos: return "acos";
    case Operation::atan: return "atan";
    case Operation::sinh: return "sinh";
    case Operation::cosh: return "cosh";
    case Operation::tanh: return "tanh";
    case Operation::floor: return "floor";
    case Operation::ceil: return "ceil";
    case Operation::integer: return "integer";
    case Operation::no_event: return "noEvent";
    case Operation::atan2: return "atan2";
    case Operation::min: return "min";
    case Operation::max: return "max";
    case Operation::div: return "div";
    case Operation::mod: return "mod";
    case Operation::rem: return "rem";
    case Operation::sample: return "sample";
    default: return "";
  }
}

const char* sign_of(Operation operation) {
  switch (operation) {
    case Operation::add: return " + ";
    case Operation::subtract: return " - ";
    case Operation::multiply: return "*";
    case Operation::divide: return "/";
    case Operation::power: return "^";
    case Operation::less: return " < ";
    case Operation::less_equal: return " <= ";
    case Operation::greater: return " > ";
    case Operation::greater_equal: return " >= ";
    case Operation::equal: return " == ";
    case Operation::not_equal: return " <> ";
    case Operation::and_: return " and ";
    case Operation::or_: return " or ";
    default: return nullptr;
  }
}

// Operator precedence.
int strength(Operation operation) {
  switch (operation) {
    case Operation::or_: return 1;
    case Operation::and_: return 2;
    case Operation::not_: return 3;
    case Operation::add:
    case Operation::subtract:
    case Operation::negate: return 5;
    case Operation::multiply:
    case Operation::divide: return 6;
    case Operation::power: return 7;
    case Operation::choose: return 0;
    default: return sign_of(operation) != nullptr ? 4 : 8;
  }
}

class Printer {
 public:
  explicit Printer(const FlatModel& model) : model_(model) {}

  void print(const Node& node, int least) {
    if (text.size() > longest) return;
    const bool needs_parentheses = strength(node.operation) < least;
    if (needs_parentheses) text += "(";
    print_inner(node);
    if (needs_parentheses) text += ")";
  }

  std::string text;

 private:
  const std::string& name(const Node& node) const {
    return model_.variables[static_cast<std::size_t>(node.index)].name;
  }

  void print_inner(const Node& node) {
    const int own = strength(node.operation);
    switch (node.operation) {
      case Operation::number: text += to_text(node.value); return;
      case Operation::time: text += "time"; return;
      case Operation::initial: text += "initial()"; return;
      case Operation::terminal: text += "terminal()"; return;
      case Operation::variable: text += name(node); return;
      case Operation::derivative:
      case Operation::previous: text += std::string(name_of(node.operation)) + "(" + name(node) + ")"; return;
      case Operation::negate:
      case Operation::not_:
        text += node.operation == Operation::negate ? "-" : "not ";
        print(*node.operands[0], own + 1);
        return;
      case Operation::choose:
        text += "if ";
        print(*node.operands[0], 0);
        text += " then ";
        print(*node.operands[1], 0);
        text += " else ";
        print(*node.operands[2], 0);
        return;
      default: break;
    }
    if (const char* const sign = sign_of(node.operation)) {
      print(*node.operands[0], own);
      text += sign;
      print(*node.operands[1], own + 1);
      return;
    }
    text += std::string(name_of(node.operation)) + "(";
    for (std::size_t k = 0; k < node.operands.size(); ++k) {
      if (k > 0) text += ", ";
      print(*node.operands[k], 0);
    }
    text += ")";
  }

  const FlatModel& model_;
};

}  // namespace

std::string to_text(const Expression& expression, const FlatModel& model) {
  Printer printer(model);
  printer.print(*expression, 0);
  if (printer.text.size() > longest) printer.text = printer.text.substr(0, longest - 4) + " ...";
  return printer.text;
}

namespace {

// The formula as an expression; null if it has more levels or contains an unnamed quantity.
Expression expression_of(const Formulas& formulas, Formula formula, const FlatModel& model, int levels) {
  const FormulaNode& formula_node = formulas[formula];
  const bool is_name = formula_node.operation == Operation::variable ||
                       formula_node.operation == Operation::previous ||
                       formula_node.operation == Operation::derivative;
  const bool is_switch = formula_node.operands[0] < 0 && formula_node.index >= 0 && !is_name;
  const bool is_hidden = is_name && at(formula_node.index) >= model.variables.size();
  Node node{formula_node.operation, formula_node.value, formula_node.index, {}, {}};
  if (levels == 0 || is_switch || is_hidden) return nullptr;
  for (Formula operand : formula_node.operands) {
    if (operand < 0) continue;
    node.operands.push_back(expression_of(formulas, operand, model, levels - 1));
    if (!node.operands.back()) return nullptr;
  }
  return std::make_shared<const Node>(std::move(node));
}

}  // namespace

std::string to_text(const Formulas& formulas, Formula formula, const FlatModel& model) {
  constexpr int most_levels = 5;
  const Expression expression = expression_of(formulas, formula, model, most_levels);
  return expression ? to_text(expression, model) : "discrete value";
}

std::string place(const FlatModel& model, Location at) {
  return at.line > 0 ? model.file + ":" + std::to_string(at.line) : model.file;
}

std::string to_text(double number) {
  if (std::isnan(number)) return "nan";  // never -nan
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", number);
  return text.data();
}

}  // namespace sfdae::cli
