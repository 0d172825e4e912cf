// Anderson's method for an iteration z := z + d(z): the last two changes improve the next one [WN11].
//
// If few eigenvalues of G dominate the errors e := G e, such as a pair +-sqrt(q) where x and its derivatives correct
// each other alternately, three changes suffice to identify them.
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
  // Memory for iterations with `size` unknowns.
  void resize(std::size_t size);
  // An iteration begins.
  void begin() { count_ = 0; }
  // d: change at z. True: the iteration continues with z + d + correction; false: with z + d.
  bool correct(const double* d, double* correction);

 private:
  // Differences of z and d between the last iterations, the newest first.
  struct Difference {
    std::vector<double> z, d;
  };

  int count_ = 0;  // changes seen
  Difference differences_[2];
  std::vector<double> d_;     // the last change
  std::vector<double> step_;  // and the last change of z with its correction
};

}  // namespace sfdae::core
