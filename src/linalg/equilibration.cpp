// Scaling by powers of two: square roots of the largest entries, of rows and columns at once, repeated [R01]. Where that leaves
// sizes far apart, means of all entries first [CR72].
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/equilibration.h"

namespace sfdae::core {

namespace {

// Each sweep halves the distances, so that matrices of sizes 1e-300 to 1e300 are within a factor of two after 10.
constexpr int most_sweeps = 10;

constexpr int sweeps_of_means = 60;

bool is_zero(int exponent) { return exponent < exponent_of_zero / 2; }

}  // namespace

template <class Number>
bool Equilibration::compute(const CompressedLines& matrix, const Number* values) {
  const std::size_t count = index(matrix.first[matrix.lines]);
  exponents_.resize(count);
  for (std::size_t k = 0; k < count; ++k) exponents_[k] = binary_exponent(values[k]);
  const bool is_first = line_.size() != index(matrix.lines) || crossing_.size() != index(matrix.crossings);
  if (is_first) {
    line_.assign(index(matrix.lines), 0);
    crossing_.assign(index(matrix.crossings), 0);
  }
  const bool has_no_zeros = scale_largest(matrix);
  // Means are led astray by values that are rounding errors, largest entries are not: these come first. Later matrices
  // profit from the means of the first.
  const double distance = distance_from_one(matrix);
  const bool is_far = is_first ? distance > far_apart_ : distance > far_apart_ + 2.0 * distance_;
  if (is_first || is_far) distance_ = distance;
  if (!is_far) return has_no_zeros;
  const std::vector<int> line = line_, crossing = crossing_;
  scale_means(matrix);
  scale_largest(matrix);
  distance_ = distance_from_one(matrix);
  if (distance_ > 0.75 * distance) {
    line_ = line;
    crossing_ = crossing;
    distance_ = distance;
  }
  return has_no_zeros;
}

bool Equilibration::scale_largest(const CompressedLines& matrix) {
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    find_largest(matrix);
    if (!halve_distances()) break;
  }
  // What is left, so that the largest of each column is between 1 and 2, none above.
  find_largest(matrix);
  bool has_zeros = false;
  for (std::size_t i = 0; i < crossing_.size(); ++i)
    if (is_zero(largest_crossing_[i])) has_zeros = true;
    else crossing_[i] -= largest_crossing_[i];
  find_largest(matrix);
  for (std::size_t j = 0; j < line_.size(); ++j)
    if (is_zero(largest_in_line_[j])) has_zeros = true;
    else line_[j] -= largest_in_line_[j];
  return !has_zeros;
}

// Of the exponents from 0, on average over the entries.
double Equilibration::distance_from_one(const CompressedLines& matrix) const {
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < matrix.lines; ++j)
    for (int k = matrix.first[j]; k < matrix.first[j + 1]; ++k) {
      if (is_zero(exponents_[index(k)])) continue;
      sum += std::abs(exponents_[index(k)] + line_[index(j)] + crossing_[index(matrix.crossing[k])]);
      ++count;
    }
  return count > 0 ? sum / count : 0.0;
}

// Least squares of the exponents, lines and crossings by turns.
void Equilibration::scale_means(const CompressedLines& matrix) {
  const auto divide = [](double relaxation, int sum, int count) {
    return count > 0 ? static_cast<int>(std::lround(relaxation * sum / count)) : 0;
  };
  for (int sweep = 0; sweep < sweeps_of_means; ++sweep) {
    const double relaxation = sweep < sweeps_of_means - 10 ? 1.85 : 1.0;
    sums_.assign(index(matrix.crossings), 0);
    counts_.assign(index(matrix.crossings), 0);
    for (int j = 0; j < matrix.lines; ++j) {
      int sum = 0, count = 0;
      for (int k = matrix.first[j]; k < matrix.first[j + 1]; ++k) {
        if (is_zero(exponents_[index(k)])) continue;
        sum += exponents_[index(k)] + line_[index(j)] + crossing_[index(matrix.crossing[k])];
        ++count;
      }
      line_[index(j)] -= divide(relaxation, sum, count);
      for (int k = matrix.first[j]; k < matrix.first[j + 1]; ++k) {
        if (is_zero(exponents_[index(k)])) continue;
        const std::size_t i = index(matrix.crossing[k]);
        sums_[i] += exponents_[index(k)] + line_[index(j)] + crossing_[i];
        ++counts_[i];
      }
    }
    for (std::size_t i = 0; i < crossing_.size(); ++i) crossing_[i] -= divide(relaxation, sums_[i], counts_[i]);
  }
}

void Equilibration::find_largest(const CompressedLines& matrix) {
  largest_in_line_.assign(index(matrix.lines), exponent_of_zero);
  largest_crossing_.assign(index(matrix.crossings), exponent_of_zero);
  for (int j = 0; j < matrix.lines; ++j) {
    int largest = exponent_of_zero;
    for (int k = matrix.first[j]; k < matrix.first[j + 1]; ++k) {
      const std::size_t i = index(matrix.crossing[k]);
      const int exponent = exponents_[index(k)] + line_[index(j)] + crossing_[i];
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
