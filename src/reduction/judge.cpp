// Rank decisions of one reduction.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/judge.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

// The array of level 0 contains A only in the decision on constraints.
Judge::Judge(const TaylorData& data, int level, const Settings& settings, std::vector<RankDecision>* log)
    : settings_(settings),
      log_(log),
      t_(data.t),
      level_(level),
      sizes_{std::max(data.m, data.n),
             data.norm(level),
             data.norm_A(level),
             data.norm_E0(),
             level > 0 ? data.noise_A(level) : data.noise(level),
             data.noise_A(level),
             std::max(data.residual_noise, data.difference_noise.E) * data.norm(level)},
      errors_(sizes_.eps * sizes_.norm),
      constraint_errors_(sizes_.eps_A * sizes_.norm_A) {}

int Judge::take_known_rank(const Question& question, ConstView r) {
  const int count = std::min(r.rows, r.cols);
  const RankSequence& known = *settings_.known_ranks;
  int rank = ranks_.count < known.count ? known.rank[ranks_.count] : count + 1;
  if (rank > count) {
    fits_ = false;
    rank = count;
  }
  // Nothing can be solved with pivots that have vanished.
  while (rank > 0 && r(rank - 1, rank - 1) == 0.0) {
    fits_ = false;
    --rank;
  }
  ranks_.add(rank);
  if (rank > 0 && question.norm > 0.0)
    question.kept = std::min(question.kept, std::fabs(r(rank - 1, rank - 1)) / question.norm);
  if (log_ != nullptr) record_known(question, r, rank);
  return rank;
}

void Judge::record_known(const Question& question, ConstView r, int rank) {
  // The threshold that gives this rank, so that the record reads as that of any other decision.
  RankDecision decision = decide_rank(r.data, rank, r.ld + 1, {0.0, question.norm, 1, 1e-300, 0.0});
  const double unit = question.norm > 0.0 ? question.norm : 1.0;
  decision.rank = rank;
  decision.rows = r.rows;
  decision.cols = r.cols;
  decision.dropped = rank < std::min(r.rows, r.cols) ? std::fabs(r(rank, rank)) / unit : 0.0;
  decision.noise = question.noise / unit;
  const double below = std::max(decision.dropped, decision.noise);
  if (rank > 0 && below > 0.0) decision.gap = decision.kept / below;
  decision.threshold = std::sqrt(decision.kept * below);
  decision.verdict = settings_.rank_tol > 0.0 ? Verdict::user : Verdict::confirmed;
  log(decision, question);
}

int Judge::record(const RankDecision& decision, const Question& question) {
  if (decision.rank > 0) question.kept = std::min(question.kept, decision.kept);
  if (decision.verdict == Verdict::unclear) all_clear_ = false;
  if (log_ != nullptr) log(decision, question);
  ranks_.add(decision.rank);
  return decision.rank;
}

void Judge::log(RankDecision decision, const Question& question) {
  decision.t = t_;
  decision.level = level_;
  decision.stage = question.stage;
  decision.subject = question.subject;
  log_->push_back(decision);
}

int Judge::decide(Question question, ConstView r, ConstView original) {
  if (settings_.known_ranks != nullptr) return take_known_rank(question, r);
  const double least_noise = (question.subject == Subject::constraints ? sizes_.eps_A : sizes_.eps) * question.norm;
  if (settings_.noise == NoiseModel::data) question.noise = least_noise;
  const int count = std::min(r.rows, r.cols);
  const RankScale scale{question.noise, question.norm, std::max({r.rows, r.cols, sizes_.dimension}),
                        settings_.rank_tol, log_ != nullptr ? least_noise : 0.0};
  RankDecision decision = decide_rank(r.data, count, r.ld + 1, scale);
  const bool doubtful = decision.verdict == Verdict::unclear && log_ != nullptr;
  if (original.data != nullptr && count > 0 && (doubtful || settings_.by_singular_values)) {
    const std::vector<double> s = singular_values(original);
    decision = decide_rank(s.data(), count, 1, scale);
    if (doubtful && decision.verdict == Verdict::clear) decision.verdict = Verdict::confirmed;
  }
  decision.rows = r.rows;
  decision.cols = r.cols;
  return record(decision, question);
}

// Thresholds are 10 dimension unit_roundoff norm at least; a block of such columns has sqrt(dimension) times their
// length.
double Judge::negligible(double norm) const {
  if (settings_.known_ranks != nullptr || settings_.rank_tol > 0.0) return -1.0;
  return std::sqrt(static_cast<double>(sizes_.dimension)) * unit_roundoff * norm;
}

int Judge::decide_diagonal_block(ConstView r, ConstView original) {
  // E_0 carries no derivatives: its noise is that of rounding and of residuals only.
  const double noise = std::max(unit_roundoff * sizes_.norm_E0, sizes_.residual_errors);
  const int rank = decide({Subject::stage, level_ + 1, noise, sizes_.norm_E0, pivot_}, r, original);
  errors_ = entering_error() / pivot_;
  constraint_errors_ = entering_constraint_error() / pivot_;
  return rank;
}

int Judge::decide_stage(int stage, ConstView r, ConstView original, double norm) {
  norm = std::max(norm, sizes_.norm_E0);
  const double errors =
      settings_.noise == NoiseModel::pivots ? sizes_.eps * std::max(norm, sizes_.norm) / pivot_ : errors_;
  return decide({Subject::stage, stage, std::max(errors, sizes_.eps * norm), norm, pivot_}, r, original);
}

int Judge::decide_array(const std::vector<double>& s, int rows, int cols) {
  if (settings_.known_ranks != nullptr) {
    const int count = static_cast<int>(s.size());
    const ConstView diagonal{s.data(), count, count, 0};  // of which only the diagonal is read
    const int rank = take_known_rank({Subject::array, 0, sizes_.eps * sizes_.norm, sizes_.norm, pivot_}, diagonal);
    constraint_errors_ = sizes_.eps_A * sizes_.norm_A / pivot_;
    return rank;
  }
  RankDecision decision =
      decide_rank(s.data(), static_cast<int>(s.size()), 1,
                  {sizes_.eps * sizes_.norm, sizes_.norm, std::max(rows, cols), settings_.rank_tol, 0.0});
  decision.rows = rows;
  decision.cols = cols;
  const int rank = record(decision, {Subject::array, 0, sizes_.eps * sizes_.norm, sizes_.norm, pivot_});
  constraint_errors_ = sizes_.eps_A * sizes_.norm_A / pivot_;
  return rank;
}

int Judge::decide_constraints(ConstView r, ConstView original) {
  if (settings_.noise == NoiseModel::pivots) constraint_errors_ = sizes_.eps_A * sizes_.norm_A / pivot_;
  const double noise = std::max(constraint_errors_, sizes_.eps_A * sizes_.norm_A);
  const int rank = decide({Subject::constraints, 0, noise, sizes_.norm_A, kept_constraints_}, r, original);
  has_constraints_ = rank > 0;
  return rank;
}

int Judge::decide_differential(ConstView r, ConstView original) {
  // T2 is as uncertain as A^ relative to its smallest kept value; without constraints it is the identity.
  const double uncertainty = has_constraints_ ? constraint_errors_ / (sizes_.norm_A * kept_constraints_) : 0.0;
  const double noise = std::max(sizes_.norm_E0 * std::max(sizes_.eps, uncertainty), sizes_.residual_errors);
  return decide({Subject::differential, 0, noise, sizes_.norm_E0, kept_differential_}, r, original);
}

}  // namespace sfdae::core
