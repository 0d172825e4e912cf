// Formulas of all derivatives of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/derivative_formulas.h"

#include <memory>
#include <utility>

#include "expression/all_derivatives.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Most nodes of formulas for each node of the equations and for each derivative: longer formulas take more time than
// sweeps. By judgement.
constexpr std::size_t most_of_nodes = 6, most_of_entries = 4;

}  // namespace

DerivativeFormulas::DerivativeFormulas(RecordedProblem& problem, const ParameterSeries& series,
                                       const std::vector<int>& parameters)
    : problem_(problem) {
  if (problem.source() != nullptr) return;
  std::vector<int> chosen;
  for (int number : parameters)
    if (number >= 0) chosen.push_back(number);
  const TaylorEvaluator& from = problem.evaluator();
  const Tape& tape = from.tape();
  count_ = tape.targets.size() + series.places().size();
  const std::size_t most = most_of_nodes * index(from.record().num_nodes()) + most_of_entries * count_;
  std::shared_ptr<const Record> formulas = all_derivatives(from.record(), tape, chosen, most);
  if (formulas == nullptr || index(formulas->m()) != count_) return;
  for (int e = 0; e < formulas->m(); ++e) {
    is_number_.push_back(varies_in_time(formulas->dependence(formulas->residual(e))) ? 0 : 1);
    if (is_number_.back() == 0) varying_.push_back(e);
  }
  evaluator_.emplace(std::move(formulas));
  take_parameters();
}

void DerivativeFormulas::take_parameters() {
  ++version_;
  const TaylorEvaluator& from = problem_.evaluator();
  for (int i = 0; evaluator_ && i < from.num_parameters(); ++i) evaluator_->set_parameter(i, from.parameter(i));
}

const double* DerivativeFormulas::evaluate(double t, const double* jet, int order) {
  const bool are_numbers_known = known_version_ == version_ && known_order_ == order;
  if (!are_numbers_known) {
    known_version_ = -1;
    values_.resize(count_ * index(order + 1) + 1);
  }
  bool is_evaluated = false;
  const CallbackError error = problem_.gradients_for(t, [&](TaylorEvaluator&) {
    is_evaluated = are_numbers_known ? evaluator_->values_of(varying_, t, jet, order, values_.data())
                                     : evaluator_->values(t, jet, order, values_.data());
    return true;
  });
  if (!is_evaluated || error.status != SFDAE_OK) return nullptr;
  known_version_ = version_;
  known_order_ = order;
  return values_.data();
}

bool DerivativeFormulas::evaluate_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets, int order) {
  if (!problem_.has_lanes(order) || problem_.stop_is_requested()) return false;
  if (!lanes_.evaluate(*evaluator_, LaneEvaluator::points_of(t, jets, order, problem_.n()), order, false))
    return false;
  problem_.count_linearizations(count);
  return true;
}

}  // namespace sfdae::core
