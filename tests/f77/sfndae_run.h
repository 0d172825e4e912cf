// SPDX-License-Identifier: BSD-3-Clause
// SFNDAE called from C++: equations recorded once serve as NDIF; arguments with their lengths, in arrays with guards.
#ifndef SFDAE_TESTS_SFNDAE_RUN_H
#define SFDAE_TESTS_SFNDAE_RUN_H

#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "dgelda_entry.h"
#include "expression/taylor_evaluator.h"
#include "f77/sfndae_problem.h"
#include "recorded.h"

namespace sfdae_test {

template <class I>
using SfndaeFunction = void(sfdae::f77::TotalDerivative<I> ndif, const I* n, const I* m, double* t,
                            const double* tout, double* x, double* xprime, I* cval, I* ipar, double* rpar, I* iwork,
                            const I* liw, double* rwork, const I* lrw, double* rtol, double* atol, const I* method,
                            I* info, I* iwarn, I* ierr) noexcept;

}  // namespace sfdae_test

extern "C" {
sfdae_test::SfndaeFunction<std::int32_t> sfndae_;
sfdae_test::SfndaeFunction<std::int64_t> sfndae_64_, sfndae_64__;
}

namespace sfdae_test {

inline double derivative_factor(int k) { return k < 2 ? 1.0 : k * derivative_factor(k - 1); }

// F(t, x, x') = 0 with all its total derivatives.
class NonlinearEquations {
 public:
  using Formulas = std::function<std::vector<Term>(const Term& t, const Term* x, const Term* xdot)>;

  NonlinearEquations(int num_unknowns, const Formulas& formulas) : n(num_unknowns) {
    Recording recording(n);
    const std::vector<Term> residuals = formulas(recording.t, recording.x.data(), recording.xdot.data());
    m = static_cast<int>(residuals.size());
    evaluator_ = std::make_unique<sfdae::core::TaylorEvaluator>(recording.finish(residuals));
  }

  // derivatives: n x (order + 2). F: m, F_x and F_xdot: m x n, or null. False where they are not defined.
  bool evaluate(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot) {
    const std::size_t unknowns = index(n), rows = index(m), area = unknowns * rows, levels = index(order) + 1;
    std::vector<double> jet(unknowns * (levels + 1)), all_F(rows * levels), all_x(area * levels),
        all_xdot(area * levels);
    for (std::size_t i = 0; i < jet.size(); ++i)
      jet[i] = derivatives[i] / derivative_factor(static_cast<int>(i / unknowns));
    if (!evaluator_->gradients(t, jet.data(), {order, order, order}, all_F.data(), all_xdot.data(), all_x.data()))
      return false;
    const double factor = derivative_factor(order);
    for (std::size_t i = 0; i < rows; ++i) F[i] = factor * all_F[rows * index(order) + i];
    for (std::size_t i = 0; i < area && F_x != nullptr; ++i) F_x[i] = factor * all_x[area * index(order) + i];
    for (std::size_t i = 0; i < area && F_xdot != nullptr; ++i)
      F_xdot[i] = factor * all_xdot[area * index(order) + i];
    return true;
  }

  int m = 0, n;

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  std::unique_ptr<sfdae::core::TaylorEvaluator> evaluator_;
};

// A problem with what goes wrong in it and what was noticed.
struct NonlinearUser {
  std::shared_ptr<NonlinearEquations> equations;
  std::function<int(double t, int order)> ierr = [](double, int) { return 0; };
  bool returns_nan = false;
  int calls = 0, highest_order = 0;
  bool arguments_are_right = true;
};

template <class I>
struct NonlinearCallback {
  static void ndif(const double* t, const I* idif, const I* n, const I* m, double* jet, const I* ldx, double* F,
                   double* F_x, const I* ldfx, double* F_xdot, const I* ldfxp, I*, double* rpar, I* ierr) {
    NonlinearUser* pointer;
    std::memcpy(&pointer, rpar, sizeof pointer);
    NonlinearUser& user = *pointer;
    const int order = static_cast<int>(*idif);
    ++user.calls;
    user.highest_order = std::max(user.highest_order, order);
    const NonlinearEquations& known = *user.equations;
    user.arguments_are_right = user.arguments_are_right && *n == known.n && *m == known.m && *ldx == known.n &&
                               *ldfx == known.m && *ldfxp == known.m && *ierr == 0 && order >= 0;
    const int wanted = user.ierr(*t, order);
    if (!user.equations->evaluate(*t, order, jet, F, F_x, F_xdot)) *ierr = -1;
    if (user.returns_nan) F[0] = std::numeric_limits<double>::quiet_NaN();
    // What is an input here need not stay as it is.
    jet[0] = 1e300;
    if (wanted != 0) *ierr = static_cast<I>(wanted);
  }
};

inline std::int64_t documented_sfndae_lrw(int n, int m, int maxord = 5, int mxindx = 3) {
  return 100 + 2 * mxindx + m + std::int64_t{20 + 2 * maxord + 4 * mxindx} * n;
}

// The 20 arguments. Arrays have the documented minimal lengths and contain garbage, all options have their defaults.
template <class I = std::int32_t>
struct SfndaeRun {
  SfndaeRun(std::shared_ptr<NonlinearEquations> equations, int which_method, int maxord = 5, int mxindx = 3)
      : n(static_cast<I>(equations->n)),
        m(static_cast<I>(equations->m)),
        method(static_cast<I>(which_method)),
        x(n),
        xprime(n),
        cval(5),
        iwork(20),
        rwork(documented_sfndae_lrw(equations->n, equations->m, maxord, mxindx)),
        rtol(n),
        atol(n),
        info(20) {
    user.equations = std::move(equations);
    liw = static_cast<I>(iwork.length());
    lrw = static_cast<I>(rwork.length());
    info.fill(0);
    if (maxord != 5) info(9) = 1, iwork(3) = static_cast<I>(maxord);
    if (mxindx != 3) info(10) = 1, iwork(4) = static_cast<I>(mxindx);
    rtol(1) = atol(1) = 1e-6;
  }
  void set_x(const std::vector<double>& values) { std::copy(values.begin(), values.end(), x.data()); }
  std::vector<double> values() const { return {x.data(), x.data() + n}; }
  std::vector<double> slopes() const { return {xprime.data(), xprime.data() + n}; }

  // IERR
  int call(double tout) {
    NonlinearUser* pointer = &user;
    double rpar = 0.0;
    static_assert(sizeof pointer <= sizeof rpar);
    std::memcpy(&rpar, &pointer, sizeof pointer);
    entry(NonlinearCallback<I>::ndif, &n, &m, &t, &tout, x.data(), xprime.data(), cval.data(), nullptr, &rpar,
          iwork.data(), &liw, rwork.data(), &lrw, rtol.data(), atol.data(), &method, info.data(), &iwarn, &ierr);
    return static_cast<int>(ierr);
  }
  bool guards_intact() const {
    return x.guards_intact() && xprime.guards_intact() && cval.guards_intact() && iwork.guards_intact() &&
           rwork.guards_intact() && rtol.guards_intact() && atol.guards_intact() && info.guards_intact();
  }
  std::vector<int> characteristics() const {
    return {static_cast<int>(cval(1)), static_cast<int>(cval(2)), static_cast<int>(cval(3)),
            static_cast<int>(cval(4)), static_cast<int>(cval(5))};
  }

  SfndaeFunction<I>* entry = [] {
    if constexpr (sizeof(I) == 4) return &sfndae_;
    else return &sfndae_64_;
  }();
  NonlinearUser user;
  I n, m;
  double t = 0.0;
  I method;
  FortranArray<double> x, xprime;
  FortranArray<I> cval, iwork;
  FortranArray<double> rwork, rtol, atol;
  FortranArray<I> info;
  I liw = 0, lrw = 0, iwarn = 77, ierr = 99;
};

}  // namespace sfdae_test

#endif
