// SPDX-License-Identifier: BSD-3-Clause
#include "expression/regularized_conditions.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "expression/held_conditions.h"
#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

class CombinedSides {
 public:
  CombinedSides(const Record& record, const std::vector<RegularizedCondition>& which)
      : record_(record), recorder_(record.n()) {
    for (const RegularizedCondition& each : which) {
      conditions_.emplace(record.conditions()[each.condition].parameter, each);
      if (each.condition == each.leader) surfaces_.push_back(each);
    }
  }

  std::shared_ptr<const Record> record() {
    const std::size_t sides = std::size_t{1} << surfaces_.size();
    for (std::size_t above = 0; above < sides; ++above) copy(above);
    for (std::size_t surface = 0; surface < surfaces_.size(); ++surface)
      for (std::size_t above = 0; above < sides; ++above)
        if ((above >> surface & 1U) == 0) mix(surface, combinations_[above | std::size_t{1} << surface], above);
    return with_conditions(recorder_.finish(std::move(combinations_[0].residuals), record_.equation_names()),
                           layers_);
  }

 private:
  // Nodes of the recorder for one combination of sides.
  struct Combination {
    std::vector<int> residuals;
    std::vector<int> parts;  // u of each surface
  };

  int sum(int a, int b) { return recorder_.apply(Operation::add, a, b); }
  int subtract(int a, int b) { return recorder_.apply(Operation::subtract, a, b); }
  int choose(int condition, int a, int b) { return recorder_.apply(Operation::choose, condition, a, b); }

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

  // Records the equations on one side of each surface; above: a bit for each, whether it is the one above.
  void copy(std::size_t above) {
    const auto copy_of = [&](const CopiedChoice& copied) {
      const Condition* const condition = condition_of(record_.node(copied.choice).a);
      if (condition != nullptr) {
        const auto found = conditions_.find(condition->parameter);
        if (found != conditions_.end()) {
          const bool is_above = (above >> surface_of(found->second) & 1U) != 0;
          return is_above != found->second.is_opposite ? copied.if_met : copied.otherwise;
        }
        if (condition->is_of_layer) layers_.push_back(copied.condition);
      }
      return choose(copied.condition, copied.if_met, copied.otherwise);
    };
    const std::vector<int> copies = copy_with_choices(record_, recorder_, copy_of);
    Combination& made = combinations_.emplace_back();
    for (int i = 0; i < record_.m(); ++i) made.residuals.push_back(copies[index(record_.residual(i))]);
    for (const RegularizedCondition& each : surfaces_) {
      const int g = copies[index(record_.conditions()[each.condition].node)];
      const int scaled = recorder_.apply(Operation::divide, g, recorder_.constant(2.0 * each.width));
      made.parts.push_back(sum(recorder_.constant(0.5), scaled));
    }
  }
  std::size_t surface_of(const RegularizedCondition& condition) const {
    std::size_t surface = 0;
    while (surfaces_[surface].leader != condition.leader) ++surface;
    return surface;
  }

  // Replaces the combination with these sides `below` by the mixture across the surface.
  void mix(std::size_t surface, const Combination& above, std::size_t below) {
    Combination& mixed = combinations_[below];
    const int u = mixed.parts[surface];
    for (std::size_t i = 0; i < mixed.residuals.size(); ++i)
      mixed.residuals[i] = mixture(u, above.residuals[i], mixed.residuals[i]);
    for (std::size_t k = surface + 1; k < surfaces_.size(); ++k)
      mixed.parts[k] = mixture(u, above.parts[k], mixed.parts[k]);
  }

  // Returns one value for u <= 0, the other for u > 1, and a mixture of both between. If branches are held that
  // contradict each other (u > 1 holds and u > 0 does not), parts are exchanged, so that the value is continuous at
  // both ends whichever branch is held.
  int mixture(int u, int above, int below) {
    if (above == below) return above;
    const int one = recorder_.constant(1.0), beyond = subtract(u, one), change = subtract(above, below);
    layers_.insert(layers_.end(), {u, beyond});
    const auto part = [&](int of) { return sum(below, recorder_.apply(Operation::multiply, of, change)); };
    return choose(u, choose(beyond, above, part(u)), choose(beyond, part(subtract(one, u)), below));
  }

  const Record& record_;
  Recorder recorder_;
  std::map<int, RegularizedCondition> conditions_;  // by the parameters of conditions
  std::vector<RegularizedCondition> surfaces_;      // their leaders
  std::vector<Combination> combinations_;           // by the sides above
  std::vector<int> layers_;                         // nodes that are conditions of layers
};

}  // namespace

std::shared_ptr<const Record> with_regularized(const Record& record, const std::vector<RegularizedCondition>& which) {
  return CombinedSides(record, which).record();
}

}  // namespace sfdae::core
