// SPDX-License-Identifier: BSD-3-Clause
#include "undifferentiated_problem.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "kronecker_problem.h"

namespace campaign {

namespace {

// x_j(t) = amplitude sin(frequency t + phase), of group `group`.
struct Unknown {
  int group, column;  // of the group
  double amplitude, frequency, phase;
};

struct Row {
  int group, row;
};

struct Groups {
  std::vector<LinearProblem> problems;
  std::vector<Row> rows;
  std::vector<Unknown> unknowns;
};

constexpr int max_group_size = 5;

// Regular, at most 5 unknowns, with a chain of at least two if wanted.
KroneckerSizes group_sizes(bool with_chain, RandomNumbers& random) {
  KroneckerSizes sizes;
  if (with_chain) sizes.nilpotent.push_back(random.integer(2, 4));
  sizes.differential = random.integer(0, std::min(2, max_group_size - sizes.unknowns()));
  if (sizes.unknowns() < max_group_size && random.chance(0.5)) sizes.nilpotent.push_back(1);
  if (sizes.unknowns() == 0) sizes.differential = 1;
  return sizes;
}

template <class Element>
void shuffle(std::vector<Element>& elements, RandomNumbers& random) {
  for (std::size_t i = elements.size(); i > 1; --i)
    std::swap(elements[i - 1], elements[static_cast<std::size_t>(random.integer(0, static_cast<int>(i) - 1))]);
}

Groups random_groups(RandomNumbers& random) {
  constexpr Difficulty easy{10.0, 3.0};
  Groups groups;
  const int count = random.integer(1, 3);
  for (int group = 0; group < count; ++group) {
    const bool with_chain = group == 0 || random.chance(0.5);
    groups.problems.push_back(kronecker_problem(group_sizes(with_chain, random), easy, random).problem);
    const double size = random.chance(0.3) ? 1.0 : random.log_uniform(1.0, 1e8);
    for (int j = 0; j < groups.problems.back().n; ++j) {
      groups.rows.push_back({group, j});
      groups.unknowns.push_back(
          {group, j, size * random.uniform(0.3, 1.0), random.uniform(0.5, 3.0), random.uniform(0.0, 6.28)});
    }
  }
  shuffle(groups.rows, random);
  shuffle(groups.unknowns, random);
  return groups;
}

void write_coefficients(const Groups& groups, double s, int order, TaylorMatrix& E, TaylorMatrix& A) {
  std::vector<TaylorMatrix> E_of, A_of;
  for (const LinearProblem& problem : groups.problems) {
    E_of.emplace_back(problem.m, problem.n);
    A_of.emplace_back(problem.m, problem.n);
    problem.coefficients(s, order, E_of.back(), A_of.back());
  }
  for (int j = 0; j < E.columns; ++j) {
    const Unknown& unknown = groups.unknowns[static_cast<std::size_t>(j)];
    for (int i = 0; i < E.rows; ++i) {
      const Row& row = groups.rows[static_cast<std::size_t>(i)];
      if (row.group != unknown.group) continue;
      E(i, j) = E_of[static_cast<std::size_t>(row.group)](row.row, unknown.column);
      A(i, j) = A_of[static_cast<std::size_t>(row.group)](row.row, unknown.column);
    }
  }
}

// f = E x' - A x.
void write_inhomogeneity(const Groups& groups, double s, int order, std::vector<TaylorSeries>& f) {
  const int n = static_cast<int>(groups.unknowns.size());
  TaylorMatrix E(n, n), A(n, n);
  write_coefficients(groups, s, order, E, A);
  for (int j = 0; j < n; ++j) {
    const Unknown& unknown = groups.unknowns[static_cast<std::size_t>(j)];
    const TaylorSeries slope = derivative(sine(unknown.amplitude, unknown.frequency, unknown.phase, s));
    const TaylorSeries minus_x = sine(-unknown.amplitude, unknown.frequency, unknown.phase, s);
    for (int i = 0; i < n; ++i) {
      add_product(f[static_cast<std::size_t>(i)], E(i, j), slope, order);
      add_product(f[static_cast<std::size_t>(i)], A(i, j), minus_x, order);
    }
  }
}

LinearProblem problem_of(const std::shared_ptr<const Groups>& groups, RandomNumbers& random) {
  const int n = static_cast<int>(groups->unknowns.size());
  LinearProblem problem;
  problem.m = problem.n = n;
  problem.units = Units(n, n);
  for (double& row : problem.units.rows) row = random.log_uniform(1e-6, 1e6);
  problem.constant = true;
  for (const LinearProblem& group : groups->problems) {
    problem.values.mu = std::max(problem.values.mu, group.values.mu);
    problem.values.d += group.values.d;
    problem.values.a += group.values.a;
    problem.constant = problem.constant && group.constant;
  }
  problem.available_order = 0;
  problem.begin = random.uniform(-0.5, 0.5);
  problem.end = problem.begin + 0.5;
  problem.coefficients = [groups](double s, int order, TaylorMatrix& E, TaylorMatrix& A) {
    write_coefficients(*groups, s, order, E, A);
  };
  problem.inhomogeneity = [groups](double s, int order, std::vector<TaylorSeries>& f) {
    write_inhomogeneity(*groups, s, order, f);
  };
  return problem;
}

}  // namespace

UndifferentiatedProblem random_undifferentiated_problem(RandomNumbers& random) {
  const auto groups = std::make_shared<const Groups>(random_groups(random));
  UndifferentiatedProblem result;
  result.problem = problem_of(groups, random);
  for (const Unknown& unknown : groups->unknowns) result.exact.sizes.push_back(unknown.amplitude);
  // The size of an unknown is that of its group.
  for (std::size_t j = 0; j < groups->unknowns.size(); ++j)
    for (const Unknown& other : groups->unknowns)
      if (other.group == groups->unknowns[j].group)
        result.exact.sizes[j] = std::max(result.exact.sizes[j], other.amplitude);
  // Rounding errors of the largest group may reach the others.
  const auto [smallest, largest] = std::minmax_element(result.exact.sizes.begin(), result.exact.sizes.end());
  const double least = result.problem.values.mu >= 3 ? 1e-8 : 1e-7;
  result.tolerance = random.log_uniform(std::max(least, 1e-14 * *largest / *smallest), 1e-3);
  result.exact.x = [groups](double t) {
    std::vector<double> x;
    for (const Unknown& unknown : groups->unknowns)
      x.push_back(unknown.amplitude * std::sin(unknown.frequency * t + unknown.phase));
    return x;
  };
  return result;
}

}  // namespace campaign
