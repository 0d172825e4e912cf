// Singular points of a nonlinear system between two points that an integration went through.
//
// The solution in between is interpolated; at a singular point the sign of det(Z1^T F_x' T2) changes (bases aligned
// from point to point), or a value of singularity_sample.h vanishes (docs/decisions/31-nonlinear-singular-points.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "linalg/arena.h"
#include "reduction/stored_elimination.h"
#include "system/analyzed_equations.h"
#include "system/array_linearization.h"
#include "system/jet_course.h"
#include "system/singularity_sample.h"

namespace sfdae::core {

class SingularitySearch {
 public:
  SingularitySearch(AnalyzedEquations& problem, const ArrayLinearization& linearization,
                    const CallbackError& callback_error)
      : problem_(problem), linearization_(linearization), callback_error_(callback_error) {}

  JetCourse& course() { return course_; }
  // Linearizes at the jet, with the known ranks. False where that is not possible. Throws Failure where a callback
  // stops.
  bool measure(const Jet& jet, SingularitySample& sample);
  // At the interpolated jet.
  bool measure_at(double t, SingularitySample& sample);
  // Values that fall by this factor have vanished from now on.
  void set_dip(double dip) { dip_ = dip; }
  // A point between left and right where the sign changes and the values vanish.
  std::optional<double> find_turn(double left, double right);
  // A point between left and right where the value of that number vanishes; before, after: its sizes there.
  struct Ends {
    double left, right;
    double before, after;
  };
  std::optional<double> find_dip(Ends ends, std::size_t number);
  // The characteristic values at a singular point of the interpolated solution; undetermined where no consistent
  // values are found near. beside: a sample of a point that is not singular.
  CharacteristicValues values_at(double t, const SingularitySample& beside);

 private:
  bool reduce(const Jet& jet);
  bool correct(Jet& jet);
  void improve_course();
  bool dips_between(Ends ends, std::size_t number, double level);
  double value_at(double t, std::size_t number);
  bool is_resolved(double left, double right) const;
  double smallest(double left, double right, std::size_t number, double& value);

  AnalyzedEquations& problem_;
  const ArrayLinearization& linearization_;
  const CallbackError& callback_error_;
  Arena arena_;
  JetCourse course_;
  Jet jet_;
  TaylorData data_;
  NullSpaceForm form_;
  SingularitySample left_, middle_, right_;
  StoredElimination elimination_;
  std::vector<double> transformed_, dy_;
  double dip_ = 0.0;
  bool has_failed_ = false;  // a point could not be evaluated
  double span_ = 0.0;        // that is searched
};

}  // namespace sfdae::core
