// Anderson's method for an iteration z := z + d(z): the change is made better by what the last two have done [WN11].
//
// For errors e := G e that few eigenvalues of G dominate, such as a pair +-sqrt(q) where x and its derivatives correct
// each other in turn, three changes are enough to see these.
//
// [WN11] H. F. Walker, P. Ni: Anderson Acceleration for Fixed-Point Iterations. SIAM J. Numer. Anal. 49 (2011),
//        1715-1735.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace sfdae::core {

class AndersonMixing {
 public:
  // Of iterations for `size` unknowns.
  void resize(std::size_t size);
  // An iteration begins.
  void begin() { count_ = 0; }
  // d: of the iteration that has come to z; z + d + correction is where it goes on. False: with z + d.
  bool correct(const double* d, double* correction);

 private:
  // Of the last iterations, the newest first: how z has changed, and how d has.
  struct Difference {
    std::vector<double> z, d;
  };

  int count_ = 0;  // changes seen
  Difference differences_[2];
  std::vector<double> d_;     // the last change
  std::vector<double> step_;  // and what z was changed by
};

}  // namespace sfdae::core
