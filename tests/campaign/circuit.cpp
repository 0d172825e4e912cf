// SPDX-License-Identifier: BSD-3-Clause
#include "circuit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace campaign {

namespace {

int count(const Circuit& circuit, BranchKind kind) {
  return static_cast<int>(std::count_if(circuit.branches.begin(), circuit.branches.end(),
                                        [kind](const Branch& branch) { return branch.kind == kind; }));
}

// A forest that grows branch by branch.
class Forest {
 public:
  explicit Forest(int nodes) : parent_(static_cast<std::size_t>(nodes) + 1) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  // Adds all branches of a kind that close no loop and returns how many these are.
  int add(const Circuit& circuit, BranchKind kind) {
    int added = 0;
    for (const Branch& branch : circuit.branches) {
      const int from = root(branch.from), to = root(branch.to);
      if (branch.kind != kind || from == to) continue;
      parent_[static_cast<std::size_t>(from)] = to;
      ++added;
    }
    size_ += added;
    return added;
  }
  bool spans(const Circuit& circuit) const { return size_ == circuit.nodes; }

 private:
  int root(int node) const {
    while (parent_[static_cast<std::size_t>(node)] != node) node = parent_[static_cast<std::size_t>(node)];
    return node;
  }

  std::vector<int> parent_;
  int size_ = 0;
};

}  // namespace

int unknowns(const Circuit& circuit) {
  return circuit.nodes + count(circuit, BranchKind::inductor) + count(circuit, BranchKind::voltage_source);
}

std::optional<CharacteristicValues> values_by_topology(const Circuit& circuit) {
  const int sources = count(circuit, BranchKind::voltage_source);
  Forest tree(circuit.nodes);
  if (tree.add(circuit, BranchKind::voltage_source) < sources) return std::nullopt;
  const int tree_capacitors = tree.add(circuit, BranchKind::capacitor);
  tree.add(circuit, BranchKind::resistor);
  const bool inductive_cutset = !tree.spans(circuit);
  const int tree_inductors = tree.add(circuit, BranchKind::inductor);
  if (!tree.spans(circuit)) return std::nullopt;

  // A voltage source that closes a loop with capacitors, the other sources before it included.
  Forest capacitive(circuit.nodes);
  capacitive.add(circuit, BranchKind::capacitor);
  const bool capacitive_loop = capacitive.add(circuit, BranchKind::voltage_source) < sources;

  CharacteristicValues values;
  values.mu = inductive_cutset || capacitive_loop ? 1 : 0;
  values.d = tree_capacitors + count(circuit, BranchKind::inductor) - tree_inductors;
  values.a = unknowns(circuit) - values.d;
  return values;
}

namespace {

// Any value of the range, or one of the series E12 as shops sell them.
double component_value(const std::array<double, 2>& range, bool standard, RandomNumbers& random) {
  constexpr std::array<double, 12> E12 = {1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.3, 3.9, 4.7, 5.6, 6.8, 8.2};
  if (!standard) return random.log_uniform(range[0], range[1]);
  const int first = static_cast<int>(std::lround(std::log10(range[0])));
  const int last = static_cast<int>(std::lround(std::log10(range[1])));
  return E12[static_cast<std::size_t>(random.integer(0, 11))] * std::pow(10.0, random.integer(first, last - 1));
}

// What the components of a circuit are like.
struct Components {
  ComponentRanges ranges;
  bool standard;  // of the series E12
};

Branch random_branch(BranchKind kind, const Components& components, RandomNumbers& random) {
  const ComponentRanges& ranges = components.ranges;
  Branch branch{kind, 0, 0, 1.0};
  switch (kind) {
    case BranchKind::resistor: branch.value = component_value(ranges.resistance, components.standard, random); break;
    case BranchKind::capacitor:
      branch.value = component_value(ranges.capacitance, components.standard, random);
      break;
    case BranchKind::inductor: branch.value = component_value(ranges.inductance, components.standard, random); break;
    case BranchKind::voltage_source: branch.value = random.log_uniform(0.1, 20.0); break;
    case BranchKind::current_source: branch.value = random.log_uniform(1e-6, 1.0); break;
  }
  branch.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
  return branch;
}

BranchKind random_branch_kind(RandomNumbers& random) {
  const double choice = random.uniform();
  if (choice < 0.35) return BranchKind::resistor;
  if (choice < 0.65) return BranchKind::capacitor;
  if (choice < 0.83) return BranchKind::inductor;
  return choice < 0.92 ? BranchKind::voltage_source : BranchKind::current_source;
}

void set_times(Circuit& circuit, const ComponentRanges& ranges, RandomNumbers& random) {
  circuit.duration = random.log_uniform(ranges.duration[0], ranges.duration[1]);
  circuit.omega = 2.0 * std::numbers::pi * random.uniform(0.2, 1.0) / circuit.duration;
}

// Each node hangs on one before it, then some more branches.
Circuit random_graph(const ComponentRanges& ranges, RandomNumbers& random) {
  Circuit circuit;
  circuit.nodes = random.integer(2, 7);
  const Components components{ranges, random.chance(0.5)};
  set_times(circuit, ranges, random);
  const auto add = [&](int from, int to) {
    Branch branch = random_branch(random_branch_kind(random), components, random);
    branch.from = random.chance(0.5) ? from : to;
    branch.to = branch.from == from ? to : from;
    circuit.branches.push_back(branch);
  };
  for (int node = 1; node <= circuit.nodes; ++node) add(node, random.integer(0, node - 1));
  for (int more = random.integer(1, circuit.nodes + 3); more > 0; --more) {
    const int from = random.integer(0, circuit.nodes);
    add(from, (from + random.integer(1, circuit.nodes)) % (circuit.nodes + 1));
  }
  return circuit;
}

}  // namespace

Circuit random_circuit(const ComponentRanges& ranges, RandomNumbers& random) {
  for (;;) {
    const Circuit circuit = random_graph(ranges, random);
    const int sources = count(circuit, BranchKind::voltage_source) + count(circuit, BranchKind::current_source);
    if (sources > 0 && unknowns(circuit) <= 20 && values_by_topology(circuit)) return circuit;
  }
}

Circuit random_divider(RandomNumbers& random) {
  Circuit circuit;
  circuit.nodes = 3;
  set_times(circuit, si_units, random);
  const Components components{si_units, random.chance(0.5)};
  const auto add = [&](BranchKind kind, int from, int to) {
    Branch branch = random_branch(kind, components, random);
    branch.from = from;
    branch.to = to;
    circuit.branches.push_back(branch);
  };
  add(BranchKind::capacitor, 1, 2);
  add(BranchKind::capacitor, 2, 0);
  add(BranchKind::inductor, random.integer(1, 2), 3);
  add(BranchKind::resistor, 3, 0);
  if (random.chance(0.5)) {
    circuit.nodes = 4;
    add(BranchKind::voltage_source, 4, 0);
    add(BranchKind::resistor, 4, 1);
  } else {
    add(BranchKind::current_source, 0, 1);
    add(BranchKind::resistor, 1, 0);
  }
  return circuit;
}

}  // namespace campaign
