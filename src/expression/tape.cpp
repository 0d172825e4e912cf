// Layout of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/tape.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

Code code_of(Operation operation) {
  switch (operation) {
    case Operation::negate: return Code::negate;
    case Operation::add: return Code::add;
    case Operation::subtract: return Code::subtract;
    case Operation::multiply: return Code::multiply;
    case Operation::divide: return Code::divide;
    case Operation::power: return Code::power;
    case Operation::sqrt: return Code::sqrt;
    case Operation::exp: return Code::exp;
    case Operation::log_of_base:
    case Operation::log: return Code::log;
    case Operation::log10: return Code::log10;
    case Operation::sin:
    case Operation::cos: return Code::sin_cos;
    case Operation::sinh:
    case Operation::cosh: return Code::sinh_cosh;
    case Operation::tan: return Code::tan;
    case Operation::tanh: return Code::tanh;
    case Operation::asin: return Code::asin;
    case Operation::acos: return Code::acos;
    case Operation::atan: return Code::atan;
    case Operation::atan2: return Code::atan2;
    case Operation::floor: return Code::floor;
    case Operation::modulo: return Code::modulo;
    case Operation::function: return Code::function;
    default: return Code::choose;
  }
}

std::vector<bool> live_nodes(const Record& record) {
  std::vector<bool> live(index(record.num_nodes()), false);
  for (int i = 0; i < record.m(); ++i) live[index(record.residual(i))] = true;
  for (int i = record.num_nodes() - 1; i >= 0; --i) {
    if (!live[index(i)]) continue;
    const Operands operands = record.operands(i);
    for (int k = 0; k < operands.size(); ++k) live[index(operands[k])] = true;
  }
  return live;
}

namespace {

// Returns whether the derivative is neither a number nor a value that exists anyway.
bool has_slope(Code code) {
  switch (code) {
    case Code::negate:
    case Code::add:
    case Code::subtract:
    case Code::multiply:
    case Code::scale:
    case Code::exp:
    case Code::floor:
    case Code::modulo:
    case Code::copy:
    case Code::choose: return false;
    default: return true;
  }
}

// Returns whether the derivative by the second operand has to be stored.
bool has_second_slope(Code code) { return code == Code::divide || code == Code::atan2 || code == Code::modulo; }

// Missing slots are 0 in lists.
Instruction without_gaps(Instruction instruction) {
  for (int* slot : {&instruction.a, &instruction.b, &instruction.c, &instruction.p, &instruction.q})
    *slot = std::max(*slot, 0);
  return instruction;
}

// Reorders instructions within blocks, so that their data stay in the cache: independent instructions are adjacent,
// grouped by kind. The results do not change.
class InRuns {
 public:
  explicit InRuns(InstructionList& list) : list_(list) {}

  void add(const Instruction& instruction, int num_slots) {
    constexpr std::size_t size = 1024;
    if (block_.size() == size) finish();
    block_of_.resize(std::max(block_of_.size(), index(num_slots)), -1);
    level_of_.resize(block_of_.size(), 0);
    block_.emplace_back(level_of(instruction), instruction);
  }

  void finish() {
    std::stable_sort(block_.begin(), block_.end(), [](const auto& one, const auto& other) {
      return one.first != other.first ? one.first < other.first : one.second.code < other.second.code;
    });
    for (const auto& levelled : block_) list_.push_back(without_gaps(levelled.second));
    block_.clear();
    ++number_;
  }

 private:
  // The slots that it computes get the level, too.
  int level_of(const Instruction& instruction) {
    const bool is_function = instruction.code == Code::function;
    const int arguments = is_function ? instruction.call->function->num_arguments() : 0;
    int level = 0;
    const auto read = [&](int slot) {
      if (slot >= 0 && block_of_[index(slot)] == number_) level = std::max(level, level_of_[index(slot)] + 1);
    };
    const auto write = [&](int slot) {
      if (slot < 0) return;
      block_of_[index(slot)] = number_;
      level_of_[index(slot)] = level;
    };
    if (is_function)
      for (int argument = 0; argument < arguments; ++argument) read(instruction.a + argument);
    else
      for (int slot : {instruction.a, instruction.b, instruction.c}) read(slot);
    for (int slot : {instruction.v, instruction.p, instruction.q}) write(slot);
    for (int argument = 1; argument < arguments; ++argument) write(instruction.p + argument);
    return level;
  }

  InstructionList& list_;
  std::vector<std::pair<int, Instruction>> block_;  // with levels
  int number_ = 0;                                  // of the block
  std::vector<int> block_of_, level_of_;            // of slots
};

// Stores equal lists of edges, and of adjoints of targets, once.
class Forms {
 public:
  explicit Forms(Tape& tape) : tape_(tape) {
    tape_.first_edge.assign(1, 0);
    tape_.first_target_adjoint.assign(1, 0);
  }

  int number_of(const std::vector<Edge>& edges, const std::vector<int>& targets) {
    const std::uint64_t hash = hash_of(edges, targets);
    const auto [first, last] = known_.equal_range(hash);
    for (auto known = first; known != last; ++known)
      if (is_form(known->second, edges, targets)) return known->second;
    const int number = static_cast<int>(tape_.first_edge.size()) - 1;
    tape_.edges.insert(tape_.edges.end(), edges.begin(), edges.end());
    tape_.first_edge.push_back(tape_.edges.size());
    tape_.target_adjoints.insert(tape_.target_adjoints.end(), targets.begin(), targets.end());
    tape_.first_target_adjoint.push_back(tape_.target_adjoints.size());
    known_.emplace(hash, number);
    return number;
  }

 private:
  // FNV-1a with the prime for 64 bits.
  static std::uint64_t hash_of(const std::vector<Edge>& edges, const std::vector<int>& targets) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&hash](int part) { hash = (hash ^ static_cast<std::uint32_t>(part)) * 0x100000001b3u; };
    for (const Edge& edge : edges) {
      add(static_cast<int>(edge.code) * 4 + (edge.is_first ? 2 : 0) + (edge.from_number ? 1 : 0));
      add(edge.from);
      add(edge.to);
    }
    for (int adjoint : targets) add(adjoint);
    return hash ^ (hash >> 32);
  }
  bool is_form(int number, const std::vector<Edge>& edges, const std::vector<int>& targets) const {
    const int *const of_form = tape_.target_adjoints.data() + tape_.first_target_adjoint[index(number)],
                     *const last = tape_.target_adjoints.data() + tape_.first_target_adjoint[index(number + 1)];
    if (!std::equal(of_form, last, targets.begin(), targets.end())) return false;
    const std::size_t first = tape_.first_edge[index(number)];
    if (tape_.first_edge[index(number + 1)] - first != edges.size()) return false;
    return std::equal(edges.begin(), edges.end(), tape_.edges.begin() + static_cast<std::ptrdiff_t>(first),
                      [](const Edge& one, const Edge& other) {
                        return one.code == other.code && one.is_first == other.is_first &&
                               one.from_number == other.from_number && one.from == other.from && one.to == other.to;
                      });
  }

  Tape& tape_;
  std::unordered_multimap<std::uint64_t, int> known_;
};

class Builder {
 public:
  Builder(const Record& record, Tape& tape, NodeSlots& slots)
      : record_(record), tape_(tape), v_of_(slots.v), p_of_(slots.p), q_of_(slots.q), of_state_(tape.of_state) {}

  void lay_out() {
    const std::vector<bool> live = live_nodes(record_);
    for (auto* list : {&v_of_, &p_of_, &q_of_, &partner_}) list->assign(index(record_.num_nodes()), -1);
    for (int i = 0; i < record_.num_nodes(); ++i) {
      if (!live[index(i)]) continue;
      if (is_leaf(record_.node(i).operation)) add_leaf(i);
      else if (record_.node(i).operation == Operation::function) add_function(i);
      else add_instruction(i);
    }
    of_state_.finish();
    renumber();
    for (auto* instructions : {&tape_.of_parameters, &tape_.of_time, &tape_.of_state}) instructions->finish();
    for (int i = 0; i < record_.m(); ++i) tape_.residuals.push_back(slot(record_.residual(i)));
  }

  void add_gradients() {
    touched_.assign(index(tape_.num_slots), -1);
    adjoint_of_.assign(index(tape_.num_slots), -1);
    BackwardWalk backward(record_);
    Forms forms(tape_);
    for (int i = 0; i < record_.m(); ++i) {
      tape_.first_factor.push_back(static_cast<std::uint32_t>(tape_.factors.size()));
      tape_.first_target.push_back(static_cast<std::uint32_t>(tape_.targets.size()));
      add_edges(i, backward.walk(i));
      tape_.form_of.push_back(forms.number_of(edges_, target_adjoints_));
    }
    tape_.factors.push_back(0);
    tape_.first_target.push_back(static_cast<std::uint32_t>(tape_.targets.size()));
    tape_.edges.shrink_to_fit();
    tape_.factors.shrink_to_fit();
    tape_.targets.shrink_to_fit();
    for (auto* first : {&tape_.first_edge, &tape_.first_target_adjoint}) first->shrink_to_fit();
    for (auto* first : {&tape_.first_factor, &tape_.first_target}) first->shrink_to_fit();
    tape_.target_adjoints.shrink_to_fit();
    tape_.form_of.shrink_to_fit();
    tape_.residuals.shrink_to_fit();
    tape_.leaves.shrink_to_fit();
  }

 private:
  // Results of binary instructions come last, as these are executed: they need not be listed.
  void renumber() {
    const auto lists = {&tape_.of_parameters, &tape_.of_time, &tape_.of_state};
    std::vector<int> number(index(tape_.num_slots), 0);
    for (const InstructionList* list : lists)
      for (int result : list->results()) number[index(result)] = -1;
    int next = 0;
    for (int& slot : number)
      if (slot == 0) slot = next++;
    for (const InstructionList* list : lists)
      for (int result : list->results()) number[index(result)] = next++;
    for (InstructionList* list : lists) list->renumber(number);
    for (auto* numbers : {&tape_.constants, &tape_.parameters})
      for (Tape::Number& of_slot : *numbers) of_slot.slot = number[index(of_slot.slot)];
    for (Tape::Leaf& leaf : tape_.leaves) leaf.slot = number[index(leaf.slot)];
    if (tape_.time >= 0) tape_.time = number[index(tape_.time)];
    for (auto* slots : {&v_of_, &p_of_, &q_of_})
      for (int& slot : *slots)
        if (slot >= 0) slot = number[index(slot)];
  }

  int slot(int node) const { return node < 0 ? -1 : v_of_[index(node)]; }
  bool is_number(int node) const { return !varies_in_time(record_.dependence(node)); }

  void add_leaf(int i) {
    const Node node = record_.node(i);
    const int slot = v_of_[index(i)] = tape_.num_slots++;
    switch (node.operation) {
      case Operation::constant: tape_.constants.push_back({slot, node.a}); break;
      case Operation::parameter: tape_.parameters.push_back({slot, node.a}); break;
      case Operation::time: tape_.time = slot; break;
      default: tape_.leaves.push_back({slot, node.a, node.operation == Operation::derivative});
    }
  }

  void add(int i, const Instruction& instruction) {
    if (record_.is_active(i)) return of_state_.add(instruction, tape_.num_slots);
    (is_number(i) ? tape_.of_parameters : tape_.of_time).push_back(without_gaps(instruction));
  }

  void add_instruction(int i) {
    const Node node = record_.node(i);
    Instruction instruction{code_of(node.operation), 0, slot(node.a), slot(node.b), slot(node.c)};
    const bool is_pair = instruction.code == Code::sin_cos || instruction.code == Code::sinh_cosh;
    // sin a and cos a, sinh a and cosh a come from one instruction.
    if (is_pair && share(i)) return;
    choose_variant(node, instruction);
    instruction.v = tape_.num_slots++;
    if (has_slope(instruction.code)) instruction.p = tape_.num_slots++;
    if (has_second_slope(instruction.code)) instruction.q = tape_.num_slots++;
    if (instruction.code == Code::choose && record_.is_active(i)) tape_.has_choices = true;
    v_of_[index(i)] = instruction.v;
    p_of_[index(i)] = instruction.p;
    q_of_[index(i)] = instruction.q;
    if (node.operation == Operation::cos || node.operation == Operation::cosh) {
      v_of_[index(i)] = instruction.p;
      p_of_[index(i)] = instruction.v;
    }
    add(i, instruction);
  }

  // Arguments follow each other, and so do the derivatives by them.
  void add_function(int i) {
    const FunctionCall& call = record_.call(i);
    const int k = call.function->num_arguments();
    Instruction instruction{Code::function};
    instruction.call = &call;
    instruction.a = k == 1 ? slot(call.arguments[0]) : tape_.num_slots;
    instruction.b = instruction.a + 1;
    if (k > 1)
      for (int argument : call.arguments) add(i, {Code::copy, tape_.num_slots++, slot(argument)});
    instruction.v = v_of_[index(i)] = tape_.num_slots++;
    instruction.p = p_of_[index(i)] = tape_.num_slots;
    tape_.num_slots += k;
    add(i, instruction);
  }

  // Takes the value from the instruction of the other one of the pair.
  bool share(int i) {
    const Node node = record_.node(i);
    const bool is_circular = node.operation == Operation::sin || node.operation == Operation::cos;
    auto& partner = is_circular ? partner_[index(node.a)] : hyperbolic_partner(node.a);
    if (partner < 0) {
      partner = i;
      return false;
    }
    v_of_[index(i)] = p_of_[index(partner)];
    p_of_[index(i)] = v_of_[index(partner)];
    return true;
  }

  int& hyperbolic_partner(int node) {
    if (hyperbolic_partner_.empty()) hyperbolic_partner_.assign(index(record_.num_nodes()), -1);
    return hyperbolic_partner_[index(node)];
  }

  // Uses the variants for products and quotients with numbers.
  void choose_variant(const Node& node, Instruction& instruction) const {
    if (instruction.code == Code::divide && is_number(node.b)) instruction.code = Code::divide_by_number;
    if (instruction.code != Code::multiply) return;
    if (is_number(node.a)) std::swap(instruction.a, instruction.b);
    if (is_number(node.a) || is_number(node.b)) instruction.code = Code::scale;
  }

  void add_edges(int equation, const std::vector<Adjoint>& adjoints) {
    edges_.clear();
    target_adjoints_.clear();
    equation_ = equation;
    num_adjoints_ = 0;
    if (!adjoints.empty()) touch(slot(adjoints.front().node));
    for (const Adjoint& adjoint : adjoints) {
      const Node node = record_.node(adjoint.node);
      from_number_ = !varies_in_time(adjoint.dependence);
      if (!is_leaf(node.operation)) {
        add_edges_of(adjoint.node);
        continue;
      }
      tape_.targets.push_back({node.a, node.operation == Operation::derivative});
      target_adjoints_.push_back(adjoint_of_[index(slot(adjoint.node))]);
    }
  }

  void add_edges_of(int i) {
    const Node node = record_.node(i);
    const int p = p_of_[index(i)], q = q_of_[index(i)];
    switch (node.operation) {
      case Operation::negate: return add_edge(EdgeCode::negate, i, node.a, -1);
      case Operation::add: add_edge(EdgeCode::pass, i, node.a, -1); return add_edge(EdgeCode::pass, i, node.b, -1);
      case Operation::subtract:
        add_edge(EdgeCode::pass, i, node.a, -1);
        return add_edge(EdgeCode::negate, i, node.b, -1);
      case Operation::multiply:
        add_edge(is_number(node.b) ? EdgeCode::scale : EdgeCode::multiply, i, node.a, slot(node.b));
        return add_edge(is_number(node.a) ? EdgeCode::scale : EdgeCode::multiply, i, node.b, slot(node.a));
      case Operation::divide:
        add_edge(is_number(node.b) ? EdgeCode::scale : EdgeCode::multiply, i, node.a, p);
        return add_edge(EdgeCode::multiply_negated, i, node.b, q);
      case Operation::exp: return add_edge(EdgeCode::multiply, i, node.a, slot(i));
      case Operation::cos: return add_edge(EdgeCode::multiply_negated, i, node.a, p);
      case Operation::atan2:
        add_edge(EdgeCode::multiply, i, node.a, p);
        return add_edge(EdgeCode::multiply, i, node.b, q);
      case Operation::floor: return;
      case Operation::function: {
        const Operands operands = record_.operands(i);
        for (int k = 0; k < operands.size(); ++k) add_edge(EdgeCode::multiply, i, operands[k], p + k);
        return;
      }
      case Operation::modulo:
        add_edge(EdgeCode::pass, i, node.a, -1);
        return add_edge(EdgeCode::multiply_negated, i, node.b, q);
      case Operation::choose:
        add_edge(EdgeCode::pass_if_positive, i, node.b, slot(node.a));
        return add_edge(EdgeCode::pass_otherwise, i, node.c, slot(node.a));
      default: return add_edge(EdgeCode::multiply, i, node.a, p);
    }
  }

  void add_edge(EdgeCode code, int from, int to, int factor) {
    if (!record_.is_active(to)) return;
    const bool is_first = touch(slot(to));
    const int place = static_cast<int>(tape_.factors.size() - tape_.first_factor.back());
    edges_.push_back({code, is_first, from_number_, adjoint_of_[index(slot(from))], adjoint_of_[index(slot(to))],
                      has_factor(code) ? place : 0});
    if (has_factor(code)) tape_.factors.push_back(std::max(factor, 0));
  }

  // Returns false if it has an adjoint in this equation already.
  bool touch(int slot) {
    if (touched_[index(slot)] == equation_) return false;
    touched_[index(slot)] = equation_;
    adjoint_of_[index(slot)] = num_adjoints_++;
    tape_.num_adjoints = std::max(tape_.num_adjoints, num_adjoints_);
    return true;
  }

  const Record& record_;
  Tape& tape_;
  std::vector<int>&v_of_, &p_of_, &q_of_;
  InRuns of_state_;
  std::vector<int> partner_, hyperbolic_partner_;
  std::vector<Edge> edges_;                // of the equation
  std::vector<int> target_adjoints_;       // of the equation
  std::vector<int> touched_, adjoint_of_;  // slots: by which equation, and the number of its adjoint there
  int num_adjoints_ = 0;
  int equation_ = 0;
  bool from_number_ = false;
};

}  // namespace

Tape::Tape(const Record& record) {
  NodeSlots slots;
  Builder builder(record, *this, slots);
  builder.lay_out();
  builder.add_gradients();
}

NodeSlots slots_of_nodes(const Record& record) {
  NodeSlots slots;
  Tape unused;
  Builder(record, unused, slots).lay_out();
  return slots;
}

}  // namespace sfdae::core
