// The solution over a whole run: a polynomial for every step, in Chebyshev's basis.
//
// Degrees and bounds are explained in docs/design/error_control.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "linalg/archive.h"

namespace sfdae::core {

class SolutionPieces {
 public:
  // An accepted step from a to b. continues: the last step added is the one before, of the same integration.
  struct Step {
    double a, b;
    bool continues;
    // Writes x at a time from a to b; false if it may be inaccurate.
    std::function<bool(double t, double* x)> sample;
    // Tolerances of x there.
    std::function<double(int i, const double* x)> tolerance;
  };

  // Removes the record after a if a lies within it, and all of it if not or if the direction differs; adds the step.
  void add(int n, const Step& step);

  int n() const { return n_; }
  std::size_t count() const { return pieces_.size(); }
  double start() const { return start_; }  // where there are pieces
  double end() const { return end_; }
  // The piece with the largest deviation from the recorded solution, and the approximate deviation in tolerances: the
  // size of its last two coefficients; 1e300 if one of its values may be inaccurate.
  struct Accuracy {
    double in_tolerances, t;
  };
  Accuracy accuracy() const;

  // Ends the record at t, between start and end; at the start nothing is left.
  void cut(double t);

  // False outside of start ... end. x and xdot: n values, xdot may be null.
  bool evaluate(double t, double* x, double* xdot) const;

  // Archives everything; throws DamagedArchive and is empty then.
  void archive(Archive& archive);

 private:
  // A polynomial on [a, b]; degree + 1 coefficients of every unknown, order after order.
  struct Piece {
    double a, b;
    int degree;
    double left_out;  // in tolerances
    std::size_t first;
  };
  struct Samples;

  void forget();
  // Adds the interval as a whole, or in halves if that reduces the error, as it does with a jump.
  void add_interval(const Step& step, Samples& samples, int halvings);
  double fit(const Step& step, Samples& samples) const;
  bool is_sound() const;

  int n_ = 0;
  double direction_ = 1.0, start_ = 0.0, end_ = 0.0;
  std::vector<Piece> pieces_;
  std::vector<double> coefficients_;
};

}  // namespace sfdae::core
