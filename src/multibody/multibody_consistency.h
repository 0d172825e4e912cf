// Consistent positions and velocities of a mechanical system with constraints, and the ranks that hold there.
//
// Positions and velocities that are consistent but for rounding errors stay bit by bit. Else positions move to the
// nearest that fulfil the constraints (multibody_nearest_positions.h), in the metric of multibody_metric.h, and then
// velocities by one linear step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/rank.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_position_search.h"
#include "multibody/multibody_problem.h"
#include "multibody/multibody_ranks.h"
#include "starts/consistent_values.h"

namespace sfdae::core {

class MultibodyConsistency {
 public:
  // request: fixed and weights for all unknowns; mu is ignored. tolerant: the violation of constraints that contradict
  // each other is minimized.
  MultibodyConsistency(MultibodyProblem& problem, double t, const ConsistencyRequest& request, bool tolerant);

  // Consistent positions near q. All functions here throw Failure.
  std::vector<double> positions(const double* q);
  // Ranks at consistent positions, after a check that K is nonsingular. rank_tol: as of partitions.
  MultibodyRanks ranks(const std::vector<double>& q, double rank_tol, std::vector<RankDecision>& decisions);
  int rank_of_mass() const { return rank_of_mass_; }
  bool has_contradiction() const { return has_contradiction_; }
  // Velocities consistent with q, near v.
  std::vector<double> velocities(const std::vector<double>& q, const double* v, int rank);

 private:
  void evaluate_at(const std::vector<double>& q);
  PositionSearch search_at(const std::vector<double>& q);
  double position_tolerance() const;
  // Returns if the violation is tolerated.
  void refuse_positions(const PositionSearch& search, const Matrix& open);
  void check_nearby(const std::vector<double>& q, const MultibodyRanks& ranks);
  // C v + r at the point, in units of the rows.
  std::vector<double> scaled_velocity_residuals() const;
  // Returns if they are rounding errors, or tolerated.
  void refuse_velocities(const std::vector<double>& residuals, const double* given);
  bool has_fixed(int first, int count) const;

  MultibodyProblem& problem_;
  MultibodySizes sizes_;
  double t_;
  const ConsistencyRequest& request_;
  MultibodyPoint point_;
  Arena arena_;
  double rank_tol_ = 0.0;
  int rank_of_mass_ = 0;
  bool tolerant_, has_contradiction_ = false;
};

}  // namespace sfdae::core
