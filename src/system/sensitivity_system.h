// Interface of a problem for the driver of sensitivities S = dx/dp: the linear strangeness-free system of S along x.
//
// The derivative array of F(t, x, x', p) = 0 differentiated by p has the matrices of its linearization: S solves
//
//     Z1^T (E S' - A S - f) = 0,   A2 S + f2 = 0,        E = F_x',  A = -F_x,  f = -F_p
//
// with the Z1, A2 of the state, discretized as the state is [FTB97, MP96]. One column for each of `count` parameters,
// n x count in column-major order, in the user's units everywhere.
//
// [FTB97] W. F. Feehery, J. E. Tolsma, P. I. Barton: Efficient sensitivity analysis of large-scale
// differential-algebraic
//         systems. Appl. Numer. Math. 25 (1997).
// [MP96]  T. Maly, L. R. Petzold: Numerical methods and software for sensitivity analysis of differential-algebraic
//         systems. Appl. Numer. Math. 20 (1996).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "linalg/archive.h"
#include "problem/problem.h"
#include "system/adjoint_system.h"
#include "system/consistency_request.h"
#include "system/stage_method.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

struct SensitivityCounts {
  long linearizations = 0, factorizations = 0;
};

class SensitivitySystem {
 public:
  virtual ~SensitivitySystem() = default;

  virtual int unknowns() const = 0;
  // Their numbers, as of ParameterSeries.
  virtual const std::vector<int>& parameters() const = 0;
  int count() const { return static_cast<int>(parameters().size()); }
  std::size_t size() const { return index(unknowns()) * index(count()); }

  // The parameters of the equations have changed since the start.
  virtual void parameters_changed() = 0;

  // Everything below refers to the current point of the system of x, which has converged there.
  // F1 with S' = c S + rest, and F2; xdot: D_h x. On entry S is an initial guess.
  virtual PointStatus solve_step(double c, const double* rest, const double* xdot, double* S) = 0;
  // Stage i of the step that the system of x has solved last, or of one whose stages it has been moved to, one by
  // one. xdot: x' there, as discretized or true.
  virtual PointStatus keep_stage_of_step(const StageMethod& method, int i, const double* xdot) = 0;
  virtual PointStatus keep_stage(const StageMethod& method, int i, const double* xdot) = 0;
  // Solves a step h from S_start; S: one block for each stage. ok or singular.
  virtual PointStatus solve_kept_stages(const StageMethod& method, double h, const double* S_start, double* S) = 0;
  // S with F2 = 0 whose differential part is that of the initial guess.
  virtual PointStatus restore(const double* guess, double* S) = 0;
  // Maps errors of the differential part to errors of S; at the point or at the end of the stages that were solved for
  // last.
  virtual void error_in_S(const double* errors, double* mapped) = 0;
  // S' of sensitivities restored here, or of a stage stored here. On entry it is S' of a polynomial, which is corrected
  // where the derivative array does not determine it.
  virtual PointStatus derivative(const double* S, double* Sdot) = 0;
  // The S nearest to the directions given, as the request measures changes of x. Throws Failure if none exists.
  virtual void start(const ConsistencyRequest& request, const double* directions, double* S) = 0;

  // The same equations transposed, for the same parameters, along the same system of x.
  virtual std::unique_ptr<AdjointSystem> adjoint() = 0;

  // Contradiction of redundant equations at the point linearized last, relative.
  virtual double inconsistency() const = 0;
  virtual const CallbackError& callback_error() const = 0;
  virtual SensitivityCounts counts() const = 0;

  // State that later steps depend on, apart from the system of x and S. Reading: in place of start(). Throws
  // DamagedArchive.
  virtual void archive(Archive& archive) = 0;
};

}  // namespace sfdae::core
