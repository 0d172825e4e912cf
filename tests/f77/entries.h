// SPDX-License-Identifier: BSD-3-Clause
// The entries of the Fortran 77 layer as C++ sees them, for either width of INTEGER.
#ifndef SFDAE_TESTS_F77_ENTRIES_H
#define SFDAE_TESTS_F77_ENTRIES_H

#include <cstdint>

#include "f77/user_functions.h"

namespace sfdae_test {

template <class I>
using Matrices = sfdae::f77::MatrixFunction<I>;
template <class I>
using Vectors = sfdae::f77::VectorFunction<I>;

template <class I>
using Dnfpen = void(Matrices<I> edif, Matrices<I> adif, Vectors<I> fdif, const I* n, const double* t, const I* l,
                    double* wq, const I* ldwq, double* eq, const I* ldeq, double* aq, const I* ldaq, double* fq,
                    I* ipar, double* rpar, I* ierr) noexcept;
template <class I>
using Dnfval = void(const I* n, const I* nq, const double* eq, const I* ldeq, const double* aq, const I* ldaq, I* r0,
                    I* a0, I* s0, I* d0, I* u0, double* zq, const I* ldzq, double* rwork, const I* lrwork,
                    I* ierr) noexcept;
template <class I>
using Dnfind = void(Matrices<I> edif, Matrices<I> adif, Vectors<I> fdif, const I* n, const double* t, const I* lmax,
                    I* m, I* idf, I* iaf, I* iuf, I* ireq, double* ah, const I* ldah, double* eq, const I* ldeq,
                    double* aq, const I* ldaq, double* fq, double* zq, const I* ldzq, I* ipar, double* rpar,
                    double* rwork, const I* lrwork, I* ierr) noexcept;
template <class I>
using Dnfotr = void(const I* n, const I* nq, const I* id, const I* ia, const I* ireq, const double* eq, const I* ldeq,
                    const double* aq, const I* ldaq, double* z2q, const I* ldz2q, double* z1, const I* ldz1,
                    double* ah, const I* ldah, double* rwork, const I* lrwork, I* ierr) noexcept;
template <class I>
using Dnfred = void(const I* n, const I* nq, const I* id, const I* ia, const I* iu, const I* ireq, const double* eq,
                    const I* ldeq, const double* aq, const I* ldaq, const double* fq, double* z2q, const I* ldz2q,
                    double* z1, const I* ldz1, double* e, const I* lde, double* a, const I* lda, double* f,
                    double* ah, const I* ldah, double* rwork, const I* lrwork, I* ierr) noexcept;
template <class I>
using Dnfix1 = void(Matrices<I> edif, Matrices<I> adif, Vectors<I> fdif, const I* n, const double* t, const I* lmax,
                    const I* m, const I* id, const I* ia, const I* iu, I* ireq, I* mq, I* idq, I* iaq, I* iuq,
                    double* e, const I* lde, double* a, const I* lda, double* f, double* eq, const I* ldeq,
                    double* aq, const I* ldaq, double* fq, double* z1, const I* ldz1, double* z2q, const I* ldz2q,
                    double* ah, const I* ldah, I* ipar, double* rpar, double* rwork, const I* lrwork, const I* mconst,
                    I* ierr) noexcept;
template <class I>
using Dnfini = void(const I* n, const I* id, const I* ia, const I* iu, double* x, const double* e, const I* lde,
                    const double* a, const I* lda, const double* f, double* delta, double* tau, double* rwork,
                    const I* lrwork, const I* method, I* ierr) noexcept;
template <class I>
using Dgeini = void(Matrices<I> edif, Matrices<I> adif, Vectors<I> fdif, const I* neq, const double* tn,
                    const I* mxindx, double* x, double* xprime, I* m, I* id, I* ia, I* iu, I* ireq, double* eq,
                    const I* ldeq, double* aq, const I* ldaq, double* fq, double* e, const I* lde, double* a,
                    const I* lda, double* f, double* z1, const I* ldz1, double* z2q, const I* ldz2q, double* d,
                    double* ah, const I* ldah, double* v, I* ipar, double* rpar, double* rwork, const I* lrwork,
                    const I* inival, I* ierr) noexcept;
template <class I>
using Dgeerm = void(Matrices<I> edif, Matrices<I> adif, Vectors<I> fdif, const I* neq, const double* t,
                    const double* tout, const double* x, const double* xprime, const I* cval, const I* ipar,
                    const double* rpar, const I* iwork, const I* liw, const double* rwork, const I* lrw,
                    const double* rtol, const double* atol, const I* method, const I* info, const I* iwarn,
                    const I* ierr) noexcept;
template <class I>
using Dgenrm = double(const I* neq, const double* v, const double* rwt) noexcept;

// The entries of one width.
template <class I>
struct Entries {
  Dnfpen<I>* dnfpen;
  Dnfval<I>* dnfval;
  Dnfind<I>* dnfind;
  Dnfotr<I>* dnfotr;
  Dnfred<I>* dnfred;
  Dnfix1<I>* dnfix1;
  Dnfini<I>* dnfini;
  Dgeini<I>* dgeini;
  Dgenrm<I>* dgenrm;
};

}  // namespace sfdae_test

extern "C" {
sfdae_test::Dnfpen<std::int32_t> dnfpen_;
sfdae_test::Dnfval<std::int32_t> dnfval_;
sfdae_test::Dnfind<std::int32_t> dnfind_;
sfdae_test::Dnfotr<std::int32_t> dnfotr_;
sfdae_test::Dnfred<std::int32_t> dnfred_;
sfdae_test::Dnfix1<std::int32_t> dnfix1_;
sfdae_test::Dnfini<std::int32_t> dnfini_;
sfdae_test::Dgeini<std::int32_t> dgeini_;
sfdae_test::Dgeerm<std::int32_t> dgeerm_;
sfdae_test::Dgenrm<std::int32_t> dgenrm_;

sfdae_test::Dnfpen<std::int64_t> dnfpen_64_, dnfpen_64__;
sfdae_test::Dnfval<std::int64_t> dnfval_64_, dnfval_64__;
sfdae_test::Dnfind<std::int64_t> dnfind_64_, dnfind_64__;
sfdae_test::Dnfotr<std::int64_t> dnfotr_64_, dnfotr_64__;
sfdae_test::Dnfred<std::int64_t> dnfred_64_, dnfred_64__;
sfdae_test::Dnfix1<std::int64_t> dnfix1_64_, dnfix1_64__;
sfdae_test::Dnfini<std::int64_t> dnfini_64_, dnfini_64__;
sfdae_test::Dgeini<std::int64_t> dgeini_64_, dgeini_64__;
sfdae_test::Dgeerm<std::int64_t> dgeerm_64_, dgeerm_64__;
sfdae_test::Dgenrm<std::int64_t> dgenrm_64_, dgenrm_64__;
}

namespace sfdae_test {

template <class I>
Entries<I> entries();
template <>
inline Entries<std::int32_t> entries() {
  return {dnfpen_, dnfval_, dnfind_, dnfotr_, dnfred_, dnfix1_, dnfini_, dgeini_, dgenrm_};
}
template <>
inline Entries<std::int64_t> entries() {
  return {dnfpen_64_, dnfval_64_, dnfind_64_, dnfotr_64_, dnfred_64_, dnfix1_64_, dnfini_64_, dgeini_64_, dgenrm_64_};
}
// Names with a second underscore.
inline Entries<std::int64_t> second_underscore_entries() {
  return {dnfpen_64__, dnfval_64__, dnfind_64__, dnfotr_64__, dnfred_64__,
          dnfix1_64__, dnfini_64__, dgeini_64__, dgenrm_64__};
}

}  // namespace sfdae_test

#endif
