// The only file that calls KLU. Its structs are plain arrays, so that factors can be copied.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/klu_factors.h"

#include <klu.h>

#include <cassert>
#include <cfenv>
#include <cmath>
#include <cstring>
#include <new>
#include <random>
#include <utility>
#include <vector>

#include "linalg/dense_factors.h"
#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

// Pivots are reused while the growth of the factors is at most this multiple of that of a factorization with new ones.
constexpr double most_loss = 100.0;
// Diagonal pivots are taken if they are at least this part of the largest entry of their column. 0.001 is usual for
// circuits; there is no refinement of solutions here.
constexpr double pivot_threshold = 0.1;

int* mutable_data(const std::vector<int>& values) { return const_cast<int*>(values.data()); }
double* parts(const double* values) { return const_cast<double*>(values); }
double* parts(const std::complex<double>* values) {
  return const_cast<double*>(reinterpret_cast<const double*>(values));
}

// The routines for real and for complex matrices.
template <class Number>
struct Routines;
template <>
struct Routines<double> {
  static constexpr auto factor = klu_factor;
  static constexpr auto refactor = klu_refactor;
  static constexpr auto growth = klu_rgrowth;
  static constexpr auto solve = klu_solve;
  static constexpr auto free_numeric = klu_free_numeric;
  static int solve_transposed(klu_symbolic* symbolic, klu_numeric* numeric, int count, double* b,
                              klu_common* common) {
    return klu_tsolve(symbolic, numeric, symbolic->n, count, b, common);
  }
};
template <>
struct Routines<std::complex<double>> {
  static constexpr auto factor = klu_z_factor;
  static constexpr auto refactor = klu_z_refactor;
  static constexpr auto growth = klu_z_rgrowth;
  static constexpr auto solve = klu_z_solve;
  static constexpr auto free_numeric = klu_z_free_numeric;
  static int solve_transposed(klu_symbolic* symbolic, klu_numeric* numeric, int count, double* b,
                              klu_common* common) {
    return klu_z_tsolve(symbolic, numeric, symbolic->n, count, b, 0, common);
  }
};

klu_common settings() {
  klu_common common;
  klu_defaults(&common);
  common.tol = pivot_threshold;
  common.scale = -1;  // values are scaled, indices in order: neither is checked
  return common;
}

using Symbolic = std::shared_ptr<klu_symbolic>;

enum class Ordering { amd, colamd };

Symbolic analyzed(const SparsePattern& pattern, Ordering ordering) {
  klu_common common = settings();
  common.ordering = ordering == Ordering::colamd ? 1 : 0;
  klu_symbolic* symbolic = klu_analyze(pattern.size, mutable_data(pattern.first), mutable_data(pattern.row), &common);
  if (symbolic == nullptr) throw std::bad_alloc();
  return {symbolic, [](klu_symbolic* last) {
            klu_common any = settings();
            klu_free_symbolic(&last, &any);
          }};
}

// COLAMD predicts no fill: the need of random numbers is written to `symbolic` as AMD does.
void estimate_by_trial(const SparsePattern& pattern, klu_symbolic& symbolic) {
  std::minstd_rand generator;
  std::vector<double> values(pattern.row.size());
  for (double& value : values) value = symmetric_random(generator);
  klu_common common = settings();
  klu_numeric* numeric =
      klu_factor(mutable_data(pattern.first), mutable_data(pattern.row), values.data(), &symbolic, &common);
  if (numeric == nullptr) throw std::bad_alloc();
  klu_flops(&symbolic, numeric, &common);
  symbolic.est_flops = common.flops;
  symbolic.lnz = numeric->lnz;
  symbolic.unz = numeric->unz;
  klu_free_numeric(&numeric, &common);
}

// AMD orders A + A^T, COLAMD A^T A: after rows are exchanged for a diagonal without zeros, as in saddle points, the
// former can mean ten times the work (flow over 40 x 40 cells: 158 ms for a factorization, 11 ms with COLAMD).
Symbolic analyzed(const SparsePattern& pattern) {
  constexpr double symmetric = 0.5;  // part of the entries that have one opposite
  Symbolic amd = analyzed(pattern, Ordering::amd);
  if (amd->symmetry < 0.0 || amd->symmetry >= symmetric) return amd;
  Symbolic colamd = analyzed(pattern, Ordering::colamd);
  estimate_by_trial(pattern, *colamd);
  return colamd->est_flops < amd->est_flops ? colamd : amd;
}

}  // namespace

bool klu_is_available() { return true; }

template <class Number>
struct KluFactors<Number>::State {
  explicit State(const SparsePattern& pattern) : symbolic(analyzed(pattern)) {}
  State(const State& other) : symbolic(other.symbolic), fresh_growth(other.fresh_growth) {
    if (other.numeric != nullptr) copy_numeric(*other.numeric);
  }
  State& operator=(const State&) = delete;
  ~State() { release(); }

  void release() {
    if (numeric != nullptr) Routines<Number>::free_numeric(&numeric, &common);
  }
  bool refactor(const SparsePattern& pattern, const Number* values);
  void copy_numeric(const klu_numeric& from);
  // nullptr remains nullptr.
  template <class Item>
  void copy_array(const Item* from, std::size_t count, std::size_t item_size, Item*& to);
  double growth(const SparsePattern& pattern, const Number* values) {
    Routines<Number>::growth(mutable_data(pattern.first), mutable_data(pattern.row), parts(values), symbolic.get(),
                             numeric, &common);
    return common.rgrowth;
  }
  bool has_vanishing_pivot() const {
    const Number* pivots = static_cast<const Number*>(numeric->Udiag);
    for (int k = 0; k < symbolic->n; ++k)
      if (!(std::abs(pivots[k]) >= vanishing_pivot)) return true;
    return false;
  }

  klu_common common = settings();
  Symbolic symbolic;  // never changed
  klu_numeric* numeric = nullptr;
  double fresh_growth = 0.0;  // reciprocal, with newly chosen pivots
};

// False if the pivots are not good enough. Old pivots may vanish: quotients that overflow are no error then.
template <class Number>
bool KluFactors<Number>::State::refactor(const SparsePattern& pattern, const Number* values) {
  std::fenv_t environment;
  std::feholdexcept(&environment);
  bool good = Routines<Number>::refactor(mutable_data(pattern.first), mutable_data(pattern.row), parts(values),
                                         symbolic.get(), numeric, &common) != 0 &&
              common.status == KLU_OK;
  good = good && growth(pattern, values) * most_loss >= fresh_growth && !has_vanishing_pivot() &&
         std::fetestexcept(FE_OVERFLOW | FE_INVALID | FE_DIVBYZERO) == 0;
  std::fesetenv(&environment);
  return good;
}

template <class Number>
template <class Item>
void KluFactors<Number>::State::copy_array(const Item* from, std::size_t count, std::size_t item_size, Item*& to) {
  to = nullptr;
  if (from == nullptr) return;
  to = static_cast<Item*>(klu_malloc(count, item_size, &common));
  if (to == nullptr) throw std::bad_alloc();
  std::memcpy(static_cast<void*>(to), static_cast<const void*>(from), count * item_size);
}

// Copies the arrays that klu_factor() allocates. If memory runs out on the way, the finished parts are released.
template <class Number>
void KluFactors<Number>::State::copy_numeric(const klu_numeric& from) {
  const std::size_t n = index(from.n), entries = index(from.nzoff) + 1, blocks = index(from.nblocks);
  numeric = static_cast<klu_numeric*>(klu_malloc(1, sizeof(klu_numeric), &common));
  if (numeric == nullptr) throw std::bad_alloc();
  klu_numeric& to = *numeric;
  to = from;
  to.Pnum = to.Pinv = to.Lip = to.Uip = to.Llen = to.Ulen = to.Iwork = to.Offp = to.Offi = nullptr;
  to.LUbx = nullptr;
  to.LUsize = nullptr;
  to.Udiag = to.Work = to.Xwork = to.Offx = nullptr;
  to.Rs = nullptr;
  try {
    copy_array(from.Pnum, n, sizeof(int), to.Pnum);
    copy_array(from.Pinv, n, sizeof(int), to.Pinv);
    copy_array(from.Lip, n, sizeof(int), to.Lip);
    copy_array(from.Uip, n, sizeof(int), to.Uip);
    copy_array(from.Llen, n, sizeof(int), to.Llen);
    copy_array(from.Ulen, n, sizeof(int), to.Ulen);
    copy_array(from.Offp, n + 1, sizeof(int), to.Offp);
    copy_array(from.Offi, entries, sizeof(int), to.Offi);
    copy_array(from.Offx, entries, sizeof(Number), to.Offx);
    copy_array(from.Udiag, n, sizeof(Number), to.Udiag);
    copy_array(from.Rs, n, sizeof(double), to.Rs);
    copy_array(from.Work, from.worksize, 1, to.Work);
    to.Xwork = to.Work;
    to.Iwork = reinterpret_cast<int*>(static_cast<char*>(to.Work) + (reinterpret_cast<const char*>(from.Iwork) -
                                                                     static_cast<const char*>(from.Work)));
    copy_array(from.LUsize, blocks, sizeof(std::size_t), to.LUsize);
    copy_array(from.LUbx, blocks, sizeof(void*), to.LUbx);
    for (std::size_t block = 0; block < blocks; ++block) to.LUbx[block] = nullptr;
    for (std::size_t block = 0; block < blocks; ++block)
      copy_array(from.LUbx[block], from.LUbx[block] == nullptr ? 0 : from.LUsize[block], sizeof(Number),
                 to.LUbx[block]);
  } catch (const std::bad_alloc&) {
    release();
    throw;
  }
}

template <class Number>
KluFactors<Number>::KluFactors() = default;
template <class Number>
KluFactors<Number>::~KluFactors() = default;
template <class Number>
KluFactors<Number>::KluFactors(const KluFactors& other)
    : state_(other.state_ ? std::make_unique<State>(*other.state_) : nullptr),
      has_new_pivots_(other.has_new_pivots_) {}
template <class Number>
KluFactors<Number>::KluFactors(KluFactors&&) noexcept = default;
template <class Number>
KluFactors<Number>& KluFactors<Number>::operator=(KluFactors other) noexcept {
  state_.swap(other.state_);
  has_new_pivots_ = other.has_new_pivots_;
  return *this;
}

template <class Number>
void KluFactors<Number>::analyze(const SparsePattern& pattern) {
  state_ = std::make_unique<State>(pattern);
}

template <class Number>
double KluFactors<Number>::flops() const {
  return state_->symbolic->est_flops > 0.0 ? state_->symbolic->est_flops : 0.0;
}

template <class Number>
bool KluFactors<Number>::factor(const SparsePattern& pattern, const Number* values) {
  State& state = *state_;
  has_new_pivots_ = state.numeric == nullptr || !state.refactor(pattern, values);
  if (!has_new_pivots_) return true;
  state.release();
  state.numeric = Routines<Number>::factor(mutable_data(pattern.first), mutable_data(pattern.row), parts(values),
                                           state.symbolic.get(), &state.common);
  if (state.numeric == nullptr && state.common.status == KLU_SINGULAR) return false;
  if (state.numeric == nullptr) throw std::bad_alloc();
  if (state.has_vanishing_pivot()) {
    state.release();
    return false;
  }
  state.fresh_growth = state.growth(pattern, values);
  return true;
}

template <class Number>
void KluFactors<Number>::forget_pivots() {
  state_->release();
}

template <class Number>
void KluFactors<Number>::solve(Op op, Number* b, int count) {
  State& state = *state_;
  assert(state.numeric != nullptr);
  if (op == Op::plain)
    Routines<Number>::solve(state.symbolic.get(), state.numeric, state.symbolic->n, count, parts(b), &state.common);
  else Routines<Number>::solve_transposed(state.symbolic.get(), state.numeric, count, parts(b), &state.common);
}

template <class Number>
std::size_t KluFactors<Number>::fill() const {
  if (state_->numeric == nullptr) return static_cast<std::size_t>(state_->symbolic->lnz + state_->symbolic->unz);
  return index(state_->numeric->lnz) + index(state_->numeric->unz) + index(state_->numeric->nzoff);
}

template <class Number>
Determinant<Number> KluFactors<Number>::determinant() const {
  assert(state_->numeric != nullptr);
  const int n = state_->symbolic->n;
  const Number* pivots = static_cast<const Number*>(state_->numeric->Udiag);
  Determinant<Number> determinant;
  for (int k = 0; k < n; ++k) determinant.multiply(pivots[k]);
  determinant.change_sign_if(is_odd(state_->numeric->Pnum, n) != is_odd(state_->symbolic->Q, n));
  return determinant;
}

template class KluFactors<double>;
template class KluFactors<std::complex<double>>;

}  // namespace sfdae::core
