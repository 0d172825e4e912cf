// SPDX-License-Identifier: BSD-3-Clause
#include "formula.h"

#include <cctype>
#include <cstdlib>

namespace sfdae_test {

// One function for each line of the grammar; each returns the index of the node it has made.
class FormulaReader {
  using Kind = Formula::Kind;
  using Node = Formula::Node;

 public:
  FormulaReader(std::string_view source, std::vector<Node>& nodes) : source_(source), nodes_(nodes) {}

  void formula() {
    sum();
    if (peek() != '\0') fail("text after the end");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("formula \"" + std::string(source_) + "\", character " + std::to_string(at_) + ": " +
                             what);
  }
  char peek() {
    while (at_ < source_.size() && source_[at_] == ' ') ++at_;
    return at_ < source_.size() ? source_[at_] : '\0';
  }
  bool take(std::string_view token) {
    if (peek() == '\0' || source_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) fail("expected " + std::string(token));
  }
  std::size_t add(Node node) {
    nodes_.push_back(std::move(node));
    return nodes_.size() - 1;
  }

  std::size_t sum() {
    std::size_t left = product();
    for (;;) {
      const bool plus = take("+");
      if (!plus && !take("-")) return left;
      const std::size_t right = product();
      left = add({plus ? Kind::add : Kind::subtract, left, right});
    }
  }
  std::size_t product() {
    std::size_t left = sign();
    for (;;) {
      const bool times = take("*");
      if (!times && !take("/")) return left;
      const std::size_t right = sign();
      left = add({times ? Kind::multiply : Kind::divide, left, right});
    }
  }
  std::size_t sign() {
    if (take("+")) return sign();
    if (!take("-")) return power();
    const std::size_t operand = sign();
    return add({Kind::negate, operand});
  }
  std::size_t power() {
    const std::size_t base = atom();
    if (!take("**")) return base;
    const double exponent = number();
    if (exponent != std::floor(exponent)) fail("expected an integer exponent");
    return add({Kind::power, base, 0, exponent});
  }
  std::size_t atom() {
    const char c = peek();
    if (take("(")) {
      const std::size_t inside = sum();
      expect(")");
      return inside;
    }
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') return add({Kind::number, 0, 0, number()});
    if (std::isalpha(static_cast<unsigned char>(c))) return word();
    fail("expected a number, a name or (");
  }
  std::size_t word() {
    const std::size_t begin = at_;
    while (at_ < source_.size() && std::isalnum(static_cast<unsigned char>(source_[at_]))) ++at_;
    const std::string name(source_.substr(begin, at_ - begin));
    if (name == "t") return add({Kind::t});
    if (name == "pi") return add({Kind::number, 0, 0, 4.0 * std::atan(1.0)});
    if (take("[")) {
      if (name != "x" && name != "xd") fail("expected x[j] or xd[j]");
      const auto j = static_cast<std::size_t>(number());
      expect("]");
      return add({name == "x" ? Kind::x : Kind::xdot, j});
    }
    if (take("(")) {
      const std::size_t argument = sum();
      expect(")");
      return add({function(name), argument});
    }
    return add({Kind::name, 0, 0, 0.0, name});
  }
  Kind function(const std::string& name) const {
    if (name == "sin") return Kind::sin;
    if (name == "cos") return Kind::cos;
    if (name == "exp") return Kind::exp;
    if (name == "sqrt") return Kind::sqrt;
    fail("unknown function " + name);
  }
  double number() {
    peek();
    const std::string rest(source_.substr(at_));
    char* end = nullptr;
    const double value = std::strtod(rest.c_str(), &end);
    if (end == rest.c_str() || rest[0] == '-') fail("expected a number");
    at_ += static_cast<std::size_t>(end - rest.c_str());
    return value;
  }

  std::string_view source_;
  std::vector<Node>& nodes_;
  std::size_t at_ = 0;
};

Formula::Formula(std::string_view source) { FormulaReader(source, nodes_).formula(); }

}  // namespace sfdae_test
