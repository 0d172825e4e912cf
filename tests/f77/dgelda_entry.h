// The entry DGELDA of the Fortran 77 layer with its arguments in one object, for both widths of INTEGER.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "f77/user_functions.h"

namespace sfdae_test {

template <class Integer>
using DgeldaFunction = void(sfdae::f77::MatrixFunction<Integer> edif, sfdae::f77::MatrixFunction<Integer> adif,
                            sfdae::f77::VectorFunction<Integer> fdif, const Integer* neq, double* t,
                            const double* tout, double* x, double* xprime, Integer* cval, Integer* ipar, double* rpar,
                            Integer* iwork, const Integer* liw, double* rwork, const Integer* lrw, double* rtol,
                            double* atol, const Integer* method, Integer* info, Integer* iwarn, Integer* ierr);

}  // namespace sfdae_test

extern "C" {
sfdae_test::DgeldaFunction<std::int32_t> dgelda_;
sfdae_test::DgeldaFunction<std::int64_t> dgelda_64_;
sfdae_test::DgeldaFunction<std::int64_t> dgelda_64__;  // the same, as gfortran -fsecond-underscore calls it
}

namespace sfdae_test {

template <class Integer>
constexpr DgeldaFunction<Integer>* dgelda_entry() {
  if constexpr (sizeof(Integer) == 4) return dgelda_;
  else return dgelda_64_;
}

// An array of Fortran, numbered from 1, between zones that nobody may write to. Filled with garbage: NaN or an odd
// large number.
template <class Number>
class FortranArray {
 public:
  explicit FortranArray(std::int64_t length)
      : storage_(static_cast<std::size_t>(length) + 2 * zone, garbage()), length_(length) {
    const Number mark = guard();
    std::fill_n(storage_.begin(), zone, mark);
    std::fill_n(storage_.end() - zone, zone, mark);
  }

  Number& operator()(std::int64_t i) { return storage_[zone + static_cast<std::size_t>(i - 1)]; }
  const Number& operator()(std::int64_t i) const { return storage_[zone + static_cast<std::size_t>(i - 1)]; }
  Number* data() { return storage_.data() + zone; }
  const Number* data() const { return storage_.data() + zone; }
  std::int64_t length() const { return length_; }
  void fill(Number value) { std::fill_n(data(), length_, value); }

  bool guards_intact() const {
    const Number mark = guard();
    const auto is_mark = [&](const Number& value) { return std::memcmp(&value, &mark, sizeof mark) == 0; };
    return std::all_of(storage_.begin(), storage_.begin() + zone, is_mark) &&
           std::all_of(storage_.end() - zone, storage_.end(), is_mark);
  }
  // Bit by bit, which NaN do not prevent.
  bool same_bits(const FortranArray& other) const {
    return storage_.size() == other.storage_.size() &&
           std::memcmp(storage_.data(), other.storage_.data(), storage_.size() * sizeof(Number)) == 0;
  }

 private:
  static constexpr std::ptrdiff_t zone = 64;
  static Number garbage() {
    if constexpr (std::numeric_limits<Number>::is_integer) return static_cast<Number>(-1234567891);
    else return std::numeric_limits<Number>::quiet_NaN();
  }
  static Number guard() { return static_cast<Number>(987654321); }

  std::vector<Number> storage_;
  std::int64_t length_;
};

// Lengths of the work arrays as documented. q = mxindx + 1.
inline std::int64_t documented_liw(int n, int method) { return method == 1 ? 20 + 2 * n : 20 + 6 * n; }
inline std::int64_t documented_lrw(int n, int method, int maxord = 5, int mxindx = 3) {
  const std::int64_t q = mxindx + 1;
  return method == 1 ? 50 + (21 + maxord + 14 * mxindx) * n + (6 + mxindx + 6 * q * q) * n * n
                     : 20 + (29 + 14 * mxindx) * n + (15 + mxindx + 6 * q * q) * n * n;
}

// The 21 arguments. Arrays have the documented minimal lengths and contain garbage, all options have their defaults.
// Copies are independent, as copies of the arrays have to be.
template <class Integer>
struct Dgelda {
  Dgelda(int neq, int which_method, int maxord = 5, int mxindx = 3)
      : n(neq),
        method(which_method),
        x(neq),
        xprime(neq),
        cval(4),
        iwork(documented_liw(neq, which_method)),
        rwork(documented_lrw(neq, which_method, maxord, mxindx)),
        rtol(neq),
        atol(neq),
        info(20) {
    liw = static_cast<Integer>(iwork.length());
    lrw = static_cast<Integer>(rwork.length());
    info.fill(0);
    if (maxord != 5) info(9) = 1, iwork(3) = static_cast<Integer>(maxord);
    if (mxindx != 3) info(10) = 1, iwork(4) = static_cast<Integer>(mxindx);
    set_tolerance(1e-6);
  }

  void set_tolerance(double tol) { rtol(1) = atol(1) = tol; }
  void functions(sfdae::f77::MatrixFunction<Integer> e, sfdae::f77::MatrixFunction<Integer> a,
                 sfdae::f77::VectorFunction<Integer> f) {
    edif = e, adif = a, fdif = f;
  }

  // IERR
  int call(double tout) {
    entry(edif, adif, fdif, &n, &t, &tout, x.data(), xprime.data(), cval.data(), ipar, rpar, iwork.data(), &liw,
          rwork.data(), &lrw, rtol.data(), atol.data(), &method, info.data(), &iwarn, &ierr);
    return static_cast<int>(ierr);
  }

  bool guards_intact() const {
    return x.guards_intact() && xprime.guards_intact() && cval.guards_intact() && iwork.guards_intact() &&
           rwork.guards_intact() && rtol.guards_intact() && atol.guards_intact() && info.guards_intact();
  }

  // Documented results.
  long steps() const { return static_cast<long>(iwork(11)); }
  long attempts() const { return static_cast<long>(iwork(11) + iwork(14) + iwork(15)); }

  DgeldaFunction<Integer>* entry = dgelda_entry<Integer>();
  sfdae::f77::MatrixFunction<Integer> edif = nullptr, adif = nullptr;
  sfdae::f77::VectorFunction<Integer> fdif = nullptr;
  Integer n;
  double t = 0.0;
  Integer method;
  FortranArray<double> x, xprime;
  FortranArray<Integer> cval, iwork;
  FortranArray<double> rwork, rtol, atol;
  FortranArray<Integer> info;
  Integer liw = 0, lrw = 0, iwarn = 0, ierr = 0;
  Integer* ipar = nullptr;
  double* rpar = nullptr;
};

}  // namespace sfdae_test
