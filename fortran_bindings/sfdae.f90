! SPDX-License-Identifier: BSD-3-Clause
!
! sfdae - initial value problems for differential-algebraic equations of arbitrary index.
!
!     F(t, x(t), x'(t)) = 0   or   E(t) x'(t) = A(t) x(t) + f(t),
!     m equations, n unknowns, any strangeness index.
!
! Extend one of these; its components are your data:
!
!     nonlinear_dae          `equations` writes F(t, x, x') once, as formulas
!     recorded_linear_dae    `linear_equations` writes E(t), A(t), f(t) once, as formulas
!     linear_dae             `eval_e`, `eval_a`, `eval_f` evaluate E, A, f and their derivatives
!     derivative_dae         `total_derivative` evaluates F and its total derivatives along a jet
!     derivative_array_dae   `derivative_array` evaluates all of them at once, with one Jacobian
!     recorded_multibody_dae `equations` writes a mechanical system with constraints as formulas
!     multibody_dae          `forces`, `constraints`, ... evaluate those of a mechanical system
!
! Then
!
!     type(my_problem), target :: problem
!     type(dae_solver) :: solver
!     call solver%create(problem, status)
!     call solver%start(t0, tend, x, status)
!     call solver%advance(tend, t, x, status)
!     call solver%destroy(status)
!
! Conventions
! - This is the C API of sfdae.h in Fortran style. Components, rows, columns and rank
!    decisions count from 1. Constants and result types have their C names, and sfdae.h explains
!    them and their components (evaluations_residual is evaluations_F there).
!  - status: sfdae_ok, a warning (> 0) or a failure (< 0); solver%message() explains the last one.
!    After a failure output arguments keep their values, except where stated (advance, step).
!  - The problem and the monitor are pointed to, not copied: declare them with `target`, and let
!    them live, in place, as long as the solver. Their numbers of equations, unknowns and
!    prescribed components are read by `create` and must not change afterwards.
!  - A solver is not to be copied or assigned: both copies would own the same memory. Call
!    `destroy` before it goes out of scope; there is no finalizer.
!  - Different solvers are independent, in threads, too. A solver may not be used from within its
!    own callbacks.
!  - If your program has a name of this module, rename or leave out that of the module:
!        use sfdae, only: dae_solver, nonlinear_dae, expr => expression, operator(+), operator(*)
!        use sfdae, lookup => table, partial => derivative
!    Likely candidates also have a name with a prefix: sfdae_choose, sfdae_derivative,
!    sfdae_expression, sfdae_external_value, sfdae_named_parameter, sfdae_table,
!    sfdae_time_derivative. Operators and assignment(=) have to be listed after `only`, too.
!  - Kinds are c_int, c_long and c_double of iso_c_binding, whatever the default kinds are.
module sfdae
  use sfdae_arrays
  use sfdae_control, only: dae_events, dae_monitor, dae_options
  use sfdae_ensembles, only: dae_ensemble, dae_ensemble_monitor, dae_ensemble_results
  use sfdae_expressions
  use sfdae_hybrids, only: dae_hybrid, dae_switch, dae_transition
  use sfdae_linearizations, only: dae_descriptor, dae_linearization
  use sfdae_multibody, only: kinematic_multibody_dae, multibody_dae, multibody_formulas, &
    recorded_multibody_dae
  use sfdae_problems, only: derivative_array_dae, derivative_dae, linear_dae, nonlinear_dae, &
    recorded_linear_dae, sfdae_split_derivative_array, sparsity_pattern
  use sfdae_sensitivities, only: dae_sensitivities
  use sfdae_solver, only: dae_solver, sfdae_check_linear, sfdae_check_multibody, &
    sfdae_check_nonlinear, sfdae_status_name, sfdae_version
  use sfdae_solutions, only: dae_solution
  use sfdae_types
  implicit none
  private

  ! ---- Problems, options, solver ------------------------------------------------------------

  public :: linear_dae, nonlinear_dae, recorded_linear_dae, derivative_dae, derivative_array_dae, &
    sparsity_pattern
  public :: recorded_multibody_dae, multibody_dae, kinematic_multibody_dae, multibody_formulas
  public :: dae_events, dae_monitor, dae_options, dae_solver
  public :: dae_ensemble, dae_ensemble_monitor, dae_ensemble_results, dae_sensitivities, &
    dae_solution
  public :: dae_descriptor, dae_linearization
  public :: dae_hybrid, dae_switch, dae_transition
  public :: sfdae_check_linear, sfdae_check_nonlinear, sfdae_check_multibody
  public :: sfdae_split_derivative_array, sfdae_status_name, sfdae_version

  ! ---- Recorded equations -------------------------------------------------------------------

  public :: expression, named_parameter, choose
  public :: assignment(=), operator(+), operator(-), operator(*), operator(/), operator(**)
  public :: sqrt, exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh
  public :: abs, min, max, log10, floor, sign, modulo
  public :: operator(<), operator(<=), operator(>), operator(>=)
  public :: operator(.and.), operator(.or.), operator(.not.)
  public :: derivative, time_derivative, table, external_value
  public :: sum, dot_product, matmul, maxval, minval, norm2
  !> Second names, for programs that have these names themselves.
  public :: sfdae_choose, sfdae_derivative, sfdae_expression, sfdae_external_value, &
    sfdae_named_parameter, sfdae_table, sfdae_time_derivative

  ! ---- Structs of C: results, and what a program does not need ------------------------------

  public :: sfdae_characteristics, sfdae_decision, sfdae_change, sfdae_initial_report, &
    sfdae_statistics, sfdae_derivative_check, sfdae_progress, sfdae_multibody_report, &
    sfdae_structure, sfdae_spectrum, sfdae_mode, sfdae_passage, sfdae_transition, &
    sfdae_singular_point, sfdae_switch
  public :: sfdae_linear_problem, sfdae_nonlinear_problem, sfdae_multibody_problem, &
    sfdae_multibody_formulas, sfdae_options
  public :: sfdae_ensemble, sfdae_ensemble_progress, sfdae_ensemble_results
  public :: sfdae_descriptor_matrices, sfdae_linearization
  public :: sfdae_sensitivity_options, sfdae_sensitivity_statistics

  ! ---- Version of the header that these modules mirror --------------------------------------

  public :: sfdae_version_major, sfdae_version_minor, sfdae_version_patch

  ! ---- Status -------------------------------------------------------------------------------

  public :: sfdae_ok
  !> Warnings: the call succeeded in part; see the message.
  public :: sfdae_step_taken, sfdae_stopped, sfdae_not_unique, sfdae_inconsistency_ignored, &
    sfdae_values_changed, sfdae_event, sfdae_instances_failed
  !> Failures: wrong use.
  public :: sfdae_illegal_argument, sfdae_out_of_memory, sfdae_busy, sfdae_empty_problem, &
    sfdae_not_started
  !> Failures: the user's procedures.
  public :: sfdae_callback_stopped, sfdae_callback_failed, sfdae_not_finite, sfdae_order_missing, &
    sfdae_wrong_derivatives, sfdae_wrong_pattern
  !> Failures: the structure of the problem.
  public :: sfdae_index_too_high, sfdae_rank_unclear, sfdae_characteristics_changed, &
    sfdae_prescription_singular
  !> Failures: values.
  public :: sfdae_inconsistent_values, sfdae_inconsistent_equations, sfdae_fixed_values, &
    sfdae_no_consistent_values
  !> Failures: the integration. The point reached is returned, advance may be called again.
  public :: sfdae_max_steps, sfdae_step_too_small, sfdae_singular, sfdae_tolerance_too_small, &
    sfdae_zeno
  !> A defect of the library; report it to the developers.
  public :: sfdae_internal
  !> Status of a callback that cannot provide the derivative order asked for.
  public :: sfdae_order_not_available

  ! ---- Values of options and results --------------------------------------------------------

  !> How the derivative array is reduced (dae_options%reduction).
  public :: sfdae_reduction_staged, sfdae_reduction_svd
  !> How initial values become consistent (dae_options%initial_values).
  public :: sfdae_initial_nearest, sfdae_initial_fixed, sfdae_initial_accept
  !> The quantity W x that is differentiated by the integrator (dae_options%leading_term).
  public :: sfdae_leading_automatic, sfdae_leading_projector, sfdae_leading_matrix, &
    sfdae_leading_identity
  !> Integration methods (dae_options%method).
  public :: sfdae_method_bdf, sfdae_method_radau, sfdae_method_automatic
  !> Outputs within steps (dae_options%output).
  public :: sfdae_output_consistent, sfdae_output_interpolated
  !> Use of the structural analysis for the derivative array (dae_options%structure).
  public :: sfdae_structure_off, sfdae_structure_automatic, sfdae_structure_required
  !> Treatment of zeros of conditions (dae_options%conditions).
  public :: sfdae_conditions_smooth, sfdae_conditions_events
  !> Format of matrices with given patterns in bindings (`matrices` of a problem).
  public :: sfdae_matrices_dense, sfdae_matrices_compressed, sfdae_matrices_differences
  !> Numerical verdicts on the structural analysis (sfdae_structure%verdict).
  public :: sfdae_structure_unchecked, sfdae_structure_certified, sfdae_structure_misleads, &
    sfdae_structure_unclear
  !> Languages of dae_solver%export_source.
  public :: sfdae_source_c, sfdae_source_fortran
  !> Kinds of breakpoints (dae_solver%set_breakpoints).
  public :: sfdae_breakpoint_kink, sfdae_breakpoint_jump
  !> Kinds of singular points (sfdae_singular_point%kind).
  public :: sfdae_singular_undetermined, sfdae_singular_fold, sfdae_singular_crossing, &
    sfdae_singular_unbounded
  !> Part of the equations that loses rank there (sfdae_singular_point%part).
  public :: sfdae_part_undetermined, sfdae_part_constraints, sfdae_part_differential, &
    sfdae_part_both
  !> When a transition happens (dae_transition%kind).
  public :: sfdae_transition_condition, sfdae_transition_zero, sfdae_transition_time
  !> How positions and velocities are divided (coordinates of multibody systems).
  public :: sfdae_coordinates_orthogonal, sfdae_coordinates_permutation
  !> Matrices of rank decisions (sfdae_decision%what).
  public :: sfdae_decision_stage, sfdae_decision_a2, sfdae_decision_et2, sfdae_decision_array, sfdae_decision_block
  !> Verdicts on rank decisions (sfdae_decision%verdict).
  public :: sfdae_verdict_clear, sfdae_verdict_confirmed, sfdae_verdict_unclear, sfdae_verdict_user

end module sfdae
