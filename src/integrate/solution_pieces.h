// The solution over a whole run: a polynomial for every step, in Chebyshev's basis.
//
// docs/design/error_control.md has the degrees and the bounds.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "linalg/archive.h"

namespace sfdae::core {

class SolutionPieces {
 public:
  // Of a step from a to b that was accepted. continues: the step before is the last one added, of the same integration.
  struct Step {
    double a, b;
    bool continues;
    // Writes x at a time from a to b; false if it is not known to be accurate.
    std::function<bool(double t, double* x)> sample;
    // Tolerances of x there.
    std::function<double(int i, const double* x)> tolerance;
  };

  // What was recorded after a goes, if a lies within it: everything, if not, or for steps in the other direction.
  void add(int n, const Step& step);

  int n() const { return n_; }
  std::size_t count() const { return pieces_.size(); }
  double start() const { return start_; }  // where there are pieces
  double end() const { return end_; }
  // The piece that differs most from what it was made of, and by how many tolerances, about: what the last two of its
  // coefficients amount to; 1e300 if one of its values is not known to be accurate.
  struct Accuracy {
    double in_tolerances, t;
  };
  Accuracy accuracy() const;

  // It ends at t, between start and end; at the start there is nothing left.
  void cut(double t);

  // False outside of start ... end. x and xdot: n values, xdot may be null.
  bool evaluate(double t, double* x, double* xdot) const;

  // All of it; throws DamagedArchive, after which there is nothing.
  void archive(Archive& archive);

 private:
  // The polynomial holds in [a, b]; degree + 1 coefficients of every unknown, order after order.
  struct Piece {
    double a, b;
    int degree;
    double left_out;  // in tolerances
    std::size_t first;
  };
  struct Samples;

  void forget();
  // Adds the interval as it is, or in halves where that helps, as it does with a jump.
  void add_interval(const Step& step, Samples& samples, int halvings);
  double fit(const Step& step, Samples& samples) const;
  bool is_sound() const;

  int n_ = 0;
  double direction_ = 1.0, start_ = 0.0, end_ = 0.0;
  std::vector<Piece> pieces_;
  std::vector<double> coefficients_;
};

}  // namespace sfdae::core
