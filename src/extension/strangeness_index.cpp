// The exact strangeness index by trial changes of the equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/strangeness_index.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "linalg/index.h"
#include "linalg/random.h"
#include "structure/structure.h"

namespace sfdae::core {

namespace {

// Relative to the effects of all levels on x_j, the second for replaced equations; to the entries; to the effect.
// Chosen, not measured.
constexpr double clear_effect = 1e-8, least = 1e-14, little = 1e-10, same = 1e-3;
// Parts of a sum that matter so little may be rounding errors of its factors. Chosen, not measured.
constexpr double hardly_a_part = 1e-6;

class LevelEffects {
 public:
  // values: derivatives of the rows, in their order.
  LevelEffects(const MinimalExtension& extension, const std::vector<double>& values, const StateChoice& choice,
               double tau)
      : extension_(extension),
        choice_(choice),
        tau_(tau),
        n_(index(extension.n())),
        changes_(n_ * index(extension.highest_level() + 1), 0.0),
        work_(index(extension.num_rows()) + 1) {
    note_changes(values);
  }

  // Effects of changes of each level on the unknowns x_j, with the states given. solve: by the matrix with the states
  // held.
  template <class Solve>
  std::vector<std::vector<double>> all(Solve solve) {
    std::vector<std::vector<double>> effects;
    for (int level = 0; level <= extension_.highest_level(); ++level) effects.push_back(of_level(level, solve));
    return effects;
  }

 private:
  // A change of each derivative of a recorded equation: as large as entries of the rows that it is part of, all with
  // time in units of tau.
  void note_changes(const std::vector<double>& values) {
    const std::vector<int>& first = extension_.first();
    for (int row = 0; row < extension_.num_rows(); ++row) {
      double size = 0.0;
      for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
        const int order = extension_.columns()[index(extension_.column()[index(e)])].order;
        size = std::max(size, std::fabs(values[index(e)]) * std::pow(tau_, -order));
      }
      double largest = 0.0;
      for (const MinimalExtension::Part& part : extension_.parts(row)) largest = std::max(largest, weight(part));
      for (const MinimalExtension::Part& part : extension_.parts(row)) {
        if (weight(part) <= hardly_a_part * largest) continue;
        double& change = changes_[index(part.equation) + index(part.order) * n_];
        change = std::max(change, size / std::fabs(part.factor));
      }
    }
    std::minstd_rand generator(1);
    for (double& change : changes_) change *= 1.5 + 0.5 * symmetric_random(generator);
  }

  double weight(const MinimalExtension::Part& part) const {
    return std::fabs(part.factor) * std::pow(tau_, -part.order);
  }

  template <class Solve>
  std::vector<double> of_level(int level, Solve solve) {
    for (int row = 0; row < extension_.num_rows(); ++row) {
      work_[index(row)] = 0.0;
      for (const MinimalExtension::Part& part : extension_.parts(row))
        if (part.order == level)
          work_[index(row)] += part.factor * changes_[index(part.equation) + index(level) * n_];
    }
    solve(work_.data());
    std::vector<double> effect(n_, 0.0);
    for (int j = 0; j < extension_.n(); ++j)
      if (!choice_.is_state(j)) effect[index(j)] = std::fabs(work_[index(choice_.slot(extension_.column_of(j, 0)))]);
    return effect;
  }

  const MinimalExtension& extension_;
  const StateChoice& choice_;
  double tau_;
  std::size_t n_;
  std::vector<double> changes_;  // by equations and levels
  std::vector<double> work_;
};

// Computes the derivatives at the jet moved by its rounding errors, and perturbs them a little: entries that vanish at
// all solutions differ there.
void change_entries(MinimalExtension& extension, const ExtensionLinearization& linearization) {
  const Jet& jet = linearization.origin();
  const std::vector<double> noise = linearization.noise_of_jet();
  Jet moved = jet;
  // One side may be beyond the domain of a function.
  for (const double side : {1.0, -1.0}) {
    moved.x = moved_by_rounding({jet.t, jet.x.data(), noise.data()}, jet.x.size(), side);
    if (extension.linearize(moved).status == SFDAE_OK) break;
  }
  extension.perturb(little);
}

}  // namespace

// If changes of a level move x_j little compared with others, as for a capacitor in farad or the last level of a deep
// chain, the effect has to be the same with slightly changed entries: rounding errors are not. However small it then
// is, it counts, except for sums of equations, whose factors are rounded.
int strangeness_index(MinimalExtension& extension, ExtensionLinearization& linearization, double tau) {
  if (extension.highest_level() == 0) return 0;
  const StateChoice& choice = linearization.choice();
  LevelEffects effects(extension, linearization.derivatives().values, choice, tau);
  const auto plain = effects.all([&linearization](double* r) { linearization.solve_held(r); });
  // Computed when first needed, which is seldom.
  std::vector<std::vector<double>> changed;
  const auto changed_effect = [&](int level, std::size_t j) {
    if (changed.empty()) {
      change_entries(extension, linearization);
      StateMatrix<double> other(true);
      other.set_choice_of(linearization.held());
      const bool has_other = other.factor({extension, extension.values()}, choice, 0.0);
      changed = has_other ? effects.all([&other](double* r) { other.solve(r); }) : plain;
    }
    return changed[index(level)][j];
  };
  const double least_effect = extension.structure().equations.num_replaced() > 0 ? least : 0.0;
  int mu = 0;
  for (std::size_t j = 0; j < index(extension.n()); ++j) {
    double largest = 0.0;
    for (const std::vector<double>& effect : plain) largest = std::max(largest, effect[j]);
    for (int level = mu + 1; level <= extension.highest_level(); ++level) {
      const double effect = plain[index(level)][j];
      if (effect > clear_effect * largest ||
          (effect > least_effect * largest && std::fabs(changed_effect(level, j) - effect) <= same * effect))
        mu = level;
    }
  }
  return mu;
}

}  // namespace sfdae::core
