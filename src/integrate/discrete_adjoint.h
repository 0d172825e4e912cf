// Discrete adjoint of an integration: stored steps, through which the sensitivity equations are solved backward.
//
// S_k = dx(t_k)/dp at the points of an integration follows from earlier ones by the linear equations that
// sensitivities.h solves. For a functional with weights w_k of x(t_k) the gradient sum_k S_k^T w_k is computed in one
// pass from the last point to the first: lambda_k = w_k + contributions of later steps to S_k. The result is the exact
// gradient of the numerical solution, including hidden constraints, for the given steps. If memory is limited, steps of
// earlier pieces of the integration are repeated from checkpoints [GW08, with two levels].
//
// [GW08] A. Griewank, A. Walther: Evaluating Derivatives. SIAM, 2nd ed. 2008, chapter 12.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "integrate/companion.h"
#include "integrate/points_within.h"
#include "integrate/step_piece.h"
#include "linalg/matrix.h"
#include "system/adjoint_system.h"

namespace sfdae::core {

struct AdjointWork {
  long kept_steps = 0, checkpoints = 0, repeated_steps = 0;
  std::size_t bytes = 0;  // of the stored data
};

class DiscreteAdjoint final : public Companion {
 public:
  // S: at the current point of the system of x, consistent, n x count. max_kept_steps: 0: all.
  DiscreteAdjoint(std::unique_ptr<AdjointSystem> system, std::vector<double> S, long max_kept_steps);

  void start(const Integrator& integrator) override;
  void prepare(Integrator& integrator, const IntegrationOptions& options, double t) override;
  void note(AttemptEnd end) override;
  StepOutcome attempt(Integrator& integrator, const Tolerances& tolerances) override;
  void commit(Integrator& integrator) override;

  // Ends the integration at t, within the last step, with one more point. move_to(t): moves the system of x to a point
  // there, and returns its x'. An exception changes nothing.
  void end_within(const Integrator& integrator, double t, const std::function<const double*(double)>& move_to);
  // No more steps follow: drops those that can be repeated.
  void drop_all();
  // Tangent space at the current point of the system of x. Throws Failure.
  TangentSpace tangent_space();
  const std::vector<double>& values_at_start() const { return S_; }

  // A place: the start, the end of a step (the last one at that time), or a point within a step.
  struct Place {
    std::size_t point;  // its number, or that of the point at the end of the step
    bool is_within;     // then the place is at t
    double t;
  };
  // Empty if t is not between the start and the last point.
  std::optional<Place> place_of(double t) const;

  // weights: n x places.size() for each functional, one after the other; gradient: count x functionals. Throws Failure.
  struct Functionals {
    const std::vector<Place>& places;
    const double* weights;
    int count;
  };
  // tolerances: accuracy of steps to points within others.
  struct Surroundings {
    PointsWithin::KeepToPiece keep_to_piece;
    const Tolerances& tolerances;
  };
  void gradient(const Functionals& functionals, const Surroundings& surroundings, double* gradient);

  int count() const { return system_->count(); }
  int unknowns() const { return system_->unknowns(); }
  AdjointWork work() const;

 private:
  void demand(PointStatus status, double t) const;
  bool keeps_all() const { return length_of_pieces_ == 0; }
  void begin_piece(Integrator& integrator, const IntegrationOptions& options);
  void drop_pieces();
  struct Backward;
  void read_piece(const StepPiece& piece, const KeptSteps& steps, Backward& backward);
  void read_within(const StepPiece& piece, const KeptSteps& steps, std::size_t i, Backward& backward);
  void read_back(const KeptStep& step, const KeptPoint* points, std::size_t k, Backward& backward);
  void hand_on(const KeptStep& step, std::size_t k, Backward& backward);

  std::unique_ptr<AdjointSystem> system_;
  std::vector<double> S_;
  std::size_t length_of_pieces_;  // 0: there is only one piece
  std::vector<double> times_;     // of all points
  std::deque<StepPiece> pieces_;
  std::size_t kept_points_ = 0, next_to_drop_ = 0;  // of all pieces; index of a piece
  std::size_t origin_ = 0;                          // the point at which the BDF history starts
  KeptStep tried_, last_;                           // the step tried last, and taken last
  std::vector<KeptPoint> tried_points_;
  std::vector<double> xdot_;
  long repeated_steps_ = 0;
  long failed_evaluations_ = 0;  // of the system, before the last attempt
};

}  // namespace sfdae::core
