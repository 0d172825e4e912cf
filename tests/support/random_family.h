// SPDX-License-Identifier: BSD-3-Clause
// Random linear DAEs built backwards from their characteristic values and their solution.
#ifndef SFDAE_TESTS_RANDOM_FAMILY_H
#define SFDAE_TESTS_RANDOM_FAMILY_H

#include <cstdint>
#include <memory>

#include "linear_family.h"

namespace sfdae_test {

struct RandomOptions {
  int max_size = 20;  // bound of m and n
  int mu = -1;        // -1: random, 0..max_mu
  int max_mu = 4;
  int max_undetermined = 2;     // bound of u
  int max_redundant = 2;        // bound of v
  bool singular_blocks = true;  // u and v also from the singular blocks of Kronecker, not only from zeros
  double w = 0.5;               // the planes of P and Q turn at random speeds in [-w, w]
  bool scalings = true;         // P and Q also contain diagonal factors 1 + 0.3 sin(...): not orthogonal
  double sigma = 1.0;           // multiplies the eigenvalues of the dynamics, real parts -0.2 sigma ... -sigma
  double rho = 0.0;             // size of the contradiction in redundant zero rows; no solution if not 0 and v > 0
  int row_decades = 0;          // rows of E, A, f are multiplied by 10^k, random |k| <= row_decades
};

// The same problem for the same arguments on every platform, up to rounding of sine and cosine.
// has_exact() is false if a contradiction is in it.
std::unique_ptr<LinearFamily> random_family(std::uint64_t seed, const RandomOptions& options = {});

// splitmix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014).
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double uniform(double low, double high);  // low <= x < high
  int integer(int low, int high);           // low <= i <= high
 private:
  std::uint64_t state_;
};

}  // namespace sfdae_test

#endif
