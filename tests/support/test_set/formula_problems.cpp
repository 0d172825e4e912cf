// SPDX-License-Identifier: BSD-3-Clause
#include "formula_problems.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace sfdae_test {

namespace {

using Json = nlohmann::ordered_json;

// Null if there is none.
const Json* find(const Json& object, const char* key) {
  const auto member = object.find(key);
  return member == object.end() ? nullptr : &*member;
}

// Numbers, or numbers as text with more digits than a double has.
std::vector<double> numbers(const Json& list) {
  std::vector<double> values;
  for (const Json& item : list)
    values.push_back(item.is_string() ? std::stod(item.get<std::string>()) : item.get<double>());
  return values;
}

std::vector<Formula> formulas(const Json& list) {
  std::vector<Formula> read;
  for (const Json& item : list) read.emplace_back(item.get<std::string>());
  return read;
}

// "name=formula; name=formula"
std::vector<std::pair<std::string, Formula>> assignments(std::string_view source) {
  std::vector<std::pair<std::string, Formula>> read;
  while (!source.empty()) {
    const std::string_view one = source.substr(0, source.find(';'));
    source.remove_prefix(std::min(source.size(), one.size() + 1));
    const std::size_t begin = one.find_first_not_of(' '), equals = one.find('=');
    if (equals == std::string_view::npos) throw std::runtime_error("abbreviation without =: " + std::string(one));
    read.emplace_back(one.substr(begin, equals - begin), Formula(one.substr(equals + 1)));
  }
  return read;
}

void read_solution(const Json& source, FormulaProblem& p) {
  const Json* exact = find(source, "exact");
  if (exact == nullptr || exact->is_null()) return;
  if (exact->is_array()) {
    p.solution = ExactSolution::formulas;
    p.exact_formulas = formulas(*exact);
  } else if (*exact == "recursive") {
    p.solution = ExactSolution::recursion;
  } else if (*exact == "crane") {
    p.solution = ExactSolution::crane;
  } else if (*exact == "robot") {
    p.solution = ExactSolution::robot_arm;
  } else {
    throw std::runtime_error("unknown kind of solution " + exact->get<std::string>());
  }
}

void read_references(const Json& source, TestProblem& p) {
  const Json* reference = find(source, "reference");
  if (reference == nullptr) return;
  for (const auto& [key, value] : reference->items())
    if (key != "source") p.references.push_back({std::stod(key), numbers(value)});
  const auto earlier = [](const ReferencePoint& a, const ReferencePoint& b) { return a.t < b.t; };
  std::sort(p.references.begin(), p.references.end(), earlier);
}

FormulaProblem read_problem(const Json& source) {
  FormulaProblem p;
  const Json& values = source.at("charvals");
  p.data.name = source.at("name").get<std::string>();
  p.data.m = source.at("m").get<int>();
  p.data.n = source.at("n").get<int>();
  p.data.values = {values.at("mu").get<int>(), values.at("d").get<int>(), values.at("a").get<int>(),
                   values.at("u").get<int>(), values.at("v").get<int>()};
  p.data.t0 = source.at("t0").get<double>();
  p.data.tf = source.at("tf").get<double>();
  p.data.counted = first_components(p.data.n);
  if (const Json* parameters = find(source, "p"))
    for (const auto& [name, value] : parameters->items()) p.parameters.emplace_back(name, value.get<double>());
  if (const Json* pre = find(source, "pre")) p.abbreviations = assignments(pre->get<std::string>());
  p.F = formulas(source.at("F"));
  read_solution(source, p);
  read_references(source, p.data);
  if (const Json* x0 = find(source, "x0")) {
    p.data.x0 = numbers(*x0);
  } else {
    for (const Jet& x : p.exact(p.data.t0, 0)) p.data.x0.push_back(x[0]);
  }
  return p;
}

// x' as a series of the order of x less one, so that it may stand beside x.
std::vector<Jet> in_order(std::vector<Jet> x, int order) {
  for (Jet& component : x) {
    Jet shorter = Jet::zero(order);
    for (int k = 0; k <= order; ++k) shorter[k] = component[k];
    component = shorter;
  }
  return x;
}

}  // namespace

double FormulaProblem::parameter(const std::string& name) const {
  for (const auto& [key, value] : parameters)
    if (key == name) return value;
  throw std::runtime_error("no parameter " + name);
}

std::vector<Jet> FormulaProblem::exact(double t, int order) const {
  // The recursion, the crane and the arm differentiate the path up to n times.
  const Jet time = Jet::variable(t, std::min(order + data.n, max_jet_order));
  switch (solution) {
    case ExactSolution::formulas: return in_order(exact_formulas_at(time), order);
    case ExactSolution::recursion: return in_order(exact_recursion(time), order);
    case ExactSolution::crane: return in_order(exact_crane(time), order);
    case ExactSolution::robot_arm: return in_order(exact_robot_arm(time), order);
    default: throw std::logic_error("no exact solution of " + data.name);
  }
}

std::vector<Jet> FormulaProblem::exact_formulas_at(const Jet& t) const {
  const FormulaScope<Jet> scope = scope_at(t);
  std::vector<Jet> x;
  for (const Formula& formula : exact_formulas) x.push_back(formula.evaluate(scope));
  return x;
}

std::vector<Jet> FormulaProblem::exact_recursion(const Jet& t) const {
  const auto n = static_cast<std::size_t>(data.n);
  std::vector<Jet> x(n, sin(t));
  for (std::size_t i = n - 1; i-- > 0;) x[i] = derivative(x[i + 1]) + sin(t);
  return x;
}

// x2 = g(t), x1 = g - dd + (m2/k) g'' from the balance of the second mass, the force from that of the first.
std::vector<Jet> FormulaProblem::exact_crane(const Jet& t) const {
  FormulaScope<Jet> scope = scope_at(t);
  abbreviate(scope);
  const Jet x2 = scope.names.at("gt"), v2 = derivative(x2), a2 = derivative(v2);
  const Jet x1 = x2 - parameter("dd") + parameter("m2") / parameter("k") * a2, v1 = derivative(x1);
  return {x1, x2, v1, v2, parameter("m1") * derivative(v1) + parameter("m2") * a2};
}

// The path of the tip gives x1 = 1 - e^t and x1 + x3 = 1 - t. With p = 2 x3 - x2 and q = u1 - u2 the equations of v1'
// and v3' are linear in (p, q); then x2, its derivative v2, and u2 from the equation of v2'.
std::vector<Jet> FormulaProblem::exact_robot_arm(const Jet& t) const {
  const Jet x1 = 1.0 - exp(t), x3 = 1.0 - t - x1, v1 = derivative(x1), v3 = derivative(x3);
  const Jet den = 2.0 - cos(x3) * cos(x3);
  const Jet a = 2.0 / den, b = cos(x3) / den, c = sin(x3) / den, d = cos(x3) * sin(x3) / den;
  const Jet turn = 2.0 * c * (v1 + v3) * (v1 + v3) + v1 * v1 * d;
  // (a + 2b) p + a q = r1, (a - 9b) p - (a + b) q = r3
  const Jet r1 = derivative(v1) - turn;
  const Jet r3 = derivative(v3) + turn + 2.0 * v1 * v1 * c + d * (v1 + v3) * (v1 + v3);
  const Jet determinant = -(a + 2.0 * b) * (a + b) - a * (a - 9.0 * b);
  const Jet p = (-(a + b) * r1 - a * r3) / determinant;
  const Jet q = ((a + 2.0 * b) * r3 - (a - 9.0 * b) * r1) / determinant;
  const Jet x2 = 2.0 * x3 - p, v2 = derivative(x2);
  const Jet u2 = derivative(v2) + turn - p * (1.0 - 3.0 * a - 2.0 * b) + a * q;
  return {x1, x2, x3, v1, v2, v3, q + u2, u2};
}

std::vector<FormulaProblem> read_formula_problems(const std::string& path) {
  std::vector<FormulaProblem> problems;
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  for (const Json& source : Json::parse(file)) problems.push_back(read_problem(source));
  return problems;
}

const std::vector<FormulaProblem>& formula_problems() {
  static const std::vector<FormulaProblem> problems = read_formula_problems(SFDAE_TEST_DATA "/problems.json");
  return problems;
}

const FormulaProblem& formula_problem(std::string_view name) {
  for (const FormulaProblem& problem : formula_problems())
    if (problem.data.name == name) return problem;
  throw std::runtime_error("no problem " + std::string(name));
}

}  // namespace sfdae_test
