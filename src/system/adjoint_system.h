// Interface of a problem for the driver of adjoints: the equations of sensitivities (sensitivity_system.h), transposed.
//
// A step computes S from earlier ones and from F_p by linear equations. Read backward, these equations turn weights of
// S into weights of the earlier ones and add the contribution of F_p to the gradient. The result is as exact as the
// sensitivities of the same steps, at a cost that hardly depends on the number of parameters [CLPS03: index 0 and 1].
//
// [CLPS03] Y. Cao, S. Li, L. Petzold, R. Serban: Adjoint sensitivity analysis for differential-algebraic equations:
// the adjoint
//          DAE system and its numerical solution. SIAM J. Sci. Comput. 24 (2003).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "linalg/archive.h"
#include "linalg/matrix.h"
#include "problem/problem.h"
#include "system/dae_system.h"
#include "system/jet.h"
#include "system/stage_method.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

// A point of x that steps were made to, with the data needed to linearize the equations there again.
struct KeptPoint {
  Jet jet;
  std::vector<double> xdot;  // as discretized, where the equations need it
};

// Weights of S, n x columns in the user's units, and the gradient, count x columns, which contributions are added to.
struct AdjointValues {
  View weights, gradient;
};

// All S at a point: S = basis z + offset, z = coordinates S, one column of the offset for each parameter, in the
// user's units. Without constraints z = S, and basis and coordinates, which are unit matrices then, are empty.
struct TangentSpace {
  Matrix basis, coordinates, offset;  // n x d, d x n, n x count
  double inconsistency = 0.0;         // contradiction of redundant equations, relative
  bool is_whole() const { return basis.cols() == 0 && coordinates.cols() == 0; }
};

// A system of x, and the data stored of the points that it is moved to.
class PointKeeper {
 public:
  virtual ~PointKeeper() = default;
  virtual DaeSystem& system() = 0;
  // The point where the system of x stands, or stage i of the step that it has solved last. xdot: D_h x, or null.
  virtual KeptPoint point(const double* xdot) const = 0;
  virtual KeptPoint stage(const StageMethod& method, int i, const double* xdot) const = 0;
};

// A second system of x for steps that are repeated. It stops where the system of the integration is asked to.
class SystemTwin : public PointKeeper {
 public:
  // Restores the archived state of the other system. Throws DamagedArchive.
  virtual void restore(Archive& archive) = 0;
  // Makes these the last two points that were accepted. Throws Failure.
  virtual void stand_between(const KeptPoint& from, const KeptPoint& to) = 0;
  virtual bool stop_is_requested() const = 0;
};

class AdjointSystem : public PointKeeper {
 public:
  virtual int unknowns() const = 0;
  virtual int count() const = 0;
  // The twin of the system of x, which has to be restored before it is used.
  virtual std::unique_ptr<SystemTwin> twin() = 0;
  // False: S has no constraints to fulfill, and interpolated values stay as they are.
  virtual bool has_constraints() const = 0;

  // For a step that solved F1 with S' = c S + rest, and F2: the weights become those of rest.
  virtual PointStatus step_back(const KeptPoint& point, double c, const AdjointValues& values) = 0;
  // For the stages of a step h: weights of S at its end become those of S at its start. points: one for each stage.
  virtual PointStatus step_back(const StageMethod& method, double h, const KeptPoint* points,
                                const AdjointValues& values) = 0;
  // For S with F2 = 0 and the differential part of an initial guess: the weights become those of the guess.
  virtual PointStatus restore_back(const KeptPoint& point, const AdjointValues& values) = 0;

  // No steps are read back for now: memory for that is released.
  virtual void forget_work() = 0;
  // Uses the equations linearized as they are at the point.
  virtual PointStatus find_tangent_space(const KeptPoint& point, TangentSpace& space) = 0;

  virtual const CallbackError& callback_error() const = 0;
};

}  // namespace sfdae::core
