// What the API asks of a problem, linear or nonlinear: analysis, consistent values, the objects of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "integrate/checkpoint.h"
#include "integrate/integration.h"
#include "multibody/multibody_problem.h"
#include "problem/linear_problem.h"
#include "problem/nonlinear_problem.h"
#include "sfdae/sfdae.h"
#include "system/consistent_values.h"

namespace sfdae::core {

// Options in the form that the core wants.
struct SolverOptions {
  explicit SolverOptions(const sfdae_options& options, int n);
  AnalysisSettings analysis;
  DifferenceOptions differences;
  LeadingTerm leading;
  ConsistencyRequest consistency;
  IntegrationOptions integration;
};

// x: n values, or null where none are known.
struct PointOfInterest {
  double t, toward;
  const double* x;
};

struct Consistent {
  std::vector<double> x, xdot;
  sfdae_initial_report report{};
  bool contradiction = false;
};

class Model {
 public:
  virtual ~Model() = default;
  virtual Problem& problem() = 0;
  virtual int m() const = 0;
  virtual int n() const = 0;
  // Points do not matter to the analysis.
  virtual bool is_constant() const { return false; }
  // The analysis is that of a solution, and needs x.
  virtual bool needs_x() const { return false; }
  virtual LinearProblem* linear() { return nullptr; }
  virtual NonlinearProblem* nonlinear() { return nullptr; }
  virtual MultibodyProblem* multibody() { return nullptr; }
  // Of recorded equations.
  virtual TaylorEvaluator* evaluator() { return nullptr; }
  virtual void parameters_changed() {}

  virtual void set_differences(const DifferenceOptions& options) = 0;
  virtual std::unique_ptr<DaeSystem> analyze(const PointOfInterest& point, const SolverOptions& options,
                                             std::vector<RankDecision>& decisions) = 0;
  // A system like the given one on which questions can be asked without disturbing the integration.
  virtual std::unique_ptr<DaeSystem> copy_of(const DaeSystem& system, const SolverOptions& options) = 0;
  // Consistent values near x, x' in the direction toward `toward`; the system stands there afterwards.
  virtual Consistent consistent_values(DaeSystem& system, const SolverOptions& options,
                                       const PointOfInterest& point) = 0;
  virtual std::unique_ptr<ChangeDetector> detector(DaeSystem& system) = 0;
  virtual CheckpointTarget checkpoint_target(const AnalysisSettings& settings) = 0;
  virtual void count_evaluations(sfdae_statistics& statistics) const = 0;
};

std::unique_ptr<Model> linear_model(const sfdae_linear_problem& problem);
// Takes recorded equations that are linear for what they are.
std::unique_ptr<Model> nonlinear_model(const sfdae_nonlinear_problem& problem);
std::unique_ptr<Model> multibody_model(const sfdae_multibody_problem& problem);

// Throws Failure if that is none.
void demand_finite_derivative(const std::vector<double>& xdot, double t);

}  // namespace sfdae::core
