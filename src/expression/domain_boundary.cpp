// Operations at the boundary of their domain.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/domain_boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "expression/execution.h"
#include "expression/kernel.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// The operand is where the value exists and its derivative of order 1, or of a higher one, does not.
bool is_at_boundary(const Instruction& instruction, const double* slots) {
  const double a = slots[instruction.a];
  switch (instruction.code) {
    case Code::sqrt: return a == 0.0;
    case Code::power: {
      const double exponent = slots[instruction.b];
      return a == 0.0 && exponent > 0.0 && exponent != std::floor(exponent);
    }
    case Code::asin:
    case Code::acos: return std::fabs(a) == 1.0;
    default: return false;
  }
}

// Value and derivative inside of the domain, this far from its boundary.
struct Inside {
  double value, slope;
};
Inside inside(const Instruction& instruction, const double* slots, double distance) {
  switch (instruction.code) {
    case Code::sqrt: return {std::sqrt(distance), 0.5 / std::sqrt(distance)};
    case Code::power: {
      const double exponent = slots[instruction.b];
      return {std::pow(distance, exponent), exponent * std::pow(distance, exponent - 1.0)};
    }
    default: {
      distance = std::min(distance, 1.0);
      const double sign = instruction.code == Code::asin ? 1.0 : -1.0;
      const double a = std::copysign(1.0 - distance, slots[instruction.a]);
      return {sign > 0.0 ? std::asin(a) : std::acos(a), sign / std::sqrt(distance * (2.0 - distance))};
    }
  }
}

bool is_constant(const double* series, int order) {
  return std::all_of(series + 1, series + 1 + order, [](double coefficient) { return coefficient == 0.0; });
}

}  // namespace

double Movement::of(int j, double value) const {
  // Formulations may have unknowns of their own behind those of the user.
  const auto for_unknown = [j](const std::vector<double>& each) { return each[std::min(index(j), each.size() - 1)]; };
  const double relative = for_unknown(rtol), tolerance = relative * std::fabs(value) + for_unknown(atol);
  return tolerance > 0.0 ? tolerance : std::max(relative, std::numeric_limits<double>::epsilon());
}

BoundarySweep::BoundarySweep(const Tape& tape, const Movement& movement, std::vector<double>& slots, int stride)
    : slots_(slots.data()), moved_(slots) {
  // By different parts of tolerances, so that differences of unknowns move, too: multiples of the golden ratio.
  constexpr double golden_ratio = 0.6180339887498949;
  double part = 0.0;
  for (const Tape::Leaf& leaf : tape.leaves) {
    part = std::fmod(part + golden_ratio, 1.0);
    double& value = moved_[index(leaf.slot) * index(stride)];
    value += (0.5 + 0.5 * part) * movement.of(leaf.unknown, value);
  }
  if (tape.time < 0) return;
  // Only tells constants from what depends on t.
  double& t = moved_[index(tape.time) * index(stride)];
  t += std::sqrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::fabs(t));
}

void BoundarySweep::execute(const InstructionList& list, int order, bool with_slopes) {
  const auto binary = [&](auto code, double* a, double* b, double* v) {
    const auto apply = [code](const double* x, const double* y, double* result, int K) {
      if constexpr (code == Code::add) series::add(x, y, result, K);
      else if constexpr (code == Code::subtract) series::subtract(x, y, result, K);
      else if constexpr (code == Code::multiply) series::multiply(x, y, result, K);
      else series::scale(x, y[0], result, K);
    };
    const auto at_moved_point = [this](const double* slot) { return moved_.data() + (slot - slots_); };
    apply(a, b, v, order);
    apply(at_moved_point(a), at_moved_point(b), at_moved_point(v), 0);
  };
  execute_list(list, slots_, binary, [&](const Instruction& other) { execute_other(other, order, with_slopes); });
}

void BoundarySweep::execute_other(const Instruction& instruction, int order, bool with_slopes) {
  if (with_slopes) sfdae::core::execute<true>(instruction, slots_, order);
  else sfdae::core::execute<false>(instruction, slots_, order);
  move(instruction);
  if (!is_at_boundary(instruction, slots_)) return;
  has_found_boundary_ = true;
  correct(instruction, order, with_slopes);
}

// The branch that is taken is that of the point itself.
void BoundarySweep::move(const Instruction& instruction) {
  double* const moved = moved_.data();
  if (instruction.code == Code::choose)
    moved[instruction.v] = moved[series::is_positive(slots_[instruction.a]) ? instruction.b : instruction.c];
  else sfdae::core::execute<false>(instruction, moved, series::Fixed<0>());
}

void BoundarySweep::correct(const Instruction& instruction, int order, bool with_slopes) {
  const double *const a = slots_ + instruction.a, moved = moved_[index(instruction.a)];
  double *const v = slots_ + instruction.v, *const p = slots_ + instruction.p;
  const bool has_constant_operand = moved == a[0] && is_constant(a, order);
  if (has_constant_operand) {
    std::fill(v + 1, v + 1 + order, 0.0);
    if (with_slopes) std::fill(p, p + 1 + order, 0.0);
    return;
  }
  double distance = std::fabs(moved - a[0]);
  // The operand itself is not defined at the moved point.
  if (!std::isfinite(distance) || distance == 0.0) distance = std::sqrt(std::numeric_limits<double>::epsilon());
  const Inside nearby = inside(instruction, slots_, distance);
  moved_[index(instruction.v)] = nearby.value;
  if (with_slopes && !std::isfinite(p[0])) p[0] = nearby.slope;
}

}  // namespace sfdae::core
