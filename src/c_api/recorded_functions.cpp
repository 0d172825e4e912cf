// Derivatives of recorded expressions, tables and user-supplied functions.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <optional>

#include "c_api/recording.h"
#include "expression/symbolic_gradient.h"
#include "linalg/format.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

sfdae_expression no_number() { return plain(std::numeric_limits<double>::quiet_NaN()); }

// Stores a mistake.
sfdae_expression refuse(sfdae_record* record, const std::string& message) {
  record->remember(SFDAE_ILLEGAL_ARGUMENT, message);
  return in(record, mistaken);
}

// Runs a body that records. Nothing is thrown.
template <class Body>
sfdae_expression recorded(sfdae_record* record, Body body) noexcept {
  try {
    return body();
  } catch (...) {
    record->remember(SFDAE_OUT_OF_MEMORY, "out of memory.");  // a short string, which needs none
    return in(record, mistaken);
  }
}

bool is_variable(Operation operation) { return is_leaf(operation) && operation != Operation::constant; }

// Differentiates by all present leaves.
void differentiate(sfdae_record& record, int node) {
  std::vector<int> leaves;
  for (int i = 0; i <= node; ++i)
    if (is_variable(record.recorder.node(i).operation)) leaves.push_back(i);
  const std::vector<int> gradient = symbolic_gradient(record.recorder, node, leaves);
  record.differentiated = -1;
  record.derivatives.clear();
  for (std::size_t k = 0; k < leaves.size(); ++k) record.derivatives[leaves[k]] = gradient[k];
  record.differentiated = node;
}

sfdae_expression derivative(sfdae_record* record, const sfdae_expression& a, const sfdae_expression& variable) {
  constexpr const char* name = "derivative";
  if (variable.record == nullptr)
    return refuse(record,
                  "derivative: the variable is a plain number. It has to be t, an unknown, the derivative of an "
                  "unknown or a parameter.");
  const int by = node_of(*record, variable, name), node = node_of(*record, a, name);
  if (by == mistaken || node == mistaken) return in(record, mistaken);
  if (!is_variable(record->recorder.node(by).operation))
    return refuse(record,
                  "derivative: the variable is a formula. It has to be t, an unknown, the derivative of an unknown "
                  "or a parameter, as it was handed to the function that writes equations.");
  if (by > node) return in(record, record->recorder.constant(0.0));
  if (record->differentiated != node) differentiate(*record, node);
  return in(record, record->derivatives.at(by));
}

sfdae_expression time_derivative(sfdae_record* record, const sfdae_expression& a) {
  if (!record->has_derivatives)
    return refuse(record,
                  "time_derivative: formulas of mechanical systems do not know q' and v'. With q' = S v the "
                  "derivative of a(t, q) along time is derivative(a, t) + the sum of derivative(a, q[j]) "
                  "(S v)[j].");
  const int node = node_of(*record, a, "time_derivative");
  if (node == mistaken) return in(record, mistaken);
  const std::optional<int> result = symbolic_time_derivative(record->recorder, node);
  if (result) return in(record, *result);
  return refuse(record,
                "time_derivative: the formula depends on x', so that x'' would be needed, which is no variable. "
                "Introduce an unknown for what is differentiated, and an equation that defines it.");
}

std::shared_ptr<const Spline> spline_of(sfdae_record& record, const TableData& data) {
  for (const auto& known : record.splines)
    if (known->data() == data) return known;
  std::shared_ptr<const Spline> spline = Spline::through(data);
  if (spline) record.splines.push_back(spline);
  return spline;
}

sfdae_expression table(sfdae_record* record, const sfdae_expression& a, const TableData& data) {
  const std::string complaint = Spline::complaint(data);
  if (!complaint.empty()) return refuse(record, "table: " + complaint + ".");
  const int node = node_of(*record, a, "table");
  if (node == mistaken) return in(record, mistaken);
  const std::shared_ptr<const Spline> spline = spline_of(*record, data);
  if (!spline)
    return refuse(record, format("table: the points lie too unevenly for a spline of degree %d. Try a lower degree.",
                                 data.degree));
  return in(record, record->recorder.call({spline, {node}, {}}));
}

sfdae_expression number_of_table(double a, const TableData& data) {
  if (!std::isfinite(a) || !Spline::complaint(data).empty()) return no_number();
  const std::shared_ptr<const Spline> spline = Spline::through(data);
  double value = 0.0;
  if (!spline || spline->derivatives(0, &a, &value) != 0) return no_number();
  return plain(value);
}

struct External {
  const char* name;
  sfdae_external_function function;
  int count;
  const sfdae_expression* arguments;
  void* user;
};

std::shared_ptr<const PointFunction> function_of(sfdae_record& record, const External& e) {
  for (const auto& known : record.functions)
    if (known->is(e.function, e.user, e.count)) return known;
  record.functions.push_back(std::make_shared<const ExternalFunction>(e.name, e.count, e.function, e.user));
  return record.functions.back();
}

sfdae_expression external(sfdae_record* record, const External& e) {
  if (e.name == nullptr || *e.name == '\0') return refuse(record, "external: a function needs a name.");
  if (e.function == nullptr) return refuse(record, format("external: the function %.60s is NULL.", e.name));
  if (e.count > PointFunction::max_arguments)
    return refuse(record, format("external: %.60s has %d arguments, more than %d.", e.name, e.count,
                                 PointFunction::max_arguments));
  FunctionCall call;
  for (int k = 0; k < e.count; ++k) {
    call.arguments.push_back(node_of(*record, e.arguments[k], format("argument %d of %.60s", k, e.name)));
    if (call.arguments.back() == mistaken) return in(record, mistaken);
  }
  call.function = function_of(*record, e);
  return in(record, record->recorder.call(call));
}

}  // namespace

}  // namespace sfdae::core

using namespace sfdae::core;

sfdae_expression sfdae_derivative(sfdae_expression a, sfdae_expression variable) {
  sfdae_record* const record = variable.record != nullptr ? variable.record : a.record;
  if (record == nullptr) return no_number();
  return recorded(record, [&] { return derivative(record, a, variable); });
}

sfdae_expression sfdae_time_derivative(sfdae_expression a) {
  if (a.record == nullptr) return std::isfinite(a.value) ? plain(0.0) : a;
  return recorded(a.record, [&] { return time_derivative(a.record, a); });
}

sfdae_expression sfdae_table(sfdae_expression a, int degree, int count, const double* x, const double* y) {
  if (count > 0 && (x == nullptr || y == nullptr)) {
    if (a.record == nullptr) return no_number();
    return recorded(a.record, [&] { return refuse(a.record, "table: x or y is NULL."); });
  }
  const auto data = [&] {
    return count > 0 ? TableData{degree, {x, x + count}, {y, y + count}} : TableData{degree, {}, {}};
  };
  if (a.record != nullptr) return recorded(a.record, [&] { return table(a.record, a, data()); });
  try {
    return number_of_table(a.value, data());
  } catch (...) {
    return no_number();
  }
}

sfdae_expression sfdae_external(const char* name, sfdae_external_function function, int count,
                                const sfdae_expression* arguments, void* user) {
  if (arguments == nullptr || count < 1) return no_number();
  for (int k = 0; k < count; ++k)
    if (sfdae_record* const record = arguments[k].record)
      return recorded(record, [&] { return external(record, {name, function, count, arguments, user}); });
  if (count > PointFunction::max_arguments) return no_number();
  double numbers[PointFunction::max_arguments], value = 0.0;
  for (int k = 0; k < count; ++k) {
    numbers[k] = arguments[k].value;
    if (!std::isfinite(numbers[k])) return no_number();
  }
  if (function == nullptr || function(0, numbers, &value, user) != 0) return no_number();
  return plain(value);
}
