// SPDX-License-Identifier: BSD-3-Clause
// Calls the helper routines for a family, with arrays as a Fortran program would keep them: leading dimensions larger
// than necessary, guarded against being written beyond their ends.
#ifndef SFDAE_TESTS_F77_FAMILY_CALLER_H
#define SFDAE_TESTS_F77_FAMILY_CALLER_H

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "entries.h"
#include "linalg/matrix.h"
#include "linear_family.h"
#include "matrix_checks.h"

namespace sfdae_test {

// What EDIF, ADIF, FDIF find behind RPAR.
struct FamilyUser {
  const LinearFamily* family;
  int highest_order = max_family_order;
  int failing_code = 0;  // returned by ADIF at order failing_order
  int failing_order = -1;
  bool poison = false;  // FDIF returns NaN
  int highest_asked = -1;
  long calls = 0;
  std::vector<char> sequence;  // which function, order by order
};

template <class I>
void write_matrix(FamilyUser& user, char which, double t, I order, double* out, I ld, I* ierr) {
  const LinearFamily& family = *user.family;
  ++user.calls;
  user.sequence.push_back(which);
  user.highest_asked = std::max(user.highest_asked, static_cast<int>(order));
  if (order > user.highest_order) {
    *ierr = -2;
    return;
  }
  if (which == 'A' && order == user.failing_order) {
    *ierr = static_cast<I>(user.failing_code);
    return;
  }
  const int n = family.n();
  std::vector<double> values(size(n) * size(n));
  if (which == 'E') family.E(t, static_cast<int>(order), values.data());
  else family.A(t, static_cast<int>(order), values.data());
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) out[i + j * static_cast<std::ptrdiff_t>(ld)] = values[size(i + j * n)];
}

template <class I>
FamilyUser& user_of(double* rpar) {
  return *reinterpret_cast<FamilyUser*>(rpar);
}

template <class I>
void edif(const I*, const double* t, const I* order, double* e, const I* lde, I*, double* rpar, I* ierr) {
  write_matrix(user_of<I>(rpar), 'E', *t, *order, e, *lde, ierr);
}
template <class I>
void adif(const I*, const double* t, const I* order, double* a, const I* lda, I*, double* rpar, I* ierr) {
  write_matrix(user_of<I>(rpar), 'A', *t, *order, a, *lda, ierr);
}
template <class I>
void fdif(const I*, const double* t, const I* order, double* f, I*, double* rpar, I* ierr) {
  FamilyUser& user = user_of<I>(rpar);
  ++user.calls;
  user.sequence.push_back('f');
  if (*order > user.highest_order) {
    *ierr = -2;
    return;
  }
  user.family->f(*t, static_cast<int>(*order), f);
  if (user.poison) f[0] = std::numeric_limits<double>::quiet_NaN();
}

// rows x cols within a larger array; what lies around keeps its value.
class PaddedArray {
 public:
  PaddedArray(int rows, int cols) : ld(rows + 3), rows_(rows), cols_(cols), data_(size(ld * (cols + 1)), untouched) {}
  double* data() { return data_.data(); }
  sfdae::core::ConstView block(int rows, int cols) const { return {data_.data(), rows, cols, ld}; }
  sfdae::core::View block(int rows, int cols) { return {data_.data(), rows, cols, ld}; }
  // Nothing written outside the first rows x cols entries.
  bool padding_kept(int rows, int cols) const {
    for (int j = 0; j <= cols_; ++j)
      for (int i = 0; i < ld; ++i)
        if ((i >= rows || j >= cols) && data_[size(i + j * ld)] != untouched) return false;
    return true;
  }
  bool padding_kept() const { return padding_kept(rows_, cols_); }
  bool is_untouched() const { return padding_kept(0, 0); }

  static constexpr double untouched = -7.25e77;
  int ld;

 private:
  int rows_, cols_;
  std::vector<double> data_;
};

// All that the routines write for one problem.
template <class I>
struct Call {
  Call(std::shared_ptr<const LinearFamily> f, int most_levels)
      : family(std::move(f)),
        user{family.get(), max_family_order, 0, -1, false, -1, 0, {}},
        n(static_cast<I>(family->n())),
        lmax(static_cast<I>(most_levels)),
        rows(family->n() * (most_levels + 1)),
        AH(rows, rows),
        EQ(rows, rows),
        AQ(rows, family->n()),
        FQ(rows, 1),
        ZQ(rows, rows),
        E(family->n(), family->n()),
        A(family->n(), family->n()),
        F(family->n(), 1),
        Z1(family->n(), family->n()),
        lrwork(static_cast<I>(3 * rows * rows + 6 * rows)) {}

  double* rpar() { return reinterpret_cast<double*>(&user); }
  int nq() const { return static_cast<int>(n * (m + 1)); }

  void find(double t, const Entries<I>& entry = entries<I>()) {
    const I ld = static_cast<I>(EQ.ld);
    ierr = 0;
    entry.dnfind(edif<I>, adif<I>, fdif<I>, &n, &t, &lmax, &m, &d, &a, &u, &ireq, AH.data(), &ld, EQ.data(), &ld,
                 AQ.data(), &ld, FQ.data(), ZQ.data(), &ld, nullptr, rpar(), nullptr, &lrwork, &ierr);
  }
  void reduce(const Entries<I>& entry = entries<I>()) {
    const I ld = static_cast<I>(EQ.ld), ld_n = static_cast<I>(E.ld), rows_now = n * (m + 1);
    ierr = 77;
    entry.dnfred(&n, &rows_now, &d, &a, &u, &ireq, EQ.data(), &ld, AQ.data(), &ld, FQ.data(), ZQ.data(), &ld,
                 Z1.data(), &ld_n, E.data(), &ld_n, A.data(), &ld_n, F.data(), AH.data(), &ld, nullptr, &lrwork,
                 &ierr);
  }

  std::shared_ptr<const LinearFamily> family;
  FamilyUser user;
  I n, lmax;
  int rows;
  PaddedArray AH, EQ, AQ, FQ, ZQ, E, A, F, Z1;
  I lrwork;
  I m = 55, d = 55, a = 55, u = 55, ireq = 55, ierr = 0;
};

// E^(k) or A^(k) of the family.
inline sfdae::core::Matrix derivative(const LinearFamily& family, char which, double t, int k) {
  sfdae::core::Matrix value(family.m(), family.n());
  if (which == 'E') family.E(t, k, value.data());
  else family.A(t, k, value.data());
  return value;
}

struct ExactSolution {
  std::vector<double> x, xdot;
};
inline ExactSolution exact_solution(const LinearFamily& family, double t) {
  ExactSolution solution{std::vector<double>(size(family.n())), std::vector<double>(size(family.n()))};
  family.exact(t, solution.x.data(), solution.xdot.data());
  return solution;
}

}  // namespace sfdae_test

#endif
