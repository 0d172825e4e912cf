// Scaling by powers of two: square roots of the largest entries, of rows and columns at once, repeated [R01].
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/equilibration.h"

namespace sfdae::core {

namespace {

// Each sweep halves the distances, so that matrices of sizes 1e-300 to 1e300 are within a factor of two after 10.
constexpr int most_sweeps = 10;

bool is_zero(int exponent) { return exponent < exponent_of_zero / 2; }

}  // namespace

template <class Number>
bool Equilibration::compute(const CompressedLines& matrix, const Number* values) {
  line_.assign(index(matrix.lines), 0);
  crossing_.assign(index(matrix.crossings), 0);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    find_largest(matrix, values);
    if (!halve_distances()) break;
  }
  // Removes the remaining factors, so that the largest of each column is between 1 and 2, none above.
  find_largest(matrix, values);
  bool has_zeros = false;
  for (std::size_t i = 0; i < crossing_.size(); ++i)
    if (is_zero(largest_crossing_[i])) has_zeros = true;
    else crossing_[i] -= largest_crossing_[i];
  find_largest(matrix, values);
  for (std::size_t j = 0; j < line_.size(); ++j)
    if (is_zero(largest_in_line_[j])) has_zeros = true;
    else line_[j] -= largest_in_line_[j];
  return !has_zeros;
}

template <class Number>
void Equilibration::find_largest(const CompressedLines& matrix, const Number* values) {
  largest_in_line_.assign(index(matrix.lines), exponent_of_zero);
  largest_crossing_.assign(index(matrix.crossings), exponent_of_zero);
  for (int j = 0; j < matrix.lines; ++j) {
    int largest = exponent_of_zero;
    for (int k = matrix.first[j]; k < matrix.first[j + 1]; ++k) {
      const std::size_t i = index(matrix.crossing[k]);
      const int exponent = binary_exponent(values[k]) + line_[index(j)] + crossing_[i];
      largest = std::max(largest, exponent);
      largest_crossing_[i] = std::max(largest_crossing_[i], exponent);
    }
    largest_in_line_[index(j)] = largest;
  }
}

// False if all are within a factor of two already.
bool Equilibration::halve_distances() {
  bool changes = false;
  const auto halve = [&](std::vector<int>& exponents, const std::vector<int>& largest) {
    for (std::size_t i = 0; i < exponents.size(); ++i) {
      const int half = is_zero(largest[i]) ? 0 : largest[i] / 2;
      exponents[i] -= half;
      changes = changes || half != 0;
    }
  };
  halve(line_, largest_in_line_);
  halve(crossing_, largest_crossing_);
  return changes;
}

template bool Equilibration::compute(const CompressedLines& matrix, const double* values);
template bool Equilibration::compute(const CompressedLines& matrix, const std::complex<double>* values);

}  // namespace sfdae::core
