// Rank decisions of one reduction.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/judge.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"

namespace sfdae::core {

Judge::Judge(const TaylorData& data, int level, const Settings& settings, std::vector<RankDecision>* log)
    : settings_(settings),
      log_(log),
      t_(data.t),
      level_(level),
      dimension_(std::max(data.m, data.n)),
      norm_(data.norm(level)),
      norm_A_(data.norm_A(level)),
      norm_E0_(data.norm_E0()),
      eps_(data.noise(level)),
      residual_errors_(data.residual_noise * norm_),
      errors_(eps_ * norm_),
      constraint_errors_(eps_ * norm_A_) {}

int Judge::take_known_rank(ConstView r, double norm, double& kept) {
  const int count = std::min(r.rows, r.cols);
  const RankSequence& known = *settings_.known_ranks;
  int rank = ranks_.count < known.count ? known.rank[ranks_.count] : count + 1;
  if (rank > count) {
    fits_ = false;
    rank = count;
  }
  ranks_.add(rank);
  if (rank > 0 && norm > 0.0) kept = std::min(kept, std::fabs(r(rank - 1, rank - 1)) / norm);
  return rank;
}

int Judge::record(RankDecision decision, Subject subject, int stage, double& kept) {
  decision.t = t_;
  decision.level = level_;
  decision.stage = stage;
  decision.subject = subject;
  if (decision.rank > 0) kept = std::min(kept, decision.kept);
  if (decision.verdict == Verdict::unclear) all_clear_ = false;
  if (log_ != nullptr) log_->push_back(decision);
  ranks_.add(decision.rank);
  return decision.rank;
}

int Judge::decide(Subject subject, int stage, ConstView r, ConstView original, double noise, double norm,
                  double& kept) {
  if (settings_.known_ranks != nullptr) return take_known_rank(r, norm, kept);
  const double least_noise = eps_ * norm;
  if (settings_.noise == NoiseModel::data) noise = least_noise;
  const int count = std::min(r.rows, r.cols);
  const RankScale scale{noise, norm, std::max({r.rows, r.cols, dimension_}), settings_.rank_tol,
                        log_ != nullptr ? least_noise : 0.0};
  RankDecision decision = decide_rank(r.data, count, r.ld + 1, scale);
  const bool doubtful = decision.verdict == Verdict::unclear && log_ != nullptr;
  if (original.data != nullptr && count > 0 && (doubtful || settings_.by_singular_values)) {
    const std::vector<double> s = singular_values(original);
    decision = decide_rank(s.data(), count, 1, scale);
    if (doubtful && decision.verdict == Verdict::clear) decision.verdict = Verdict::confirmed;
  }
  decision.rows = r.rows;
  decision.cols = r.cols;
  return record(decision, subject, stage, kept);
}

int Judge::decide_diagonal_block(ConstView r, ConstView original) {
  // E_0 carries no derivatives: its noise is that of rounding alone, and of residuals.
  const double noise = std::max(unit_roundoff * norm_E0_, residual_errors_);
  const int rank = decide(Subject::stage, level_ + 1, r, original, noise, norm_E0_, pivot_);
  errors_ = entering_error() / pivot_;
  constraint_errors_ = entering_constraint_error() / pivot_;
  return rank;
}

int Judge::decide_stage(int stage, ConstView r, ConstView original, double norm) {
  norm = std::max(norm, norm_E0_);
  const double errors = settings_.noise == NoiseModel::pivots ? eps_ * std::max(norm, norm_) / pivot_ : errors_;
  return decide(Subject::stage, stage, r, original, std::max(errors, eps_ * norm), norm, pivot_);
}

int Judge::decide_array(const std::vector<double>& s, int rows, int cols) {
  RankDecision decision = decide_rank(s.data(), static_cast<int>(s.size()), 1,
                                      {eps_ * norm_, norm_, std::max(rows, cols), settings_.rank_tol, 0.0});
  decision.rows = rows;
  decision.cols = cols;
  const int rank = record(decision, Subject::array, 0, pivot_);
  constraint_errors_ = eps_ * norm_A_ / pivot_;
  return rank;
}

int Judge::decide_constraints(ConstView r, ConstView original) {
  if (settings_.noise == NoiseModel::pivots) constraint_errors_ = eps_ * norm_A_ / pivot_;
  const double noise = std::max(constraint_errors_, eps_ * norm_A_);
  const int rank = decide(Subject::constraints, 0, r, original, noise, norm_A_, kept_constraints_);
  has_constraints_ = rank > 0;
  return rank;
}

int Judge::decide_differential(ConstView r, ConstView original) {
  // T2 is as uncertain as A^ relative to its smallest kept value; without constraints it is the identity.
  const double uncertainty = has_constraints_ ? constraint_errors_ / (norm_A_ * kept_constraints_) : 0.0;
  const double noise = std::max(norm_E0_ * std::max(eps_, uncertainty), residual_errors_);
  return decide(Subject::differential, 0, r, original, noise, norm_E0_, kept_differential_);
}

}  // namespace sfdae::core
