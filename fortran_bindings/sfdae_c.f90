! SPDX-License-Identifier: BSD-3-Clause
!
! Written by scripts/generate_fortran_mirror.py from the headers in include/sfdae: do not edit.
! Callbacks and functions of C; the header explains them and their arguments.
module sfdae_c
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funloc, c_funptr, c_int, c_long, &
    c_ptr, c_size_t
  use sfdae_types, only: expression, sfdae_change, sfdae_characteristics, sfdae_decision, &
    sfdae_derivative_check, sfdae_descriptor_matrices, sfdae_ensemble, sfdae_ensemble_progress, &
    sfdae_ensemble_results, sfdae_initial_report, sfdae_linear_problem, sfdae_linearization, &
    sfdae_mode, sfdae_multibody_formulas, sfdae_multibody_problem, sfdae_multibody_report, &
    sfdae_nonlinear_problem, sfdae_options, sfdae_passage, sfdae_progress, &
    sfdae_sensitivity_options, sfdae_sensitivity_statistics, sfdae_singular_point, sfdae_spectrum, &
    sfdae_statistics, sfdae_structure, sfdae_switch, sfdae_transition
  implicit none
  private

  public :: c_abs, c_acos, c_add, c_add_mode, c_add_switch, c_add_transition, c_advance, &
    c_advance_hybrid, c_advance_to_transition, c_analyze, c_analyze_at, c_and, c_asin, c_atan, &
    c_atan2, c_certify, c_change_init, c_characteristics_init, c_check_derivatives, &
    c_check_linear, c_check_multibody, c_check_multibody_derivatives, c_check_nonlinear, &
    c_check_total_derivatives, c_choose, c_cos, c_cosh, c_create_descriptor, c_create_hybrid, &
    c_create_linear, c_create_multibody, c_create_nonlinear, c_create_solution, c_cut_solution, &
    c_decision_init, c_derivative, c_derivative_check_init, c_descriptor_matrices_init, &
    c_descriptor_message, c_destroy, c_destroy_descriptor, c_destroy_hybrid, c_destroy_solution, &
    c_divide, c_ensemble_init, c_ensemble_results_init, c_evaluate_solution, c_exp, &
    c_export_source, c_external, c_floor, c_get_accumulation, c_get_change, c_get_characteristics, &
    c_get_checkpoint_length, c_get_current_mode, c_get_decision, c_get_derivative_array, &
    c_get_derivative_array_at, c_get_descriptor_matrices, c_get_descriptor_sizes, &
    c_get_event_sensitivities, c_get_events, c_get_extended_system, c_get_gradient, &
    c_get_hybrid_checkpoint_length, c_get_hybrid_gradient, c_get_hybrid_message, &
    c_get_hybrid_sensitivities, c_get_hybrid_statistics, c_get_initial_report, c_get_jet, &
    c_get_jump, c_get_mode, c_get_multibody_report, c_get_num_decisions, c_get_num_passages, &
    c_get_num_switches, c_get_parameter, c_get_passage, c_get_passage_sensitivities, &
    c_get_passage_values, c_get_poles, c_get_projectors, c_get_projectors_at, c_get_sensitivities, &
    c_get_sensitivity_statistics, c_get_singular_point, c_get_solution_accuracy, &
    c_get_solution_length, c_get_solution_range, c_get_statistics, c_get_strangeness_free, &
    c_get_strangeness_free_at, c_get_structure, c_get_switch, c_get_transfer, c_get_zeros, &
    c_greater, c_greater_equal, c_impact, c_initial_report_init, c_interpolate, c_jump, c_less, &
    c_less_equal, c_linear_problem_init, c_linearization_init, c_linearize, c_load_solution, &
    c_log, c_log10, c_make_consistent, c_max, c_message, c_min, c_mode_init, c_modulo, &
    c_multibody_problem_init, c_multibody_report_init, c_multiply, c_negate, &
    c_nonlinear_problem_init, c_not, c_number, c_options_init, c_or, c_parameter, &
    c_pass_singular_points, c_passage_init, c_power, c_record_hybrid, c_record_solution, c_report, &
    c_report_hybrid, c_request_stop, c_request_stop_hybrid, c_restore_checkpoint, &
    c_restore_hybrid_checkpoint, c_save_checkpoint, c_save_hybrid_checkpoint, c_save_solution, &
    c_sensitivity_options_init, c_sensitivity_statistics_init, c_set_breakpoints, c_set_events, &
    c_set_hybrid_sensitivities, c_set_options, c_set_parameter, c_set_sensitivities, c_sign, &
    c_sin, c_singular_point_init, c_sinh, c_solve_ensemble, c_spectrum_init, &
    c_split_derivative_array, c_sqrt, c_start, c_start_hybrid, c_statistics_init, c_status_name, &
    c_step, c_structure_init, c_subtract, c_switch_init, c_table, c_tan, c_tanh, &
    c_time_derivative, c_transition_init, c_version, address_of_conditions_function, &
    address_of_derivative_array_function, address_of_ensemble_monitor_function, &
    address_of_equations_function, address_of_event_function, address_of_external_function, &
    address_of_jump_function, address_of_linear_equations_function, address_of_matrix_function, &
    address_of_monitor_function, address_of_multibody_equations_function, &
    address_of_position_function, address_of_total_derivative_function, &
    address_of_vector_function, address_of_velocity_function

  abstract interface

    function sfdae_conditions_function(t, x, xdot, g, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      type(c_ptr), value :: x
      type(c_ptr), value :: xdot
      type(c_ptr), value :: g
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_conditions_function
    end function sfdae_conditions_function

    function sfdae_derivative_array_function(t, order, derivatives, f, jacobian, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      integer(c_int), value :: order
      type(c_ptr), value :: derivatives
      type(c_ptr), value :: f
      type(c_ptr), value :: jacobian
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_derivative_array_function
    end function sfdae_derivative_array_function

    function sfdae_ensemble_monitor_function(progress, user) bind(c)
      import :: c_int, c_ptr, sfdae_ensemble_progress
      type(sfdae_ensemble_progress), intent(in) :: progress
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_ensemble_monitor_function
    end function sfdae_ensemble_monitor_function

    function sfdae_equations_function(record, t, x, xdot, residual, user) bind(c)
      import :: c_int, c_ptr, expression
      type(c_ptr), value :: record
      type(expression), value :: t
      type(c_ptr), value :: x
      type(c_ptr), value :: xdot
      type(c_ptr), value :: residual
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_equations_function
    end function sfdae_equations_function

    function sfdae_event_function(t, x, xdot, g, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      type(c_ptr), value :: x
      type(c_ptr), value :: xdot
      type(c_ptr), value :: g
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_event_function
    end function sfdae_event_function

    function sfdae_external_function(order, arguments, derivatives, user) bind(c)
      import :: c_int, c_ptr
      integer(c_int), value :: order
      type(c_ptr), value :: arguments
      type(c_ptr), value :: derivatives
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_external_function
    end function sfdae_external_function

    function sfdae_jump_function(t, from, to, before, after, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      integer(c_int), value :: from
      integer(c_int), value :: to
      type(c_ptr), value :: before
      type(c_ptr), value :: after
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_jump_function
    end function sfdae_jump_function

    function sfdae_linear_equations_function(record, t, e, a, f, user) bind(c)
      import :: c_int, c_ptr, expression
      type(c_ptr), value :: record
      type(expression), value :: t
      type(c_ptr), value :: e
      type(c_ptr), value :: a
      type(c_ptr), value :: f
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_linear_equations_function
    end function sfdae_linear_equations_function

    function sfdae_matrix_function(t, order, matrix, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      integer(c_int), value :: order
      type(c_ptr), value :: matrix
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_matrix_function
    end function sfdae_matrix_function

    function sfdae_monitor_function(progress, user) bind(c)
      import :: c_int, c_ptr, sfdae_progress
      type(sfdae_progress), intent(in) :: progress
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_monitor_function
    end function sfdae_monitor_function

    function sfdae_multibody_equations_function(record, t, q, v, formulas, user) bind(c)
      import :: c_int, c_ptr, expression, sfdae_multibody_formulas
      type(c_ptr), value :: record
      type(expression), value :: t
      type(c_ptr), value :: q
      type(c_ptr), value :: v
      type(sfdae_multibody_formulas), intent(in) :: formulas
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_multibody_equations_function
    end function sfdae_multibody_equations_function

    function sfdae_position_function(t, q, result, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      type(c_ptr), value :: q
      type(c_ptr), value :: result
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_position_function
    end function sfdae_position_function

    function sfdae_total_derivative_function(t, order, derivatives, f, f_x, f_xdot, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      integer(c_int), value :: order
      type(c_ptr), value :: derivatives
      type(c_ptr), value :: f
      type(c_ptr), value :: f_x
      type(c_ptr), value :: f_xdot
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_total_derivative_function
    end function sfdae_total_derivative_function

    function sfdae_vector_function(t, order, vector, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      integer(c_int), value :: order
      type(c_ptr), value :: vector
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_vector_function
    end function sfdae_vector_function

    function sfdae_velocity_function(t, q, v, result, user) bind(c)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      type(c_ptr), value :: q
      type(c_ptr), value :: v
      type(c_ptr), value :: result
      type(c_ptr), value :: user
      integer(c_int) :: sfdae_velocity_function
    end function sfdae_velocity_function

  end interface

  interface

    function c_abs(a) bind(c, name="sfdae_abs")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_abs
    end function c_abs

    function c_acos(a) bind(c, name="sfdae_acos")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_acos
    end function c_acos

    function c_add(a, b) bind(c, name="sfdae_add")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_add
    end function c_add

    function c_add_mode(hybrid, solver, name, mode) bind(c, name="sfdae_add_mode")
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: hybrid
      type(c_ptr), value :: solver
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), intent(inout) :: mode
      integer(c_int) :: c_add_mode
    end function c_add_mode

    function c_add_switch(hybrid, below, above, surface, user, name, mode) &
      bind(c, name="sfdae_add_switch")
      import :: c_char, c_funptr, c_int, c_ptr
      type(c_ptr), value :: hybrid
      integer(c_int), value :: below
      integer(c_int), value :: above
      type(c_funptr), value :: surface
      type(c_ptr), value :: user
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), intent(inout) :: mode
      integer(c_int) :: c_add_switch
    end function c_add_switch

    function c_add_transition(hybrid, transition, number) bind(c, name="sfdae_add_transition")
      import :: c_int, c_ptr, sfdae_transition
      type(c_ptr), value :: hybrid
      type(sfdae_transition), intent(in) :: transition
      integer(c_int), intent(inout) :: number
      integer(c_int) :: c_add_transition
    end function c_add_transition

    function c_advance(solver, tout, t, x, xdot) bind(c, name="sfdae_advance")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: tout
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_advance
    end function c_advance

    function c_advance_hybrid(hybrid, tout, t, x, xdot) bind(c, name="sfdae_advance_hybrid")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      real(c_double), value :: tout
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_advance_hybrid
    end function c_advance_hybrid

    function c_advance_to_transition(hybrid, tout, t, x, xdot) &
      bind(c, name="sfdae_advance_to_transition")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      real(c_double), value :: tout
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_advance_to_transition
    end function c_advance_to_transition

    function c_analyze(solver, t, toward, result) bind(c, name="sfdae_analyze")
      import :: c_double, c_int, c_ptr, sfdae_characteristics
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: toward
      type(sfdae_characteristics), intent(inout) :: result
      integer(c_int) :: c_analyze
    end function c_analyze

    function c_analyze_at(solver, t, toward, x, result) bind(c, name="sfdae_analyze_at")
      import :: c_double, c_int, c_ptr, sfdae_characteristics
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: toward
      real(c_double), intent(in) :: x(*)
      type(sfdae_characteristics), intent(inout) :: result
      integer(c_int) :: c_analyze_at
    end function c_analyze_at

    function c_and(a, b) bind(c, name="sfdae_and")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_and
    end function c_and

    function c_asin(a) bind(c, name="sfdae_asin")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_asin
    end function c_asin

    function c_atan(a) bind(c, name="sfdae_atan")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_atan
    end function c_atan

    function c_atan2(y, x) bind(c, name="sfdae_atan2")
      import :: expression
      type(expression), value :: y
      type(expression), value :: x
      type(expression) :: c_atan2
    end function c_atan2

    function c_certify(solver, distance) bind(c, name="sfdae_certify")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), intent(inout) :: distance
      integer(c_int) :: c_certify
    end function c_certify

    function c_change_init(change, size) bind(c, name="sfdae_change_init")
      import :: c_int, c_size_t, sfdae_change
      type(sfdae_change), intent(inout) :: change
      integer(c_size_t), value :: size
      integer(c_int) :: c_change_init
    end function c_change_init

    function c_characteristics_init(characteristics, size) &
      bind(c, name="sfdae_characteristics_init")
      import :: c_int, c_size_t, sfdae_characteristics
      type(sfdae_characteristics), intent(inout) :: characteristics
      integer(c_size_t), value :: size
      integer(c_int) :: c_characteristics_init
    end function c_characteristics_init

    function c_check_derivatives(solver, t, max_order, result) &
      bind(c, name="sfdae_check_derivatives")
      import :: c_double, c_int, c_ptr, sfdae_derivative_check
      type(c_ptr), value :: solver
      real(c_double), value :: t
      integer(c_int), value :: max_order
      type(sfdae_derivative_check), intent(inout) :: result
      integer(c_int) :: c_check_derivatives
    end function c_check_derivatives

    function c_check_linear(problem, options, text, length) bind(c, name="sfdae_check_linear")
      import :: c_char, c_int, c_size_t, sfdae_linear_problem, sfdae_options
      type(sfdae_linear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_check_linear
    end function c_check_linear

    function c_check_multibody(problem, options, text, length) bind(c, name="sfdae_check_multibody")
      import :: c_char, c_int, c_size_t, sfdae_multibody_problem, sfdae_options
      type(sfdae_multibody_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_check_multibody
    end function c_check_multibody

    function c_check_multibody_derivatives(solver, t, q, v, result) &
      bind(c, name="sfdae_check_multibody_derivatives")
      import :: c_double, c_int, c_ptr, sfdae_derivative_check
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(in) :: q(*)
      real(c_double), intent(in) :: v(*)
      type(sfdae_derivative_check), intent(inout) :: result
      integer(c_int) :: c_check_multibody_derivatives
    end function c_check_multibody_derivatives

    function c_check_nonlinear(problem, options, text, length) bind(c, name="sfdae_check_nonlinear")
      import :: c_char, c_int, c_size_t, sfdae_nonlinear_problem, sfdae_options
      type(sfdae_nonlinear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_check_nonlinear
    end function c_check_nonlinear

    function c_check_total_derivatives(solver, t, derivatives, max_order, result) &
      bind(c, name="sfdae_check_total_derivatives")
      import :: c_double, c_int, c_ptr, sfdae_derivative_check
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(in) :: derivatives(*)
      integer(c_int), value :: max_order
      type(sfdae_derivative_check), intent(inout) :: result
      integer(c_int) :: c_check_total_derivatives
    end function c_check_total_derivatives

    function c_choose(c, a, b) bind(c, name="sfdae_choose")
      import :: expression
      type(expression), value :: c
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_choose
    end function c_choose

    function c_cos(a) bind(c, name="sfdae_cos")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_cos
    end function c_cos

    function c_cosh(a) bind(c, name="sfdae_cosh")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_cosh
    end function c_cosh

    function c_create_descriptor(matrices, descriptor) bind(c, name="sfdae_create_descriptor")
      import :: c_int, c_ptr, sfdae_descriptor_matrices
      type(sfdae_descriptor_matrices), intent(in) :: matrices
      type(c_ptr), intent(inout) :: descriptor
      integer(c_int) :: c_create_descriptor
    end function c_create_descriptor

    function c_create_hybrid(hybrid) bind(c, name="sfdae_create_hybrid")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: hybrid
      integer(c_int) :: c_create_hybrid
    end function c_create_hybrid

    function c_create_linear(solver, problem, options) bind(c, name="sfdae_create_linear")
      import :: c_int, c_ptr, sfdae_linear_problem, sfdae_options
      type(c_ptr), intent(inout) :: solver
      type(sfdae_linear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: c_create_linear
    end function c_create_linear

    function c_create_multibody(solver, problem, options) bind(c, name="sfdae_create_multibody")
      import :: c_int, c_ptr, sfdae_multibody_problem, sfdae_options
      type(c_ptr), intent(inout) :: solver
      type(sfdae_multibody_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: c_create_multibody
    end function c_create_multibody

    function c_create_nonlinear(solver, problem, options) bind(c, name="sfdae_create_nonlinear")
      import :: c_int, c_ptr, sfdae_nonlinear_problem, sfdae_options
      type(c_ptr), intent(inout) :: solver
      type(sfdae_nonlinear_problem), intent(in) :: problem
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: c_create_nonlinear
    end function c_create_nonlinear

    function c_create_solution(solution) bind(c, name="sfdae_create_solution")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: solution
      integer(c_int) :: c_create_solution
    end function c_create_solution

    function c_cut_solution(solution, t) bind(c, name="sfdae_cut_solution")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solution
      real(c_double), value :: t
      integer(c_int) :: c_cut_solution
    end function c_cut_solution

    function c_decision_init(decision, size) bind(c, name="sfdae_decision_init")
      import :: c_int, c_size_t, sfdae_decision
      type(sfdae_decision), intent(inout) :: decision
      integer(c_size_t), value :: size
      integer(c_int) :: c_decision_init
    end function c_decision_init

    function c_derivative(a, variable) bind(c, name="sfdae_derivative")
      import :: expression
      type(expression), value :: a
      type(expression), value :: variable
      type(expression) :: c_derivative
    end function c_derivative

    function c_derivative_check_init(check, size) bind(c, name="sfdae_derivative_check_init")
      import :: c_int, c_size_t, sfdae_derivative_check
      type(sfdae_derivative_check), intent(inout) :: check
      integer(c_size_t), value :: size
      integer(c_int) :: c_derivative_check_init
    end function c_derivative_check_init

    function c_descriptor_matrices_init(matrices, size) &
      bind(c, name="sfdae_descriptor_matrices_init")
      import :: c_int, c_size_t, sfdae_descriptor_matrices
      type(sfdae_descriptor_matrices), intent(inout) :: matrices
      integer(c_size_t), value :: size
      integer(c_int) :: c_descriptor_matrices_init
    end function c_descriptor_matrices_init

    function c_descriptor_message(descriptor) bind(c, name="sfdae_descriptor_message")
      import :: c_ptr
      type(c_ptr), value :: descriptor
      type(c_ptr) :: c_descriptor_message
    end function c_descriptor_message

    function c_destroy(solver) bind(c, name="sfdae_destroy")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: solver
      integer(c_int) :: c_destroy
    end function c_destroy

    function c_destroy_descriptor(descriptor) bind(c, name="sfdae_destroy_descriptor")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: descriptor
      integer(c_int) :: c_destroy_descriptor
    end function c_destroy_descriptor

    function c_destroy_hybrid(hybrid) bind(c, name="sfdae_destroy_hybrid")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: hybrid
      integer(c_int) :: c_destroy_hybrid
    end function c_destroy_hybrid

    function c_destroy_solution(solution) bind(c, name="sfdae_destroy_solution")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: solution
      integer(c_int) :: c_destroy_solution
    end function c_destroy_solution

    function c_divide(a, b) bind(c, name="sfdae_divide")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_divide
    end function c_divide

    function c_ensemble_init(ensemble, size) bind(c, name="sfdae_ensemble_init")
      import :: c_int, c_size_t, sfdae_ensemble
      type(sfdae_ensemble), intent(inout) :: ensemble
      integer(c_size_t), value :: size
      integer(c_int) :: c_ensemble_init
    end function c_ensemble_init

    function c_ensemble_results_init(results, size) bind(c, name="sfdae_ensemble_results_init")
      import :: c_int, c_size_t, sfdae_ensemble_results
      type(sfdae_ensemble_results), intent(inout) :: results
      integer(c_size_t), value :: size
      integer(c_int) :: c_ensemble_results_init
    end function c_ensemble_results_init

    function c_evaluate_solution(solution, t, x, xdot) bind(c, name="sfdae_evaluate_solution")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solution
      real(c_double), value :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_evaluate_solution
    end function c_evaluate_solution

    function c_exp(a) bind(c, name="sfdae_exp")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_exp
    end function c_exp

    function c_export_source(solver, language, name, text, length, needed) &
      bind(c, name="sfdae_export_source")
      import :: c_char, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      integer(c_int), value :: language
      character(kind=c_char), intent(in) :: name(*)
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_size_t), intent(inout) :: needed
      integer(c_int) :: c_export_source
    end function c_export_source

    function c_external(name, function, count, arguments, user) bind(c, name="sfdae_external")
      import :: c_char, c_funptr, c_int, c_ptr, expression
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr), value :: function
      integer(c_int), value :: count
      type(expression), intent(in) :: arguments(*)
      type(c_ptr), value :: user
      type(expression) :: c_external
    end function c_external

    function c_floor(a) bind(c, name="sfdae_floor")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_floor
    end function c_floor

    function c_get_accumulation(hybrid, t) bind(c, name="sfdae_get_accumulation")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      real(c_double), intent(inout) :: t
      integer(c_int) :: c_get_accumulation
    end function c_get_accumulation

    function c_get_change(solver, result) bind(c, name="sfdae_get_change")
      import :: c_int, c_ptr, sfdae_change
      type(c_ptr), value :: solver
      type(sfdae_change), intent(inout) :: result
      integer(c_int) :: c_get_change
    end function c_get_change

    function c_get_characteristics(solver, result) bind(c, name="sfdae_get_characteristics")
      import :: c_int, c_ptr, sfdae_characteristics
      type(c_ptr), value :: solver
      type(sfdae_characteristics), intent(inout) :: result
      integer(c_int) :: c_get_characteristics
    end function c_get_characteristics

    function c_get_checkpoint_length(solver, length) bind(c, name="sfdae_get_checkpoint_length")
      import :: c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      integer(c_size_t), intent(inout) :: length
      integer(c_int) :: c_get_checkpoint_length
    end function c_get_checkpoint_length

    function c_get_current_mode(hybrid, mode) bind(c, name="sfdae_get_current_mode")
      import :: c_int, c_ptr
      type(c_ptr), value :: hybrid
      integer(c_int), intent(inout) :: mode
      integer(c_int) :: c_get_current_mode
    end function c_get_current_mode

    function c_get_decision(solver, index, result) bind(c, name="sfdae_get_decision")
      import :: c_int, c_ptr, sfdae_decision
      type(c_ptr), value :: solver
      integer(c_int), value :: index
      type(sfdae_decision), intent(inout) :: result
      integer(c_int) :: c_get_decision
    end function c_get_decision

    function c_get_derivative_array(solver, t, level, m, n, g) &
      bind(c, name="sfdae_get_derivative_array")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      integer(c_int), value :: level
      real(c_double), intent(inout) :: m(*)
      real(c_double), intent(inout) :: n(*)
      real(c_double), intent(inout) :: g(*)
      integer(c_int) :: c_get_derivative_array
    end function c_get_derivative_array

    function c_get_derivative_array_at(solver, t, jet, level, m, n, g) &
      bind(c, name="sfdae_get_derivative_array_at")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(in) :: jet(*)
      integer(c_int), value :: level
      real(c_double), intent(inout) :: m(*)
      real(c_double), intent(inout) :: n(*)
      real(c_double), intent(inout) :: g(*)
      integer(c_int) :: c_get_derivative_array_at
    end function c_get_derivative_array_at

    function c_get_descriptor_matrices(descriptor, e, a, b, c, d) &
      bind(c, name="sfdae_get_descriptor_matrices")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: descriptor
      real(c_double), intent(inout) :: e(*)
      real(c_double), intent(inout) :: a(*)
      real(c_double), intent(inout) :: b(*)
      real(c_double), intent(inout) :: c(*)
      real(c_double), intent(inout) :: d(*)
      integer(c_int) :: c_get_descriptor_matrices
    end function c_get_descriptor_matrices

    function c_get_descriptor_sizes(descriptor, num_equations, num_unknowns, num_inputs, &
      num_outputs) bind(c, name="sfdae_get_descriptor_sizes")
      import :: c_int, c_ptr
      type(c_ptr), value :: descriptor
      integer(c_int), intent(inout) :: num_equations
      integer(c_int), intent(inout) :: num_unknowns
      integer(c_int), intent(inout) :: num_inputs
      integer(c_int), intent(inout) :: num_outputs
      integer(c_int) :: c_get_descriptor_sizes
    end function c_get_descriptor_sizes

    function c_get_event_sensitivities(solver, t, g_t, g_x, g_p, dt) &
      bind(c, name="sfdae_get_event_sensitivities")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: g_t
      real(c_double), intent(in) :: g_x(*)
      type(c_ptr), value :: g_p
      real(c_double), intent(inout) :: dt(*)
      integer(c_int) :: c_get_event_sensitivities
    end function c_get_event_sensitivities

    function c_get_events(solver, which) bind(c, name="sfdae_get_events")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), intent(inout) :: which(*)
      integer(c_int) :: c_get_events
    end function c_get_events

    function c_get_extended_system(solver, t, x, qq, qv, e, a, f, w) &
      bind(c, name="sfdae_get_extended_system")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      type(c_ptr), value :: x
      real(c_double), intent(inout) :: qq(*)
      real(c_double), intent(inout) :: qv(*)
      real(c_double), intent(inout) :: e(*)
      real(c_double), intent(inout) :: a(*)
      real(c_double), intent(inout) :: f(*)
      real(c_double), intent(inout) :: w(*)
      integer(c_int) :: c_get_extended_system
    end function c_get_extended_system

    function c_get_gradient(solver, num_times, t, num_functionals, weights, gradient) &
      bind(c, name="sfdae_get_gradient")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), value :: num_times
      real(c_double), intent(in) :: t(*)
      integer(c_int), value :: num_functionals
      real(c_double), intent(in) :: weights(*)
      real(c_double), intent(inout) :: gradient(*)
      integer(c_int) :: c_get_gradient
    end function c_get_gradient

    function c_get_hybrid_checkpoint_length(hybrid, length) &
      bind(c, name="sfdae_get_hybrid_checkpoint_length")
      import :: c_int, c_ptr, c_size_t
      type(c_ptr), value :: hybrid
      integer(c_size_t), intent(inout) :: length
      integer(c_int) :: c_get_hybrid_checkpoint_length
    end function c_get_hybrid_checkpoint_length

    function c_get_hybrid_gradient(hybrid, num_times, t, num_functionals, weights, gradient) &
      bind(c, name="sfdae_get_hybrid_gradient")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      integer(c_int), value :: num_times
      real(c_double), intent(in) :: t(*)
      integer(c_int), value :: num_functionals
      real(c_double), intent(in) :: weights(*)
      real(c_double), intent(inout) :: gradient(*)
      integer(c_int) :: c_get_hybrid_gradient
    end function c_get_hybrid_gradient

    function c_get_hybrid_message(hybrid) bind(c, name="sfdae_get_hybrid_message")
      import :: c_ptr
      type(c_ptr), value :: hybrid
      type(c_ptr) :: c_get_hybrid_message
    end function c_get_hybrid_message

    function c_get_hybrid_sensitivities(hybrid, t, s, sdot) &
      bind(c, name="sfdae_get_hybrid_sensitivities")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      real(c_double), value :: t
      real(c_double), intent(inout) :: s(*)
      type(c_ptr), value :: sdot
      integer(c_int) :: c_get_hybrid_sensitivities
    end function c_get_hybrid_sensitivities

    function c_get_hybrid_statistics(hybrid, result) bind(c, name="sfdae_get_hybrid_statistics")
      import :: c_int, c_ptr, sfdae_statistics
      type(c_ptr), value :: hybrid
      type(sfdae_statistics), intent(inout) :: result
      integer(c_int) :: c_get_hybrid_statistics
    end function c_get_hybrid_statistics

    function c_get_initial_report(solver, result) bind(c, name="sfdae_get_initial_report")
      import :: c_int, c_ptr, sfdae_initial_report
      type(c_ptr), value :: solver
      type(sfdae_initial_report), intent(inout) :: result
      integer(c_int) :: c_get_initial_report
    end function c_get_initial_report

    function c_get_jet(solver, t, x, level, jet) bind(c, name="sfdae_get_jet")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      type(c_ptr), value :: x
      integer(c_int), value :: level
      real(c_double), intent(inout) :: jet(*)
      integer(c_int) :: c_get_jet
    end function c_get_jet

    function c_get_jump(solver, t, before, after, impulse) bind(c, name="sfdae_get_jump")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: before(*)
      real(c_double), intent(inout) :: after(*)
      type(c_ptr), value :: impulse
      integer(c_int) :: c_get_jump
    end function c_get_jump

    function c_get_mode(hybrid, mode, result) bind(c, name="sfdae_get_mode")
      import :: c_int, c_ptr, sfdae_mode
      type(c_ptr), value :: hybrid
      integer(c_int), value :: mode
      type(sfdae_mode), intent(inout) :: result
      integer(c_int) :: c_get_mode
    end function c_get_mode

    function c_get_multibody_report(solver, report) bind(c, name="sfdae_get_multibody_report")
      import :: c_int, c_ptr, sfdae_multibody_report
      type(c_ptr), value :: solver
      type(sfdae_multibody_report), intent(inout) :: report
      integer(c_int) :: c_get_multibody_report
    end function c_get_multibody_report

    function c_get_num_decisions(solver, count) bind(c, name="sfdae_get_num_decisions")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), intent(inout) :: count
      integer(c_int) :: c_get_num_decisions
    end function c_get_num_decisions

    function c_get_num_passages(hybrid, count) bind(c, name="sfdae_get_num_passages")
      import :: c_int, c_long, c_ptr
      type(c_ptr), value :: hybrid
      integer(c_long), intent(inout) :: count
      integer(c_int) :: c_get_num_passages
    end function c_get_num_passages

    function c_get_num_switches(solver, count) bind(c, name="sfdae_get_num_switches")
      import :: c_int, c_long, c_ptr
      type(c_ptr), value :: solver
      integer(c_long), intent(inout) :: count
      integer(c_int) :: c_get_num_switches
    end function c_get_num_switches

    function c_get_parameter(solver, name, value) bind(c, name="sfdae_get_parameter")
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), intent(inout) :: value
      integer(c_int) :: c_get_parameter
    end function c_get_parameter

    function c_get_passage(hybrid, index, result) bind(c, name="sfdae_get_passage")
      import :: c_int, c_long, c_ptr, sfdae_passage
      type(c_ptr), value :: hybrid
      integer(c_long), value :: index
      type(sfdae_passage), intent(inout) :: result
      integer(c_int) :: c_get_passage
    end function c_get_passage

    function c_get_passage_sensitivities(hybrid, dt) bind(c, name="sfdae_get_passage_sensitivities")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      real(c_double), intent(inout) :: dt(*)
      integer(c_int) :: c_get_passage_sensitivities
    end function c_get_passage_sensitivities

    function c_get_passage_values(hybrid, before, after, impulse) &
      bind(c, name="sfdae_get_passage_values")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      real(c_double), intent(inout) :: before(*)
      real(c_double), intent(inout) :: after(*)
      type(c_ptr), value :: impulse
      integer(c_int) :: c_get_passage_values
    end function c_get_passage_values

    function c_get_poles(descriptor, spectrum, real, imaginary, errors) &
      bind(c, name="sfdae_get_poles")
      import :: c_double, c_int, c_ptr, sfdae_spectrum
      type(c_ptr), value :: descriptor
      type(sfdae_spectrum), intent(inout) :: spectrum
      real(c_double), intent(inout) :: real(*)
      real(c_double), intent(inout) :: imaginary(*)
      real(c_double), intent(inout) :: errors(*)
      integer(c_int) :: c_get_poles
    end function c_get_poles

    function c_get_projectors(solver, t, z1, z2, z3, t2, vhat) bind(c, name="sfdae_get_projectors")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: z1(*)
      type(c_ptr), value :: z2
      type(c_ptr), value :: z3
      real(c_double), intent(inout) :: t2(*)
      type(c_ptr), value :: vhat
      integer(c_int) :: c_get_projectors
    end function c_get_projectors

    function c_get_projectors_at(solver, t, jet, z1, z2, z3, t2, vhat) &
      bind(c, name="sfdae_get_projectors_at")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(in) :: jet(*)
      real(c_double), intent(inout) :: z1(*)
      type(c_ptr), value :: z2
      type(c_ptr), value :: z3
      real(c_double), intent(inout) :: t2(*)
      type(c_ptr), value :: vhat
      integer(c_int) :: c_get_projectors_at
    end function c_get_projectors_at

    function c_get_sensitivities(solver, t, s, sdot) bind(c, name="sfdae_get_sensitivities")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: s(*)
      type(c_ptr), value :: sdot
      integer(c_int) :: c_get_sensitivities
    end function c_get_sensitivities

    function c_get_sensitivity_statistics(solver, statistics) &
      bind(c, name="sfdae_get_sensitivity_statistics")
      import :: c_int, c_ptr, sfdae_sensitivity_statistics
      type(c_ptr), value :: solver
      type(sfdae_sensitivity_statistics), intent(inout) :: statistics
      integer(c_int) :: c_get_sensitivity_statistics
    end function c_get_sensitivity_statistics

    function c_get_singular_point(solver, result) bind(c, name="sfdae_get_singular_point")
      import :: c_int, c_ptr, sfdae_singular_point
      type(c_ptr), value :: solver
      type(sfdae_singular_point), intent(inout) :: result
      integer(c_int) :: c_get_singular_point
    end function c_get_singular_point

    function c_get_solution_accuracy(solution, accuracy, t) &
      bind(c, name="sfdae_get_solution_accuracy")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solution
      real(c_double), intent(inout) :: accuracy
      real(c_double), intent(inout) :: t
      integer(c_int) :: c_get_solution_accuracy
    end function c_get_solution_accuracy

    function c_get_solution_length(solution, length) bind(c, name="sfdae_get_solution_length")
      import :: c_int, c_ptr, c_size_t
      type(c_ptr), value :: solution
      integer(c_size_t), intent(inout) :: length
      integer(c_int) :: c_get_solution_length
    end function c_get_solution_length

    function c_get_solution_range(solution, num_unknowns, start, end) &
      bind(c, name="sfdae_get_solution_range")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solution
      integer(c_int), intent(inout) :: num_unknowns
      real(c_double), intent(inout) :: start
      real(c_double), intent(inout) :: end
      integer(c_int) :: c_get_solution_range
    end function c_get_solution_range

    function c_get_statistics(solver, result) bind(c, name="sfdae_get_statistics")
      import :: c_int, c_ptr, sfdae_statistics
      type(c_ptr), value :: solver
      type(sfdae_statistics), intent(inout) :: result
      integer(c_int) :: c_get_statistics
    end function c_get_statistics

    function c_get_strangeness_free(solver, t, e1, a1, f1, a2, f2, residual) &
      bind(c, name="sfdae_get_strangeness_free")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: e1(*)
      real(c_double), intent(inout) :: a1(*)
      real(c_double), intent(inout) :: f1(*)
      real(c_double), intent(inout) :: a2(*)
      real(c_double), intent(inout) :: f2(*)
      real(c_double), intent(inout) :: residual
      integer(c_int) :: c_get_strangeness_free
    end function c_get_strangeness_free

    function c_get_strangeness_free_at(solver, t, jet, e1, a1, f1, a2, f2, residual) &
      bind(c, name="sfdae_get_strangeness_free_at")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(in) :: jet(*)
      real(c_double), intent(inout) :: e1(*)
      real(c_double), intent(inout) :: a1(*)
      real(c_double), intent(inout) :: f1(*)
      real(c_double), intent(inout) :: a2(*)
      real(c_double), intent(inout) :: f2(*)
      real(c_double), intent(inout) :: residual
      integer(c_int) :: c_get_strangeness_free_at
    end function c_get_strangeness_free_at

    function c_get_structure(solver, result, differentiations, orders, assigned, block) &
      bind(c, name="sfdae_get_structure")
      import :: c_int, c_ptr, sfdae_structure
      type(c_ptr), value :: solver
      type(sfdae_structure), intent(inout) :: result
      integer(c_int), intent(inout) :: differentiations(*)
      integer(c_int), intent(inout) :: orders(*)
      integer(c_int), intent(inout) :: assigned(*)
      integer(c_int), intent(inout) :: block(*)
      integer(c_int) :: c_get_structure
    end function c_get_structure

    function c_get_switch(solver, index, result, condition, length, needed) &
      bind(c, name="sfdae_get_switch")
      import :: c_char, c_int, c_long, c_ptr, c_size_t, sfdae_switch
      type(c_ptr), value :: solver
      integer(c_long), value :: index
      type(sfdae_switch), intent(inout) :: result
      character(kind=c_char), intent(inout) :: condition(*)
      integer(c_size_t), value :: length
      integer(c_size_t), intent(inout) :: needed
      integer(c_int) :: c_get_switch
    end function c_get_switch

    function c_get_transfer(descriptor, count, real, imaginary, h_real, h_imaginary) &
      bind(c, name="sfdae_get_transfer")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: descriptor
      integer(c_int), value :: count
      real(c_double), intent(in) :: real(*)
      real(c_double), intent(in) :: imaginary(*)
      real(c_double), intent(inout) :: h_real(*)
      real(c_double), intent(inout) :: h_imaginary(*)
      integer(c_int) :: c_get_transfer
    end function c_get_transfer

    function c_get_zeros(descriptor, spectrum, real, imaginary, errors) &
      bind(c, name="sfdae_get_zeros")
      import :: c_double, c_int, c_ptr, sfdae_spectrum
      type(c_ptr), value :: descriptor
      type(sfdae_spectrum), intent(inout) :: spectrum
      real(c_double), intent(inout) :: real(*)
      real(c_double), intent(inout) :: imaginary(*)
      real(c_double), intent(inout) :: errors(*)
      integer(c_int) :: c_get_zeros
    end function c_get_zeros

    function c_greater(a, b) bind(c, name="sfdae_greater")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_greater
    end function c_greater

    function c_greater_equal(a, b) bind(c, name="sfdae_greater_equal")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_greater_equal
    end function c_greater_equal

    function c_impact(solver, t, restitution, before, after, impulses) bind(c, name="sfdae_impact")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      type(c_ptr), value :: restitution
      real(c_double), intent(in) :: before(*)
      real(c_double), intent(inout) :: after(*)
      type(c_ptr), value :: impulses
      integer(c_int) :: c_impact
    end function c_impact

    function c_initial_report_init(report, size) bind(c, name="sfdae_initial_report_init")
      import :: c_int, c_size_t, sfdae_initial_report
      type(sfdae_initial_report), intent(inout) :: report
      integer(c_size_t), value :: size
      integer(c_int) :: c_initial_report_init
    end function c_initial_report_init

    function c_interpolate(solver, t, x, xdot) bind(c, name="sfdae_interpolate")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_interpolate
    end function c_interpolate

    function c_jump(solver, t, toward, before, after, orders, impulses) bind(c, name="sfdae_jump")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: toward
      real(c_double), intent(in) :: before(*)
      real(c_double), intent(inout) :: after(*)
      integer(c_int), value :: orders
      type(c_ptr), value :: impulses
      integer(c_int) :: c_jump
    end function c_jump

    function c_less(a, b) bind(c, name="sfdae_less")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_less
    end function c_less

    function c_less_equal(a, b) bind(c, name="sfdae_less_equal")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_less_equal
    end function c_less_equal

    function c_linear_problem_init(problem, size) bind(c, name="sfdae_linear_problem_init")
      import :: c_int, c_size_t, sfdae_linear_problem
      type(sfdae_linear_problem), intent(inout) :: problem
      integer(c_size_t), value :: size
      integer(c_int) :: c_linear_problem_init
    end function c_linear_problem_init

    function c_linearization_init(choice, size) bind(c, name="sfdae_linearization_init")
      import :: c_int, c_size_t, sfdae_linearization
      type(sfdae_linearization), intent(inout) :: choice
      integer(c_size_t), value :: size
      integer(c_int) :: c_linearization_init
    end function c_linearization_init

    function c_linearize(solver, choice, descriptor) bind(c, name="sfdae_linearize")
      import :: c_int, c_ptr, sfdae_linearization
      type(c_ptr), value :: solver
      type(sfdae_linearization), intent(in) :: choice
      type(c_ptr), intent(inout) :: descriptor
      integer(c_int) :: c_linearize
    end function c_linearize

    function c_load_solution(solution, values, length) bind(c, name="sfdae_load_solution")
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solution
      real(c_double), intent(in) :: values(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_load_solution
    end function c_load_solution

    function c_log(a) bind(c, name="sfdae_log")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_log
    end function c_log

    function c_log10(a) bind(c, name="sfdae_log10")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_log10
    end function c_log10

    function c_make_consistent(solver, t, x, xdot) bind(c, name="sfdae_make_consistent")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_make_consistent
    end function c_make_consistent

    function c_max(a, b) bind(c, name="sfdae_max")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_max
    end function c_max

    function c_message(solver) bind(c, name="sfdae_message")
      import :: c_ptr
      type(c_ptr), value :: solver
      type(c_ptr) :: c_message
    end function c_message

    function c_min(a, b) bind(c, name="sfdae_min")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_min
    end function c_min

    function c_mode_init(mode, size) bind(c, name="sfdae_mode_init")
      import :: c_int, c_size_t, sfdae_mode
      type(sfdae_mode), intent(inout) :: mode
      integer(c_size_t), value :: size
      integer(c_int) :: c_mode_init
    end function c_mode_init

    function c_modulo(a, b) bind(c, name="sfdae_modulo")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_modulo
    end function c_modulo

    function c_multibody_problem_init(problem, size) bind(c, name="sfdae_multibody_problem_init")
      import :: c_int, c_size_t, sfdae_multibody_problem
      type(sfdae_multibody_problem), intent(inout) :: problem
      integer(c_size_t), value :: size
      integer(c_int) :: c_multibody_problem_init
    end function c_multibody_problem_init

    function c_multibody_report_init(report, size) bind(c, name="sfdae_multibody_report_init")
      import :: c_int, c_size_t, sfdae_multibody_report
      type(sfdae_multibody_report), intent(inout) :: report
      integer(c_size_t), value :: size
      integer(c_int) :: c_multibody_report_init
    end function c_multibody_report_init

    function c_multiply(a, b) bind(c, name="sfdae_multiply")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_multiply
    end function c_multiply

    function c_negate(a) bind(c, name="sfdae_negate")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_negate
    end function c_negate

    function c_nonlinear_problem_init(problem, size) bind(c, name="sfdae_nonlinear_problem_init")
      import :: c_int, c_size_t, sfdae_nonlinear_problem
      type(sfdae_nonlinear_problem), intent(inout) :: problem
      integer(c_size_t), value :: size
      integer(c_int) :: c_nonlinear_problem_init
    end function c_nonlinear_problem_init

    function c_not(a) bind(c, name="sfdae_not")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_not
    end function c_not

    function c_number(value) bind(c, name="sfdae_number")
      import :: c_double, expression
      real(c_double), value :: value
      type(expression) :: c_number
    end function c_number

    function c_options_init(options, size) bind(c, name="sfdae_options_init")
      import :: c_int, c_size_t, sfdae_options
      type(sfdae_options), intent(inout) :: options
      integer(c_size_t), value :: size
      integer(c_int) :: c_options_init
    end function c_options_init

    function c_or(a, b) bind(c, name="sfdae_or")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_or
    end function c_or

    function c_parameter(record, name, value) bind(c, name="sfdae_parameter")
      import :: c_char, c_double, c_ptr, expression
      type(c_ptr), value :: record
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: value
      type(expression) :: c_parameter
    end function c_parameter

    function c_pass_singular_points(solver, max_points) bind(c, name="sfdae_pass_singular_points")
      import :: c_int, c_long, c_ptr
      type(c_ptr), value :: solver
      integer(c_long), value :: max_points
      integer(c_int) :: c_pass_singular_points
    end function c_pass_singular_points

    function c_passage_init(passage, size) bind(c, name="sfdae_passage_init")
      import :: c_int, c_size_t, sfdae_passage
      type(sfdae_passage), intent(inout) :: passage
      integer(c_size_t), value :: size
      integer(c_int) :: c_passage_init
    end function c_passage_init

    function c_power(a, b) bind(c, name="sfdae_power")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_power
    end function c_power

    function c_record_hybrid(hybrid, solution) bind(c, name="sfdae_record_hybrid")
      import :: c_int, c_ptr
      type(c_ptr), value :: hybrid
      type(c_ptr), value :: solution
      integer(c_int) :: c_record_hybrid
    end function c_record_hybrid

    function c_record_solution(solver, solution) bind(c, name="sfdae_record_solution")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      type(c_ptr), value :: solution
      integer(c_int) :: c_record_solution
    end function c_record_solution

    function c_report(solver, text, length, needed) bind(c, name="sfdae_report")
      import :: c_char, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_size_t), intent(inout) :: needed
      integer(c_int) :: c_report
    end function c_report

    function c_report_hybrid(hybrid, text, length, needed) bind(c, name="sfdae_report_hybrid")
      import :: c_char, c_int, c_ptr, c_size_t
      type(c_ptr), value :: hybrid
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_size_t), intent(inout) :: needed
      integer(c_int) :: c_report_hybrid
    end function c_report_hybrid

    function c_request_stop(solver) bind(c, name="sfdae_request_stop")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int) :: c_request_stop
    end function c_request_stop

    function c_request_stop_hybrid(hybrid) bind(c, name="sfdae_request_stop_hybrid")
      import :: c_int, c_ptr
      type(c_ptr), value :: hybrid
      integer(c_int) :: c_request_stop_hybrid
    end function c_request_stop_hybrid

    function c_restore_checkpoint(solver, checkpoint, length) &
      bind(c, name="sfdae_restore_checkpoint")
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      real(c_double), intent(in) :: checkpoint(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_restore_checkpoint
    end function c_restore_checkpoint

    function c_restore_hybrid_checkpoint(hybrid, checkpoint, length) &
      bind(c, name="sfdae_restore_hybrid_checkpoint")
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: hybrid
      real(c_double), intent(in) :: checkpoint(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_restore_hybrid_checkpoint
    end function c_restore_hybrid_checkpoint

    function c_save_checkpoint(solver, checkpoint, length) bind(c, name="sfdae_save_checkpoint")
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solver
      real(c_double), intent(inout) :: checkpoint(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_save_checkpoint
    end function c_save_checkpoint

    function c_save_hybrid_checkpoint(hybrid, checkpoint, length) &
      bind(c, name="sfdae_save_hybrid_checkpoint")
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: hybrid
      real(c_double), intent(inout) :: checkpoint(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_save_hybrid_checkpoint
    end function c_save_hybrid_checkpoint

    function c_save_solution(solution, values, length) bind(c, name="sfdae_save_solution")
      import :: c_double, c_int, c_ptr, c_size_t
      type(c_ptr), value :: solution
      real(c_double), intent(inout) :: values(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_save_solution
    end function c_save_solution

    function c_sensitivity_options_init(options, size) &
      bind(c, name="sfdae_sensitivity_options_init")
      import :: c_int, c_size_t, sfdae_sensitivity_options
      type(sfdae_sensitivity_options), intent(inout) :: options
      integer(c_size_t), value :: size
      integer(c_int) :: c_sensitivity_options_init
    end function c_sensitivity_options_init

    function c_sensitivity_statistics_init(statistics, size) &
      bind(c, name="sfdae_sensitivity_statistics_init")
      import :: c_int, c_size_t, sfdae_sensitivity_statistics
      type(sfdae_sensitivity_statistics), intent(inout) :: statistics
      integer(c_size_t), value :: size
      integer(c_int) :: c_sensitivity_statistics_init
    end function c_sensitivity_statistics_init

    function c_set_breakpoints(solver, count, t, kinds) bind(c, name="sfdae_set_breakpoints")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), value :: count
      real(c_double), intent(in) :: t(*)
      type(c_ptr), value :: kinds
      integer(c_int) :: c_set_breakpoints
    end function c_set_breakpoints

    function c_set_events(solver, num_events, function, directions, user) &
      bind(c, name="sfdae_set_events")
      import :: c_funptr, c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), value :: num_events
      type(c_funptr), value :: function
      type(c_ptr), value :: directions
      type(c_ptr), value :: user
      integer(c_int) :: c_set_events
    end function c_set_events

    function c_set_hybrid_sensitivities(hybrid, count, parameters, directions, options) &
      bind(c, name="sfdae_set_hybrid_sensitivities")
      import :: c_int, c_ptr, sfdae_sensitivity_options
      type(c_ptr), value :: hybrid
      integer(c_int), value :: count
      type(c_ptr), intent(in) :: parameters(*)
      type(c_ptr), value :: directions
      type(sfdae_sensitivity_options), intent(in) :: options
      integer(c_int) :: c_set_hybrid_sensitivities
    end function c_set_hybrid_sensitivities

    function c_set_options(solver, options) bind(c, name="sfdae_set_options")
      import :: c_int, c_ptr, sfdae_options
      type(c_ptr), value :: solver
      type(sfdae_options), intent(in) :: options
      integer(c_int) :: c_set_options
    end function c_set_options

    function c_set_parameter(solver, name, value) bind(c, name="sfdae_set_parameter")
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: value
      integer(c_int) :: c_set_parameter
    end function c_set_parameter

    function c_set_sensitivities(solver, count, parameters, directions, options) &
      bind(c, name="sfdae_set_sensitivities")
      import :: c_int, c_ptr, sfdae_sensitivity_options
      type(c_ptr), value :: solver
      integer(c_int), value :: count
      type(c_ptr), intent(in) :: parameters(*)
      type(c_ptr), value :: directions
      type(sfdae_sensitivity_options), intent(in) :: options
      integer(c_int) :: c_set_sensitivities
    end function c_set_sensitivities

    function c_sign(a) bind(c, name="sfdae_sign")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_sign
    end function c_sign

    function c_sin(a) bind(c, name="sfdae_sin")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_sin
    end function c_sin

    function c_singular_point_init(point, size) bind(c, name="sfdae_singular_point_init")
      import :: c_int, c_size_t, sfdae_singular_point
      type(sfdae_singular_point), intent(inout) :: point
      integer(c_size_t), value :: size
      integer(c_int) :: c_singular_point_init
    end function c_singular_point_init

    function c_sinh(a) bind(c, name="sfdae_sinh")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_sinh
    end function c_sinh

    function c_solve_ensemble(solver, ensemble, results) bind(c, name="sfdae_solve_ensemble")
      import :: c_int, c_ptr, sfdae_ensemble, sfdae_ensemble_results
      type(c_ptr), value :: solver
      type(sfdae_ensemble), intent(in) :: ensemble
      type(sfdae_ensemble_results), intent(inout) :: results
      integer(c_int) :: c_solve_ensemble
    end function c_solve_ensemble

    function c_spectrum_init(spectrum, size) bind(c, name="sfdae_spectrum_init")
      import :: c_int, c_size_t, sfdae_spectrum
      type(sfdae_spectrum), intent(inout) :: spectrum
      integer(c_size_t), value :: size
      integer(c_int) :: c_spectrum_init
    end function c_spectrum_init

    function c_split_derivative_array(num_equations, num_unknowns, order, jacobian, f_x, f_xdot, &
      text, length) bind(c, name="sfdae_split_derivative_array")
      import :: c_char, c_double, c_int, c_size_t
      integer(c_int), value :: num_equations
      integer(c_int), value :: num_unknowns
      integer(c_int), value :: order
      real(c_double), intent(in) :: jacobian(*)
      real(c_double), intent(inout) :: f_x(*)
      real(c_double), intent(inout) :: f_xdot(*)
      character(kind=c_char), intent(inout) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: c_split_derivative_array
    end function c_split_derivative_array

    function c_sqrt(a) bind(c, name="sfdae_sqrt")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_sqrt
    end function c_sqrt

    function c_start(solver, t, toward, x, xdot) bind(c, name="sfdae_start")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: t
      real(c_double), value :: toward
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_start
    end function c_start

    function c_start_hybrid(hybrid, mode, t, toward, x, xdot) bind(c, name="sfdae_start_hybrid")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: hybrid
      integer(c_int), value :: mode
      real(c_double), value :: t
      real(c_double), value :: toward
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_start_hybrid
    end function c_start_hybrid

    function c_statistics_init(statistics, size) bind(c, name="sfdae_statistics_init")
      import :: c_int, c_size_t, sfdae_statistics
      type(sfdae_statistics), intent(inout) :: statistics
      integer(c_size_t), value :: size
      integer(c_int) :: c_statistics_init
    end function c_statistics_init

    function c_status_name(status) bind(c, name="sfdae_status_name")
      import :: c_int, c_ptr
      integer(c_int), value :: status
      type(c_ptr) :: c_status_name
    end function c_status_name

    function c_step(solver, tout, t, x, xdot) bind(c, name="sfdae_step")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: solver
      real(c_double), value :: tout
      real(c_double), intent(inout) :: t
      real(c_double), intent(inout) :: x(*)
      type(c_ptr), value :: xdot
      integer(c_int) :: c_step
    end function c_step

    function c_structure_init(structure, size) bind(c, name="sfdae_structure_init")
      import :: c_int, c_size_t, sfdae_structure
      type(sfdae_structure), intent(inout) :: structure
      integer(c_size_t), value :: size
      integer(c_int) :: c_structure_init
    end function c_structure_init

    function c_subtract(a, b) bind(c, name="sfdae_subtract")
      import :: expression
      type(expression), value :: a
      type(expression), value :: b
      type(expression) :: c_subtract
    end function c_subtract

    function c_switch_init(result, size) bind(c, name="sfdae_switch_init")
      import :: c_int, c_size_t, sfdae_switch
      type(sfdae_switch), intent(inout) :: result
      integer(c_size_t), value :: size
      integer(c_int) :: c_switch_init
    end function c_switch_init

    function c_table(a, degree, count, x, y) bind(c, name="sfdae_table")
      import :: c_double, c_int, expression
      type(expression), value :: a
      integer(c_int), value :: degree
      integer(c_int), value :: count
      real(c_double), intent(in) :: x(*)
      real(c_double), intent(in) :: y(*)
      type(expression) :: c_table
    end function c_table

    function c_tan(a) bind(c, name="sfdae_tan")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_tan
    end function c_tan

    function c_tanh(a) bind(c, name="sfdae_tanh")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_tanh
    end function c_tanh

    function c_time_derivative(a) bind(c, name="sfdae_time_derivative")
      import :: expression
      type(expression), value :: a
      type(expression) :: c_time_derivative
    end function c_time_derivative

    function c_transition_init(transition, size) bind(c, name="sfdae_transition_init")
      import :: c_int, c_size_t, sfdae_transition
      type(sfdae_transition), intent(inout) :: transition
      integer(c_size_t), value :: size
      integer(c_int) :: c_transition_init
    end function c_transition_init

    function c_version() bind(c, name="sfdae_version")
      import :: c_ptr
      type(c_ptr) :: c_version
    end function c_version

  end interface

contains

  !> Address of a sfdae_conditions_function; the compiler compares its arguments.
  function address_of_conditions_function(callback) result(address)
    procedure(sfdae_conditions_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_conditions_function

  !> Address of a sfdae_derivative_array_function; the compiler compares its arguments.
  function address_of_derivative_array_function(callback) result(address)
    procedure(sfdae_derivative_array_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_derivative_array_function

  !> Address of a sfdae_ensemble_monitor_function; the compiler compares its arguments.
  function address_of_ensemble_monitor_function(callback) result(address)
    procedure(sfdae_ensemble_monitor_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_ensemble_monitor_function

  !> Address of a sfdae_equations_function; the compiler compares its arguments.
  function address_of_equations_function(callback) result(address)
    procedure(sfdae_equations_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_equations_function

  !> Address of a sfdae_event_function; the compiler compares its arguments.
  function address_of_event_function(callback) result(address)
    procedure(sfdae_event_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_event_function

  !> Address of a sfdae_external_function; the compiler compares its arguments.
  function address_of_external_function(callback) result(address)
    procedure(sfdae_external_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_external_function

  !> Address of a sfdae_jump_function; the compiler compares its arguments.
  function address_of_jump_function(callback) result(address)
    procedure(sfdae_jump_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_jump_function

  !> Address of a sfdae_linear_equations_function; the compiler compares its arguments.
  function address_of_linear_equations_function(callback) result(address)
    procedure(sfdae_linear_equations_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_linear_equations_function

  !> Address of a sfdae_matrix_function; the compiler compares its arguments.
  function address_of_matrix_function(callback) result(address)
    procedure(sfdae_matrix_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_matrix_function

  !> Address of a sfdae_monitor_function; the compiler compares its arguments.
  function address_of_monitor_function(callback) result(address)
    procedure(sfdae_monitor_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_monitor_function

  !> Address of a sfdae_multibody_equations_function; the compiler compares its arguments.
  function address_of_multibody_equations_function(callback) result(address)
    procedure(sfdae_multibody_equations_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_multibody_equations_function

  !> Address of a sfdae_position_function; the compiler compares its arguments.
  function address_of_position_function(callback) result(address)
    procedure(sfdae_position_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_position_function

  !> Address of a sfdae_total_derivative_function; the compiler compares its arguments.
  function address_of_total_derivative_function(callback) result(address)
    procedure(sfdae_total_derivative_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_total_derivative_function

  !> Address of a sfdae_vector_function; the compiler compares its arguments.
  function address_of_vector_function(callback) result(address)
    procedure(sfdae_vector_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_vector_function

  !> Address of a sfdae_velocity_function; the compiler compares its arguments.
  function address_of_velocity_function(callback) result(address)
    procedure(sfdae_velocity_function) :: callback
    type(c_funptr) :: address

    address = c_funloc(callback)
  end function address_of_velocity_function

end module sfdae_c
