// Search for singular points of a nonlinear system between two points of an integration.
//
// The solution in between is interpolated. At a singular point the sign of det(Z1^T F_x' T2) changes (bases aligned
// from point to point), or E T2 or A2 lose rank: values relative to one point, with the row factors from there, vanish
// (docs/design/singular_points.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "array/analyzed_equations.h"
#include "array/array_linearization.h"
#include "array/jet_course.h"
#include "array/singularity_sample.h"
#include "linalg/arena.h"
#include "reduction/stored_elimination.h"
#include "system/singular_part.h"

namespace sfdae::core {

class SingularitySearch {
 public:
  SingularitySearch(AnalyzedEquations& problem, const ArrayLinearization& linearization,
                    const CallbackError& callback_error)
      : problem_(problem), linearization_(linearization), callback_error_(callback_error) {}

  JetCourse& course() { return course_; }
  const JetCourse& course() const { return course_; }
  // Linearizes at the jet, with the known ranks. False if that is not possible. Throws Failure if a callback stops.
  bool measure(const Jet& jet, SingularitySample& sample);
  // Likewise at the interpolated jet.
  bool measure_at(double t, SingularitySample& sample);
  // Sets the factor by which values have to fall to count as vanished.
  void set_dip(double dip) { dip_ = dip; }
  // A point between left and right where the sign changes and something vanishes.
  std::optional<double> find_turn(double left, double right);
  // A point between left and right where something vanishes. before, after: sizes at the ends of the sample value with
  // that number, which raised the suspicion.
  struct Suspicion {
    double left, right;
    std::size_t number;
    double before, after;
  };
  std::optional<double> find_dip(const Suspicion& suspicion);
  // Tells whether something vanishes at t, a point of the integration that is between two others.
  bool vanishes_at(double t, double before, double after);
  // A point beyond the last accepted one where something vanishes if the solution continues as it has. h: the size of a
  // step that has failed.
  std::optional<double> find_ahead(double h);
  // The consistent jet near the interpolated one at t, whose derivatives may be far from those of any solution if x is
  // inconsistent; none if none is near.
  std::optional<Jet> consistent_at(double t);
  // Fraction of the smallest values kept at a jet, relative to the reference of the last search.
  double kept_of(const Jet& jet);
  // The same at the consistent jet near one from which no step succeeds: it may be farther away.
  std::optional<double> kept_consistently_at_end(const Jet& reference, const Jet& jet);
  // The characteristic values at a singular point of the interpolated solution; undetermined if no consistent values
  // are found nearby.
  CharacteristicValues values_at(double t);
  // The part that has fallen at a jet near a singular point, relative to the reference of the last search.
  SingularPart fallen_part(const Jet& jet);
  SingularPart fallen_part_at(double t) { return fallen_part(interpolated(t)); }
  // Fraction of the smallest values kept at `jet`, relative to `reference`; 1 if that is unknown.
  double kept(const Jet& reference, const Jet& jet);

 private:
  // The smallest values kept of A^ and E T2.
  struct Kept {
    double constraints = 1.0, differential = 1.0;
  };
  bool reduce(const Jet& jet, const std::vector<double>* rows, RowScaling scaling);
  bool correct(Jet& jet);
  void improve_course();
  bool set_reference(const Jet& jet);
  const Jet& interpolated(double t);
  std::optional<Jet> consistent_near(const Jet& jet, double within);
  template <class Use>
  void use_consistent(const Jet& jet, double within, Use use);
  double kept_at(double t);
  Kept relative(const Jet& jet);
  bool is_resolved(double left, double right) const;
  std::optional<double> find_ahead_of(double t, double before, double kept_before);
  double smallest(double left, double middle, double right, double& kept);

  AnalyzedEquations& problem_;
  const ArrayLinearization& linearization_;
  const CallbackError& callback_error_;
  Arena arena_;
  JetCourse course_;
  Jet jet_;
  TaylorData data_;
  NullSpaceForm form_;
  StoredElimination elimination_;
  SingularitySample left_, middle_, right_;
  // Reference of the smallest values.
  struct Reference {
    std::vector<double> rows;  // factors
    Kept kept;
  } reference_;
  std::vector<double> transformed_, dy_;
  double dip_ = 0.0;
  bool is_measured_ = false;  // middle_ is a sample of the last suspicion, in this interval
  double measured_from_ = 0.0, measured_to_ = 0.0;
  // The current search: the length of its interval, the largest credible size of x at interpolated points, and whether
  // a point could not be evaluated.
  struct Range {
    double span = 0.0;
    double credible_size = std::numeric_limits<double>::infinity();
    bool has_failed = false;
  } range_;
};

}  // namespace sfdae::core
