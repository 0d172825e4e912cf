// SPDX-License-Identifier: BSD-3-Clause
#include "circuit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

namespace campaign {

namespace {

int count(const Circuit& circuit, BranchKind kind) {
  return static_cast<int>(std::count_if(circuit.branches.begin(), circuit.branches.end(),
                                        [kind](const Branch& branch) { return branch.kind == kind; }));
}

int unknowns(const Circuit& circuit) {
  return circuit.nodes + count(circuit, BranchKind::inductor) + count(circuit, BranchKind::voltage_source);
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

struct NodalEquations {
  DenseMatrix E, A;
  struct Source {
    int row;
    double amplitude, phase;
  };
  std::vector<Source> sources;  // terms of f
};

// entry += sign at (row, node), for both ends of a branch.
void stamp_column(DenseMatrix& matrix, int node, int column, double value) {
  if (node > 0) matrix(node - 1, column) += value;
}
void stamp_row(DenseMatrix& matrix, int row, int node, double value) {
  if (node > 0) matrix(row, node - 1) += value;
}

void stamp_between(DenseMatrix& matrix, const Branch& branch, double value) {
  if (branch.from > 0) {
    stamp_row(matrix, branch.from - 1, branch.from, value);
    stamp_row(matrix, branch.from - 1, branch.to, -value);
  }
  if (branch.to > 0) {
    stamp_row(matrix, branch.to - 1, branch.to, value);
    stamp_row(matrix, branch.to - 1, branch.from, -value);
  }
}

NodalEquations nodal_equations(const Circuit& circuit) {
  const int n = unknowns(circuit);
  NodalEquations equations{DenseMatrix(n, n), DenseMatrix(n, n), {}};
  int next = circuit.nodes;
  for (const Branch& branch : circuit.branches) {
    switch (branch.kind) {
      case BranchKind::resistor: stamp_between(equations.A, branch, -1.0 / branch.value); break;
      case BranchKind::capacitor: stamp_between(equations.E, branch, branch.value); break;
      case BranchKind::inductor:
      case BranchKind::voltage_source:
        stamp_column(equations.A, branch.from, next, -1.0);
        stamp_column(equations.A, branch.to, next, 1.0);
        stamp_row(equations.A, next, branch.from, 1.0);
        stamp_row(equations.A, next, branch.to, -1.0);
        if (branch.kind == BranchKind::inductor) equations.E(next, next) = branch.value;
        if (branch.kind == BranchKind::voltage_source)
          equations.sources.push_back({next, -branch.value, branch.phase});
        ++next;
        break;
      case BranchKind::current_source:
        if (branch.from > 0) equations.sources.push_back({branch.from - 1, -branch.value, branch.phase});
        if (branch.to > 0) equations.sources.push_back({branch.to - 1, branch.value, branch.phase});
        break;
    }
  }
  return equations;
}

}  // namespace

LinearProblem modified_nodal_analysis(const Circuit& circuit, const CharacteristicValues& values) {
  const auto equations = std::make_shared<const NodalEquations>(nodal_equations(circuit));
  LinearProblem problem;
  problem.m = problem.n = unknowns(circuit);
  problem.values = values;
  problem.units = Units(problem.m, problem.n);
  problem.constant = true;
  problem.end = circuit.duration;
  problem.coefficients = [equations](double, int, TaylorMatrix& E, TaylorMatrix& A) {
    for (std::size_t k = 0; k < E.entries.size(); ++k) {
      E.entries[k][0] = equations->E.entries[k];
      A.entries[k][0] = equations->A.entries[k];
    }
  };
  problem.inhomogeneity = [equations, omega = circuit.omega](double t, int order, std::vector<TaylorSeries>& f) {
    for (const auto& source : equations->sources)
      add_multiple(f[static_cast<std::size_t>(source.row)], 1.0, sine(source.amplitude, omega, source.phase, t),
                   order);
  };
  return problem;
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

namespace {

using Complex = std::complex<long double>;

// Gaussian elimination with row scaling and column pivoting; false if singular. X: right-hand sides, then solutions.
bool solve(MatrixOf<Complex> matrix, MatrixOf<Complex>& X) {
  const int n = matrix.rows;
  for (int i = 0; i < n; ++i) {
    long double largest = 0.0L;
    for (int j = 0; j < n; ++j) largest = std::max(largest, std::abs(matrix(i, j)));
    if (largest == 0.0L) return false;
    for (int j = 0; j < n; ++j) matrix(i, j) /= largest;
    for (int j = 0; j < X.columns; ++j) X(i, j) /= largest;
  }
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(matrix(i, k)) > std::abs(matrix(pivot, k))) pivot = i;
    if (std::abs(matrix(pivot, k)) == 0.0L) return false;
    for (int j = 0; j < n; ++j) std::swap(matrix(k, j), matrix(pivot, j));
    for (int j = 0; j < X.columns; ++j) std::swap(X(k, j), X(pivot, j));
    for (int i = k + 1; i < n; ++i) {
      const Complex factor = matrix(i, k) / matrix(k, k);
      if (factor == Complex(0.0L)) continue;
      for (int j = k; j < n; ++j) matrix(i, j) -= factor * matrix(k, j);
      for (int j = 0; j < X.columns; ++j) X(i, j) -= factor * X(k, j);
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = 0; j < X.columns; ++j) {
      for (int l = k + 1; l < n; ++l) X(k, j) -= matrix(k, l) * X(l, j);
      X(k, j) /= matrix(k, k);
    }
  }
  return true;
}

// (i omega E - A) X = F, entries of E and A changed by a random relative amount up to `change`; empty if singular.
std::vector<Complex> amplitudes(const NodalEquations& equations, double omega, double change, RandomNumbers& random) {
  const int n = equations.E.rows;
  MatrixOf<Complex> matrix(n, n), X(n, 1);
  const auto changed = [&](double entry) {
    return static_cast<long double>(entry) * (1.0L + static_cast<long double>(change * random.uniform(-1.0, 1.0)));
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      matrix(i, j) =
          Complex(-changed(equations.A(i, j)), static_cast<long double>(omega) * changed(equations.E(i, j)));
  for (const auto& source : equations.sources)
    X(source.row, 0) +=
        std::polar(1.0L, static_cast<long double>(source.phase)) * static_cast<long double>(source.amplitude);
  if (!solve(matrix, X)) return {};
  return X.entries;
}

// Norm of (sigma R)^2, R = (lambda E - A)^-1 E, sigma = Re lambda, unknowns measured by their sizes.
double resolvent_norm(const NodalEquations& equations, const std::vector<double>& sizes, Complex lambda) {
  const int n = equations.E.rows;
  MatrixOf<Complex> matrix(n, n), R(n, n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto E = static_cast<long double>(equations.E(i, j)), A = static_cast<long double>(equations.A(i, j));
      matrix(i, j) = lambda * E - A;
      R(i, j) = lambda.real() * E;
    }
  }
  if (!solve(matrix, R)) return 0.0;
  long double largest = 0.0L;
  for (int i = 0; i < n; ++i) {
    long double sum = 0.0L;
    for (int j = 0; j < n; ++j) {
      Complex entry = 0.0L;
      for (int k = 0; k < n; ++k) entry += R(i, k) * R(k, j);
      sum += std::abs(entry) * static_cast<long double>(sizes[static_cast<std::size_t>(j)]);
    }
    largest = std::max(largest, sum / static_cast<long double>(sizes[static_cast<std::size_t>(i)]));
  }
  return static_cast<double>(largest);
}

// Lower bound of how much errors grow: sup over t >= 0 of the norm of exp(J t), J the finite part of the pencil, is at
// least |(sigma (lambda - J)^-1)^2| for all lambda = sigma + i eta with sigma > 0 (Hille, Yosida). The square makes the
// nilpotent part vanish, mu <= 1.
double amplification(const NodalEquations& equations, const std::vector<double>& sizes, double duration) {
  double largest = 0.0;
  for (double decade = 0.0; decade <= 9.0; decade += 0.5) {
    const auto sigma = static_cast<long double>(std::pow(10.0, decade) / duration);
    for (long double slope : {0.0L, 1.0L, 3.0L, 10.0L})
      largest = std::max(largest, resolvent_norm(equations, sizes, Complex(sigma, slope * sigma)));
  }
  return largest;
}

// |X_j|, at least a thousandth of the largest of its kind; empty if there are only zeros.
std::vector<double> sizes_of(const std::vector<Complex>& X, std::size_t nodes) {
  std::array<double, 2> largest{};  // potentials, currents
  for (std::size_t j = 0; j < X.size(); ++j) {
    double& of_kind = largest[j < nodes ? 0 : 1];
    of_kind = std::max(of_kind, static_cast<double>(std::abs(X[j])));
  }
  std::vector<double> sizes;
  for (std::size_t j = 0; j < X.size(); ++j) {
    const double of_kind = largest[j < nodes ? 0 : 1];
    if (of_kind == 0.0) return {};
    sizes.push_back(std::max(static_cast<double>(std::abs(X[j])), 1e-3 * of_kind));
  }
  return sizes;
}

}  // namespace

std::optional<ExactSolution> periodic_solution(const Circuit& circuit, RandomNumbers& random) {
  constexpr double rounding = 1e-16, harmless = 1e-9;
  const NodalEquations equations = nodal_equations(circuit);
  const std::vector<Complex> X = amplitudes(equations, circuit.omega, 0.0, random);
  ExactSolution solution;
  solution.sizes = sizes_of(X, static_cast<std::size_t>(circuit.nodes));
  if (solution.sizes.empty()) return std::nullopt;
  for (int trial = 0; trial < 3; ++trial) {
    const std::vector<Complex> other = amplitudes(equations, circuit.omega, rounding, random);
    if (other.empty()) return std::nullopt;
    for (std::size_t j = 0; j < X.size(); ++j)
      if (!(static_cast<double>(std::abs(other[j] - X[j])) <= harmless * solution.sizes[j])) return std::nullopt;
  }
  solution.amplification = [equations, sizes = solution.sizes, duration = circuit.duration] {
    return amplification(equations, sizes, duration);
  };
  solution.x = [X, omega = circuit.omega](double t) {
    const Complex turned = std::polar(1.0L, static_cast<long double>(omega) * static_cast<long double>(t));
    std::vector<double> x;
    for (const Complex& amplitude : X) x.push_back(static_cast<double>((amplitude * turned).imag()));
    return x;
  };
  return solution;
}

}  // namespace campaign
