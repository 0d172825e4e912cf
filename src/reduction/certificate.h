// Ranks of one level of the derivative array with a certificate: by elimination in lockstep with perturbed copies of
// the data.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <vector>

#include "problem/taylor_data.h"
#include "reduction/balanced_units.h"
#include "reduction/judge.h"
#include "reduction/lockstep_elimination.h"
#include "reduction/null_space_form.h"

namespace sfdae::core {

// Random numbers for the copies, the same ones at every level and point: made once.
class TrialPerturbations {
 public:
  const double* first(std::size_t count);

 private:
  std::minstd_rand generator_{1};
  std::vector<double> values_;
};

struct CertifiedRanks {
  PointRanks ranks;
  RankSequence list;         // as known ranks of an elimination of this level
  RankSequence list_by_svd;  // of one by singular values
  Significance significance;
};

struct CertificateSettings {
  const BalancedUnits& units;
  TrialPerturbations& random;
  bool omits_suspects = false;  // rounding errors among them count as zeros always
  double rank_tol = 0.0;        // > 0: the user decides, relative to the largest entry of each matrix judged
  // Ranks found by norms, to be confirmed unchanged (known_rank_elimination.h); null: all ranks are searched for. Every
  // row has to be in every level.
  const RankSequence* suggested = nullptr;
};

// data: in balanced units.
CertifiedRanks certified_ranks(const TaylorData& data, int level, const CertificateSettings& settings);

// Rank of lambda E - A for a lambda that is no eigenvalue: n - u = m - v of a problem with constant coefficients, from
// one matrix, better conditioned than the chain of decisions. The largest rank that is clear for one lambda: fast and
// slow parts need different ones.
int clear_pencil_rank(const TaylorData& data, const BalancedUnits& units);

// True if the rows of [M N] of a level are clearly independent, again from one matrix: then nothing is redundant, v^ =
// 0.
bool has_independent_rows(const TaylorData& data, int level, const BalancedUnits& units);

}  // namespace sfdae::core
