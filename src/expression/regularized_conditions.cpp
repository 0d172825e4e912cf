// SPDX-License-Identifier: BSD-3-Clause
#include "expression/regularized_conditions.h"

#include <algorithm>
#include <map>
#include <utility>

#include "expression/held_conditions.h"
#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

class Regularization {
 public:
  Regularization(const Record& record, const std::vector<RegularizedCondition>& which)
      : record_(record), recorder_(record.n()), sides_(index(record.num_nodes())) {
    for (const RegularizedCondition& each : which)
      regularized_.emplace(record.conditions()[each.condition].parameter, each);
  }

  std::shared_ptr<const Record> record() {
    const std::vector<int> copies =
        copy_with_choices(record_, recorder_, [this](const CopiedChoice& copied) { return copy_of(copied); });
    std::vector<int> residuals;
    for (int i = 0; i < record_.m(); ++i) residuals.push_back(copies[index(record_.residual(i))]);
    return with_conditions(recorder_.finish(std::move(residuals), record_.equation_names()), layers_);
  }

 private:
  static constexpr int none = -1;
  // The values of a choice on both sides of a surface, and the part of the one above: nodes of the recorder.
  struct Sides {
    int above = none, below = none, part = none;
  };

  int sum(int a, int b) { return recorder_.apply(Operation::add, a, b); }
  int subtract(int a, int b) { return recorder_.apply(Operation::subtract, a, b); }
  int choose(int condition, int a, int b) { return recorder_.apply(Operation::choose, condition, a, b); }
  int mix(const Sides& of) {
    return sum(of.below, recorder_.apply(Operation::multiply, of.part, subtract(of.above, of.below)));
  }

  // Returns 0 for u <= 0, u between, and 1 for u > 1. If branches are held that contradict each other (u > 1 holds and
  // u > 0 does not) it is 1 - u, so that it is continuous at both ends whichever branch is held.
  int cut(int u) {
    const int zero = recorder_.constant(0.0), one = recorder_.constant(1.0);
    const int beyond = subtract(u, one);
    layers_.insert(layers_.end(), {u, beyond});
    return choose(u, choose(beyond, one, u), choose(beyond, subtract(one, u), zero));
  }

  // Returns the condition that a choice has at this node; null: none.
  const Condition* condition_of(int node_of_choice) const {
    const Node node = record_.node(node_of_choice);
    // The sum of g and its parameter, which the recorder may write as a difference.
    if (node.operation != Operation::add && node.operation != Operation::subtract) return nullptr;
    for (const int operand : {node.a, node.b}) {
      const Node leaf = record_.node(operand);
      const int first = record_.num_user_parameters();
      if (leaf.operation == Operation::parameter && leaf.a >= first)
        return &record_.conditions()[index(leaf.a - first)];
    }
    return nullptr;
  }
  // Returns how this condition becomes continuous; null: it stays as it is.
  const RegularizedCondition* regularized(const Condition* condition) const {
    if (condition == nullptr) return nullptr;
    const auto found = regularized_.find(condition->parameter);
    return found != regularized_.end() ? &found->second : nullptr;
  }

  // Returns the part u of the surface that this condition, with g at this node, belongs to.
  int part_of(const RegularizedCondition& of, int copy) {
    const auto [place, is_new] = parts_.try_emplace(of.leader, none);
    if (!is_new) return place->second;
    const double width = of.is_opposite ? -of.width : of.width;
    const int scaled = recorder_.apply(Operation::divide, copy, recorder_.constant(2.0 * width));
    return place->second = cut(sum(recorder_.constant(0.5), scaled));
  }

  // Returns what an operand of a choice is on both sides of the surface with this part: twice the same, unless it is
  // such a choice itself.
  Sides sides_of(int node, int copy, int part) const {
    const Sides& known = sides_[index(node)];
    return known.part == part ? known : Sides{copy, copy, part};
  }

  // Returns the sides of a choice by another condition, which has them if its operands have sides of one part.
  Sides sides_of_choice(const CopiedChoice& copied) {
    const Node node = record_.node(copied.choice);
    const int part = std::max(sides_[index(node.b)].part, sides_[index(node.c)].part);
    if (part == none) return {};
    const Sides met = sides_of(node.b, copied.if_met, part), other = sides_of(node.c, copied.otherwise, part);
    return {choose(copied.condition, met.above, other.above), choose(copied.condition, met.below, other.below), part};
  }

  int copy_of(const CopiedChoice& copied) {
    const Node node = record_.node(copied.choice);
    Sides& own = sides_[index(copied.choice)];
    const Condition* const condition = condition_of(node.a);
    Sides truth = sides_[index(node.a)];  // of the condition, which may be a choice itself
    if (const RegularizedCondition* const found = regularized(condition)) {
      truth = {recorder_.constant(1.0), recorder_.constant(0.0), part_of(*found, copied.condition)};
      if (found->is_opposite) std::swap(truth.above, truth.below);
    } else if (truth.part == none) {
      if (condition != nullptr && condition->is_of_layer) layers_.push_back(copied.condition);
      own = sides_of_choice(copied);
      return choose(copied.condition, copied.if_met, copied.otherwise);
    }
    const Sides met = sides_of(node.b, copied.if_met, truth.part);
    const Sides other = sides_of(node.c, copied.otherwise, truth.part);
    own = {choose(truth.above, met.above, other.above), choose(truth.below, met.below, other.below), truth.part};
    return mix(own);
  }

  const Record& record_;
  Recorder recorder_;
  std::map<int, RegularizedCondition> regularized_;  // by the parameters of conditions
  std::map<std::size_t, int> parts_;                 // by leaders
  std::vector<int> layers_;                          // nodes that are conditions of layers
  std::vector<Sides> sides_;                         // of choices in the record that are continuous
};

}  // namespace

std::shared_ptr<const Record> with_regularized(const Record& record, const std::vector<RegularizedCondition>& which) {
  return Regularization(record, which).record();
}

}  // namespace sfdae::core
