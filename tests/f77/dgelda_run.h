// SPDX-License-Identifier: BSD-3-Clause
// DGELDA called from C++: arguments with their lengths, and words behind the work arrays that must stay.
#ifndef SFDAE_TESTS_DGELDA_RUN_H
#define SFDAE_TESTS_DGELDA_RUN_H

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "dgelda_entry.h"

template <class Integer>
using DgeldaEntry = sfdae_test::DgeldaFunction<Integer>;

namespace sfdae_test {

// Writes all entries of the derivative of the given order; returns IERR.
using Values = std::function<int(double t, int order, double* values)>;

struct UserData {
  int n;
  Values E, A, f;
  int calls_E = 0, calls_A = 0, calls_f = 0;
};

// Callbacks find their data through RPAR.
template <class Integer>
struct Callbacks {
  static UserData& data(double* rpar) {
    UserData* pointer;
    std::memcpy(&pointer, rpar, sizeof pointer);
    return *pointer;
  }
  static void matrix(const Values& values, const Integer* n, const double* t, const Integer* order, double* to,
                     const Integer* ld, Integer* ierr) {
    std::vector<double> entries(static_cast<std::size_t>(*n * *n), 0.0);
    *ierr = values(*t, static_cast<int>(*order), entries.data());
    for (Integer j = 0; j < *n; ++j)
      for (Integer i = 0; i < *n; ++i) to[i + j * *ld] = entries[static_cast<std::size_t>(i + j * *n)];
  }
  static void edif(const Integer* n, const double* t, const Integer* order, double* E, const Integer* ld, Integer*,
                   double* rpar, Integer* ierr) {
    ++data(rpar).calls_E;
    matrix(data(rpar).E, n, t, order, E, ld, ierr);
  }
  static void adif(const Integer* n, const double* t, const Integer* order, double* A, const Integer* ld, Integer*,
                   double* rpar, Integer* ierr) {
    ++data(rpar).calls_A;
    matrix(data(rpar).A, n, t, order, A, ld, ierr);
  }
  static void fdif(const Integer* n, const double* t, const Integer* order, double* f, Integer*, double* rpar,
                   Integer* ierr) {
    ++data(rpar).calls_f;
    for (Integer i = 0; i < *n; ++i) f[i] = 0.0;
    *ierr = data(rpar).f(*t, static_cast<int>(*order), f);
  }
};

// A problem under way: what a caller keeps between calls. Work arrays start with NaN and large numbers.
template <class Integer = std::int32_t>
class DgeldaRun {
 public:
  DgeldaRun(UserData user_data, int method_number, int max_order = 5, int max_index = 3)
      : user(std::move(user_data)),
        method(method_number),
        n(user.n),
        x(size(n), 0.0),
        xprime(size(n), 0.0),
        info(20, 0),
        cval(4, -77) {
    lrw = static_cast<Integer>(documented_lrw(user.n, method_number, max_order, max_index));
    liw = static_cast<Integer>(documented_liw(user.n, method_number));
    rwork.assign(size(lrw) + guards, std::numeric_limits<double>::quiet_NaN());
    iwork.assign(size(liw) + guards, 123456789);
    if (max_order != 5) set_integer(9, 3, max_order);
    if (max_index != 3) set_integer(10, 4, max_index);
  }
  void set_integer(int flag, int position, int value) {
    info[size(flag) - 1] = 1;
    iwork[size(position) - 1] = value;
  }
  void set_real(int flag, int position, double value) {
    info[size(flag) - 1] = 1;
    rwork[size(position) - 1] = value;
  }
  Integer call(double tout, DgeldaEntry<Integer>* entry) {
    using Functions = Callbacks<Integer>;
    UserData* pointer = &user;
    double rpar = 0.0;
    static_assert(sizeof pointer <= sizeof rpar);
    std::memcpy(&rpar, &pointer, sizeof pointer);
    Integer ipar = 0;
    entry(Functions::edif, Functions::adif, Functions::fdif, &n, &t, &tout, x.data(), xprime.data(), cval.data(),
          &ipar, &rpar, iwork.data(), &liw, rwork.data(), &lrw, rtol.data(), atol.data(), &method, info.data(),
          &iwarn, &ierr);
    return ierr;
  }
  Integer call(double tout) {
    if constexpr (sizeof(Integer) == 4) return call(tout, dgelda_);
    else return call(tout, dgelda_64_);
  }
  bool guards_are_intact() const {
    for (std::size_t i = size(lrw); i < rwork.size(); ++i)
      if (!std::isnan(rwork[i])) return false;
    for (std::size_t i = size(liw); i < iwork.size(); ++i)
      if (iwork[i] != 123456789) return false;
    return true;
  }
  Integer iw(int position) const { return iwork[size(position) - 1]; }
  double rw(int position) const { return rwork[size(position) - 1]; }

  UserData user;
  Integer method, n, liw, lrw, iwarn = 5, ierr = 99;
  double t = 0.0;
  std::vector<double> x, xprime, rtol{1e-6}, atol{1e-6}, rwork;
  std::vector<Integer> info, cval, iwork;

 private:
  template <class Number>
  static std::size_t size(Number value) {
    return static_cast<std::size_t>(value);
  }
  static constexpr std::size_t guards = 64;
};

}  // namespace sfdae_test

#endif
