// Linear problems E x' = A x + f with known characteristic values, as the generators make them and as the library
// sees them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sfdae/sfdae.h>

#include <functional>
#include <string>
#include <vector>

#include "kronecker_form.h"
#include "taylor_series.h"
#include "units.h"

namespace campaign {

// In the problem's own units, at s, up to the order given. Matrices come as zeros.
using Coefficients = std::function<void(double s, int order, TaylorMatrix& E, TaylorMatrix& A)>;
using Inhomogeneity = std::function<void(double s, int order, std::vector<TaylorSeries>& f)>;

struct LinearProblem {
  int m = 0, n = 0;
  CharacteristicValues values;
  Coefficients coefficients;
  Inhomogeneity inhomogeneity;  // empty: f = 0
  Units units;
  bool constant = false;                           // declared so
  int available_order = highest_taylor_order - 1;  // derivatives above are not available
  double begin = 0.0, end = 1.0;                   // interval of interest, own time
};

// The callbacks of a problem, with what they evaluated last.
class LinearCallbacks {
 public:
  explicit LinearCallbacks(const LinearProblem& problem);
  LinearCallbacks(const LinearCallbacks&) = delete;
  LinearCallbacks& operator=(const LinearCallbacks&) = delete;

  sfdae_linear_problem c_problem();

 private:
  static int write_E(double t, int order, double* matrix, void* user);
  static int write_A(double t, int order, double* matrix, void* user);
  static int write_f(double t, int order, double* vector, void* user);
  int write_matrix(double t, int order, bool is_E, double* matrix);
  int write_vector(double t, int order, double* vector);
  void evaluate_matrices(double t, int order);

  const LinearProblem& problem_;
  double t_ = 0.0, t_of_f_ = 0.0;
  int evaluated_order_ = -1;  // of E_, A_ at t_; -1: not evaluated yet
  bool f_evaluated_ = false;
  TaylorMatrix E_, A_;
  std::vector<TaylorSeries> f_;
};

// A solver of the C API that frees itself.
class Solver {
 public:
  Solver(LinearCallbacks& callbacks, const sfdae_options& options);
  ~Solver() { sfdae_destroy(&handle_); }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  sfdae_solver* get() const { return handle_; }

 private:
  sfdae_solver* handle_ = nullptr;
};

sfdae_options default_options();

// What an analysis says.
struct Answer {
  int status = SFDAE_OK;
  CharacteristicValues values;  // if status >= 0
  std::string message;          // if status < 0
};

// The values in use by a solver whose last call returned `status`.
Answer answer_of(sfdae_solver* solver, int status);

// sfdae_analyze over the interval of the problem.
Answer analyze(const LinearProblem& problem, const sfdae_options& options = default_options());

// E, A and E', A' at the begin, what the library says last and its report.
void print(const LinearProblem& problem, sfdae_solver* solver);

}  // namespace campaign
