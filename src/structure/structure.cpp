// Certificates of the structural analysis at a point.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/structure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "linalg/arena.h"
#include "linalg/balanced_matrix.h"
#include "linalg/dense.h"
#include "linalg/random.h"
#include "linalg/sparse_lu.h"
#include "linalg/units.h"
#include "structure/system_jacobian.h"

namespace sfdae::core {

BlockVerdict Certificate::verdict(int block) const {
  const RankDecision& decision = blocks[index(block)];
  if (decision.verdict == Verdict::unclear) return BlockVerdict::unclear;
  return decision.rank < decision.cols ? BlockVerdict::singular : BlockVerdict::regular;
}

int Certificate::first(BlockVerdict verdict) const {
  const int count = static_cast<int>(blocks.size());
  int block = 0;
  while (block < count && this->verdict(block) != verdict) ++block;
  return block < count ? block : -1;
}

namespace {

// The power of two next to 1 / size, or the largest one.
double inverse_power(double size) {
  constexpr double largest = std::numeric_limits<double>::max_exponent - 1;
  return size > 0.0 ? std::exp2(std::min(-std::round(std::log2(size)), largest)) : 1.0;
}

// Scales entries to one size in rows and columns, as far as possible, by a few sweeps of maxima: more change little.
void equilibrate(View a) {
  constexpr int sweeps = 3;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int i = 0; i < a.rows; ++i) {
      double largest = 0.0;
      for (int j = 0; j < a.cols; ++j) largest = std::max(largest, std::fabs(a(i, j)));
      const double factor = inverse_power(largest);
      for (int j = 0; j < a.cols; ++j) a(i, j) *= factor;
    }
    for (int j = 0; j < a.cols; ++j) {
      const double factor = inverse_power(max_abs(a.column(j), a.rows));
      for (int i = 0; i < a.rows; ++i) a(i, j) *= factor;
    }
  }
}

// Diagonal blocks of the system Jacobian as it was evaluated.
class DiagonalBlocks {
 public:
  DiagonalBlocks(const Structure& structure, const SystemJacobian& jacobian)
      : structure_(structure), values_(jacobian.values()), entries_(structure, jacobian) {}

  int size(int number) const { return static_cast<int>(structure_.blocks.equations(number).size()); }

  Matrix block(int number) {
    Matrix J(size(number), size(number));
    entries_.for_each(number, [&](int row, int column, int e) { J(row, column) = values_[index(e)]; });
    return J;
  }

  // Differences of the entries to `nearby`, values of all entries as well.
  Matrix changes_of_block(int number, const std::vector<double>& nearby) {
    Matrix changes(size(number), size(number));
    if (nearby.empty()) return changes;
    entries_.for_each(number, [&](int row, int column, int e) {
      changes(row, column) = values_[index(e)] == 0.0 ? 0.0 : nearby[index(e)] - values_[index(e)];
    });
    return changes;
  }

  // The entry of a block of one equation.
  double only_entry(int number) {
    double entry = 0.0;
    entries_.for_each(number, [&](int, int, int e) { entry = values_[index(e)]; });
    return entry;
  }

  SparsePattern sparse_block(int number, std::vector<double>& values) {
    std::vector<std::vector<std::pair<int, double>>> columns(index(size(number)));
    entries_.for_each(
        number, [&](int row, int column, int e) { columns[index(column)].emplace_back(row, values_[index(e)]); });
    return pattern_of(columns, values);
  }

 private:
  const Structure& structure_;
  const std::vector<double>& values_;
  BlockEntries entries_;
};

RankDecision decision_on(const double* R, int size, double t, double rank_tol) {
  RankDecision decision =
      decide_rank(R, size, size + 1, {.noise = unit_roundoff, .dimension = size, .rank_tol = rank_tol});
  decision.t = t;
  decision.rows = decision.cols = size;
  return decision;
}

// Judges a block of one equation without a matrix: semi-discretized equations have thousands of such blocks.
RankDecision judge(double J, double t, double rank_tol) {
  const View block{&J, 1, 1, 1};
  equilibrate(block);
  return decision_on(&J, 1, t, rank_tol);
}

RankDecision judge(Matrix J, double t, double rank_tol) {
  const int size = J.rows();
  equilibrate(J);
  Arena arena;
  std::vector<int> pivots(index(size));
  std::vector<double> tau(index(size));
  factor_qr_pivoted(J, pivots.data(), tau.data(), arena);
  return decision_on(J.data(), size, t, rank_tol);
}

// Larger blocks are factored as sparse matrices: a good estimate of the condition is sufficient. Otherwise the dense
// factorization decides, up to a size that takes seconds.
constexpr int largest_dense_block = 100, largest_in_doubt = 1500;
constexpr double good_condition = 1e-9;

// Judges as if the matrix were factored for the first time: decisions depend on nothing before.
RankDecision judge_sparse(SparseLu<double>& lu, const SparsePattern& pattern, const std::vector<double>& values,
                          double t) {
  lu.forget_pivots();
  const bool is_regular = lu.factor(values.data());
  RankDecision decision;
  decision.t = t;
  decision.rows = decision.cols = decision.rank = pattern.size;
  decision.kept = is_regular ? lu.reciprocal_condition() : 0.0;
  decision.noise = unit_roundoff;
  decision.threshold = good_condition;
  decision.gap = decision.kept / decision.noise;
  decision.verdict = decision.kept >= good_condition ? Verdict::clear : Verdict::unclear;
  return decision;
}

}  // namespace

std::vector<double> moved_by_rounding(const CertifiedPoint& point, std::size_t count, double side) {
  constexpr double few_roundings = 8.0;
  std::minstd_rand generator(1);
  std::vector<double> jet(point.jet, point.jet + count);
  for (std::size_t k = 0; k < count; ++k) {
    const double noise = point.noise != nullptr ? point.noise[k] : 0.0;
    const double size = few_roundings * std::max(unit_roundoff * std::fabs(jet[k]), noise);
    const double part = symmetric_random(generator);
    jet[k] += side * size * (part < 0.0 ? part - 1.0 : part + 1.0) / 2.0;
  }
  return jet;
}

class OrderedBlocks {
 public:
  double noise = 0.0;  // of entries; a good estimate of the condition is sufficient beyond it

  // nearby: entries at a point moved by its rounding errors.
  RankDecision judge_block(DiagonalBlocks& diagonal, int block, const std::vector<double>& nearby, double t,
                           double rank_tol) {
    const int size = diagonal.size(block);
    if (size == 1) return judge(diagonal.only_entry(block), t, rank_tol);
    if (size > largest_dense_block && (rank_tol == 0.0 || rank_tol == noise)) {
      std::vector<double> of_block;
      const SparsePattern pattern = diagonal.sparse_block(block, of_block);
      const RankDecision decision = decision_on_large(block, pattern, std::move(of_block), t);
      if (decision.verdict == Verdict::clear || size > largest_in_doubt) return decision;
    }
    Matrix J = diagonal.block(block);
    RankDecision decision = judge(J, t, rank_tol);
    const bool is_regular = decision.verdict == Verdict::clear && decision.rank == size;
    if (!is_regular && size <= largest_dense_block && rank_tol == 0.0)
      is_regular_in_balanced_units(J, diagonal.changes_of_block(block, nearby), decision);
    return decision;
  }

 private:
  struct Judged {
    SparseLu<double> lu;
    std::vector<double> values;
    RankDecision decision;
  };

  RankDecision decision_on_large(int block, const SparsePattern& pattern, std::vector<double> values, double t) {
    auto place = judged_.find(block);
    if (place == judged_.end()) {
      Judged ordered;
      ordered.lu.analyze(pattern);
      place = judged_.emplace(block, std::move(ordered)).first;
    }
    Judged& judged = place->second;
    if (judged.values.empty() || judged.values != values) {
      judged.values.clear();  // until there is a decision
      judged.decision = judge_sparse(judged.lu, pattern, values, t);
      judged.values = std::move(values);
    }
    judged.decision.t = t;
    return judged.decision;
  }

  std::map<int, Judged> judged_;  // by numbers of blocks
};

StructureJudge::StructureJudge(const Structure& structure, SystemJacobian& jacobian,
                               std::shared_ptr<OrderedBlocks> ordered)
    : structure_(structure),
      jacobian_(jacobian),
      ordered_(ordered ? std::move(ordered) : std::make_shared<OrderedBlocks>()) {}

void StructureJudge::forget_order() { ordered_ = std::make_shared<OrderedBlocks>(); }

bool StructureJudge::certify(TaylorEvaluator& evaluator, const CertifiedPoint& point, double rank_tol,
                             Certificate& certificate) {
  ordered_->noise = evaluator.noise_of_entries();
  rank_tol = std::max(rank_tol, ordered_->noise);
  const std::size_t count = index(structure_.signature.size()) * index(jacobian_.jet_order() + 1);
  // One side may be beyond the domain of a function.
  std::vector<double> nearby;
  for (const double side : {1.0, -1.0})
    if (nearby.empty() && jacobian_.evaluate(evaluator, point.t, moved_by_rounding(point, count, side).data()))
      nearby = jacobian_.values();
  if (!jacobian_.evaluate(evaluator, point.t, point.jet)) return false;
  if (!nearby.empty()) jacobian_.drop_changes_from(nearby);
  DiagonalBlocks diagonal(structure_, jacobian_);
  certificate.blocks.clear();
  certificate.blocks.reserve(index(structure_.blocks.count()));
  for (int block = 0; block < structure_.blocks.count(); ++block) {
    certificate.blocks.push_back(ordered_->judge_block(diagonal, block, nearby, point.t, rank_tol));
    certificate.blocks.back().subject = Subject::block;
    certificate.blocks.back().stage = block;
  }
  return true;
}

bool certify_structure(const Structure& structure, TaylorEvaluator& evaluator, const CertifiedPoint& point,
                       double rank_tol, Certificate& certificate) {
  SystemJacobian jacobian(structure, evaluator.tape());
  return StructureJudge(structure, jacobian).certify(evaluator, point, rank_tol, certificate);
}

}  // namespace sfdae::core
