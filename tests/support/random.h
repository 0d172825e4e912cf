// SPDX-License-Identifier: BSD-3-Clause
// Random numbers of tests, the same in every run.
#ifndef SFDAE_TESTS_RANDOM_H
#define SFDAE_TESTS_RANDOM_H

#include <cstddef>
#include <random>
#include <vector>

namespace sfdae_test {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  std::vector<double> reals(int count, double low, double high) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (double& value : values) value = real(low, high);
    return values;
  }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }

 private:
  std::mt19937 engine_;
};

}  // namespace sfdae_test

#endif
