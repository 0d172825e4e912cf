// Shared libraries with the entry dgelda_ (DGELDA of Fortran 77, INTEGER of 32 bits), loaded at run time, and
// problems solved through it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dlfcn.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "f77/user_functions.h"
#include "replay.h"

namespace sfdae_bench {

using Dgelda = void (*)(sfdae::f77::MatrixFunction<int> edif, sfdae::f77::MatrixFunction<int> adif,
                        sfdae::f77::VectorFunction<int> fdif, const int* neq, double* t, const double* tout,
                        double* x, double* xprime, int* cval, int* ipar, double* rpar, int* iwork, const int* liw,
                        double* rwork, const int* lrw, double* rtol, double* atol, const int* method, int* info,
                        int* iwarn, int* ierr);

class DgeldaLibrary {
 public:
  // Throws what dlopen or dlsym complains about. RTLD_LOCAL: routines of two libraries have the same names.
  explicit DgeldaLibrary(const std::string& file) : handle_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL), &dlclose) {
    if (!handle_) throw std::runtime_error(dlerror());
    dgelda = reinterpret_cast<Dgelda>(dlsym(handle_.get(), "dgelda_"));
    if (dgelda == nullptr) throw std::runtime_error(dlerror());
    path = file;
  }

  Dgelda dgelda;
  std::string path;

 private:
  std::unique_ptr<void, int (*)(void*)> handle_;
};

enum class Method { bdf = 1, radau = 2 };

struct Counts {
  int steps, evaluations, error_failures, other_failures;
  int attempts() const { return steps + error_failures + other_failures; }
};

// The user's functions; IPAR is the Replay.
namespace user {

inline void answer(Callback function, const double* t, const int* order, double* values, int leading_dimension,
                   int* ipar, int* ierr) {
  const int status = reinterpret_cast<Replay*>(ipar)->get(function, *t, *order, values, leading_dimension);
  if (status != 0)
    *ierr = status == SFDAE_ORDER_NOT_AVAILABLE ? sfdae::f77::order_not_available : sfdae::f77::function_failed;
}
inline void edif(const int*, const double* t, const int* order, double* values, const int* leading_dimension,
                 int* ipar, double*, int* ierr) {
  answer(Callback::E, t, order, values, *leading_dimension, ipar, ierr);
}
inline void adif(const int*, const double* t, const int* order, double* values, const int* leading_dimension,
                 int* ipar, double*, int* ierr) {
  answer(Callback::A, t, order, values, *leading_dimension, ipar, ierr);
}
inline void fdif(const int*, const double* t, const int* order, double* values, int* ipar, double*, int* ierr) {
  answer(Callback::f, t, order, values, 0, ipar, ierr);
}

}  // namespace user

// The arguments of dgelda_: everything that has to be kept between calls. One after the other several runs.
class DgeldaProblem {
 public:
  DgeldaProblem(const DgeldaLibrary& library, Replay& functions, Method method, double tol)
      : dgelda_(library.dgelda),
        functions_(functions),
        method_(static_cast<int>(method)),
        tol_(tol),
        n_(functions.family().n()) {
    const int n = n_, q = default_mxindx + 1;
    const bool is_bdf = method == Method::bdf;
    // The lengths documented. One more, because dgesvd gets one too few of METHOD = 2 in GELDA 1.1.1.
    liw_ = 20 + (is_bdf ? 2 : 6) * n;
    lrw_ = is_bdf ? 50 + (21 + default_maxord + 14 * default_mxindx) * n + (6 + default_mxindx + 6 * q * q) * n * n
                  : 20 + (29 + 14 * default_mxindx) * n + (15 + default_mxindx + 6 * q * q) * n * n + 1;
  }

  // The next call is the first of a new problem, from the exact solution at t0; options are those of INFO = 0 but for
  // every_step: return after every step.
  void start(double t0, bool every_step) {
    const auto n = static_cast<std::size_t>(n_);
    t = t0;
    x.assign(n, 0.0);
    functions_.family().exact(t0, x.data(), nullptr);
    xprime_.assign(n, 0.0);
    iwork_.assign(static_cast<std::size_t>(liw_), 0);
    rwork_.assign(static_cast<std::size_t>(lrw_), 0.0);
    std::fill_n(info_, 20, 0);
    info_[2] = every_step ? 1 : 0;
  }

  // One call; returns IERR.
  int advance(double tout) {
    int iwarn = 0, ierr = 0;
    double rpar = 0.0;
    dgelda_(user::edif, user::adif, user::fdif, &n_, &t, &tout, x.data(), xprime_.data(), cval_,
            reinterpret_cast<int*>(&functions_), &rpar, iwork_.data(), &liw_, rwork_.data(), &lrw_, &tol_, &tol_,
            &method_, info_, &iwarn, &ierr);
    return ierr;
  }

  Counts counts() const { return {iwork_[10], iwork_[11], iwork_[13], iwork_[14]}; }

  const Replay& functions() const { return functions_; }

  double t = 0.0;
  std::vector<double> x;

 private:
  static constexpr int default_maxord = 5, default_mxindx = 3;

  Dgelda dgelda_;
  Replay& functions_;
  int method_;
  double tol_;
  int n_, liw_, lrw_;
  std::vector<double> xprime_, rwork_;
  std::vector<int> iwork_;
  int cval_[4] = {}, info_[20] = {};
};

// The recorded calls once more, into a buffer: what the callbacks of a run cost.
inline void repeat_callbacks(Replay& functions, std::vector<double>& buffer) {
  const int n = functions.family().n();
  int* ipar = reinterpret_cast<int*>(&functions);
  double rpar = 0.0;
  functions.rewind();
  for (const RecordedCall& call : functions.calls()) {
    int ierr = 0;
    if (call.function == Callback::f) user::fdif(&n, &call.t, &call.order, buffer.data(), ipar, &rpar, &ierr);
    else
      (call.function == Callback::E ? user::edif : user::adif)(&n, &call.t, &call.order, buffer.data(),
                                                               &call.leading_dimension, ipar, &rpar, &ierr);
  }
}

}  // namespace sfdae_bench
