// SPDX-License-Identifier: BSD-3-Clause
#include "reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace sfdae::cli::testing {

std::string package(const std::string& definitions, const std::string& model) {
  return "//! base 0.1.0\npackage 'M'\n" + definitions + "\nmodel 'M'\n" + model + "\nend 'M';\nend 'M';\n";
}

FlatModel read(const std::string& definitions, const std::string& model) {
  return read_model(package(definitions, model), "test.bmo");
}

FlatModel read_file(const std::string& name) { return read_model_file(SFDAE_TEST_MODELS "/" + name); }

int index_of(const FlatModel& model, std::string_view name) {
  for (size_t k = 0; k < model.variables.size(); ++k)
    if (model.variables[k].name == name) return static_cast<int>(k);
  throw std::runtime_error("no variable " + std::string(name));
}

const Variable& variable(const FlatModel& model, std::string_view name) {
  return model.variables[static_cast<size_t>(index_of(model, name))];
}

namespace {

double apply_operation(Operation operation, const std::vector<double>& x) {
  switch (operation) {
    case Operation::negate: return -x[0];
    case Operation::abs: return std::fabs(x[0]);
    case Operation::sign: return x[0] > 0 ? 1 : x[0] < 0 ? -1 : 0;
    case Operation::sqrt: return std::sqrt(x[0]);
    case Operation::exp: return std::exp(x[0]);
    case Operation::log: return std::log(x[0]);
    case Operation::log10: return std::log10(x[0]);
    case Operation::sin: return std::sin(x[0]);
    case Operation::cos: return std::cos(x[0]);
    case Operation::tan: return std::tan(x[0]);
    case Operation::asin: return std::asin(x[0]);
    case Operation::acos: return std::acos(x[0]);
    case Operation::atan: return std::atan(x[0]);
    case Operation::sinh: return std::sinh(x[0]);
    case Operation::cosh: return std::cosh(x[0]);
    case Operation::tanh: return std::tanh(x[0]);
    case Operation::floor: return std::floor(x[0]);
    case Operation::ceil: return std::ceil(x[0]);
    case Operation::integer: return std::floor(x[0]);
    case Operation::not_: return x[0] == 0;
    case Operation::no_event: return x[0];
    case Operation::add: return x[0] + x[1];
    case Operation::subtract: return x[0] - x[1];
    case Operation::multiply: return x[0] * x[1];
    case Operation::divide: return x[0] / x[1];
    case Operation::power: return std::pow(x[0], x[1]);
    case Operation::atan2: return std::atan2(x[0], x[1]);
    case Operation::min: return std::fmin(x[0], x[1]);
    case Operation::max: return std::fmax(x[0], x[1]);
    case Operation::div: return std::trunc(x[0] / x[1]);
    case Operation::mod: return x[0] - std::floor(x[0] / x[1]) * x[1];
    case Operation::rem: return std::fmod(x[0], x[1]);
    case Operation::less: return x[0] < x[1];
    case Operation::less_equal: return x[0] <= x[1];
    case Operation::greater: return x[0] > x[1];
    case Operation::greater_equal: return x[0] >= x[1];
    case Operation::equal: return x[0] == x[1];
    case Operation::not_equal: return x[0] != x[1];
    case Operation::and_: return x[0] != 0 && x[1] != 0;
    case Operation::or_: return x[0] != 0 || x[1] != 0;
    default: throw std::runtime_error("an operation without a value");
  }
}

class Evaluation {
 public:
  Evaluation(const FlatModel& model, const Values& values) : model_(model), values_(values) {}

  double of(const Expression& e) {
    if (const auto found = known_.find(e.get()); found != known_.end()) return found->second;
    const double result = compute(*e);
    known_.emplace(e.get(), result);
    return result;
  }

 private:
  double given(const std::string& name) {
    const auto found = values_.find(name);
    if (found == values_.end()) throw std::runtime_error("no value of " + name);
    return found->second;
  }

  double compute(const Node& e) {
    switch (e.operation) {
      case Operation::number: return e.value;
      case Operation::time: return given("time");
      case Operation::derivative: return given("der(" + model_.variables[static_cast<size_t>(e.index)].name + ")");
      case Operation::previous: return given("pre(" + model_.variables[static_cast<size_t>(e.index)].name + ")");
      case Operation::initial: return given("initial");
      case Operation::variable: {
        const Variable& x = model_.variables[static_cast<size_t>(e.index)];
        if (values_.count(x.name) == 0 && x.variability <= Variability::parameter)
          return of(x.binding ? x.binding : x.start);
        return given(x.name);
      }
      case Operation::choose: return of(e.operands[0]) != 0 ? of(e.operands[1]) : of(e.operands[2]);
      default: break;
    }
    std::vector<double> operands;
    for (const Expression& operand : e.operands) operands.push_back(of(operand));
    return apply_operation(e.operation, operands);
  }

  const FlatModel& model_;
  const Values& values_;
  std::map<const Node*, double> known_;
};

}  // namespace

double value(const FlatModel& model, const Expression& e, const Values& values) {
  return Evaluation(model, values).of(e);
}

Expression right_of(const FlatModel& model, const std::string& name) {
  Expression result;
  const int k = index_of(model, name);
  for (const Equation& one : model.equations) {
    if (one.left->operation != Operation::variable || one.left->index != k) continue;
    if (result != nullptr) throw std::runtime_error("two equations of " + name);
    result = one.right;
  }
  if (result == nullptr) throw std::runtime_error("no equation of " + name);
  return result;
}

double solved(const FlatModel& model, const std::string& name, const Values& values) {
  return value(model, right_of(model, name), values);
}

std::string error_of(const std::string& text) {
  try {
    read_model(text, "test.bmo");
  } catch (const ModelError& error) {
    return error.what();
  }
  return "";
}

std::string place(const std::string& text, const std::string& mark) {
  const size_t i = text.find(mark);
  if (i == text.npos) throw std::runtime_error("no mark " + mark);
  size_t line = 1, column = 1;
  for (size_t k = 0; k < i; ++k) {
    ++column;
    if (text[k] == '\n') ++line, column = 1;
  }
  return std::to_string(line) + ":" + std::to_string(column);
}

}  // namespace sfdae::cli::testing
