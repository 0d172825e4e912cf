// The system Jacobian at a point.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/structure.h"

#include <algorithm>
#include <cmath>

#include "linalg/arena.h"
#include "linalg/dense.h"
#include "linalg/units.h"

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

// The power of two next to 1 / size.
double inverse_power(double size) { return size > 0.0 ? std::exp2(-std::round(std::log2(size))) : 1.0; }

// Entries of one size in rows and columns, as far as that can be had: a few sweeps of maxima, as more change little.
void equilibrate(View a) {
  constexpr int sweeps = 3;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int i = 0; i < a.rows; ++i) {
      const double factor = inverse_power(max_abs(a.block(i, 0, 1, a.cols)));
      for (int j = 0; j < a.cols; ++j) a(i, j) *= factor;
    }
    for (int j = 0; j < a.cols; ++j) {
      const double factor = inverse_power(max_abs(a.columns(j, 1)));
      for (int i = 0; i < a.rows; ++i) a(i, j) *= factor;
    }
  }
}

// Values: derivatives of the equations by the leaves that the tape leads to.
class SystemJacobian {
 public:
  SystemJacobian(const Structure& structure, const Tape& tape, const std::vector<double>& values)
      : structure_(structure), tape_(tape), values_(values), place_(index(structure.signature.size()), -1) {}

  Matrix block(int number) {
    const auto equations = structure_.blocks.equations(number), unknowns = structure_.blocks.unknowns(number);
    for (std::size_t k = 0; k < unknowns.size(); ++k) place_[index(unknowns[k])] = static_cast<int>(k);
    const int size = static_cast<int>(equations.size());
    Matrix J(size, size);
    for (int row = 0; row < size; ++row) fill_row(equations[index(row)], row, J);
    for (int j : unknowns) place_[index(j)] = -1;
    return J;
  }

 private:
  void fill_row(int i, int row, View J) const {
    for (std::size_t e = tape_.first_target[index(i)]; e < tape_.first_target[index(i + 1)]; ++e) {
      const Tape::Leaf& leaf = tape_.targets[e];
      const int column = place_[index(leaf.unknown)];
      if (column >= 0 && structure_.offsets.is_leading(i, {leaf.unknown, leaf.derivative ? 1 : 0}))
        J(row, column) = values_[e];
    }
  }

  const Structure& structure_;
  const Tape& tape_;
  const std::vector<double>& values_;
  std::vector<int> place_;  // of unknowns in the block at hand
};

RankDecision judge(Matrix J, double t, double rank_tol) {
  const int size = J.rows();
  equilibrate(J);
  Arena arena;
  std::vector<int> pivots(index(size));
  std::vector<double> tau(index(size));
  factor_qr_pivoted(J, pivots.data(), tau.data(), arena);
  RankDecision decision =
      decide_rank(J.data(), size, size + 1, {.noise = unit_roundoff, .dimension = size, .rank_tol = rank_tol});
  decision.t = t;
  decision.rows = decision.cols = size;
  return decision;
}

}  // namespace

bool certify_structure(const Structure& structure, TaylorEvaluator& evaluator, double t, const double* jet,
                       double rank_tol, Certificate& certificate) {
  std::vector<double> values(evaluator.tape().targets.size());
  if (!evaluator.entries(t, jet, values.data())) return false;
  SystemJacobian jacobian(structure, evaluator.tape(), values);
  certificate.blocks.clear();
  for (int block = 0; block < structure.blocks.count(); ++block)
    certificate.blocks.push_back(judge(jacobian.block(block), t, rank_tol));
  return true;
}

}  // namespace sfdae::core
