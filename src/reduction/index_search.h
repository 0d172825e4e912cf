// A search up the levels of the derivative array at one point, for the smallest at which the hypothesis of
// index_analysis.h holds.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <vector>

#include "reduction/balanced_units.h"
#include "reduction/certificate.h"
#include "reduction/index_analysis.h"
#include "reduction/lockstep_elimination.h"
#include "reduction/null_space_form.h"

namespace sfdae::core {

// Result at level l of the array at one point.
struct LevelResult {
  PointRanks ranks;
  double time_scale = 1.0;
  bool clear = true;
  NoiseModel noise = NoiseModel::carried;  // others are confirmed by perturbations
  RankDecision doubtful;                   // the first unclear decision
  RankDecision weakest;                    // the least clear decision
  double gap = 0.0, kept = 0.0;            // the smallest ones of all decisions
  double residual = 0.0;                   // of the jet relative to its coefficients, 0 for linear problems
  bool follows = true;                     // from the level below
  bool fits_known_ranks = true;            // where ranks were given
  Significance significance;               // of a certificate
  RankSequence known_ranks;                // of a certificate
};

// Input and settings of a search.
struct SearchTask {
  CoefficientSource& problem;
  const AnalysisSettings& settings;
  Arena& arena;
  std::vector<RankDecision>* log = nullptr;  // gets all rank decisions; may be null
  // Units of the source, if they are balanced; time is then in their unit unless something grows faster.
  const BalancedUnits* units = nullptr;
  // Ranks are those of certificates; suspects count as zeros if they are omitted.
  bool certified = false;
  bool omits_suspects = false;
  // Perturbations for certificates, stored to be used by several searches; may be null.
  TrialPerturbations* perturbations = nullptr;
  // Ranks found by norms for the requested level: certificates confirm these ranks, or report that they are not clear.
  const RankSequence* suggested = nullptr;
};

// Result of a search.
struct SearchResult {
  CharacteristicValues values;
  LevelResult last;
  std::vector<CharacteristicValues> levels;  // for messages: result of each level, d that of rank(E T2)
  // Over all levels. Certificates are completed even if they are not clear.
  bool is_clear = true;
  Significance significance;
};

class IndexSearch {
 public:
  IndexSearch(const SearchTask& task, double t);

  // From level 0 up, to the smallest one at which the hypothesis holds.
  SearchResult search(int max_index);
  // A level whose decisions are clear, or confirmed by perturbations.
  LevelResult determine_confirmed(int level);
  // Values at a level known to be mu; v^ of the level below is found on the way.
  CharacteristicValues values_at(int level);
  // True if the ranks are those expected, and stay so under perturbations.
  bool has_ranks(int level, double time_scale, const PointRanks& expected);
  // Decisions of a level, with the ranks of a certificate; none if these do not fit.
  std::vector<RankDecision> decisions_with(int level, const RankSequence& certified, double time_scale);

 private:
  // Decisions that perturbations need not confirm: those that the propagated noise makes clear, or none at all.
  enum class Trust { clear_ones, none };

  LevelResult determine(int level, double time_scale);
  bool is_final(const CharacteristicValues& values, const LevelResult& found);
  bool stands_firm(int level, const LevelResult& found);
  bool holds_above(int level, const CharacteristicValues& values, const PointRanks& ranks);
  void measure(int level, LevelResult& found, std::vector<RankDecision>& decisions);
  bool agrees_with_other_time_scales(int level, const LevelResult& found);
  bool survives_perturbations(int level, double time_scale, const std::vector<RankDecision>& decisions, double margin,
                              Trust trust);
  void doubt_cancellations(int level, LevelResult& found, std::vector<RankDecision>& decisions);
  void perturb(int level, std::minstd_rand& generator);
  bool follows(const CharacteristicValues& below, const CharacteristicValues& values, const PointRanks& ranks) const;
  bool leaves_out_rows() const { return !differentiations_.empty(); }
  int highest_level() const;
  double residual(int level) const;
  CharacteristicValues values_of(int level, const LevelResult& found, int v_hat_below) const;
  void evaluate(int level, double time_scale);
  LevelResult certify(int level);
  LevelResult judge_level(int level);

  SearchTask task_;
  double t_;
  Judge::Settings judging_;
  RowScaling rows_;
  std::vector<int> differentiations_;
  TaylorData data_;
  NullSpaceForm form_;
  std::vector<RankDecision> latest_;
  TrialPerturbations perturbations_;  // used if the task has none
};

// The smallest level at t alone, by norms or, if given, by rank_tol: mu = -1 if no level up to max_index holds or a
// decision is unclear. Throws Failure if the user stops.
CharacteristicValues local_values(const SearchTask& task, double t);

}  // namespace sfdae::core
