// Expressions of the C API: numbers are computed, everything else is recorded.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/expressions.h"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "c_api/recording.h"
#include "expression/held_conditions.h"
#include "expression/kernel.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

struct CallOperands {
  const char* operation;  // for messages
  std::initializer_list<sfdae_expression> list;
};

// The record that all operands except plain numbers belong to; null if all of them are plain numbers.
sfdae_record* record_of(const CallOperands& operands) {
  sfdae_record* record = nullptr;
  for (const sfdae_expression& operand : operands.list) {
    if (operand.record == nullptr || operand.record == record) continue;
    if (record != nullptr) {
      for (sfdae_record* mixed : {record, operand.record})
        mixed->remember(SFDAE_ILLEGAL_ARGUMENT,
                        format("%s: the operands belong to different recordings.", operands.operation));
    }
    record = operand.record;
  }
  return record;
}

// Records the result of `action` on the operands' nodes, or computes `number`. Nothing is thrown.
template <class Action, class Number>
sfdae_expression combine(const CallOperands& operands, Action action, Number number) noexcept {
  sfdae_record* record = nullptr;
  try {
    record = record_of(operands);
    if (record == nullptr) {
      const std::optional<double> value = number();
      return plain(value ? *value : std::numeric_limits<double>::quiet_NaN());
    }
    int nodes[3] = {-1, -1, -1}, count = 0;
    for (const sfdae_expression& operand : operands.list) {
      nodes[count] = node_of(*record, operand, operands.operation);
      if (nodes[count++] == mistaken) return in(record, mistaken);
    }
    return in(record, action(record->recorder, nodes));
  } catch (...) {
    // Only memory can run out. Short strings need none.
    for (const sfdae_expression& operand : operands.list) {
      if (operand.record == nullptr) continue;
      record = operand.record;
      record->remember(SFDAE_OUT_OF_MEMORY, "out of memory.");
    }
    return in(record, mistaken);
  }
}

sfdae_expression unary(Operation operation, const sfdae_expression& a) {
  return combine(
      {name_of(operation), {a}},
      [&](Recorder& recorder, const int* nodes) { return recorder.apply(operation, nodes[0]); },
      [&] { return evaluate(operation, a.value); });
}

// Applies a recorder's operations; plain numbers use a separate recorder.
template <class Action>
sfdae_expression composed(const char* name, std::initializer_list<sfdae_expression> operands, Action action) {
  return combine({name, operands}, action, [&]() -> std::optional<double> {
    Recorder recorder(0);
    int nodes[3] = {}, count = 0;
    for (const sfdae_expression& operand : operands) {
      if (!std::isfinite(operand.value)) return std::nullopt;
      nodes[count++] = recorder.constant(operand.value);
    }
    return recorder.number(action(recorder, nodes));
  });
}

sfdae_expression binary(Operation operation, const sfdae_expression& a, const sfdae_expression& b) {
  return combine(
      {name_of(operation), {a, b}},
      [&](Recorder& recorder, const int* nodes) { return recorder.apply(operation, nodes[0], nodes[1]); },
      [&] { return evaluate(operation, a.value, b.value); });
}

std::shared_ptr<const Record> finished(sfdae_record& record, const std::vector<int>& residuals,
                                       const EquationNames& names) {
  check_record(record);
  return with_conditions(record.recorder.finish(residuals, names));
}

// sum += sign * coefficient * node
void add_term(Recorder& recorder, int& sum, Operation sign, std::pair<int, int> factors) {
  sum = recorder.apply(sign, sum, recorder.apply(Operation::multiply, factors.first, factors.second));
}

}  // namespace

int node_of(sfdae_record& record, const sfdae_expression& operand, const std::string& where) {
  if (operand.record == nullptr) {
    if (std::isfinite(operand.value)) return record.recorder.constant(operand.value);
    record.remember(SFDAE_ILLEGAL_ARGUMENT,
                    where + ": a number is not finite, or was computed where it is not defined, as log(-1) is.");
    return mistaken;
  }
  if (operand.record != &record) {
    record.remember(SFDAE_ILLEGAL_ARGUMENT, where + ": an expression belongs to another recording.");
    return mistaken;
  }
  if (operand.node >= 0 && operand.node < record.recorder.num_nodes()) return operand.node;
  const bool unset = operand.node == not_set;
  record.remember(SFDAE_ILLEGAL_ARGUMENT,
                  where + (unset ? ": an expression has no value yet." : ": an expression is damaged."));
  return mistaken;
}

void check_record(const sfdae_record& record) {
  if (record.status != SFDAE_OK) throw Failure(record.status, "recording of equations: " + record.message);
}

void check_outcome(const sfdae_record& record, int returned) {
  check_record(record);
  if (returned == 0) return;
  throw Failure(returned < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED,
                format("the function that writes equations returned %d.", returned));
}

std::shared_ptr<const Record> record_equations(sfdae_equations_function F, int m, int n, void* user,
                                               const EquationNames& names) {
  sfdae_record record(n);
  std::vector<sfdae_expression> x, xdot, residual(index(m), in(&record, not_set));
  for (int j = 0; j < n; ++j) {
    x.push_back(in(&record, record.recorder.unknown(j)));
    xdot.push_back(in(&record, record.recorder.derivative(j)));
  }
  const sfdae_expression t = in(&record, record.recorder.time());
  check_outcome(record, F(&record, t, x.data(), xdot.data(), residual.data(), user));
  std::vector<int> residuals;
  for (int i = 0; i < m; ++i) {
    const sfdae_expression& entry = residual[index(i)];
    const std::string where = names.appended_to(format("residual[%d]", i), i);
    if (entry.record == &record && entry.node == not_set)
      throw Failure(SFDAE_ILLEGAL_ARGUMENT, "recording of equations: " + where + " was not set.");
    residuals.push_back(node_of(record, entry, where));
  }
  return finished(record, residuals, names);
}

std::shared_ptr<const Record> record_linear_equations(sfdae_linear_equations_function coefficients, int m, int n,
                                                      void* user, const EquationNames& names) {
  sfdae_record record(n);
  Recorder& recorder = record.recorder;
  const sfdae_expression t = in(&record, recorder.time());
  std::vector<sfdae_expression> E(index(m) * index(n), plain(0.0)), A(E), f(index(m), plain(0.0));
  check_outcome(record, coefficients(&record, t, E.data(), A.data(), f.data(), user));
  std::vector<int> residuals;
  for (int i = 0; i < m; ++i) {
    int residual = recorder.constant(0.0);
    for (int j = 0; j < n; ++j) {
      const std::size_t entry = index(i) + index(j) * index(m);
      if (is_plain_zero(E[entry]) && is_plain_zero(A[entry])) continue;
      const int E_ij = node_of(record, E[entry], format("E(%d, %d)", i, j));
      const int A_ij = node_of(record, A[entry], format("A(%d, %d)", i, j));
      if (record.status != SFDAE_OK) break;
      add_term(recorder, residual, Operation::add, {E_ij, recorder.derivative(j)});
      add_term(recorder, residual, Operation::subtract, {A_ij, recorder.unknown(j)});
    }
    const int f_i = node_of(record, f[index(i)], format("f(%d)", i));
    if (record.status == SFDAE_OK) residual = recorder.apply(Operation::subtract, residual, f_i);
    residuals.push_back(residual);
  }
  return finished(record, residuals, names);
}

}  // namespace sfdae::core

using namespace sfdae::core;

sfdae_expression sfdae_number(double value) { return plain(value); }

sfdae_expression sfdae_parameter(sfdae_record* record, const char* name, double value) {
  if (record == nullptr) return plain(std::numeric_limits<double>::quiet_NaN());
  try {
    if (name == nullptr || *name == '\0') {
      record->remember(SFDAE_ILLEGAL_ARGUMENT, "sfdae_parameter: a parameter needs a name.");
    } else if (!std::isfinite(value)) {
      record->remember(SFDAE_ILLEGAL_ARGUMENT, format("sfdae_parameter: the value of %s is not finite.", name));
    } else {
      return in(record, record->recorder.parameter(name, value));
    }
  } catch (...) {
    record->remember(SFDAE_OUT_OF_MEMORY, "out of memory.");
  }
  return in(record, mistaken);
}

sfdae_expression sfdae_add(sfdae_expression a, sfdae_expression b) { return binary(Operation::add, a, b); }
sfdae_expression sfdae_subtract(sfdae_expression a, sfdae_expression b) { return binary(Operation::subtract, a, b); }
sfdae_expression sfdae_multiply(sfdae_expression a, sfdae_expression b) { return binary(Operation::multiply, a, b); }
sfdae_expression sfdae_divide(sfdae_expression a, sfdae_expression b) { return binary(Operation::divide, a, b); }
sfdae_expression sfdae_negate(sfdae_expression a) { return unary(Operation::negate, a); }
sfdae_expression sfdae_power(sfdae_expression a, sfdae_expression b) { return binary(Operation::power, a, b); }
sfdae_expression sfdae_sqrt(sfdae_expression a) { return unary(Operation::sqrt, a); }
sfdae_expression sfdae_exp(sfdae_expression a) { return unary(Operation::exp, a); }
sfdae_expression sfdae_log(sfdae_expression a) { return unary(Operation::log, a); }
sfdae_expression sfdae_log10(sfdae_expression a) { return unary(Operation::log10, a); }
sfdae_expression sfdae_sin(sfdae_expression a) { return unary(Operation::sin, a); }
sfdae_expression sfdae_cos(sfdae_expression a) { return unary(Operation::cos, a); }
sfdae_expression sfdae_tan(sfdae_expression a) { return unary(Operation::tan, a); }
sfdae_expression sfdae_asin(sfdae_expression a) { return unary(Operation::asin, a); }
sfdae_expression sfdae_acos(sfdae_expression a) { return unary(Operation::acos, a); }
sfdae_expression sfdae_atan(sfdae_expression a) { return unary(Operation::atan, a); }
sfdae_expression sfdae_atan2(sfdae_expression y, sfdae_expression x) { return binary(Operation::atan2, y, x); }
sfdae_expression sfdae_sinh(sfdae_expression a) { return unary(Operation::sinh, a); }
sfdae_expression sfdae_cosh(sfdae_expression a) { return unary(Operation::cosh, a); }
sfdae_expression sfdae_tanh(sfdae_expression a) { return unary(Operation::tanh, a); }

sfdae_expression sfdae_floor(sfdae_expression a) { return unary(Operation::floor, a); }
sfdae_expression sfdae_modulo(sfdae_expression a, sfdae_expression b) { return binary(Operation::modulo, a, b); }

sfdae_expression sfdae_abs(sfdae_expression a) {
  return composed("abs", {a}, [](Recorder& r, const int* nodes) { return r.abs(nodes[0]); });
}
sfdae_expression sfdae_min(sfdae_expression a, sfdae_expression b) {
  return composed("min", {a, b}, [](Recorder& r, const int* nodes) { return r.min(nodes[0], nodes[1]); });
}
sfdae_expression sfdae_max(sfdae_expression a, sfdae_expression b) {
  return composed("max", {a, b}, [](Recorder& r, const int* nodes) { return r.max(nodes[0], nodes[1]); });
}
sfdae_expression sfdae_sign(sfdae_expression a) {
  return composed("sign", {a}, [](Recorder& r, const int* nodes) { return r.sign(nodes[0]); });
}
sfdae_expression sfdae_less(sfdae_expression a, sfdae_expression b) {
  return composed("less", {a, b}, [](Recorder& r, const int* nodes) { return r.greater(nodes[1], nodes[0]); });
}
sfdae_expression sfdae_less_equal(sfdae_expression a, sfdae_expression b) {
  return composed("less_equal", {a, b},
                  [](Recorder& r, const int* nodes) { return r.greater_equal(nodes[1], nodes[0]); });
}
sfdae_expression sfdae_greater(sfdae_expression a, sfdae_expression b) {
  return composed("greater", {a, b}, [](Recorder& r, const int* nodes) { return r.greater(nodes[0], nodes[1]); });
}
sfdae_expression sfdae_greater_equal(sfdae_expression a, sfdae_expression b) {
  return composed("greater_equal", {a, b},
                  [](Recorder& r, const int* nodes) { return r.greater_equal(nodes[0], nodes[1]); });
}
sfdae_expression sfdae_and(sfdae_expression a, sfdae_expression b) {
  return composed("and", {a, b}, [](Recorder& r, const int* nodes) { return r.conjunction(nodes[0], nodes[1]); });
}
sfdae_expression sfdae_or(sfdae_expression a, sfdae_expression b) {
  return composed("or", {a, b}, [](Recorder& r, const int* nodes) { return r.disjunction(nodes[0], nodes[1]); });
}
sfdae_expression sfdae_not(sfdae_expression a) {
  return composed("not", {a}, [](Recorder& r, const int* nodes) { return r.negation(nodes[0]); });
}

sfdae_expression sfdae_choose(sfdae_expression c, sfdae_expression a, sfdae_expression b) {
  const auto record = [](Recorder& recorder, const int* nodes) {
    return recorder.apply(Operation::choose, nodes[0], nodes[1], nodes[2]);
  };
  return combine({"choose", {c, a, b}}, record,
                 [&] { return evaluate(Operation::choose, c.value, a.value, b.value); });
}
