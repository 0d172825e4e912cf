// Operations at the boundary of their domain.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/domain_boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "expression/execution.h"
#include "expression/kernel.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Far above all factors of coefficients, but products of several of them do not overflow.
constexpr double other_number = 1e60;

// Distance of the operand outside of the domain; negative: it is inside. NaN: there is no boundary.
double outside(const Instruction& instruction, const double* slots) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const double a = slots[instruction.a];
  switch (instruction.code) {
    case Code::sqrt:
    case Code::log:
    case Code::log10: return -a;
    case Code::power: {
      const double exponent = slots[instruction.b];
      return exponent > 0.0 && exponent != std::floor(exponent) ? -a : none;
    }
    case Code::asin:
    case Code::acos: return std::fabs(a) - 1.0;
    default: return none;
  }
}

// The operand inside of the domain, this far from its boundary.
double operand_inside(const Instruction& instruction, const double* slots, double distance) {
  if (instruction.code != Code::asin && instruction.code != Code::acos) return distance;
  return std::copysign(1.0 - std::min(distance, 1.0), slots[instruction.a]);
}

// The value is O(s^(r e)) if the operand is O(s^r): e.
double exponent_of(const Instruction& instruction, const double* slots) {
  return instruction.code == Code::power ? slots[instruction.b] : 0.5;
}

double value_at_boundary(const Instruction& instruction, const double* slots) {
  if (instruction.code == Code::asin) return std::asin(std::copysign(1.0, slots[instruction.a]));
  return instruction.code == Code::acos ? std::acos(std::copysign(1.0, slots[instruction.a])) : 0.0;
}

bool is_logarithm(const Instruction& instruction) {
  return instruction.code == Code::log || instruction.code == Code::log10;
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

BoundarySweep::BoundarySweep(const Tape& tape, const Movement& movement, std::vector<double>& slots, int stride,
                             Unknowns unknowns)
    : slots_(slots.data()), moved_(slots), unknowns_(unknowns) {
  // By different parts of tolerances, so that differences of unknowns move, too: multiples of the golden ratio.
  constexpr double golden_ratio = 0.6180339887498949;
  double part = 0.0;
  for (const Tape::Leaf& leaf : tape.leaves) {
    part = std::fmod(part + golden_ratio, 1.0);
    double& value = moved_[index(leaf.slot) * index(stride)];
    value += (0.5 + 0.5 * part) * movement.of(leaf.unknown, value);
  }
  if (tape.time < 0) return;
  // Only distinguishes constants from values that depend on t.
  double& t = moved_[index(tape.time) * index(stride)];
  t += std::sqrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::fabs(t));
}

void BoundarySweep::execute(const InstructionList& list, int order, bool with_slopes, bool of_state) {
  is_of_state_ = of_state;
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
  if (outside(instruction, slots_) >= 0.0) correct(instruction, order, with_slopes);
}

// The moved point takes the branch of the point itself.
void BoundarySweep::move(const Instruction& instruction) {
  double* const moved = moved_.data();
  if (instruction.code == Code::choose)
    moved[instruction.v] = moved[series::is_positive(slots_[instruction.a]) ? instruction.b : instruction.c];
  else sfdae::core::execute<false>(instruction, moved, series::Fixed<0>());
}

void BoundarySweep::correct(const Instruction& instruction, int order, bool with_slopes) {
  const double *const a = slots_ + instruction.a, moved = moved_[index(instruction.a)];
  double *const v = slots_ + instruction.v, *const p = slots_ + instruction.p;
  const double excess = outside(instruction, slots_);
  double distance = std::fabs(moved - a[0]);
  const bool is_log = is_logarithm(instruction);
  if (moved == a[0] && is_constant(a, order)) {
    if (excess > 0.0 || is_log) return;
    has_found_boundary_ = true;
    std::fill(v + 1, v + 1 + order, 0.0);
    if (with_slopes) std::fill(p, p + 1 + order, 0.0);
    return;
  }
  // The operand itself is not defined at the moved point.
  if (!std::isfinite(distance) || distance == 0.0) distance = std::sqrt(std::numeric_limits<double>::epsilon());
  if (excess > (is_of_state_ ? distance : 0.0)) return;
  has_found_boundary_ = true;
  const double own_slope = with_slopes ? p[0] : 0.0;
  const bool exist = set_coefficients(instruction, order);
  if (with_slopes) {
    set_slopes(instruction, order, distance, exist);
    if (std::isfinite(own_slope)) p[0] = own_slope;
  }
  if (excess > 0.0 && !is_log) v[0] = value_at_boundary(instruction, slots_);
  const double moved_operand =
      std::exchange(moved_[index(instruction.a)], operand_inside(instruction, slots_, distance));
  sfdae::core::execute<false>(instruction, moved_.data(), series::Fixed<0>());
  moved_[index(instruction.a)] = moved_operand;
  if (!is_log) return;
  has_unknowns_ = true;
  v[0] = in_place(moved_[index(instruction.v)]);
}

double BoundarySweep::in_place(double near) const {
  if (unknowns_ == Unknowns::near) return near;
  return unknowns_ == Unknowns::other ? -other_number : std::numeric_limits<double>::quiet_NaN();
}

// Sets the coefficients of the value from the first one on. Returns whether they are finite.
bool BoundarySweep::set_coefficients(const Instruction& instruction, int order) {
  const double* const a = slots_ + instruction.a;
  double* const v = slots_ + instruction.v;
  const double exponent = exponent_of(instruction, slots_);
  int r = 1;
  while (r <= order && a[r] == 0.0) ++r;
  // All that is known of r is that it is above the order: from 1/2 on products of such values do not show.
  const bool is_log = is_logarithm(instruction);
  const bool exist = !is_log && (r > order ? exponent >= 0.5 : r * exponent == std::floor(r * exponent));
  for (int k = 1; k <= order; ++k) {
    if (!is_log && k < r * exponent) v[k] = 0.0;
    else if (!exist) v[k] = std::numeric_limits<double>::quiet_NaN();
    else {
      v[k] = in_place(0.0);
      has_unknowns_ = true;
    }
  }
  return exist;
}

// Slopes of the nearby point inside of the domain.
void BoundarySweep::set_slopes(const Instruction& instruction, int order, double distance, bool exist) {
  double &a = slots_[instruction.a], *const v = slots_ + instruction.v, *const p = slots_ + instruction.p;
  const double own = a;
  const std::vector<double> values(v, v + 1 + order);
  a = operand_inside(instruction, slots_, distance);
  sfdae::core::execute<true>(instruction, slots_, order);
  a = own;
  std::copy(values.begin(), values.end(), v);
  const bool has_none = unknowns_ == Unknowns::none && is_logarithm(instruction);
  if (has_none || !exist) std::fill(p + (has_none ? 0 : 1), p + 1 + order, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace sfdae::core
