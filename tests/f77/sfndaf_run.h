// SPDX-License-Identifier: BSD-3-Clause
// SFNDAF called from C++: the derivative array is put together from the total derivatives of recorded equations.
#ifndef SFDAE_TESTS_SFNDAF_RUN_H
#define SFDAE_TESTS_SFNDAF_RUN_H

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "f77/sfndaf_problem.h"
#include "sfndae_run.h"

namespace sfdae_test {

template <class I>
using SfndafFunction = void(sfdae::f77::ArrayRoutine<I> narr, const I* n, const I* m, double* t, const double* tout,
                            double* x, double* xprime, I* cval, I* ipar, double* rpar, I* iwork, const I* liw,
                            double* rwork, const I* lrw, double* rtol, double* atol, const I* method, I* info,
                            I* iwarn, I* ierr) noexcept;

}  // namespace sfdae_test

extern "C" {
sfdae_test::SfndafFunction<std::int32_t> sfndaf_;
sfdae_test::SfndafFunction<std::int64_t> sfndaf_64_, sfndaf_64__;
}

namespace sfdae_test {

// C(k, j), 0 unless 0 <= j <= k, by Pascal's triangle.
inline double pascal(int k, int j) {
  if (j < 0 || j > k) return 0.0;
  return j == 0 || j == k ? 1.0 : pascal(k - 1, j - 1) + pascal(k - 1, j);
}

// Jacobian of the derivative array of order mu: (mu + 1) m rows, (mu + 2) n columns. F_x, F_xdot: m x n matrices of the
// orders 0 ... mu.
inline std::vector<double> array_jacobian(int m, int n, int mu, const std::vector<std::vector<double>>& F_x,
                                          const std::vector<std::vector<double>>& F_xdot) {
  const auto index = [](int i) { return static_cast<std::size_t>(i); };
  const std::size_t rows = index((mu + 1) * m);
  std::vector<double> J(rows * index((mu + 2) * n), 0.0);
  for (int k = 0; k <= mu; ++k)
    for (int j = 0; j <= k + 1; ++j)
      for (int c = 0; c < n; ++c)
        for (int r = 0; r < m; ++r) {
          double& entry = J[index(k * m + r) + rows * index(j * n + c)];
          if (j <= k) entry += pascal(k, j) * F_x[index(k - j)][index(r + m * c)];
          if (j > 0) entry += pascal(k, j - 1) * F_xdot[index(k - j + 1)][index(r + m * c)];
        }
  return J;
}

template <class I>
struct ArrayCallback {
  static void narr(const double* t, const I* mu, const I* n, const I* m, double* jet, const I* ldx, double* F,
                   double* jacobian, const I* ldfj, I*, double* rpar, I* ierr) {
    NonlinearUser* pointer;
    std::memcpy(&pointer, rpar, sizeof pointer);
    NonlinearUser& user = *pointer;
    const int order = static_cast<int>(*mu), rows = static_cast<int>(*m), columns = static_cast<int>(*n);
    ++user.calls;
    user.highest_order = std::max(user.highest_order, order);
    user.arguments_are_right = user.arguments_are_right && columns == user.equations->n &&
                               rows == user.equations->m && *ldx == *n && *ldfj == (order + 1) * rows && *ierr == 0;
    const std::size_t area = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    std::vector<std::vector<double>> F_x(static_cast<std::size_t>(order) + 1, std::vector<double>(area)), F_xdot(F_x);
    for (int k = 0; k <= order; ++k) {
      const std::size_t at = static_cast<std::size_t>(k);
      if (!user.equations->evaluate(*t, k, jet, F + k * rows, F_x[at].data(), F_xdot[at].data())) *ierr = -1;
    }
    const std::vector<double> J = array_jacobian(rows, columns, order, F_x, F_xdot);
    std::copy(J.begin(), J.end(), jacobian);
    if (user.returns_nan) F[0] = std::numeric_limits<double>::quiet_NaN();
    // The jet is an input that may be changed here.
    jet[0] = 1e300;
    const int wanted = user.ierr(*t, order);
    if (wanted != 0) *ierr = static_cast<I>(wanted);
  }
};

template <class I = std::int32_t>
struct SfndafRun : SfndaeRun<I> {
  using SfndaeRun<I>::SfndaeRun;

  // IERR
  int call(double tout) {
    NonlinearUser* pointer = &this->user;
    double rpar = 0.0;
    std::memcpy(&rpar, &pointer, sizeof pointer);
    array_entry(ArrayCallback<I>::narr, &this->n, &this->m, &this->t, &tout, this->x.data(), this->xprime.data(),
                this->cval.data(), nullptr, &rpar, this->iwork.data(), &this->liw, this->rwork.data(), &this->lrw,
                this->rtol.data(), this->atol.data(), &this->method, this->info.data(), &this->iwarn, &this->ierr);
    return static_cast<int>(this->ierr);
  }

  SfndafFunction<I>* array_entry = [] {
    if constexpr (sizeof(I) == 4) return &sfndaf_;
    else return &sfndaf_64_;
  }();
};

}  // namespace sfdae_test

#endif
