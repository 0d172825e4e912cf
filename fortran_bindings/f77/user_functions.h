// The user's Fortran 77 subroutines EDIF, ADIF, FDIF, called from C++, for either width of INTEGER.
//
//     SUBROUTINE EDIF (N, T, IDIF, E, LDE, IPAR, RPAR, IERR)
//     SUBROUTINE ADIF (N, T, IDIF, A, LDA, IPAR, RPAR, IERR)
//     SUBROUTINE FDIF (N, T, IDIF, F,      IPAR, RPAR, IERR)
//
// store the derivative of order IDIF at T. IERR is 0 on entry; -2: this order is not available; anything else but 0:
// it cannot be computed at this T.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace sfdae::f77 {

template <class Integer>
using MatrixFunction = void (*)(const Integer* n, const double* t, const Integer* order, double* values,
                                const Integer* leading_dimension, Integer* ipar, double* rpar, Integer* ierr);
template <class Integer>
using VectorFunction = void (*)(const Integer* n, const double* t, const Integer* order, double* values,
                                Integer* ipar, double* rpar, Integer* ierr);

// What a call of a user's function comes to.
inline constexpr int function_ok = 0;
inline constexpr int function_failed = -1;  // at this T
inline constexpr int order_not_available = -2;
inline constexpr int wrong_integer_width = -140;  // the function was compiled with another width of INTEGER

// What is in the upper half of INTEGERs of 32 bits, where a user's function compiled for 64 bits looks: zero, so that
// it reads the right value; or all ones, so that it reads a negative number, as a test.
enum class HighWord { zero, ones_in_dimension, ones_in_leading, ones_in_order };

// An INTEGER handed to a user's function. With 32 bits, the word behind it makes a function compiled for 64 bits read
// the right value, and reports afterwards whether one wrote to it.
template <class Integer>
class IntegerArgument;

template <>
class IntegerArgument<std::int32_t> {
 public:
  explicit IntegerArgument(int value) : value_(value) {}
  std::int32_t* address() { return &value_; }
  int value() const { return value_; }
  void watch() { behind_ = watched; }
  void spoil() { behind_ = -1; }
  bool is_overrun() const { return behind_ != watched; }

 private:
  static constexpr std::int32_t watched = 0x5fdae;
  alignas(8) std::int32_t value_;
  volatile std::int32_t behind_ = 0;
};

template <>
class IntegerArgument<std::int64_t> {
 public:
  explicit IntegerArgument(int value) : value_(value) {}
  std::int64_t* address() { return &value_; }
  int value() const {
    return value_ == 0 ? 0 : value_ == order_not_available ? order_not_available : function_failed;
  }
  void watch() {}
  void spoil() {}
  // A negative number of 32 bits above zeros.
  bool is_overrun() const { return value_ > INT32_MAX && value_ <= UINT32_MAX; }

 private:
  std::int64_t value_;
};

// What a user's function has done with its last argument.
template <class Integer>
int code_of(const IntegerArgument<Integer>& ierr) {
  if (ierr.is_overrun()) return wrong_integer_width;
  const int code = ierr.value();
  return code == function_ok || code == order_not_available ? code : function_failed;
}

template <class Integer>
struct UserFunctions {
  MatrixFunction<Integer> edif;
  MatrixFunction<Integer> adif;
  VectorFunction<Integer> fdif;
  Integer* ipar;
  double* rpar;

  // which: 'E', 'A' or 'f'; values: leading_dimension x n, or n.
  int call(char which, int n, double t, int order, double* values, int leading_dimension,
           HighWord high_word = HighWord::zero) const {
    IntegerArgument<Integer> n_argument(n), order_argument(order), leading(leading_dimension), ierr(0);
    if (high_word == HighWord::ones_in_dimension) n_argument.spoil();
    if (high_word == HighWord::ones_in_leading) leading.spoil();
    if (high_word == HighWord::ones_in_order) order_argument.spoil();
    ierr.watch();
    if (which == 'f') fdif(n_argument.address(), &t, order_argument.address(), values, ipar, rpar, ierr.address());
    else
      (which == 'E' ? edif : adif)(n_argument.address(), &t, order_argument.address(), values, leading.address(),
                                   ipar, rpar, ierr.address());
    return code_of(ierr);
  }
};

}  // namespace sfdae::f77
