// Strangeness index and characteristic values of a linear problem.
//
// Folder reduction: the theory only: derivative array, elimination, rank decisions, null-space form, index.
//
// Hypothesis [KM06]: there are mu, a, d, v such that, on the solution interval,
//   1. the left null space of M_mu splits into Z2 (a columns, A2 = Z2^T N of full rank) and Z3 (Z3^T [M N] = 0),
//   2. T2 spans ker A2,
//   3. rank(E T2) = d = m - a - v, and Z1 spans the range of E T2.
// v = v^_mu - v^_(mu-1) with v^_l the number of redundant rows of level l. mu is the smallest level at which this
// holds, at t and at a nearby point: the larger level counts.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "linalg/arena.h"
#include "problem/coefficient_source.h"
#include "reduction/judge.h"
#include "reduction/lockstep_elimination.h"

namespace sfdae::core {

struct CharacteristicValues {
  int mu = -1;  // -1: none found
  int d = -1, a = -1, u = -1, v = -1;
  bool operator==(const CharacteristicValues&) const = default;
};

std::string describe(const CharacteristicValues& values);  // "mu = 1, d = 0, a = 2, u = 0, v = 0"
std::string describe(const RankDecision& decision);        // "rank decision at level 1 (...): kept ..., dropped ..."

// Results of the analysis of the same equations with other parameters.
struct Precedent {
  CharacteristicValues values;  // mu = -1: there is none
  int rank_E = -1;
  bool rank_E_constant = true;
};

// Stricter bounds for decisions by norms alone that lead to redundant equations: a rank that is too small looks the
// same (docs/design/rank_decisions.md).
inline constexpr double gap_of_singular = 1e9, kept_of_singular = 1e-4;

inline constexpr double useful_pivot_at_best = 1e-10;
// Smallest useful pivot for relative tolerances (0: none); docs/design/rank_decisions.md.
double least_useful_pivot(const std::vector<double>& rtol);

struct AnalysisSettings {
  int max_index = 5;
  bool by_svd = false;
  double rank_tol = 0.0;
  double time_scale = 0.0;
  RowScaling rows = RowScaling::each;
  // Smaller pivots, in balanced units, amplify rounding errors beyond the tolerances even if they are certain.
  double least_useful_pivot = useful_pivot_at_best;
  // If rows are left out of the array (CoefficientSource::differentiations), v cannot be read off it. The known d and a
  // are to be found then (mu = -1: none are known).
  CharacteristicValues expected{};
  // If ranks at t are clear and agree with it, neither the next level nor a nearby point is analyzed.
  Precedent precedent{};
  // Derivatives of order mu + 1, or of order 1 for mu = 0, are not requested even if they would be useful.
  bool orders_up_to_mu_only = false;
};

struct IndexAnalysis {
  CharacteristicValues values;
  double t = 0.0;
  double time_scale = 1.0;
  int v_hat = 0;  // redundant rows of level mu
  int rank_E = 0;
  NoiseModel noise = NoiseModel::carried;  // noise model that gives the right ranks
  bool rank_E_constant = true;             // the same at the nearby point
  // Ranks of level mu if a certificate decided and norms alone would not give them; else none.
  RankSequence certified_ranks;
  // Approximate smallest relative change of the data that changes the ranks, if a certificate was made; else 0.
  double distance = 0.0;
  RowScaling rows = RowScaling::each;
  bool by_precedent = false;  // only the ranks at t were examined
};

Precedent precedent_of(const IndexAnalysis& analysis);

// True if an analysis that was read from a checkpoint can be one of m equations in n unknowns.
bool fits_dimensions(const IndexAnalysis& analysis, int m, int n);

// Analysis at t and at a nearby point toward `toward`. Throws Failure: errors of callbacks, SFDAE_INDEX_TOO_HIGH,
// SFDAE_RANK_UNCLEAR, SFDAE_CHARACTERISTICS_CHANGED if t itself is an exceptional point.
// decisions: all that were made, also when it throws.
IndexAnalysis analyze_index(CoefficientSource& problem, double t, double toward, const AnalysisSettings& settings,
                            Arena& arena, std::vector<RankDecision>& decisions);

// The distance of an analysis, by a certificate at t. Throws Failure: errors of callbacks, SFDAE_RANK_UNCLEAR if it
// does not confirm the values known. The units of the source are changed.
double certified_distance(CoefficientSource& source, double t, const IndexAnalysis& known,
                          const AnalysisSettings& settings, Arena& arena);

// True if the values known hold at t although the propagated noise is too large to show it: judged by the effect of
// trial perturbations. Throws Failure if a callback fails.
bool known_values_hold(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                       const IndexAnalysis& known, Arena& arena);

// The smallest level at t alone; never throws for structural reasons: mu = -1 if no level up to max_index holds or a
// decision is unclear.
CharacteristicValues find_local_values(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                                       Arena& arena);

}  // namespace sfdae::core
