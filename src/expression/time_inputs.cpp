// Inputs of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/time_inputs.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "expression/instruction_operands.h"
#include "expression/tape.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

std::vector<int> input_slots(const Tape& tape) {
  const std::vector<char> is_of_time = slots_of_time(tape);
  std::vector<char> is_input(is_of_time.size(), 0);
  for (const Instruction& instruction : tape.of_state.all())
    for_operands(instruction, [&](int slot) {
      if (is_of_time[index(slot)] != 0) is_input[index(slot)] = 1;
    });
  std::vector<int> all;
  for (int slot = 0; slot < tape.num_slots; ++slot)
    if (is_input[index(slot)] != 0) all.push_back(slot);
  return all;
}

// Returns whether an instruction is more than a sum, product, sine or cosine.
bool is_steep(Code code) {
  return code != Code::negate && code != Code::divide_by_number && code != Code::sin_cos && code != Code::copy;
}

}  // namespace

TimeInputs::TimeInputs(const std::vector<const TaylorEvaluator*>& evaluators) {
  for (const TaylorEvaluator* const evaluator : evaluators) {
    const Tape& tape = evaluator->tape();
    if (evaluator->has_source() || tape.time < 0) continue;
    std::vector<int> inputs = input_slots(tape);
    if (inputs.empty()) continue;
    count_ += static_cast<int>(inputs.size());
    are_with_steep_functions_ = are_with_steep_functions_ || tape.of_state.has_other(is_steep);
    TimeEnclosures enclosures(tape, inputs);
    for (std::size_t k = 0; k < inputs.size(); ++k) is_enclosed_.push_back(enclosures.is_enclosed(k) ? 1 : 0);
    parts_.push_back({ValuesOfTime(*evaluator), std::move(enclosures), std::move(inputs)});
  }
  enclosed_.resize(index(count_));
}

void TimeInputs::evaluate(double t, double* values) {
  for (Part& part : parts_) {
    const double* const slots = part.values.at(t);
    for (const int slot : part.inputs) *values++ = slots[slot];
  }
  if (!with_slopes_) return;
  enclose_inputs(Interval::of(t), enclosed_.data());
  for (std::size_t k = 0; k < enclosed_.size(); ++k)
    *values++ = is_enclosed(k) ? 0.5 * (enclosed_[k].slope.low + enclosed_[k].slope.high) : 0.0;
}

bool TimeInputs::are_enclosed() const {
  return std::all_of(is_enclosed_.begin(), is_enclosed_.end(), [](char is) { return is != 0; });
}

void TimeInputs::enclose(Interval t, TimeSeries* all) {
  enclose_inputs(t, all);
  if (!with_slopes_) return;
  for (std::size_t k = 0; k < enclosed_.size(); ++k)
    all[enclosed_.size() + k] = {all[k].slope, all[k].bend + all[k].bend, Interval::entire()};
}

void TimeInputs::enclose_inputs(Interval t, TimeSeries* all) {
  for (Part& part : parts_) {
    part.enclosures.enclose(part.values.numbers(), t);
    for (std::size_t k = 0; k < part.inputs.size(); ++k) *all++ = part.enclosures[k];
  }
}

}  // namespace sfdae::core
