// The equations of a nonlinear problem with the result of their index analysis, evaluated along jets.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "problem/nonlinear_problem.h"
#include "reduction/index_analysis.h"
#include "reduction/null_space_form.h"
#include "system/jet.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class AnalyzedEquations {
 public:
  // analysis is kept by reference. callback_error receives the error of the last callback.
  AnalyzedEquations(NonlinearProblem& problem, const AnalysisSettings& settings, const IndexAnalysis& analysis,
                    Units units, CallbackError& callback_error)
      : problem_(problem),
        settings_(settings),
        analysis_(analysis),
        units_(std::move(units)),
        callback_error_(callback_error),
        input_values_(problem.prescribed().size() + 1) {}

  NonlinearProblem& problem() const { return problem_; }
  const AnalysisSettings& settings() const { return settings_; }
  const IndexAnalysis& analysis() const { return analysis_; }
  const Units& units() const { return units_; }
  Units& units() { return units_; }
  int m() const { return problem_.m(); }
  int n() const { return problem_.n(); }
  int mu() const { return analysis_.values.mu; }
  // Order of the jets that satisfy F_mu = 0.
  int jet_order() const { return mu() + 1; }
  // Number of residuals of F_mu.
  int array_rows() const { return m() * (mu() + 1); }

  // Prescribed components, and their values at the t evaluated last.
  const std::vector<int>& prescribed() const { return problem_.prescribed(); }
  const std::vector<double>& input_values() const { return input_values_; }
  PointStatus evaluate_inputs(double t) { return status_of(problem_.evaluate_prescribed(t, input_values_.data())); }
  // F_0, ..., F_level along a jet of order level + 1.
  PointStatus residuals(double t, const double* jet, int level, double* F) {
    return status_of(problem_.residuals(t, jet, level, F));
  }
  // Taylor coefficients up to order mu; preferred_rows: factors of rows to take again, or null.
  PointStatus linearize(const Jet& jet, const std::vector<double>* preferred_rows, TaylorData& data) {
    return linearize(jet, preferred_rows, data, analysis_.rows);
  }
  PointStatus linearize(const Jet& jet, const std::vector<double>* preferred_rows, TaylorData& data,
                        RowScaling rows) {
    const NonlinearProblem::Scaling scaling{analysis_.time_scale, rows, preferred_rows, &units_};
    return status_of(problem_.linearize(jet.t, jet.x.data(), {mu(), mu(), mu()}, scaling, data));
  }

 private:
  PointStatus status_of(CallbackError&& error) {
    callback_error_ = std::move(error);
    return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
  }

  NonlinearProblem& problem_;
  AnalysisSettings settings_;
  const IndexAnalysis& analysis_;
  Units units_;
  CallbackError& callback_error_;
  std::vector<double> input_values_;
};

}  // namespace sfdae::core
