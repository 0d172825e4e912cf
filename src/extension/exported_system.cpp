// The minimal extension as formulas.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/exported_system.h"

#include <algorithm>
#include <map>
#include <utility>

#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "expression/symbolic_jet.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

double factorial(int k) {
  double product = 1.0;
  for (int i = 2; i <= k; ++i) product *= i;
  return product;
}

// The recording again, with room for derivatives; returns the nodes of the equations.
std::vector<int> copy_of(const Record& record, Recorder& to) {
  const std::vector<int> copies = copy_nodes(record, to);
  std::vector<int> residuals;
  for (int i = 0; i < record.m(); ++i) residuals.push_back(copies[index(record.residual(i))]);
  return residuals;
}

class Export {
 public:
  Export(const MinimalExtension& extension, const StateChoice& choice, ExportedSystem& result)
      : extension_(extension), choice_(choice), result_(result), record_(extension.problem().evaluator().record()) {
    const TaylorEvaluator& evaluator = extension.problem().evaluator();
    for (int i = 0; i < record_.num_user_parameters(); ++i)
      parameters_.push_back({record_.parameters()[index(i)].name, evaluator.parameter(i)});
    number_unknowns();
  }

  void run(const Jet& jet) {
    write_point(jet);
    const int size = result_.size();
    Recorder first(record_.n()), second(size);
    for (const Parameter& parameter : parameters_) {
      first.parameter(parameter.name, parameter.value);  // the numbers that they have in the recording
      second.parameter(parameter.name, parameter.value);
    }
    const std::vector<int> recorded = copy_of(record_, first);
    SymbolicPartials partials(first);
    SymbolicJet series(first, second, [&](int j, bool derivative, int k) {
      return derivative ? product(second, k + 1, coefficient(second, j, k + 1)) : coefficient(second, j, k);
    });
    series.set_parameters(parameters_);
    std::vector<int> residuals, entries;
    for (int row = 0; row < extension_.num_rows(); ++row) {
      residuals.push_back(residual(row, second, series, recorded));
      add_partials(row, {first, second, partials, series, recorded}, entries);
    }
    residuals.insert(residuals.end(), entries.begin(), entries.end());
    result_.formulas = second.finish(std::move(residuals));
  }

 private:
  struct Tools {
    Recorder &first, &second;
    SymbolicPartials& partials;
    SymbolicJet& series;
    const std::vector<int>& recorded;
  };

  // x first, in their order, then derivatives by their order.
  void number_unknowns() {
    const std::vector<int>& d = extension_.offsets().d;
    const int highest = *std::max_element(d.begin(), d.end());
    for (int order = 0; order <= highest; ++order)
      for (int j = 0; j < extension_.n(); ++j) {
        if (order > d[index(j)] || (order == 1 && choice_.is_state(j))) continue;
        place_[{j, order}] = result_.size();
        result_.unknowns.push_back({j, order, order == 0 && choice_.is_state(j)});
      }
    for (const MinimalExtension::Row& row : extension_.rows()) result_.equations.push_back({row.equation, row.order});
  }

  void write_point(const Jet& jet) {
    result_.t = jet.t;
    const auto derivative = [&jet](int j, int order) { return factorial(order) * jet.column(order)[j]; };
    for (const ExportedSystem::Unknown& z : result_.unknowns) {
      result_.z.push_back(derivative(z.unknown, z.order));
      const bool is_known = z.order < extension_.offsets().d[index(z.unknown)];
      result_.zdot.push_back(is_known ? derivative(z.unknown, z.order + 1) : 0.0);
    }
  }

  static int product(Recorder& recorder, double factor, int node) {
    return recorder.apply(Operation::multiply, recorder.constant(factor), node);
  }
  static int sum(Recorder& recorder, int a, int b) { return recorder.apply(Operation::add, a, b); }

  // Taylor coefficient of x_j. Coefficients beyond the extension cancel in all rows that contain them.
  int coefficient(Recorder& to, int j, int order) const {
    if (order > extension_.offsets().d[index(j)]) return to.constant(0.0);
    const bool is_slope = order == 1 && choice_.is_state(j);
    const int node = is_slope ? to.derivative(place_.at({j, 0})) : to.unknown(place_.at({j, order}));
    return to.apply(Operation::divide, node, to.constant(factorial(order)));
  }

  // Rows are Taylor coefficients, equations are derivatives.
  int residual(int row, Recorder& to, SymbolicJet& series, const std::vector<int>& recorded) const {
    const double scale = factorial(extension_.rows()[index(row)].order);
    int value = to.constant(0.0);
    for (const MinimalExtension::Part& part : extension_.parts(row))
      value = sum(to, value,
                  product(to, scale * part.factor, series.coefficient(recorded[index(part.equation)], part.order)));
    return value;
  }

  // See MinimalExtension::make_pattern.
  void add_partials(int row, const Tools& tools, std::vector<int>& entries) {
    std::map<std::pair<int, int>, int> found;  // by unknown and order
    const auto [equation, row_order] = extension_.rows()[index(row)];
    std::map<int, int> highest;  // orders in the row
    for (const Signature::Entry& entry : extension_.structure().signature.row(equation))
      highest[entry.unknown] = entry.order + row_order;
    const double scale = factorial(row_order);
    const auto add = [&](int j, int order, int node, double factor) {
      if (!highest.contains(j) || order > highest[j]) return;
      const int change = product(tools.second, scale * factor / factorial(order), node);
      const auto [place, is_first] = found.try_emplace({j, order}, change);
      if (!is_first) place->second = sum(tools.second, place->second, change);
    };
    for (const MinimalExtension::Part& part : extension_.parts(row)) {
      const SymbolicPartials::Gradient gradient = tools.partials.of(tools.recorded[index(part.equation)]);
      for (const auto& [leaf, node] : gradient) {
        const int first = leaf.derivative ? 1 : 0;
        for (int l = first; l <= part.order + first; ++l)
          add(leaf.unknown, l, tools.series.coefficient(node, part.order - l + first),
              (first == 1 ? l : 1) * part.factor);
      }
    }
    write_partials(row, found, tools.second, entries);
  }

  void write_partials(int row, const std::map<std::pair<int, int>, int>& found, Recorder& to,
                      std::vector<int>& entries) {
    for (const auto& [unknown, node] : found) {
      if (to.number(node) == 0.0) continue;
      const bool is_slope = unknown.second == 1 && choice_.is_state(unknown.first);
      const int column = place_.at(is_slope ? std::pair(unknown.first, 0) : unknown);
      result_.partials.push_back({row, column, is_slope});
      entries.push_back(node);
    }
  }

  const MinimalExtension& extension_;
  const StateChoice& choice_;
  ExportedSystem& result_;
  const Record& record_;
  std::vector<Parameter> parameters_;
  std::map<std::pair<int, int>, int> place_;  // in z, of x_j^(order)
};

}  // namespace

int ExportedSystem::num_states() const {
  return static_cast<int>(
      std::count_if(unknowns.begin(), unknowns.end(), [](const Unknown& unknown) { return unknown.is_state; }));
}

ExportedSystem exported_system(const MinimalExtension& extension, const StateChoice& choice, const Jet& jet) {
  if (has_functions(extension.problem().evaluator().record()))
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "the equations call a function or a table (sfdae_external, sfdae_table), which is no formula: there "
        "is no source of it to write.");
  ExportedSystem result;
  Export(extension, choice, result).run(jet);
  return result;
}

}  // namespace sfdae::core
