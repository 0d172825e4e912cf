// Consistent positions and velocities of a mechanical system with constraints, and the ranks that hold there.
//
// Positions move by damped Gauss-Newton steps (Levenberg-Marquardt with a parameter that vanishes with the residual,
// so that constraints which depend on each other only where they hold do no harm) and then along the constraints to
// the point nearest to what was given; velocities by one linear step. The norm is that of the kinetic energy, where M
// is symmetric and positive definite; for positions, where q' = v besides. Else, or where weights are given, it is
// the (weighted) 2-norm.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/rank.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_problem.h"
#include "multibody/multibody_ranks.h"
#include "system/consistent_values.h"

namespace sfdae::core {

class MultibodyConsistency {
 public:
  // request: fixed and weights for all unknowns; mu does not matter. tolerant: constraints that contradict each other
  // are violated as little as they must.
  MultibodyConsistency(MultibodyProblem& problem, double t, const ConsistencyRequest& request, bool tolerant);

  // All throw Failure. Of q given:
  std::vector<double> positions(const double* q);
  // At consistent positions: ranks, and whether K is regular. rank_tol: as of partitions.
  MultibodyRanks ranks(const std::vector<double>& q, double rank_tol, std::vector<RankDecision>& decisions);
  int rank_of_mass() const { return rank_of_mass_; }
  bool has_contradiction() const { return has_contradiction_; }
  // Velocities that fit q, of v given.
  std::vector<double> velocities(const std::vector<double>& q, const double* v, int rank);

 private:
  void evaluate_at(const std::vector<double>& q);
  Matrix metric(int first, int count, bool by_mass) const;
  Matrix scaled_rows(const ConstraintRows& rows) const;
  double residual(const std::vector<double>& q);
  double position_tolerance() const;
  void approach(std::vector<double>& q);
  bool improve(std::vector<double>& q, double& residual);
  void minimize_change(const std::vector<double>& given, std::vector<double>& q);
  // Returns if that is tolerated.
  void refuse_positions(const std::vector<double>& q, double residual);
  void check_nearby(const std::vector<double>& q, const MultibodyRanks& ranks);
  bool has_fixed(int first, int count) const;
  std::string name_of(int constraint) const;

  MultibodyProblem& problem_;
  MultibodySizes sizes_;
  double t_;
  const ConsistencyRequest& request_;
  MultibodyPoint point_;
  Matrix directions_;  // of positions: dq = P p, |p| the norm
  std::vector<double> scaled_g_;
  Arena arena_;
  double rank_tol_ = 0.0;
  int rank_of_mass_ = 0;
  bool tolerant_, has_contradiction_ = false;
};

}  // namespace sfdae::core
