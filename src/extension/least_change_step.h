// The least change of unknowns that satisfies linear equations: minimize dx^T W dx / 2 + g^T dx so that J dx = r, J
// sparse of full row rank. One sparse matrix is factored: [W J^T; J 0], or J if it is square and leaves no choice.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/sparse_lu.h"

namespace sfdae::core {

class LeastChangeStep {
 public:
  // J by rows. Unknowns that are held do not change.
  struct Equations {
    const std::vector<int>& first;
    const std::vector<int>& column;
    int unknowns;
    int rows() const { return static_cast<int>(first.size()) - 1; }
  };
  // decides_all: as many equations as unknowns, none of which are held.
  void analyze(const Equations& equations, bool decides_all = false);
  // False if there is no such change, or more than one.
  bool factor(const Equations& equations, const std::vector<double>& values, const std::vector<double>& W,
              const std::vector<char>& is_held);
  // dx: in: -g, out: dx. r: rows() values.
  void solve(const Equations& equations, const std::vector<char>& is_held, double* dx, const double* r);
  double reciprocal_condition() { return lu_.reciprocal_condition(); }

 private:
  void note_square(const Equations& equations);
  void note_symmetric(const Equations& equations);
  void refine();

  bool decides_all_ = false;
  SparsePattern pattern_;
  std::vector<int> upper_, lower_;  // of the entries of J: their places in J^T and J
  SparseLu<double> lu_;
  std::vector<double> values_, b_, z_;
};

}  // namespace sfdae::core
