// An iteration u := u + f(u) that converges linearly, accelerated by its last changes: Anderson's method [WN11].
//
// With the differences of the last changes, df_i = f_(i+1) - f_i and du_i = u_(i+1) - u_i, and g of least |f_k - df g|:
//
//     u_(k+1) = u_k + f_k - (du + df) g
//
// which for linear f is as good as GMRES. Vectors are in units in which all entries count alike.
//
// [WN11] H. F. Walker, P. Ni: Anderson acceleration for fixed-point iterations. SIAM Journal on Numerical Analysis 49,
//        2011.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace sfdae::core {

class AcceleratedIteration {
 public:
  // Room for vectors of so many entries.
  void resize(std::size_t size);
  // A new iteration begins.
  void begin() { count_ = 0, has_last_ = false; }
  // f_k of the plain iteration becomes u_(k+1) - u_k. All calls of one iteration have the same size.
  void accelerate(std::size_t size, double* change);

 private:
  // More gain nothing: the problems of the test set have one to three slow directions.
  static constexpr int depth = 3;
  struct Difference {
    std::vector<double> f, u;
  };

  std::array<Difference, depth> differences_;  // the newest first
  int count_ = 0;
  bool has_last_ = false;
  std::vector<double> last_f_, last_u_;       // the last change of the plain iteration and that made
  std::array<std::vector<double>, depth> q_;  // orthogonalized differences of f
};

}  // namespace sfdae::core
