// SPDX-License-Identifier: BSD-3-Clause
// The Fortran 77 entries as a caller sees them, for either width of INTEGER.
#pragma once

#include <cstdint>

namespace sfdae_bench {

template <class I>
using Edif = void (*)(const I* n, const double* t, const I* idif, double* values, const I* ld, I* ipar, double* rpar,
                      I* ierr);
template <class I>
using Fdif = void (*)(const I* n, const double* t, const I* idif, double* values, I* ipar, double* rpar, I* ierr);
template <class I>
using Ndif = void (*)(const double* t, const I* idif, const I* n, const I* m, double* jet, const I* ldx, double* F,
                      double* F_x, const I* ldfx, double* F_xdot, const I* ldfxp, I* ipar, double* rpar, I* ierr);

template <class I>
using Dgelda = void(Edif<I> edif, Edif<I> adif, Fdif<I> fdif, const I* neq, double* t, const double* tout, double* x,
                    double* xprime, I* cval, I* ipar, double* rpar, I* iwork, const I* liw, double* rwork,
                    const I* lrw, double* rtol, double* atol, const I* method, I* info, I* iwarn, I* ierr);
template <class I>
using Dgeerm = void(Edif<I> edif, Edif<I> adif, Fdif<I> fdif, const I* neq, const double* t, const double* tout,
                    const double* x, const double* xprime, const I* cval, const I* ipar, const double* rpar,
                    const I* iwork, const I* liw, const double* rwork, const I* lrw, const double* rtol,
                    const double* atol, const I* method, const I* info, const I* iwarn, const I* ierr);
template <class I>
using Sfndae = void(Ndif<I> ndif, const I* n, const I* m, double* t, const double* tout, double* x, double* xprime,
                    I* cval, I* ipar, double* rpar, I* iwork, const I* liw, double* rwork, const I* lrw, double* rtol,
                    double* atol, const I* method, I* info, I* iwarn, I* ierr);

extern "C" {
Dgelda<std::int32_t> dgelda_;
Dgelda<std::int64_t> dgelda_64_;
Dgeerm<std::int32_t> dgeerm_;
Dgeerm<std::int64_t> dgeerm_64_;
Sfndae<std::int32_t> sfndae_;
Sfndae<std::int64_t> sfndae_64_;
double dgenrm_(const std::int32_t* neq, const double* v, const double* rwt);

using I32 = std::int32_t;
void dnfpen_(Edif<I32> edif, Edif<I32> adif, Fdif<I32> fdif, const I32* n, const double* t, const I32* l, double* wq,
             const I32* ldwq, double* eq, const I32* ldeq, double* aq, const I32* ldaq, double* fq, I32* ipar,
             double* rpar, I32* ierr);
void dnfval_(const I32* n, const I32* nq, const double* eq, const I32* ldeq, const double* aq, const I32* ldaq,
             I32* r0, I32* a0, I32* s0, I32* d0, I32* u0, double* zq, const I32* ldzq, double* rwork,
             const I32* lrwork, I32* ierr);
void dnfind_(Edif<I32> edif, Edif<I32> adif, Fdif<I32> fdif, const I32* n, const double* t, const I32* lmax, I32* m,
             I32* idf, I32* iaf, I32* iuf, I32* ireq, double* ah, const I32* ldah, double* eq, const I32* ldeq,
             double* aq, const I32* ldaq, double* fq, double* zq, const I32* ldzq, I32* ipar, double* rpar,
             double* rwork, const I32* lrwork, I32* ierr);
void dnfotr_(const I32* n, const I32* nq, const I32* id, const I32* ia, const I32* ireq, const double* eq,
             const I32* ldeq, const double* aq, const I32* ldaq, double* z2q, const I32* ldz2q, double* z1,
             const I32* ldz1, double* ah, const I32* ldah, double* rwork, const I32* lrwork, I32* ierr);
void dnfred_(const I32* n, const I32* nq, const I32* id, const I32* ia, const I32* iu, const I32* ireq,
             const double* eq, const I32* ldeq, const double* aq, const I32* ldaq, const double* fq, double* z2q,
             const I32* ldz2q, double* z1, const I32* ldz1, double* e, const I32* lde, double* a, const I32* lda,
             double* f, double* ah, const I32* ldah, double* rwork, const I32* lrwork, I32* ierr);
void dnfix1_(Edif<I32> edif, Edif<I32> adif, Fdif<I32> fdif, const I32* n, const double* t, const I32* lmax,
             const I32* m, const I32* id, const I32* ia, const I32* iu, I32* ireq, I32* mq, I32* idq, I32* iaq,
             I32* iuq, double* e, const I32* lde, double* a, const I32* lda, double* f, double* eq, const I32* ldeq,
             double* aq, const I32* ldaq, double* fq, double* z1, const I32* ldz1, double* z2q, const I32* ldz2q,
             double* ah, const I32* ldah, I32* ipar, double* rpar, double* rwork, const I32* lrwork,
             const I32* mconst, I32* ierr);
void dnfini_(const I32* n, const I32* id, const I32* ia, const I32* iu, double* x, const double* e, const I32* lde,
             const double* a, const I32* lda, const double* f, double* delta, double* tau, double* rwork,
             const I32* lrwork, const I32* method, I32* ierr);
void dgeini_(Edif<I32> edif, Edif<I32> adif, Fdif<I32> fdif, const I32* neq, const double* tn, const I32* mxindx,
             double* x, double* xprime, I32* m, I32* id, I32* ia, I32* iu, I32* ireq, double* eq, const I32* ldeq,
             double* aq, const I32* ldaq, double* fq, double* e, const I32* lde, double* a, const I32* lda, double* f,
             double* z1, const I32* ldz1, double* z2q, const I32* ldz2q, double* d, double* ah, const I32* ldah,
             double* v, I32* ipar, double* rpar, double* rwork, const I32* lrwork, const I32* inival, I32* ierr);
}

// What subroutines find through RPAR.
template <class Functions>
const Functions& functions_of(const double* rpar) {
  const Functions* pointer;
  __builtin_memcpy(&pointer, rpar, sizeof pointer);
  return *pointer;
}
template <class Functions>
double rpar_of(const Functions& functions) {
  const Functions* pointer = &functions;
  double rpar = 0.0;
  static_assert(sizeof pointer <= sizeof rpar);
  __builtin_memcpy(&rpar, &pointer, sizeof pointer);
  return rpar;
}

}  // namespace sfdae_bench
