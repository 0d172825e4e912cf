// Solves a family through DGELDA and compares every step and output with the exact solution.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dgelda_entry.h"
#include "family_problem.h"

namespace sfdae_test {

// Name of a test with METHOD as its parameter.
inline std::string method_name(const testing::TestParamInfo<int>& method) {
  return method.param == 1 ? "Bdf" : "Radau";
}

// The subroutines EDIF, ADIF, FDIF of a family with as many equations as unknowns. RPAR is the address of the object.
// A status of the family's hooks becomes IERR.
template <class Integer>
class DgeldaFamily {
 public:
  explicit DgeldaFamily(std::shared_ptr<const LinearFamily> family)
      : problem(std::move(family)),
        block_(static_cast<std::size_t>(problem.n()) * static_cast<std::size_t>(problem.n())) {}

  FamilyProblem problem;
  long wrong_arguments = 0;  // calls with arguments that the interface excludes

  // The arguments for this family at t0, X exact if there is an exact solution, otherwise 1.
  Dgelda<Integer> arguments(int method, double t0 = 0.0) {
    const LinearFamily& family = problem.family();
    Dgelda<Integer> call(family.n(), method);
    call.functions(edif, adif, fdif);
    call.rpar = reinterpret_cast<double*>(this);
    call.t = t0;
    call.x.fill(1.0);
    if (family.has_exact()) family.exact(t0, call.x.data(), nullptr);
    return call;
  }

 private:
  static void edif(const Integer* n, const double* t, const Integer* idif, double* values, const Integer* lde,
                   Integer*, double* rpar, Integer* ierr) {
    auto& self = *reinterpret_cast<DgeldaFamily*>(rpar);
    *ierr = self.matrix(self.problem.problem.E, *n, *t, *idif, values, *lde, *ierr);
  }
  static void adif(const Integer* n, const double* t, const Integer* idif, double* values, const Integer* lda,
                   Integer*, double* rpar, Integer* ierr) {
    auto& self = *reinterpret_cast<DgeldaFamily*>(rpar);
    *ierr = self.matrix(self.problem.problem.A, *n, *t, *idif, values, *lda, *ierr);
  }
  static void fdif(const Integer* n, const double* t, const Integer* idif, double* values, Integer*, double* rpar,
                   Integer* ierr) {
    auto& self = *reinterpret_cast<DgeldaFamily*>(rpar);
    self.check(*n, *n, *idif, *ierr);
    *ierr = code(self.problem.problem.f(*t, static_cast<int>(*idif), values, &self.problem));
  }

  Integer matrix(sfdae_matrix_function function, Integer n, double t, Integer idif, double* values, Integer leading,
                 Integer ierr) {
    check(n, leading, idif, ierr);
    const Integer status = code(function(t, static_cast<int>(idif), block_.data(), &problem));
    for (Integer j = 0; j < n; ++j) std::copy_n(block_.data() + j * n, n, values + j * leading);
    return status;
  }
  void check(Integer n, Integer leading, Integer idif, Integer ierr) {
    if (n != problem.n() || leading < n || idif < 0 || ierr != 0) ++wrong_arguments;
  }
  static Integer code(int status) { return status == SFDAE_ORDER_NOT_AVAILABLE ? -2 : status; }

  std::vector<double> block_;  // n x n
};

struct DgeldaFamilyRun {
  int ierr = 0;  // of the call that ended the run
  double t = 0.0;
  std::vector<double> x;
  CharacteristicValues values{};
  double step_error = 0.0;    // max |e_i| / (rtol |x_i| + atol) over all steps and where the run ended
  double output_error = 0.0;  // and over all outputs
  long steps = 0, attempts = 0, evaluations = 0, factorizations = 0;
};

struct DgeldaFamilyOptions {
  int method = 1;
  double tol = 1e-6;
  bool constant = false;     // INFO(5)
  std::vector<double> x0{};  // empty: exact
  int outputs = 10;
};

// max |x_i - exact_i| / (tol (|exact_i| + 1)); infinite for NaN, 0 if no solution is known.
inline double weighted_error(const LinearFamily& family, double tol, double t, const double* x) {
  if (!family.has_exact()) return 0.0;
  std::vector<double> exact(static_cast<std::size_t>(family.n()));
  family.exact(t, exact.data(), nullptr);
  double worst = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double error = std::fabs(x[i] - exact[i]) / (tol * (std::fabs(exact[i]) + 1.0));
    worst = std::isnan(error) ? INFINITY : std::max(worst, error);
  }
  return worst;
}

// From t0 to t1, every step seen (INFO(3) = 1), with equidistant outputs.
template <class Integer = std::int32_t>
DgeldaFamilyRun run_dgelda(DgeldaFamily<Integer>& functions, double t0, double t1,
                           const DgeldaFamilyOptions& options) {
  const LinearFamily& family = functions.problem.family();
  Dgelda<Integer> call = functions.arguments(options.method, t0);
  if (!options.x0.empty()) std::copy(options.x0.begin(), options.x0.end(), call.x.data());
  call.set_tolerance(options.tol);
  call.info(3) = 1;
  call.info(5) = options.constant ? 1 : 0;

  DgeldaFamilyRun run;
  for (int i = 1; i <= options.outputs; ++i) {
    const double tout = i == options.outputs ? t1 : t0 + (t1 - t0) * i / options.outputs;
    do {
      run.ierr = call.call(tout);
      const double error = weighted_error(family, options.tol, call.t, call.x.data());
      if (run.ierr <= 1) run.step_error = std::max(run.step_error, error);
      if (run.ierr > 1) run.output_error = std::max(run.output_error, error);
    } while (run.ierr == 1 && call.attempts() < 100000);
    if (run.ierr < 0) break;
  }
  run.t = call.t;
  run.x.assign(call.x.data(), call.x.data() + family.n());
  const auto value = [&](int i) { return static_cast<int>(call.cval(i)); };
  run.values = {value(1), value(2), value(3), value(4), value(4)};
  run.steps = call.steps();
  run.attempts = call.attempts();
  run.evaluations = static_cast<long>(call.iwork(12));
  run.factorizations = static_cast<long>(call.iwork(13));
  return run;
}

}  // namespace sfdae_test
