// Recorded formulas as statements.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/source_code.h"

#include <charconv>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "linalg/format.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Binding strength of a formula: one weaker than its place requires gets parentheses.
enum Binding { loose, of_sum, of_product, tight };

struct Formula {
  std::string text;
  Binding binding = tight;
};

std::string joined(std::initializer_list<std::string_view> pieces) {
  std::string text;
  for (std::string_view piece : pieces) text += piece;
  return text;
}

std::string in_place(const Formula& formula, Binding least) {
  return formula.binding >= least ? formula.text : joined({"(", formula.text, ")"});
}

const char* function_name(Operation operation) {
  return operation == Operation::log_of_base ? "log" : name_of(operation);
}

class Writer {
 public:
  Writer(const Record& record, Language language, HelpersUsed& helpers)
      : record_(record), language_(language), helpers_(helpers), formulas_(index(record.num_nodes())) {}

  Statements write(const std::vector<Assignment>& assignments) {
    std::vector<int> uses(index(record_.num_nodes()), 0);
    for (const Assignment& assignment : assignments) ++uses[index(assignment.node)];
    for (int i = record_.num_nodes() - 1; i >= 0; --i) {
      if (uses[index(i)] == 0) continue;
      const Operands operands = record_.operands(i);
      for (int k = 0; k < operands.size(); ++k) ++uses[index(operands[k])];
    }
    for (int i = 0; i < record_.num_nodes(); ++i) {
      if (uses[index(i)] == 0) continue;
      formulas_[index(i)] = formula(i);
      if (!is_leaf(record_.node(i).operation) && (uses[index(i)] > 1 || is_long(i))) give_name(i);
    }
    for (const Assignment& assignment : assignments)
      add_line(assignment.target + " = " + formulas_[index(assignment.node)].text);
    return std::move(result_);
  }

 private:
  bool is_long(int i) const {
    constexpr std::size_t most_characters = 60;
    return formulas_[index(i)].text.size() > most_characters;
  }

  void add_line(const std::string& statement) {
    const bool is_c = language_ == Language::C;
    result_.text += wrapped((is_c ? "  " : "    ") + statement + (is_c ? ";" : ""), language_) + "\n";
  }

  void give_name(int i) {
    const int number = result_.num_values++;
    Formula& formula = formulas_[index(i)];
    if (language_ == Language::C) {
      const std::string name = format("v%d", number);
      add_line(joined({"const double ", name, " = ", formula.text}));
      formula = {name};
      return;
    }
    const std::string name = element("v", number, language_);
    add_line(name + " = " + formula.text);
    formula = {name};
  }

  void note_use(char name) {
    if (!result_.uses_values_of(name)) result_.uses += name;
  }

  Formula leaf(const Node& node) {
    switch (node.operation) {
      case Operation::time: note_use('t'); return {"t"};
      case Operation::unknown: note_use('z'); return {element("z", node.a, language_)};
      case Operation::derivative: note_use('d'); return {element("zdot", node.a, language_)};
      case Operation::parameter: note_use('p'); return {element("p", node.a, language_)};
      default: break;
    }
    const double value = record_.constant(node.a);
    return {source_of(value, language_), value < 0.0 ? loose : tight};
  }

  Formula formula(int i) {
    const Node v = record_.node(i);
    if (is_leaf(v.operation)) return leaf(v);
    const auto at = [this](int operand, Binding least) { return in_place(formulas_[index(operand)], least); };
    switch (v.operation) {
      case Operation::negate: return {joined({"-", at(v.a, of_product)}), loose};
      // Sums and products are evaluated from the left; other orders stand in parentheses.
      case Operation::add: return {joined({at(v.a, loose), " + ", at(v.b, of_product)}), of_sum};
      case Operation::subtract: return {joined({at(v.a, loose), " - ", at(v.b, of_product)}), of_sum};
      case Operation::multiply: return {joined({at(v.a, of_product), " * ", at(v.b, tight)}), of_product};
      case Operation::divide: return {joined({at(v.a, of_product), " / ", at(v.b, tight)}), of_product};
      default: return call(v);
    }
  }

  Formula call(const Node& v) {
    const bool is_c = language_ == Language::C;
    const auto at = [this](int operand) { return formulas_[index(operand)].text; };
    switch (v.operation) {
      case Operation::power:
        if (is_c) return {joined({"pow(", at(v.a), ", ", at(v.b), ")"})};
        return {joined({"((", at(v.a), ")**(", at(v.b), "))"})};
      case Operation::choose:
        if (is_c) return {joined({"(", at(v.a), " > 0.0 ? ", at(v.b), " : ", at(v.c), ")"})};
        return {joined({"merge(", at(v.b), ", ", at(v.c), ", ", at(v.a), " > 0.0_dp)"})};
      case Operation::floor: helpers_.floor = true; return {joined({is_c ? "floor(" : "floor_of(", at(v.a), ")"})};
      case Operation::modulo:
        helpers_.modulo = true;
        return {joined({is_c ? "modulo_of(" : "modulo(", at(v.a), ", ", at(v.b), ")"})};
      default: break;
    }
    if (num_operands(v.operation) == 1) return {joined({function_name(v.operation), "(", at(v.a), ")"})};
    return {joined({function_name(v.operation), "(", at(v.a), ", ", at(v.b), ")"})};
  }

  const Record& record_;
  Language language_;
  HelpersUsed& helpers_;
  std::vector<Formula> formulas_;
  Statements result_;
};

}  // namespace

std::string source_of(double value, Language language) {
  char digits[40];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  std::string text(digits, end);
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos) text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
  return language == Language::C ? text : text + "_dp";
}

std::string element(const char* word, int i, Language language) {
  if (language == Language::C) return joined({word, "[", std::to_string(i), "]"});
  return joined({word, "(", std::to_string(i + 1), ")"});
}

std::string wrapped(const std::string& line, Language language) {
  constexpr std::size_t most_columns = 100;
  std::string text, rest = line;
  const std::size_t indent = line.find_first_not_of(' ') == std::string::npos ? 0 : line.find_first_not_of(' ');
  while (rest.size() > most_columns) {
    std::size_t at = rest.rfind(' ', most_columns);
    if (at == std::string::npos || at <= indent + 4) at = rest.find(' ', most_columns);
    if (at == std::string::npos) break;
    text += rest.substr(0, at) + (language == Language::Fortran ? " &\n" : "\n");
    rest = std::string(indent + 4, ' ') + rest.substr(at + 1);
  }
  return text + rest;
}

Statements statements_of(const Record& record, const std::vector<Assignment>& assignments, Language language,
                         HelpersUsed& helpers) {
  return Writer(record, language, helpers).write(assignments);
}

}  // namespace sfdae::core
