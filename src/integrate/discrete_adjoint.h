// The discrete adjoint of an integration: its steps are kept, and the equations of their sensitivities read backward.
//
// S_k = dx(t_k)/dp at the points of an integration follows from earlier ones by the linear equations that
// sensitivities.h solves. For a functional with weights w_k of x(t_k) the gradient sum_k S_k^T w_k is found in one
// pass from the last point to the first: lambda_k = w_k + what later steps make of S_k. What is found is the exact
// gradient of what the integration has computed, hidden constraints included, but for the choice of its steps. Where
// not all steps may be kept, those of earlier pieces of the integration are made again from checkpoints [GW08, with
// two levels].
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
  std::size_t bytes = 0;  // of what is kept
};

class DiscreteAdjoint final : public Companion {
 public:
  // S: at the point where the system of x stands, consistent, n x count. max_kept_steps: 0: all.
  DiscreteAdjoint(std::unique_ptr<AdjointSystem> system, std::vector<double> S, long max_kept_steps);

  void start(const Integrator& integrator) override;
  void prepare(Integrator& integrator, const IntegrationOptions& options, double t) override;
  void note(AttemptEnd end) override;
  StepOutcome attempt(Integrator& integrator, const Tolerances& tolerances) override;
  void commit(Integrator& integrator) override;

  // The integration ends at t, within the last step: one more point. move_to(t): the system of x is moved to a point
  // there, and its x' returned. Nothing has changed where that throws.
  void end_within(const Integrator& integrator, double t, const std::function<const double*(double)>& move_to);
  // No more steps follow: those that can be made again are dropped.
  void drop_all();
  // Where the system of x stands. Throws Failure.
  TangentSpace tangent_space();
  const std::vector<double>& values_at_start() const { return S_; }

  // The start, the end of a step (the last one at that time), or a point within a step.
  struct Place {
    std::size_t point;  // its number, or that of the point where the step ends
    bool is_within;     // and then at t
    double t;
  };
  // None: not between the start and the last point.
  std::optional<Place> place_of(double t) const;

  // weights: n x places.size() for each functional, one after the other; gradient: count x functionals. Throws Failure.
  struct Functionals {
    const std::vector<Place>& places;
    const double* weights;
    int count;
  };
  // accuracy: of what steps to points within others leave.
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
  std::size_t length_of_pieces_;  // 0: there is one only
  std::vector<double> times_;     // of all points
  std::deque<StepPiece> pieces_;
  std::size_t kept_points_ = 0, next_to_drop_ = 0;  // of all pieces; a piece
  std::size_t origin_ = 0;                          // the point at which the history of BDF starts
  KeptStep tried_, last_;                           // the step that was tried, or taken, last
  std::vector<KeptPoint> tried_points_;
  std::vector<double> xdot_;
  long repeated_steps_ = 0;
  long failed_evaluations_ = 0;  // of the system, before the last attempt
};

}  // namespace sfdae::core
