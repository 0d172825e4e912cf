// SPDX-License-Identifier: BSD-3-Clause
#include "expression/regularized_conditions.h"

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

  // 0 for u <= 0, u, 1 for u > 1. It goes on continuously at both ends even where the branch of the other one is held,
  // whichever: 1 - u where u > 1 holds and u > 0 does not.
  int cut(int u) {
    const int zero = recorder_.constant(0.0), one = recorder_.constant(1.0);
    const int beyond = subtract(u, one);
    layers_.insert(layers_.end(), {u, beyond});
    return choose(u, choose(beyond, one, u), choose(beyond, subtract(one, u), zero));
  }

  // Null: the node is none.
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
  // Null: the condition of a choice stays as it is.
  const RegularizedCondition* regularized(const Condition* condition) const {
    if (condition == nullptr) return nullptr;
    const auto found = regularized_.find(condition->parameter);
    return found != regularized_.end() ? &found->second : nullptr;
  }

  // The part of a surface, once it has been seen with a condition of it, whose g has this copy.
  int part_of(const RegularizedCondition& of, int copy) {
    const auto [place, is_new] = parts_.try_emplace(of.leader, none);
    if (!is_new) return place->second;
    const double width = of.is_opposite ? -of.width : of.width;
    const int scaled = recorder_.apply(Operation::divide, copy, recorder_.constant(2.0 * width));
    return place->second = cut(sum(recorder_.constant(0.5), scaled));
  }

  // Of an operand of a choice at a surface with this part: the same twice, unless it is such a choice itself.
  Sides sides_of(int node, int copy, int part) const {
    const Sides& known = sides_[index(node)];
    return known.part == part ? known : Sides{copy, copy, part};
  }

  bool is_positive(int node) const { return recorder_.number(node).value_or(0.0) > 0.0; }

  int copy_of(const CopiedChoice& copied) {
    const Node node = record_.node(copied.choice);
    Sides& own = sides_[index(copied.choice)];
    bool is_met_above = true, is_met_below = false;
    const Condition* const condition = condition_of(node.a);
    if (const RegularizedCondition* const found = regularized(condition)) {
      own.part = part_of(*found, copied.condition);
      if (found->is_opposite) std::swap(is_met_above, is_met_below);
    } else if (sides_[index(node.a)].part != none) {
      // The condition is itself a choice between numbers: a comparison.
      const Sides& truth = sides_[index(node.a)];
      own.part = truth.part;
      is_met_above = is_positive(truth.above);
      is_met_below = is_positive(truth.below);
    } else {
      if (condition != nullptr && condition->is_of_layer) layers_.push_back(copied.condition);
      return choose(copied.condition, copied.if_met, copied.otherwise);
    }
    const Sides met = sides_of(node.b, copied.if_met, own.part), other = sides_of(node.c, copied.otherwise, own.part);
    own.above = is_met_above ? met.above : other.above;
    own.below = is_met_below ? met.below : other.below;
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
