// SPDX-License-Identifier: BSD-3-Clause
// DGELDA and SFNDAE with their arguments in one object; every call is traced, work arrays included.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "fortran_entries.h"
#include "problem.h"
#include "trace.h"

namespace sfdae_bench {

// EDIF, ADIF, FDIF of a LinearFunction with as many equations as unknowns.
template <class I>
struct LinearSubroutines {
  template <char which>
  static void matrix(const I* n, const double* t, const I* idif, double* values, const I* ld, I*, double* rpar,
                     I* ierr) {
    std::vector<double> entries(size(static_cast<int>(*n * *n)), 0.0);
    const int status = functions_of<LinearFunction>(rpar)(which, *t, static_cast<int>(*idif), entries.data());
    if (status != 0) *ierr = static_cast<I>(status == SFDAE_ORDER_NOT_AVAILABLE ? -2 : -1);
    for (I j = 0; j < *n; ++j) std::copy_n(entries.data() + j * *n, *n, values + j * *ld);
  }
  static void vector(const I* n, const double* t, const I* idif, double* values, I*, double* rpar, I* ierr) {
    std::fill_n(values, *n, 0.0);
    const int status = functions_of<LinearFunction>(rpar)('f', *t, static_cast<int>(*idif), values);
    if (status != 0) *ierr = static_cast<I>(status == SFDAE_ORDER_NOT_AVAILABLE ? -2 : -1);
  }
};

// NDIF of a TotalDerivative.
template <class I>
void call_ndif(const double* t, const I* idif, const I*, const I*, double* jet, const I*, double* F, double* F_x,
               const I*, double* F_xdot, const I*, I*, double* rpar, I* ierr) {
  const int status = functions_of<TotalDerivative>(rpar)(*t, static_cast<int>(*idif), jet, F, F_x, F_xdot);
  if (status != 0) *ierr = static_cast<I>(status == SFDAE_ORDER_NOT_AVAILABLE ? -2 : -1);
}

// The arguments that both routines have. Positions count from 1.
template <class I>
struct FortranCall {
  FortranCall(Trace& its_trace, int unknowns, int equations, int which_method)
      : trace(its_trace),
        n(static_cast<I>(unknowns)),
        m(static_cast<I>(equations)),
        method(static_cast<I>(which_method)),
        x(size(unknowns)),
        xprime(size(unknowns)),
        rtol(size(unknowns), 1e-6),
        atol(size(unknowns), 1e-6),
        info(20),
        cval(5) {}

  void set(int flag) { info[size(flag - 1)] = 1; }
  void integer(int flag, int position, int value) {
    set(flag);
    iwork[size(position - 1)] = static_cast<I>(value);
  }
  void real(int flag, int position, double value) {
    set(flag);
    rwork[size(position - 1)] = value;
  }
  void tolerance(double tol) {
    std::fill(rtol.begin(), rtol.end(), tol);
    std::fill(atol.begin(), atol.end(), tol);
  }

  void trace_arguments() {
    trace.integer("IERR", static_cast<long long>(ierr));
    trace.integer("IWARN", static_cast<long long>(iwarn));
    trace.number("T", t);
    trace.numbers("X", x);
    trace.numbers("XPRIME", xprime);
    trace_integers("CVAL", cval);
    trace_integers("INFO", info);
    trace_integers("IWORK", iwork);
    trace.numbers("RWORK", rwork);
    trace.numbers("RTOL", rtol);
    trace.numbers("ATOL", atol);
  }
  void trace_integers(const char* what, const std::vector<I>& values) {
    trace.numbers(what, std::vector<double>(values.begin(), values.end()));
  }

  Trace& trace;
  I n, m, method, liw = 0, lrw = 0, iwarn = 0, ierr = 0;
  double t = 0.0;
  std::vector<double> x, xprime, rtol, atol, rwork;
  std::vector<I> info, cval, iwork;
};

// What a routine prints on standard output, without frame and line breaks.
std::string printed(const std::function<void()>& routine);

template <class I>
struct DgeldaCall : FortranCall<I> {
  DgeldaCall(Trace& its_trace, int unknowns, LinearFunction function, int which_method, int max_order = 5,
             int max_index = 3)
      : FortranCall<I>(its_trace, unknowns, unknowns, which_method), functions(std::move(function)) {
    const int q = max_index + 1;
    const bool is_bdf = which_method == 1;
    const int linear = is_bdf ? 21 + max_order + 14 * max_index : 29 + 14 * max_index;
    const int quadratic = (is_bdf ? 6 : 15) + max_index + 6 * q * q;
    this->iwork.resize(size(20 + (is_bdf ? 2 : 6) * unknowns));
    this->rwork.resize(size((is_bdf ? 50 : 20) + linear * unknowns + quadratic * unknowns * unknowns));
    this->liw = static_cast<I>(this->iwork.size());
    this->lrw = static_cast<I>(this->rwork.size());
    this->cval.resize(4);
    if (max_order != 5) this->integer(9, 3, max_order);
    if (max_index != 3) this->integer(10, 4, max_index);
  }

  int call(double tout) {
    double rpar = rpar_of(functions);
    const auto entry = [&](auto dgelda, auto dgeerm) {
      using S = LinearSubroutines<I>;
      dgelda(S::template matrix<'E'>, S::template matrix<'A'>, S::vector, &this->n, &this->t, &tout, this->x.data(),
             this->xprime.data(), this->cval.data(), nullptr, &rpar, this->iwork.data(), &this->liw,
             this->rwork.data(), &this->lrw, this->rtol.data(), this->atol.data(), &this->method, this->info.data(),
             &this->iwarn, &this->ierr);
      this->trace_arguments();
      this->trace.text("DGEERM", printed([&] {
                         dgeerm(nullptr, nullptr, nullptr, &this->n, &this->t, &tout, this->x.data(),
                                this->xprime.data(), this->cval.data(), nullptr, nullptr, this->iwork.data(),
                                &this->liw, this->rwork.data(), &this->lrw, this->rtol.data(), this->atol.data(),
                                &this->method, this->info.data(), &this->iwarn, &this->ierr);
                       }));
    };
    if constexpr (sizeof(I) == 4) entry(dgelda_, dgeerm_);
    else entry(dgelda_64_, dgeerm_64_);
    return static_cast<int>(this->ierr);
  }

  LinearFunction functions;
};

template <class I>
struct SfndaeCall : FortranCall<I> {
  SfndaeCall(Trace& its_trace, int equations, int unknowns, TotalDerivative function, int which_method,
             int max_order = 5, int max_index = 3)
      : FortranCall<I>(its_trace, unknowns, equations, which_method), functions(std::move(function)) {
    this->iwork.resize(20);
    this->rwork.resize(size(100 + 2 * max_index + equations + (20 + 2 * max_order + 4 * max_index) * unknowns));
    this->liw = static_cast<I>(this->iwork.size());
    this->lrw = static_cast<I>(this->rwork.size());
    if (max_order != 5) this->integer(9, 3, max_order);
    if (max_index != 3) this->integer(10, 4, max_index);
  }

  int call(double tout) {
    double rpar = rpar_of(functions);
    const auto entry = [&](auto sfndae) {
      sfndae(call_ndif<I>, &this->n, &this->m, &this->t, &tout, this->x.data(), this->xprime.data(),
             this->cval.data(), nullptr, &rpar, this->iwork.data(), &this->liw, this->rwork.data(), &this->lrw,
             this->rtol.data(), this->atol.data(), &this->method, this->info.data(), &this->iwarn, &this->ierr);
    };
    if constexpr (sizeof(I) == 4) entry(sfndae_);
    else entry(sfndae_64_);
    this->trace_arguments();
    return static_cast<int>(this->ierr);
  }

  TotalDerivative functions;
};

// Outputs up to tf, going on at most `most` times after interruptions and steps.
template <class Call>
void integrate(Call& call, double tf, int outputs, int most = 60) {
  const double from = call.t;
  for (int i = 1; i <= outputs; ++i) {
    const double tout = i == outputs ? tf : from + (tf - from) * i / outputs;
    int status = call.call(tout);
    for (; (status == 1 || status == -1 || status == -2) && most > 0; --most) {
      if (status < 0) call.info[0] = 1;
      status = call.call(tout);
    }
    if (status < 0) return;
  }
}

}  // namespace sfdae_bench
