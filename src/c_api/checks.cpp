// Checks of user input.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/checks.h"

#include <cmath>
#include <string>
#include <vector>

#include "integrate/integration.h"
#include "integrate/step_control.h"
#include "linalg/column_pattern.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "solver/status_of.h"

namespace sfdae::core {

namespace {

// Limits on dimensions. Recorded equations, and functions with patterns, may be solved with sparse matrices.
constexpr int largest_dimension = most_dense_unknowns, largest_sparse = 50000;

bool is_flag(int value) { return value == 0 || value == 1; }

// Finite and not negative; comparisons with NaN are false.
bool is_size(double value) { return std::isfinite(value) && value >= 0.0; }

void check_tolerances(const sfdae_options& options, int n) {
  for (int i = 0; i < n; ++i) {
    const double rtol = options.rtol_vector ? options.rtol_vector[i] : options.rtol;
    const double atol = options.atol_vector ? options.atol_vector[i] : options.atol;
    if (!is_size(rtol) || rtol >= 1.0)
      refuse_argument(format("rtol of component %d is %g; it must be in [0, 1).", i, rtol));
    if (!is_size(atol)) refuse_argument(format("atol of component %d is %g; it must be finite and >= 0.", i, atol));
    if (rtol == 0.0 && atol == 0.0) refuse_argument(format("rtol and atol of component %d are both zero.", i));
  }
}

void check_initial_values(const sfdae_options& options, int n) {
  if (options.initial_values < SFDAE_INITIAL_NEAREST || options.initial_values > SFDAE_INITIAL_ACCEPT)
    refuse_argument(format("initial_values is %d; it must be one of SFDAE_INITIAL_...", options.initial_values));
  if (options.initial_values == SFDAE_INITIAL_FIXED) {
    if (options.fixed == nullptr) refuse_argument("initial_values is SFDAE_INITIAL_FIXED, but fixed is NULL.");
    for (int i = 0; i < n; ++i)
      if (!is_flag(options.fixed[i]))
        refuse_argument(format("fixed[%d] is %d; flags are 0 or 1.", i, options.fixed[i]));
  }
  for (int i = 0; i < n && options.initial_weights != nullptr; ++i)
    if (!is_size(options.initial_weights[i]) || options.initial_weights[i] == 0.0)
      refuse_argument(format("initial_weights[%d] is %g; weights must be positive.", i, options.initial_weights[i]));
}

void check_dimensions(int m, int n, int largest = largest_dimension) {
  if (m < 0 || n < 0 || m > largest || n > largest)
    refuse_argument(format("num_equations = %d, num_unknowns = %d: must be 1 ... %d.", m, n, largest));
  if (m == 0 || n == 0)
    throw Failure(SFDAE_EMPTY_PROBLEM,
                  format("num_equations = %d, num_unknowns = %d: there is nothing to solve.", m, n));
}

template <class AnyProblem>
void check_prescribed(const AnyProblem& problem) {
  const int n = problem.num_unknowns;
  if (problem.num_prescribed < 0 || problem.num_prescribed > n)
    refuse_argument(format("num_prescribed = %d; it must be 0 ... num_unknowns.", problem.num_prescribed));
  if (problem.num_prescribed == 0) return;
  if (problem.prescribed == nullptr || problem.prescribed_values == nullptr)
    refuse_argument("num_prescribed > 0, but prescribed or prescribed_values is NULL.");
  std::vector<char> seen(index(n), 0);
  for (int i = 0; i < problem.num_prescribed; ++i) {
    const int j = problem.prescribed[i];
    if (j < 0 || j >= n) refuse_argument(format("prescribed[%d] = %d; components are 0 ... %d.", i, j, n - 1));
    if (seen[index(j)] != 0) refuse_argument(format("component %d is prescribed twice.", j));
    seen[index(j)] = 1;
  }
}

struct NamedPattern {
  const char* name;
  GivenPattern pattern;
  bool is_given() const { return pattern.entries != 0 || pattern.start != nullptr || pattern.row != nullptr; }
};

// Checks that patterns of both matrices are given, or none.
void check_patterns(const NamedPattern& first, const NamedPattern& second, int m, int n) {
  if (!first.is_given() && !second.is_given()) return;
  for (const NamedPattern* one : {&first, &second}) {
    if (!one->is_given())
      refuse_argument(format("the pattern of %s is missing: give those of both matrices or none.", one->name));
    if (const std::string wrong = complaint_about(one->pattern, one->name, m, n); !wrong.empty())
      refuse_argument(wrong);
  }
}

void check_form(int matrices, int highest, bool has_patterns) {
  if (matrices < SFDAE_MATRICES_DENSE || matrices > highest)
    refuse_argument(format("matrices is %d; it must be one of SFDAE_MATRICES_...", matrices));
  if (matrices != SFDAE_MATRICES_DENSE && !has_patterns)
    refuse_argument("matrices is not SFDAE_MATRICES_DENSE: patterns have to be given.");
}

}  // namespace

namespace {

constexpr int most_conditions = 1000;

template <class CallbackProblem>
void check_conditions(const CallbackProblem& problem) {
  if (problem.num_conditions < 0 || problem.num_conditions > most_conditions)
    refuse_argument(format("num_conditions = %d; it must be 0 ... %d.", problem.num_conditions, most_conditions));
  if (problem.num_conditions > 0 && (problem.conditions == nullptr || problem.branches == nullptr))
    refuse_argument("num_conditions > 0, but conditions or branches is NULL.");
}

}  // namespace

void check_problem(const sfdae_linear_problem& problem) {
  check_conditions(problem);
  if (problem.num_conditions > 0 && problem.num_prescribed > 0)
    refuse_argument("linear equations with conditions cannot have prescribed components.");
  if (problem.num_conditions > 0 && problem.matrices != SFDAE_MATRICES_DENSE)
    refuse_argument("linear equations with conditions have matrices of the form SFDAE_MATRICES_DENSE.");
  const bool may_be_sparse = problem.matrices == SFDAE_MATRICES_COMPRESSED && problem.num_prescribed == 0 &&
                             problem.num_equations == problem.num_unknowns;
  check_dimensions(problem.num_equations, problem.num_unknowns, may_be_sparse ? largest_sparse : largest_dimension);
  const NamedPattern E{"E", {problem.E_entries, problem.E_col_start, problem.E_row_index}},
      A{"A", {problem.A_entries, problem.A_col_start, problem.A_row_index}};
  check_form(problem.matrices, SFDAE_MATRICES_COMPRESSED, E.is_given());
  check_patterns(E, A, problem.num_equations, problem.num_unknowns);
  if (problem.E == nullptr || problem.A == nullptr) refuse_argument("the callbacks E and A must be set.");
  if (!is_flag(problem.constant_E) || !is_flag(problem.constant_A))
    refuse_argument(
        format("constant_E = %d, constant_A = %d: flags are 0 or 1.", problem.constant_E, problem.constant_A));
  return check_prescribed(problem);
}

namespace {

bool has_callback(const sfdae_nonlinear_problem& problem) {
  return problem.total_derivative != nullptr || problem.derivative_array != nullptr;
}

void check_jacobians(const sfdae_nonlinear_problem& problem) {
  const NamedPattern F_x{"F_x", {problem.F_x_entries, problem.F_x_col_start, problem.F_x_row_index}},
      F_xdot{"F_xdot", {problem.F_xdot_entries, problem.F_xdot_col_start, problem.F_xdot_row_index}};
  if (F_x.is_given() && !has_callback(problem))
    refuse_argument("patterns are for total_derivative and derivative_array: those of formulas are known.");
  const bool are_differences = problem.matrices == SFDAE_MATRICES_DIFFERENCES;
  if (are_differences && !has_callback(problem))
    refuse_argument(
        "SFDAE_MATRICES_DIFFERENCES is for total_derivative and derivative_array: derivatives of formulas are "
        "known.");
  if (problem.derivative_array != nullptr && problem.matrices == SFDAE_MATRICES_COMPRESSED)
    refuse_argument("derivative_array writes all entries of its Jacobian: matrices must not be compressed.");
  check_form(problem.matrices, SFDAE_MATRICES_DIFFERENCES, F_x.is_given() || are_differences);
  return check_patterns(F_x, F_xdot, problem.num_equations, problem.num_unknowns);
}

}  // namespace

void check_problem(const sfdae_nonlinear_problem& problem) {
  const bool has_structure = problem.num_equations == problem.num_unknowns && problem.num_prescribed == 0 &&
                             problem.differentiations == nullptr;
  const bool may_be_sparse =
      has_structure &&
      (!has_callback(problem) || (problem.matrices != SFDAE_MATRICES_DENSE && problem.F_x_col_start != nullptr));
  check_dimensions(problem.num_equations, problem.num_unknowns, may_be_sparse ? largest_sparse : largest_dimension);
  const int functions = (problem.equations != nullptr) + (problem.linear_equations != nullptr) +
                        (problem.total_derivative != nullptr) + (problem.derivative_array != nullptr);
  if (functions != 1)
    refuse_argument(
        format("%d of the functions equations, linear_equations, total_derivative and derivative_array are set; it "
               "must be one.",
               functions));
  check_jacobians(problem);
  check_conditions(problem);
  if (problem.num_conditions > 0 && !has_callback(problem))
    refuse_argument("conditions are for total_derivative and derivative_array: those of formulas are known.");
  for (int i = 0; problem.differentiations != nullptr && i < problem.num_equations; ++i)
    if (problem.differentiations[i] < 0 || problem.differentiations[i] > max_strangeness_index)
      refuse_argument(format("differentiations[%d] = %d; it must be 0 ... %d.", i, problem.differentiations[i],
                             max_strangeness_index));
  return check_prescribed(problem);
}

namespace {

// Checks that the functions for the given constraints are present.
void check_functions(const sfdae_multibody_problem& problem) {
  const int nv = problem.num_velocities > 0 ? problem.num_velocities : problem.num_positions;
  if (problem.forces == nullptr) refuse_argument("neither equations nor the callback forces is set.");
  if (problem.num_constraints > 0 && (problem.constraints == nullptr || problem.constraint_jacobian == nullptr))
    refuse_argument("num_constraints > 0, but constraints or constraint_jacobian is NULL.");
  if (problem.num_nonholonomic > 0 && problem.nonholonomic_matrix == nullptr)
    refuse_argument("num_nonholonomic > 0, but nonholonomic_matrix is NULL.");
  if (problem.kinematics == nullptr && nv != problem.num_positions)
    refuse_argument(format("num_positions = %d and num_velocities = %d differ, but kinematics is NULL.",
                           problem.num_positions, nv));
}

}  // namespace

void check_problem(const sfdae_multibody_problem& problem) {
  const int nq = problem.num_positions, nv = problem.num_velocities, nl = problem.num_constraints,
            nk = problem.num_nonholonomic;
  for (int count : {nq, nv, nl, nk})
    if (count < 0 || count > largest_dimension)
      refuse_argument(
          format("num_positions = %d, num_velocities = %d, num_constraints = %d, num_nonholonomic = %d: "
                 "must be 0 ... %d.",
                 nq, nv, nl, nk, largest_dimension));
  if (nq == 0) throw Failure(SFDAE_EMPTY_PROBLEM, "num_positions = 0: there is nothing to move.");
  if (nq + (nv > 0 ? nv : nq) + nl + nk > largest_dimension)
    refuse_argument(format("there are more than %d unknowns.", largest_dimension));
  if (problem.coordinates != SFDAE_COORDINATES_ORTHOGONAL && problem.coordinates != SFDAE_COORDINATES_PERMUTATION)
    refuse_argument(format("coordinates is %d; it must be one of SFDAE_COORDINATES_...", problem.coordinates));
  if (problem.equations == nullptr) check_functions(problem);
}

void check_options(const sfdae_options& options, int n) {
  check_tolerances(options, n);
  check_initial_values(options, n);
  if (options.max_index < 0 || options.max_index > max_strangeness_index)
    refuse_argument(format("max_index is %d; it must be 0 ... %d.", options.max_index, max_strangeness_index));
  if (options.reduction != SFDAE_REDUCTION_STAGED && options.reduction != SFDAE_REDUCTION_SVD)
    refuse_argument(format("reduction is %d; it must be one of SFDAE_REDUCTION_...", options.reduction));
  if (!is_size(options.rank_tol) || options.rank_tol >= 1.0)
    refuse_argument(format("rank_tol is %g; it must be in [0, 1).", options.rank_tol));
  if (!is_size(options.time_scale))
    refuse_argument(format("time_scale is %g; it must be finite, >= 0.", options.time_scale));
  if (!is_flag(options.difference_derivatives) || !is_flag(options.ignore_inconsistency) ||
      !is_flag(options.use_stop_time) || !is_flag(options.xdot_is_guess) || !is_flag(options.check_derivatives))
    refuse_argument(
        "difference_derivatives, ignore_inconsistency, use_stop_time, xdot_is_guess and check_derivatives are flags: "
        "0 or 1.");
  if (!is_size(options.difference_step))
    refuse_argument(format("difference_step is %g; it must be finite, >= 0.", options.difference_step));
  if (!std::isfinite(options.consistency_tol) || options.consistency_tol <= 0.0 || options.consistency_tol >= 1.0)
    refuse_argument(format("consistency_tol is %g; it must be in (0, 1).", options.consistency_tol));
  if (options.max_order < 1 || options.max_order > max_bdf_order)
    refuse_argument(format("max_order is %d; it must be 1 ... %d.", options.max_order, max_bdf_order));
  if (!is_size(options.initial_step))
    refuse_argument(format("initial_step is %g; it must be finite, >= 0.", options.initial_step));
  if (!is_size(options.max_step))
    refuse_argument(format("max_step is %g; it must be finite, >= 0.", options.max_step));
  if (options.use_stop_time == 1 && !std::isfinite(options.stop_time))
    refuse_argument(format("stop_time is %g; it must be finite.", options.stop_time));
  if (options.max_steps < 1) refuse_argument(format("max_steps is %ld; it must be >= 1.", options.max_steps));
  if (!is_size(options.max_seconds))
    refuse_argument(format("max_seconds is %g; it must be finite, >= 0.", options.max_seconds));
  if (options.leading_term < SFDAE_LEADING_AUTOMATIC || options.leading_term > SFDAE_LEADING_IDENTITY)
    refuse_argument(format("leading_term is %d; it must be one of SFDAE_LEADING_...", options.leading_term));
  if (options.method < SFDAE_METHOD_BDF || options.method > SFDAE_METHOD_AUTOMATIC)
    refuse_argument(format("method is %d; it must be one of SFDAE_METHOD_...", options.method));
  const auto is_stages = [](int s) { return s >= 1 && s <= max_stages && s % 2 == 1; };
  if (!is_stages(options.min_stages) || !is_stages(options.max_stages) || options.min_stages > options.max_stages)
    refuse_argument(format("min_stages = %d, max_stages = %d; both must be 1, 3, 5 or 7, min_stages <= max_stages.",
                           options.min_stages, options.max_stages));
  if (options.output < SFDAE_OUTPUT_CONSISTENT || options.output > SFDAE_OUTPUT_INTERPOLATED)
    refuse_argument(format("output is %d; it must be one of SFDAE_OUTPUT_...", options.output));
  if (options.structure < SFDAE_STRUCTURE_OFF || options.structure > SFDAE_STRUCTURE_REQUIRED)
    refuse_argument(format("structure is %d; it must be one of SFDAE_STRUCTURE_...", options.structure));
  if (options.conditions != SFDAE_CONDITIONS_SMOOTH && options.conditions != SFDAE_CONDITIONS_EVENTS)
    refuse_argument(format("conditions is %d; it must be one of SFDAE_CONDITIONS_...", options.conditions));
}

}  // namespace sfdae::core
