// Flat models written in C++, and their trajectories by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/simulation.h"

namespace sfdae::cli::test {

// An expression with operators; a variable knows its number.
struct Term {
  Term(double value) : e(make(Operation::number, {}, value)) {}
  explicit Term(Expression expression) : e(std::move(expression)) {}

  static Expression make(Operation operation, std::vector<Expression> operands, double value = 0.0, int index = -1) {
    return std::make_shared<const Node>(Node{operation, value, index, std::move(operands), Location{}});
  }
  static Term of(Operation operation, const Term& a) { return Term(make(operation, {a.e})); }
  static Term of(Operation operation, const Term& a, const Term& b) { return Term(make(operation, {a.e, b.e})); }

  Expression e;
};

inline Term operator+(const Term& a, const Term& b) { return Term::of(Operation::add, a, b); }
inline Term operator-(const Term& a, const Term& b) { return Term::of(Operation::subtract, a, b); }
inline Term operator*(const Term& a, const Term& b) { return Term::of(Operation::multiply, a, b); }
inline Term operator/(const Term& a, const Term& b) { return Term::of(Operation::divide, a, b); }
inline Term operator-(const Term& a) { return Term::of(Operation::negate, a); }
inline Term operator<(const Term& a, const Term& b) { return Term::of(Operation::less, a, b); }
inline Term operator<=(const Term& a, const Term& b) { return Term::of(Operation::less_equal, a, b); }
inline Term operator>(const Term& a, const Term& b) { return Term::of(Operation::greater, a, b); }
inline Term operator>=(const Term& a, const Term& b) { return Term::of(Operation::greater_equal, a, b); }
inline Term both(const Term& a, const Term& b) { return Term::of(Operation::and_, a, b); }
inline Term either(const Term& a, const Term& b) { return Term::of(Operation::or_, a, b); }
inline Term inverse(const Term& a) { return Term::of(Operation::not_, a); }
inline Term equal(const Term& a, const Term& b) { return Term::of(Operation::equal, a, b); }
inline Term power(const Term& a, const Term& b) { return Term::of(Operation::power, a, b); }
inline Term square(const Term& a) { return power(a, 2.0); }
inline Term no_event(const Term& a) { return Term::of(Operation::no_event, a); }
inline Term choose(const Term& c, const Term& a, const Term& b) {
  return Term(Term::make(Operation::choose, {c.e, a.e, b.e}));
}
inline Term function(Operation operation, const Term& a) { return Term::of(operation, a); }
inline Term der(const Term& v) { return Term(Term::make(Operation::derivative, {}, 0.0, v.e->index)); }
inline Term pre(const Term& v) { return Term(Term::make(Operation::previous, {}, 0.0, v.e->index)); }
inline Term sample(const Term& start, const Term& interval) { return Term::of(Operation::sample, start, interval); }
inline Term time_now() { return Term(Term::make(Operation::time, {})); }
inline Term initially() { return Term(Term::make(Operation::initial, {})); }
inline Term finally() { return Term(Term::make(Operation::terminal, {})); }

struct Attributes {
  std::optional<double> start = std::nullopt;
  bool fixed = false;
  std::optional<double> nominal = std::nullopt, min = std::nullopt, max = std::nullopt;
  StateSelect state_select = StateSelect::standard;
};

struct Branch {
  std::vector<Term> conditions;
  std::vector<Action> actions;
};

inline Action assign(const Term& v, const Term& value) {
  return {Action::Kind::assign, v.e->index, value.e, "", true, {}};
}
inline Action reinit(const Term& v, const Term& value) {
  return {Action::Kind::reinit, v.e->index, value.e, "", true, {}};
}
inline Action terminate(const std::string& message) { return {Action::Kind::terminate, -1, {}, message, true, {}}; }

// Declarations and equations have the lines 1, 2, ... in the order in which they are written.
class Builder {
 public:
  Builder() { model.file = "model.mo", model.name = "Model"; }

  Term real(const std::string& name, const Attributes& a = {}) {
    return add(name, Type::real, Variability::continuous, a);
  }
  Term discrete(const std::string& name, const Attributes& a = {}) {
    return add(name, Type::real, Variability::discrete, a);
  }
  Term integer(const std::string& name, const Attributes& a = {}) {
    return add(name, Type::integer, Variability::discrete, a);
  }
  Term boolean(const std::string& name, const Attributes& a = {}) {
    return add(name, Type::boolean, Variability::discrete, a);
  }
  Term parameter(const std::string& name, const Term& value) {
    const Term result = add(name, Type::real, Variability::parameter, {});
    model.variables.back().binding = value.e;
    model.variables.back().is_fixed = true;
    return result;
  }
  Term free_parameter(const std::string& name, double guess) {
    return add(name, Type::real, Variability::parameter, {.start = guess});
  }

  void equation(const Term& left, const Term& right) { model.equations.push_back({left.e, right.e, next_line()}); }
  void initial(const Term& left, const Term& right) {
    model.initial_equations.push_back({left.e, right.e, next_line()});
  }
  void when(const std::vector<Branch>& branches) {
    When result;
    result.at = next_line();
    for (const Branch& branch : branches) {
      WhenBranch copy;
      for (const Term& condition : branch.conditions) copy.conditions.push_back(condition.e);
      copy.actions = branch.actions;
      result.branches.push_back(copy);
    }
    model.whens.push_back(result);
  }
  void assertion(const Term& condition, const std::string& message, bool is_error = true) {
    model.assertions.push_back({condition.e, message, is_error, next_line()});
  }

  FlatModel model;

 private:
  Location next_line() { return {++line_, 1}; }

  Term add(const std::string& name, Type type, Variability variability, const Attributes& a) {
    Variable v;
    v.name = name;
    v.type = type;
    v.variability = variability;
    v.is_fixed = a.fixed;
    if (a.start) v.start = Term(*a.start).e;
    if (a.nominal) v.nominal = Term(*a.nominal).e;
    if (a.min) v.min = Term(*a.min).e;
    if (a.max) v.max = Term(*a.max).e;
    v.state_select = a.state_select;
    v.at = next_line();
    model.variables.push_back(v);
    return Term(Term::make(Operation::variable, {}, 0.0, static_cast<int>(model.variables.size()) - 1));
  }

  int line_ = 0;
};

inline Settings until(double stop, double tolerance = 1e-8) {
  Settings settings;
  settings.start = 0.0;
  settings.stop = stop;
  settings.tolerance = tolerance;
  settings.num_outputs = 50;
  return settings;
}

inline std::size_t column(const Result& result, const std::string& name) {
  const auto& names = result.trajectory.names;
  for (std::size_t j = 0; j < names.size(); ++j)
    if (names[j] == name) return j;
  ADD_FAILURE() << "no column " << name;
  return 0;
}

inline double value(const Result& result, const std::string& name, std::size_t row) {
  return result.trajectory.values.at(row * result.trajectory.names.size() + column(result, name));
}
inline double first(const Result& result, const std::string& name) { return value(result, name, 0); }
inline double last(const Result& result, const std::string& name) {
  return value(result, name, result.trajectory.t.size() - 1);
}

// max |values - exact(t)| over all rows; infinity if one is not finite.
template <class Exact>
double largest_error(const Result& result, const std::string& name, Exact exact) {
  double error = 0.0;
  for (std::size_t k = 0; k < result.trajectory.t.size(); ++k) {
    const double deviation = std::fabs(value(result, name, k) - exact(result.trajectory.t[k]));
    error = std::max(error, std::isfinite(deviation) ? deviation : HUGE_VAL);
  }
  return error;
}

inline std::string joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const std::string& text : texts) result += text + "\n";
  return result;
}

#define EXPECT_SOLVED(result) \
  EXPECT_EQ(static_cast<int>((result).outcome), static_cast<int>(Outcome::solved)) << (result).message
#define EXPECT_OUTCOME(result, expected) \
  EXPECT_EQ(static_cast<int>((result).outcome), static_cast<int>(expected)) << (result).message
#define EXPECT_CONTAINS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

}  // namespace sfdae::cli::test
