// Column-major matrices: views without ownership, and an owning matrix.
//
// Folder linalg: matrices, every call of BLAS and LAPACK, every rank decision, and small helpers of all folders.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

// rows x cols, entry (i, j) at data[i + j * ld]. Copying a view copies the reference.
template <class Scalar>
struct BasicView {
  Scalar* data = nullptr;
  int rows = 0;
  int cols = 0;
  int ld = 1;

  Scalar& operator()(int i, int j) const { return data[i + static_cast<std::ptrdiff_t>(j) * ld]; }
  Scalar* column(int j) const { return data + static_cast<std::ptrdiff_t>(j) * ld; }
  BasicView block(int i, int j, int r, int c) const { return {&(*this)(i, j), r, c, ld}; }
  BasicView columns(int j, int c) const { return {column(j), rows, c, ld}; }
  BasicView top(int r) const { return {data, r, cols, ld}; }
  // A view of mutable entries is also one of constant entries.
  operator BasicView<const Scalar>() const { return {data, rows, cols, ld}; }
};

using View = BasicView<double>;
using ConstView = BasicView<const double>;
using ComplexView = BasicView<std::complex<double>>;

// Leading dimension that avoids cache aliasing of columns, powers of two from 64 on: factorizations were up to 1.5
// times slower with them. 8 doubles are a cache line.
inline int padded_rows(int rows) {
  const bool power_of_two = rows >= 64 && (rows & (rows - 1)) == 0;
  return rows < 1 ? 1 : power_of_two ? rows + 8 : rows;
}

class Matrix {
 public:
  Matrix() = default;
  Matrix(int rows, int cols) : entries_(index(rows) * index(cols) + 1, 0.0), rows_(rows), cols_(cols) {}

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  double* data() { return entries_.data(); }
  const double* data() const { return entries_.data(); }
  double& operator()(int i, int j) { return view()(i, j); }
  double operator()(int i, int j) const { return view()(i, j); }
  View view() { return {entries_.data(), rows_, cols_, rows_ > 0 ? rows_ : 1}; }
  ConstView view() const { return {entries_.data(), rows_, cols_, rows_ > 0 ? rows_ : 1}; }
  operator View() { return view(); }
  operator ConstView() const { return view(); }

 private:
  // Declared first, as members are copied in order: without memory for them the sizes stay, too.
  std::vector<double> entries_;
  int rows_ = 0;
  int cols_ = 0;
};

void copy(ConstView from, View to);
void copy_multiple(double factor, ConstView from, View to);
void multiply_all(double factor, double* values, std::size_t count);
void fill(View a, double value);
Matrix to_matrix(ConstView a);
Matrix transpose(ConstView a);
Matrix identity(int n);

// max |a_ij|, 0 for an empty matrix.
double max_abs(ConstView a);
double max_abs(const double* values, int count);
inline double max_abs(const std::vector<double>& values) {
  return max_abs(values.data(), static_cast<int>(values.size()));
}
// True if no entry is NaN or infinite; raises no floating-point exception.
bool all_finite(const double* values, std::size_t count);

}  // namespace sfdae::core
