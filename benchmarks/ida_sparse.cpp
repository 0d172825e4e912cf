// SPDX-License-Identifier: BSD-3-Clause
#include "ida_sparse.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <cstdlib>

namespace sfdae_bench {

namespace {

std::size_t at(sunindextype i) { return static_cast<std::size_t>(i); }

// All that belongs to one integration; freed in the order that IDA asks for.
class SparseIda {
 public:
  SparseIda(const SparsePeer& problem, double tol, PeerMatrix kind)
      : problem_(problem), kind_(kind), n_(static_cast<sunindextype>(problem.x0.size())) {
    SUNContext_Create(nullptr, &context_);
    x_ = N_VNew_Serial(n_, context_);
    xdot_ = N_VNew_Serial(n_, context_);
    std::copy(problem.x0.begin(), problem.x0.end(), N_VGetArrayPointer(x_));
    std::copy(problem.xdot0.begin(), problem.xdot0.end(), N_VGetArrayPointer(xdot_));
    make_matrix();
    memory_ = IDACreate(context_);
    check(IDAInit(memory_, &SparseIda::residual, 0.0, x_, xdot_));
    check(IDASetErrFile(memory_, nullptr));  // failures are reported by the caller
    check(IDASetUserData(memory_, this));
    check(IDASStolerances(memory_, tol, tol));
    check(IDASetLinearSolver(memory_, solver_, matrix_));
    check(IDASetJacFn(memory_, &SparseIda::jacobian));
    check(IDASetMaxNumSteps(memory_, 100000));
    check(IDASetStopTime(memory_, problem.tf));
  }
  ~SparseIda() {
    IDAFree(&memory_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    N_VDestroy(x_);
    N_VDestroy(xdot_);
    SUNContext_Free(&context_);
  }
  SparseIda(const SparseIda&) = delete;
  SparseIda& operator=(const SparseIda&) = delete;

  SparsePeerRun run() {
    SparsePeerRun run;
    double t = 0.0;
    if (status_ >= 0) check(IDASolve(memory_, problem_.tf, &t, x_, xdot_, IDA_NORMAL));
    if (status_ < 0) run.failure = "IDA " + std::to_string(status_);
    run.x.assign(N_VGetArrayPointer(x_), N_VGetArrayPointer(x_) + n_);
    IDAGetNumSteps(memory_, &run.steps);
    IDAGetNumResEvals(memory_, &run.residuals);
    IDAGetNumJacEvals(memory_, &run.jacobians);
    return run;
  }

 private:
  static int residual(realtype t, N_Vector x, N_Vector xdot, N_Vector F, void* self) {
    static_cast<SparseIda*>(self)->problem_.residual(t, N_VGetArrayPointer(x), N_VGetArrayPointer(xdot),
                                                     N_VGetArrayPointer(F));
    return 0;
  }
  static int jacobian(realtype, realtype c, N_Vector x, N_Vector, N_Vector, SUNMatrix J, void* self, N_Vector,
                      N_Vector, N_Vector) {
    static_cast<SparseIda*>(self)->fill(c, N_VGetArrayPointer(x), J);
    return 0;
  }
  void make_matrix() {
    const std::vector<int>&first = problem_.first, &row = problem_.row;
    if (kind_ == PeerMatrix::klu) {
      matrix_ = SUNSparseMatrix(n_, n_, static_cast<sunindextype>(row.size()), CSC_MAT, context_);
      solver_ = SUNLinSol_KLU(x_, matrix_, context_);
      return;
    }
    sunindextype lower = 0, upper = 0;
    for (sunindextype j = 0; j < n_; ++j)
      for (int k = first[at(j)]; k < first[at(j + 1)]; ++k) {
        lower = std::max(lower, row[at(k)] - j);
        upper = std::max(upper, j - row[at(k)]);
      }
    matrix_ = SUNBandMatrix(n_, upper, lower, context_);
    solver_ = SUNLinSol_Band(x_, matrix_, context_);
  }
  void fill(double c, const double* x, SUNMatrix J) {
    const std::vector<int>&first = problem_.first, &row = problem_.row;
    if (kind_ == PeerMatrix::klu) {
      std::copy(first.begin(), first.end(), SUNSparseMatrix_IndexPointers(J));
      std::copy(row.begin(), row.end(), SUNSparseMatrix_IndexValues(J));
      problem_.jacobian(c, x, SUNSparseMatrix_Data(J));
      return;
    }
    values_.resize(row.size());
    problem_.jacobian(c, x, values_.data());
    for (sunindextype j = 0; j < n_; ++j) {
      double* column = SM_COLUMN_B(J, j);
      for (int k = first[at(j)]; k < first[at(j + 1)]; ++k)
        SM_COLUMN_ELEMENT_B(column, row[at(k)], j) = values_[at(k)];
    }
  }
  // Keeps the first failure.
  void check(int status) {
    if (status_ >= 0) status_ = status;
  }

  const SparsePeer& problem_;
  PeerMatrix kind_;
  sunindextype n_;
  SUNContext context_ = nullptr;
  N_Vector x_ = nullptr, xdot_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* memory_ = nullptr;
  int status_ = 0;
  std::vector<double> values_;
};

}  // namespace

bool sparse_ida_is_available() { return true; }

SparsePeerRun solve_with_sparse_ida(const SparsePeer& problem, double tol, PeerMatrix kind) {
  return SparseIda(problem, tol, kind).run();
}

}  // namespace sfdae_bench
