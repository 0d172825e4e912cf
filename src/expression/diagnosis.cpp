// Diagnosis of a failed equation: finds the first operation whose result is not finite though its operands are.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "expression/series.h"
#include "expression/tape.h"
#include "linalg/format.h"
#include "linalg/index.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

namespace {

using Kind = EvaluationFailure::Kind;

// -1: all coefficients are finite.
int first_bad_order(const double* series, int order) {
  for (int k = 0; k <= order; ++k)
    if (!std::isfinite(series[k])) return k;
  return -1;
}

class Search {
 public:
  // A tape does not keep which slots nodes have.
  Search(const Record& record, Slots slots, FailedEquation failed)
      : record_(record), slots_(slots), failed_(failed), slots_of_(slots_of_nodes(record)) {
    order_ = std::max(failed.order, failed.order_of_gradients);
  }

  EvaluationFailure result() {
    const std::vector<int> nodes = chosen_nodes(record_.residual(failed_.equation));
    for (int i : nodes) {
      const int k = first_bad_order(slots_[slots_of_.v[index(i)]], order_);
      if (k >= 0) return k == 0 ? undefined(i) : not_smooth(i, k);
    }
    for (int i : nodes)
      if (record_.is_active(i) && !has_slopes(i)) return not_smooth(i, 1);
    return {Kind::not_finite, failed_.equation, "", "overflow" + in_equation()};
  }

 private:
  bool has_slopes(int i) const {
    const auto is_good = [&](int slot) {
      return slot < 0 || first_bad_order(slots_[slot], failed_.order_of_gradients) < 0;
    };
    const int p = slots_of_.p[index(i)];
    if (record_.node(i).operation != Operation::function) return is_good(p) && is_good(slots_of_.q[index(i)]);
    for (int k = 0; k < record_.operands(i).size(); ++k)
      if (!is_good(p + k)) return false;
    return true;
  }

  // The node `top` and all nodes it depends on, except branches that were not chosen; operands first.
  std::vector<int> chosen_nodes(int top) const {
    std::set<int> found;
    std::vector<int> stack{top};
    while (!stack.empty()) {
      const int i = stack.back();
      stack.pop_back();
      if (!found.insert(i).second) continue;
      const Node node = record_.node(i);
      if (node.operation == Operation::choose) {
        stack.push_back(node.a);
        stack.push_back(series::is_positive(value(node.a)) ? node.b : node.c);
      } else {
        const Operands operands = record_.operands(i);
        for (int k = 0; k < operands.size(); ++k) stack.push_back(operands[k]);
      }
    }
    return {found.begin(), found.end()};
  }

  double value(int node) const { return *slots_[slots_of_.v[index(node)]]; }
  std::string in_equation() const { return " in " + record_.name(failed_.equation); }

  // "log of -1"
  std::string application(const Node& node) const {
    const char* const name = name_of(node.operation);
    switch (node.operation) {
      case Operation::divide: return format("division of %.6g by %.6g", value(node.a), value(node.b));
      case Operation::modulo: return format("modulo of %.6g by %.6g", value(node.a), value(node.b));
      case Operation::power: return format("%s %.6g^%.6g", name, value(node.a), value(node.b));
      case Operation::log_of_base: return format("%s of %.6g with a variable exponent", name, value(node.a));
      case Operation::parameter: return "parameter " + record_.parameters()[index(node.a)].name;
      case Operation::function: return record_.function(node).name();
      default: break;
    }
    if (num_operands(node.operation) == 2) return format("%s of %.6g and %.6g", name, value(node.a), value(node.b));
    return format("%s of %.6g", name, is_leaf(node.operation) ? 0.0 : value(node.a));
  }

  bool is_undefined(const Node& node) const {
    switch (node.operation) {
      case Operation::divide:
      case Operation::modulo: return value(node.b) == 0.0;
      case Operation::sqrt:
      case Operation::log:
      case Operation::log10:
      case Operation::log_of_base:
      case Operation::power: return !series::is_positive(value(node.a));
      case Operation::asin:
      case Operation::acos: return true;
      default: return false;
    }
  }

  // Failure of a function that rejects its arguments or lacks a derivative that is needed; else none.
  std::optional<EvaluationFailure> refusal(int i) const {
    if (record_.node(i).operation != Operation::function) return std::nullopt;
    const FunctionCall& call = record_.call(i);
    const char* const name = call.function->name().c_str();
    double arguments[PointFunction::max_arguments] = {};
    std::string list;
    for (std::size_t k = 0; k < call.arguments.size(); ++k) {
      arguments[k] = value(call.arguments[k]);
      list += format(k == 0 ? "%.6g" : ", %.6g", arguments[k]);
    }
    const std::string objection = call.function->objection(arguments);
    if (!objection.empty())
      return EvaluationFailure{Kind::undefined, failed_.equation, name, objection + in_equation()};
    const int highest = std::max(failed_.order, failed_.order_of_gradients + 1);
    const MissingOrder missing = missing_order(call, arguments, highest);
    if (missing.code == 0) return std::nullopt;
    const std::string which = missing.order == 0 ? "" : format(" for its derivatives of order %d", missing.order);
    const std::string what = missing.code == SFDAE_ORDER_NOT_AVAILABLE
                                 ? format("%s has no derivatives of order %d", name, missing.order)
                                 : format("%s(%s) returned %d%s", name, list.c_str(), missing.code, which.c_str());
    return EvaluationFailure{Kind::refused, failed_.equation, name, what + in_equation(), missing.code};
  }

  EvaluationFailure undefined(int i) const {
    if (auto refused = refusal(i)) return std::move(*refused);
    const Node node = record_.node(i);
    const bool defined = !is_undefined(node);
    const char* const what = defined ? " is not finite" : "";
    return {defined ? Kind::not_finite : Kind::undefined, failed_.equation, name_of(node.operation),
            application(node) + what + in_equation()};
  }

  EvaluationFailure not_smooth(int i, int order) const {
    if (auto refused = refusal(i)) return std::move(*refused);
    const Node node = record_.node(i);
    return {
        Kind::not_smooth, failed_.equation, name_of(node.operation),
        application(node) + format(" has no finite derivative of order %d", order) + in_equation() + remedy(node)};
  }

  // Advice for operations at the boundary of their domain that depend on unknowns.
  std::string remedy(const Node& node) const {
    const bool is_angle = node.operation == Operation::asin || node.operation == Operation::acos;
    const bool is_root = node.operation == Operation::sqrt || node.operation == Operation::power;
    const std::string unknowns = is_angle || is_root ? unknowns_of(node.a) : "";
    if (unknowns.empty()) return "";
    const char* const way = is_angle ? "at an argument between -1 and 1" : "at a small positive argument";
    const char* const other = is_root ? ", or add a small number to it, as in sqrt(h + 1e-12)" : "";
    return format(". It depends on %s and has to be differentiated to find hidden constraints: start %s%s",
                  unknowns.c_str(), way, other);
  }

  // Names of the first unknowns that a node depends on.
  std::string unknowns_of(int node) const {
    constexpr std::size_t most = 3;
    std::set<int> unknowns;
    for (int i : chosen_nodes(node)) {
      const Operation operation = record_.node(i).operation;
      if (operation == Operation::unknown || operation == Operation::derivative) unknowns.insert(record_.node(i).a);
    }
    std::string list;
    std::size_t count = 0;
    for (int j : unknowns)
      if (count++ < most) list += format(list.empty() ? "x[%d]" : ", x[%d]", j);
    return count > most ? list + ", ..." : list;
  }

  const Record& record_;
  Slots slots_;
  FailedEquation failed_;
  int order_;
  NodeSlots slots_of_;
};

}  // namespace

int status_of(const EvaluationFailure& failure) {
  if (failure.code == 0) return SFDAE_NOT_FINITE;
  if (failure.code == SFDAE_ORDER_NOT_AVAILABLE) return SFDAE_ORDER_MISSING;
  return failure.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
}

EvaluationFailure diagnose(const Record& record, Slots slots, FailedEquation failed) {
  return Search(record, slots, failed).result();
}

}  // namespace sfdae::core
