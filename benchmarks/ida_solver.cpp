// SPDX-License-Identifier: BSD-3-Clause
#include "ida_solver.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace sfdae_bench {

namespace {

// All that belongs to one integration; freed in the order that IDA asks for.
class Ida {
 public:
  Ida(const PeerProblem& problem, double tol) : problem_(problem) {
    SUNContext_Create(nullptr, &context_);
    const auto n = static_cast<sunindextype>(problem.x0.size());
    x_ = N_VNew_Serial(n, context_);
    xdot_ = N_VNew_Serial(n, context_);
    differential_ = N_VNew_Serial(n, context_);
    std::copy(problem.x0.begin(), problem.x0.end(), N_VGetArrayPointer(x_));
    std::copy(problem.xdot0.begin(), problem.xdot0.end(), N_VGetArrayPointer(xdot_));
    for (sunindextype i = 0; i < n; ++i) N_VGetArrayPointer(differential_)[i] = i < problem.differential ? 1.0 : 0.0;
    matrix_ = SUNDenseMatrix(n, n, context_);
    solver_ = SUNLinSol_Dense(x_, matrix_, context_);
    memory_ = IDACreate(context_);
    check(IDAInit(memory_, &Ida::residual, problem.t0, x_, xdot_));
    check(IDASetErrFile(memory_, nullptr));  // failures are reported by the caller
    check(IDASetUserData(memory_, this));
    check(IDASStolerances(memory_, tol, tol));
    check(IDASetLinearSolver(memory_, solver_, matrix_));
    check(IDASetId(memory_, differential_));
    check(IDASetSuppressAlg(memory_, problem.low_index ? SUNFALSE : SUNTRUE));
    check(IDASetNonlinConvCoef(memory_, problem.newton_coefficient));
    check(IDASetMaxNumSteps(memory_, max_steps));
  }
  ~Ida() {
    IDAFree(&memory_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    for (N_Vector vector : {x_, xdot_, differential_}) N_VDestroy(vector);
    SUNContext_Free(&context_);
  }
  Ida(const Ida&) = delete;
  Ida& operator=(const Ida&) = delete;

  SolverRun run() {
    std::vector<double> ends = problem_.restarts;
    ends.push_back(problem_.tf);
    for (std::size_t k = 0; k < ends.size() && status_ >= 0; ++k) {
      segment_ = static_cast<int>(k);
      if (k > 0) check(IDAReInit(memory_, ends[k - 1], x_, xdot_));
      // x is continuous at a restart, x' is not.
      if (k > 0 || problem_.differential < static_cast<int>(problem_.x0.size())) make_consistent(ends[k]);
      check(IDASetStopTime(memory_, ends[k]));
      double t = 0.0;
      if (status_ >= 0) check(IDASolve(memory_, ends[k], &t, x_, xdot_, IDA_NORMAL));
      count();
    }
    if (status_ < 0) total_.failure = "IDA " + std::to_string(status_);
    const double* x = N_VGetArrayPointer(x_);
    total_.x.assign(x, x + problem_.x0.size());
    return total_;
  }

 private:
  static constexpr long max_steps = 100000;
  static constexpr double max_seconds = 5.0;

  static int residual(realtype t, N_Vector x, N_Vector xdot, N_Vector F, void* self) {
    Ida& ida = *static_cast<Ida*>(self);
    if (ida.late()) return -1;
    double* values = N_VGetArrayPointer(F);
    ida.problem_.residual(ida.segment_, t, N_VGetArrayPointer(x), N_VGetArrayPointer(xdot), values);
    // Overflow of exponentials at wild iterates: IDA is asked for a smaller step.
    return std::all_of(values, values + ida.problem_.x0.size(), [](double v) { return std::isfinite(v); }) ? 0 : 1;
  }
  // Keeps the first failure.
  void check(int status) {
    if (status_ >= 0) status_ = status;
  }
  void make_consistent(double tout) {
    if (!problem_.low_index) return;
    check(IDACalcIC(memory_, IDA_YA_YDP_INIT, tout));
    check(IDAGetConsistentIC(memory_, x_, xdot_));
  }
  bool late() {
    if (++calls_ % 4096 != 0) return false;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() > max_seconds;
  }
  // IDA counts from its last initialization on.
  void count() {
    long steps = 0, residuals = 0, jacobian_residuals = 0, setups = 0;
    IDAGetNumSteps(memory_, &steps);
    IDAGetNumResEvals(memory_, &residuals);
    IDAGetNumLinResEvals(memory_, &jacobian_residuals);
    IDAGetNumLinSolvSetups(memory_, &setups);
    total_.steps += steps;
    total_.evaluations += residuals + jacobian_residuals;
    total_.factorizations += setups;
  }

  const PeerProblem& problem_;
  SUNContext context_ = nullptr;
  N_Vector x_ = nullptr, xdot_ = nullptr, differential_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* memory_ = nullptr;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  long calls_ = 0;
  int segment_ = 0, status_ = 0;
  SolverRun total_;
};

}  // namespace

bool ida_is_available() { return true; }

SolverRun solve_with_ida(const PeerProblem& problem, double tol) { return Ida(problem, tol).run(); }

}  // namespace sfdae_bench
