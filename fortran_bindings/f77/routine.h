// How a routine of the Fortran 77 layer is written: once, for either width of INTEGER, and never throwing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <new>

#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::f77 {

// Values of IERR that the helper routines share.
inline constexpr int argument_error = -3;
inline constexpr int not_converged = -4;       // a singular value decomposition failed, or was given NaN or Inf
inline constexpr int work_too_small = -5;      // LRWORK, or memory
inline constexpr int ranks_contradict = -100;  // a rank decision is not clear
// Those of the initialisation and of a step.
inline constexpr int no_characteristic_values = -22;
inline constexpr int not_reduced = -23;
inline constexpr int no_consistent_value = -24;
inline constexpr int no_initial_derivative = -25;
inline constexpr int values_changed = -26;

// Squares of dimensions have to fit into an int.
inline constexpr std::int64_t largest_dimension = 46340;
inline bool is_dimension(std::int64_t n) { return n >= 1 && n <= largest_dimension; }

// INTEGERs that do not fit into int are no dimension of anything: -1.
template <class Integer>
int to_int(const Integer* value) {
  const std::int64_t wide = *value;
  return wide > std::numeric_limits<int>::max() || wide < std::numeric_limits<int>::min() ? -1
                                                                                          : static_cast<int>(wide);
}

// Runs the body, which returns a value of IERR; nothing escapes.
template <class Body>
int guarded(Body body) noexcept {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return work_too_small;
  } catch (...) {
    return not_converged;
  }
}

// A caller's array with its leading dimension.
struct Array {
  template <class Integer>
  Array(double* first, const Integer* leading) : data(first), ld(to_int(leading)) {}

  bool holds(std::int64_t rows) const { return ld >= rows; }
  core::View view(int rows, int cols) const { return {data, rows, cols, ld}; }

  double* data;
  int ld;
};

struct ConstArray {
  template <class Integer>
  ConstArray(const double* first, const Integer* leading) : data(first), ld(to_int(leading)) {}
  ConstArray(const Array& array) : data(array.data), ld(array.ld) {}

  bool holds(std::int64_t rows) const { return ld >= rows; }
  core::ConstView view(int rows, int cols) const { return {data, rows, cols, ld}; }

  const double* data;
  int ld;
};

// All entries of the view finite.
inline bool is_finite(core::ConstView a) {
  for (int j = 0; j < a.cols; ++j)
    if (!core::all_finite(a.column(j), core::index(a.rows))) return false;
  return true;
}

}  // namespace sfdae::f77

#define SFDAE_F77_EXPORT __attribute__((visibility("default")))

// SFDAE_F77_ROUTINE(result, name, (parameters, in terms of Integer), (their names)) { body }
//
// defines the entries name_, name_64_ and name_64__ of one body, a template over Integer.
#define SFDAE_F77_ROUTINE(result, name, PARAMETERS, ARGUMENTS)                                               \
  namespace name##_entries {                                                                                 \
    template <class Integer>                                                                                 \
    result run PARAMETERS noexcept;                                                                          \
    namespace narrow {                                                                                       \
    using Integer = std::int32_t;                                                                            \
    extern "C" SFDAE_F77_EXPORT result name##_ PARAMETERS noexcept { return run<Integer> ARGUMENTS; }        \
    }                                                                                                        \
    namespace wide {                                                                                         \
    using Integer = std::int64_t;                                                                            \
    extern "C" SFDAE_F77_EXPORT result name##_64_ PARAMETERS noexcept { return run<Integer> ARGUMENTS; }     \
    extern "C" SFDAE_F77_EXPORT __attribute__((alias(#name "_64_"))) result name##_64__ PARAMETERS noexcept; \
    }                                                                                                        \
  }                                                                                                          \
  template <class Integer>                                                                                   \
  result name##_entries::run PARAMETERS noexcept
