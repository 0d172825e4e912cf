// Detection of switches that change at times known in advance.
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/switch_times.h"

#include <optional>

namespace sfdae::cli {

namespace {

struct LinearInTime {
  double slope = 0.0;
  Formula offset = -1;
};

std::optional<LinearInTime> linear_in_time(Formulas& formulas, Formula formula) {
  const FormulaNode node = formulas[formula];
  if ((node.dependence & (on_continuous | on_free)) == 0) return LinearInTime{0.0, formula};
  const auto [a, b, c] = node.operands;
  switch (node.operation) {
    case Operation::time: return LinearInTime{1.0, formulas.number(0.0)};
    case Operation::negate: {
      const auto of_a = linear_in_time(formulas, a);
      if (!of_a) return std::nullopt;
      return LinearInTime{-of_a->slope, formulas.negate(of_a->offset)};
    }
    case Operation::add:
    case Operation::subtract: {
      const auto of_a = linear_in_time(formulas, a), of_b = linear_in_time(formulas, b);
      if (!of_a || !of_b) return std::nullopt;
      const double sign = node.operation == Operation::add ? 1.0 : -1.0;
      return LinearInTime{of_a->slope + sign * of_b->slope,
                          formulas.apply(node.operation, of_a->offset, of_b->offset)};
    }
    case Operation::multiply:
    case Operation::divide: {
      const bool is_left = node.operation == Operation::multiply && formulas.is_number(a);
      const Formula factor = is_left ? a : b, other = is_left ? b : a;
      if (!formulas.is_number(factor)) return std::nullopt;
      const auto inner = linear_in_time(formulas, other);
      if (!inner) return std::nullopt;
      const double value = formulas[factor].value;
      if (node.operation == Operation::divide && value == 0.0) return std::nullopt;
      return LinearInTime{node.operation == Operation::divide ? inner->slope / value : inner->slope * value,
                          formulas.apply(node.operation, inner->offset, factor)};
    }
    default: return std::nullopt;
  }
}

}  // namespace

void find_switch_times(System& system) {
  for (Switch& it : system.switches) {
    if (!system.formulas.depends(it.g, on_continuous)) continue;
    const auto form = linear_in_time(system.formulas, it.g);
    it.is_by_time = form && form->slope != 0.0;
    it.has_root = !it.is_by_time;
    if (!it.is_by_time) continue;
    it.slope = form->slope;
    it.offset = form->offset;
  }
}

}  // namespace sfdae::cli
