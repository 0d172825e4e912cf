! SPDX-License-Identifier: BSD-3-Clause
!
! The module against the C header: the layout of every struct, every default.
program mirror_test
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_f_procpointer, &
    c_funptr, c_int, c_ptr, c_size_t, c_sizeof
  use sfdae, only: dae_options, expression, sfdae_change, sfdae_characteristics, sfdae_decision, &
    sfdae_derivative_check, sfdae_descriptor_matrices, sfdae_ensemble, sfdae_ensemble_progress, &
    sfdae_ensemble_results, sfdae_initial_report, sfdae_linear_problem, sfdae_linearization, &
    sfdae_multibody_formulas, sfdae_multibody_problem, sfdae_multibody_report, &
    sfdae_nonlinear_problem, sfdae_options, sfdae_progress, sfdae_spectrum, sfdae_statistics, &
    sfdae_structure
  use test_support, only: check, finish
  implicit none

  interface
    !> Of the library.
    function sfdae_options_init(options, size) bind(c) result(status)
      import :: c_int, c_size_t, sfdae_options
      type(sfdae_options), intent(inout) :: options
      integer(c_size_t), value :: size
      integer(c_int) :: status
    end function sfdae_options_init

    !> Of mirror.c, each fills a struct and returns its size.
    function fill_characteristics(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_characteristics
      type(sfdae_characteristics), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_characteristics
    function fill_decision(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_decision
      type(sfdae_decision), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_decision
    function fill_change(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_change
      type(sfdae_change), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_change
    function fill_initial_report(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_initial_report
      type(sfdae_initial_report), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_initial_report
    function fill_statistics(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_statistics
      type(sfdae_statistics), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_statistics
    function fill_derivative_check(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_derivative_check
      type(sfdae_derivative_check), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_derivative_check
    function fill_progress(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_progress
      type(sfdae_progress), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_progress
    function fill_linear_problem(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_linear_problem
      type(sfdae_linear_problem), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_linear_problem
    function fill_nonlinear_problem(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_nonlinear_problem
      type(sfdae_nonlinear_problem), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_nonlinear_problem

    function fill_multibody_problem(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_multibody_problem
      type(sfdae_multibody_problem), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_multibody_problem

    function fill_multibody_formulas(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_multibody_formulas
      type(sfdae_multibody_formulas), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_multibody_formulas

    function fill_multibody_report(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_multibody_report
      type(sfdae_multibody_report), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_multibody_report
    function fill_structure(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_structure
      type(sfdae_structure), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_structure
    function fill_options(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_options
      type(sfdae_options), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_options
    function fill_spectrum(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_spectrum
      type(sfdae_spectrum), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_spectrum
    function fill_linearization(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_linearization
      type(sfdae_linearization), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_linearization
    function fill_descriptor_matrices(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_descriptor_matrices
      type(sfdae_descriptor_matrices), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_descriptor_matrices
    function fill_ensemble(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_ensemble
      type(sfdae_ensemble), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_ensemble
    function fill_ensemble_progress(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_ensemble_progress
      type(sfdae_ensemble_progress), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_ensemble_progress
    function fill_ensemble_results(s) bind(c) result(bytes)
      import :: c_size_t, sfdae_ensemble_results
      type(sfdae_ensemble_results), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_ensemble_results
  end interface

  abstract interface
    !> sfdae_matrix_function and sfdae_vector_function.
    function evaluation(t, order, values, user) bind(c) result(number)
      import :: c_double, c_int, c_ptr
      real(c_double), value :: t
      integer(c_int), value :: order
      type(c_ptr), value :: values
      type(c_ptr), value :: user
      integer(c_int) :: number
    end function evaluation

    !> sfdae_monitor_function.
    function monitor(progress, user) bind(c) result(number)
      import :: c_int, c_ptr, sfdae_progress
      type(sfdae_progress), intent(in) :: progress
      type(c_ptr), value :: user
      integer(c_int) :: number
    end function monitor
  end interface

  call check_results()
  call check_progress()
  call check_problem()
  call check_multibody()
  call check_ensemble()
  call check_linearization()
  call check_options()
  call check_defaults()
  call finish()

contains

  !> Structs that the library fills.
  subroutine check_results()
    type(sfdae_characteristics) :: c
    type(sfdae_decision) :: d
    type(sfdae_change) :: h
    type(sfdae_initial_report) :: r
    type(sfdae_statistics) :: s
    type(sfdae_derivative_check) :: v
    character(kind=c_char), parameter :: two = "2"

    call check(fill_characteristics(c) == c_sizeof(c), "size of sfdae_characteristics")
    call check(counts([real(c_double) :: c%size, c%t, c%strangeness_index, c%differential, &
      c%algebraic, c%undetermined, c%redundant, c%rank_e, c%leading_term, c%time_scale, &
      c%smallest_gap]), "members of sfdae_characteristics")

    call check(fill_decision(d) == c_sizeof(d), "size of sfdae_decision")
    call check(counts([real(c_double) :: d%size, d%t, d%level, d%stage, d%what, d%rows, &
      d%columns, d%rank, d%kept, d%dropped, d%noise, d%threshold, d%gap, d%verdict]), &
      "members of sfdae_decision")

    call check(fill_change(h) == c_sizeof(h), "size of sfdae_change")
    call check(counts([real(c_double) :: h%size, h%t, h%old_strangeness_index, &
      h%old_differential, h%old_algebraic, h%old_undetermined, h%old_redundant, &
      h%new_strangeness_index, h%new_differential, h%new_algebraic, h%new_undetermined, &
      h%new_redundant]), "members of sfdae_change")

    call check(fill_initial_report(r) == c_sizeof(r), "size of sfdae_initial_report")
    call check(counts([real(c_double) :: r%size, r%t, r%residual_before, r%residual_after, &
      r%largest_change, r%component, r%derivative_exact]), "members of sfdae_initial_report")

    call check(fill_statistics(s) == c_sizeof(s), "size of sfdae_statistics")
    call check(counts([real(c_double) :: s%size, s%steps, s%error_failures, s%other_failures, &
      s%reductions, s%factorizations, s%evaluations_e, s%evaluations_a, s%evaluations_f, &
      s%last_order, s%next_order, s%last_step, s%next_step, s%t_internal, s%smallest_kept, &
      s%consistency, s%first_step, s%evaluations_residual, s%linearizations, s%rounding, &
      s%check_calls, s%switches, s%jumps]), &
      "members of sfdae_statistics")

    call check(fill_derivative_check(v) == c_sizeof(v), "size of sfdae_derivative_check")
    call check(v%function == two, "function of sfdae_derivative_check")
    call check(counts([real(c_double) :: v%size, 2, v%order, v%row, v%column, v%supplied, &
      v%difference, v%error, v%uncertainty, v%suspicious]), "members of sfdae_derivative_check")
  end subroutine check_results

  !> Struct of the monitor.
  subroutine check_progress()
    type(sfdae_progress) :: p

    call check(fill_progress(p) == c_sizeof(p), "size of sfdae_progress")
    call check(counts([real(c_double) :: p%size, p%t, p%step, p%order, p%steps, p%num_unknowns, &
      number_at(p%x)]), "members of sfdae_progress")
  end subroutine check_progress

  !> Structs of ensembles.
  subroutine check_ensemble()
    type(sfdae_ensemble) :: e
    type(sfdae_ensemble_progress) :: p
    type(sfdae_ensemble_results) :: r
    character(kind=c_char), pointer :: text
    type(c_ptr), pointer :: name

    call check(fill_ensemble(e) == c_sizeof(e), "size of sfdae_ensemble")
    call c_f_pointer(e%parameter_names, name)
    call c_f_pointer(name, text)
    call check(counts([real(c_double) :: e%size, e%num_instances, e%num_parameters, &
      iachar(text) - iachar("0"), number_at(e%parameters), e%t0, number_at(e%x0), &
      number_at(e%xdot0), e%num_times, number_at(e%times), e%num_threads, &
      number_of(e%monitor) + 11, integer_at(e%monitor_user)]), "members of sfdae_ensemble")

    call check(fill_ensemble_progress(p) == c_sizeof(p), "size of sfdae_ensemble_progress")
    call check(counts([real(c_double) :: p%size, p%instance, p%status, p%num_ended, &
      p%num_instances]), "members of sfdae_ensemble_progress")

    call check(fill_ensemble_results(r) == c_sizeof(r), "size of sfdae_ensemble_results")
    call c_f_pointer(r%messages, text)
    call check(counts([real(c_double) :: r%size, number_at(r%x), number_at(r%xdot), &
      integer_at(r%statuses), integer_at(r%num_outputs), iachar(text), r%message_length, &
      r%num_failed, r%num_analyses, r%num_threads]), "members of sfdae_ensemble_results")
  end subroutine check_ensemble

  !> Structs of problems.
  subroutine check_problem()
    type(sfdae_linear_problem) :: p
    type(sfdae_nonlinear_problem) :: q

    call check(fill_linear_problem(p) == c_sizeof(p), "size of sfdae_linear_problem")
    call check(counts([real(c_double) :: p%size, p%num_equations, p%num_unknowns, &
      number_of(p%e) + 3, number_of(p%a) + 3, number_of(p%f) + 3, p%constant_e, p%constant_a, &
      p%num_prescribed, integer_at(p%prescribed), number_of(p%prescribed_values) + 7, &
      integer_at(p%user), integer_at(p%equation_names), p%e_entries, integer_at(p%e_col_start), &
      integer_at(p%e_row_index), p%a_entries, integer_at(p%a_col_start), &
      integer_at(p%a_row_index), p%matrices, p%num_conditions, number_of(p%conditions) + 18, &
      integer_at(p%branches)]), "members of sfdae_linear_problem")

    call check(fill_nonlinear_problem(q) == c_sizeof(q), "size of sfdae_nonlinear_problem")
    call check(counts([real(c_double) :: q%size, q%num_equations, q%num_unknowns, &
      number_of(q%equations) + 3, number_of(q%linear_equations) + 3, &
      number_of(q%total_derivative) + 3, q%num_prescribed, integer_at(q%prescribed), &
      number_of(q%prescribed_values) + 5, integer_at(q%user), integer_at(q%differentiations), &
      integer_at(q%equation_names), q%f_x_entries, integer_at(q%f_x_col_start), &
      integer_at(q%f_x_row_index), q%f_xdot_entries, integer_at(q%f_xdot_col_start), &
      integer_at(q%f_xdot_row_index), q%matrices, q%num_conditions, &
      number_of(q%conditions) + 20, integer_at(q%branches), number_of(q%derivative_array) + 20]), &
      "members of sfdae_nonlinear_problem")
  end subroutine check_problem

  !> Structs of mechanical systems.
  subroutine check_multibody()
    type(sfdae_multibody_problem) :: p
    type(sfdae_multibody_formulas) :: f
    type(sfdae_multibody_report) :: r
    type(sfdae_structure) :: s

    call check(fill_multibody_problem(p) == c_sizeof(p), "size of sfdae_multibody_problem")
    call check(counts([real(c_double) :: p%size, p%num_positions, p%num_velocities, &
      p%num_constraints, p%num_nonholonomic, number_of(p%equations) + 5, number_of(p%mass) + 5, &
      number_of(p%forces) + 5, number_of(p%constraints) + 5, number_of(p%constraint_jacobian) + 9, &
      number_of(p%constraint_rate) + 9, number_of(p%kinematics) + 9, &
      number_of(p%nonholonomic_matrix) + 9, number_of(p%nonholonomic_offset) + 13, &
      number_of(p%constraint_curvature) + 13, number_of(p%nonholonomic_curvature) + 13, &
      p%coordinates, integer_at(p%user), integer_at(p%constraint_names)]), &
      "members of sfdae_multibody_problem")

    call check(fill_multibody_formulas(f) == c_sizeof(f), "size of sfdae_multibody_formulas")
    call check(counts([value_at(f%mass), value_at(f%forces), value_at(f%constraints), &
      value_at(f%kinematics), value_at(f%nonholonomic_matrix), value_at(f%nonholonomic_offset)]), &
      "members of sfdae_multibody_formulas")

    call check(fill_multibody_report(r) == c_sizeof(r), "size of sfdae_multibody_report")
    call check(counts([real(c_double) :: r%size, r%t, r%holonomic, r%nonholonomic, r%redundant, &
      r%degrees_of_freedom, r%position_freedom, r%condition, r%partitions, r%position_residual, &
      r%velocity_residual]), "members of sfdae_multibody_report")

    call check(fill_structure(s) == c_sizeof(s), "size of sfdae_structure")
    call check(counts([real(c_double) :: s%size, s%has_assignment, s%freedom, s%index_bound, &
      s%num_blocks, s%largest_block, s%is_followed, s%verdict, s%doubtful_block, &
      s%smallest_pivot, s%num_replaced]), "members of sfdae_structure")
  end subroutine check_multibody

  !> Structs of descriptor systems.
  subroutine check_linearization()
    type(sfdae_spectrum) :: s
    type(sfdae_linearization) :: l
    type(sfdae_descriptor_matrices) :: d
    character(kind=c_char), pointer :: text
    type(c_ptr), pointer :: name

    call check(fill_spectrum(s) == c_sizeof(s), "size of sfdae_spectrum")
    call check(counts([real(c_double) :: s%size, s%num_finite, s%num_infinite, &
      s%strangeness_index, s%differential, s%algebraic, s%undetermined, s%redundant]), &
      "members of sfdae_spectrum")

    call check(fill_linearization(l) == c_sizeof(l), "size of sfdae_linearization")
    call c_f_pointer(l%input_parameters, name)
    call c_f_pointer(name, text)
    call check(counts([real(c_double) :: l%size, l%t, number_at(l%x), number_at(l%xdot), &
      l%num_input_parameters, iachar(text) - iachar("0"), l%num_input_unknowns, &
      integer_at(l%input_unknowns), l%num_input_columns, number_at(l%input_columns), &
      l%num_output_unknowns, integer_at(l%output_unknowns), l%num_output_rows, &
      number_at(l%output_rows)]), "members of sfdae_linearization")

    call check(fill_descriptor_matrices(d) == c_sizeof(d), "size of sfdae_descriptor_matrices")
    call check(counts([real(c_double) :: d%size, d%num_equations, d%num_unknowns, d%num_inputs, &
      d%num_outputs, number_at(d%e), number_at(d%a), number_at(d%b), number_at(d%c), &
      number_at(d%d), d%rank_tol]), "members of sfdae_descriptor_matrices")
  end subroutine check_linearization

  !> Struct of the options.
  subroutine check_options()
    type(sfdae_options) :: o
    type(sfdae_progress) :: progress
    procedure(monitor), pointer :: call_monitor

    call check(fill_options(o) == c_sizeof(o), "size of sfdae_options")
    call c_f_procpointer(o%monitor, call_monitor)
    call check(counts([real(c_double) :: o%size, o%rtol, o%atol, number_at(o%rtol_vector), &
      number_at(o%atol_vector), o%max_index, o%reduction, o%rank_tol, o%time_scale, &
      o%difference_derivatives, o%difference_step, o%initial_values, integer_at(o%fixed), &
      number_at(o%initial_weights), o%ignore_inconsistency, o%consistency_tol, o%max_order, &
      o%initial_step, o%max_step, o%use_stop_time, o%stop_time, o%max_steps, o%leading_term, &
      call_monitor(progress, o%monitor_user) + 19, integer_at(o%monitor_user), o%method, &
      o%min_stages, o%max_stages, o%xdot_is_guess, o%output, o%check_derivatives, o%structure, &
      o%conditions, o%max_seconds]), "members of sfdae_options")
  end subroutine check_options

  !> dae_options starts with the library's defaults.
  subroutine check_defaults()
    type(sfdae_options) :: c
    type(dae_options) :: f

    call check(sfdae_options_init(c, c_sizeof(c)) == 0, "sfdae_options_init")
    call check(.not. (allocated(f%rtol_vector) .or. allocated(f%atol_vector) .or. &
      allocated(f%fixed) .or. allocated(f%initial_weights) .or. associated(f%monitor)), &
      "nothing is allocated or associated")
    call check(equal(f%rtol, c%rtol), "rtol")
    call check(equal(f%atol, c%atol), "atol")
    call check(f%max_index == c%max_index, "max_index")
    call check(f%reduction == c%reduction, "reduction")
    call check(equal(f%rank_tol, c%rank_tol), "rank_tol")
    call check(equal(f%time_scale, c%time_scale), "time_scale")
    call check(f%difference_derivatives .eqv. c%difference_derivatives /= 0, &
      "difference_derivatives")
    call check(equal(f%difference_step, c%difference_step), "difference_step")
    call check(f%initial_values == c%initial_values, "initial_values")
    call check(f%ignore_inconsistency .eqv. c%ignore_inconsistency /= 0, "ignore_inconsistency")
    call check(equal(f%consistency_tol, c%consistency_tol), "consistency_tol")
    call check(f%max_order == c%max_order, "max_order")
    call check(equal(f%initial_step, c%initial_step), "initial_step")
    call check(equal(f%max_step, c%max_step), "max_step")
    call check(f%use_stop_time .eqv. c%use_stop_time /= 0, "use_stop_time")
    call check(equal(f%stop_time, c%stop_time), "stop_time")
    call check(f%max_steps == c%max_steps, "max_steps")
    call check(f%leading_term == c%leading_term, "leading_term")
    call check(f%method == c%method, "method")
    call check(f%min_stages == c%min_stages, "min_stages")
    call check(f%max_stages == c%max_stages, "max_stages")
    call check(f%xdot_is_guess .eqv. c%xdot_is_guess /= 0, "xdot_is_guess")
    call check(f%output == c%output, "output")
    call check(f%check_derivatives .eqv. c%check_derivatives /= 0, "check_derivatives")
    call check(f%structure == c%structure, "structure")
    call check(f%conditions == c%conditions, "conditions")
    call check(equal(f%max_seconds, c%max_seconds), "max_seconds")
  end subroutine check_defaults

  !> Whether the values are 1, 2, 3, ...
  function counts(values) result(yes)
    real(c_double), intent(in) :: values(:)
    logical :: yes
    integer :: i

    yes = all(equal(values, [(real(i, c_double), i=1, size(values))]))
  end function counts

  !> Whether two numbers are the same.
  elemental function equal(a, b) result(yes)
    real(c_double), intent(in) :: a
    real(c_double), intent(in) :: b
    logical :: yes

    yes = abs(a - b) <= 0
  end function equal

  !> The double at an address.
  function number_at(address) result(number)
    type(c_ptr), intent(in) :: address
    real(c_double) :: number
    real(c_double), pointer :: p

    call c_f_pointer(address, p)
    number = p
  end function number_at

  !> The value of the expression at an address.
  function value_at(address) result(number)
    type(c_ptr), intent(in) :: address
    real(c_double) :: number
    type(expression), pointer :: p

    call c_f_pointer(address, p)
    number = p%value
  end function value_at

  !> The integer at an address.
  function integer_at(address) result(number)
    type(c_ptr), intent(in) :: address
    integer(c_int) :: number
    integer(c_int), pointer :: p

    call c_f_pointer(address, p)
    number = p
  end function integer_at

  !> What a callback returns.
  function number_of(callback) result(number)
    type(c_funptr), intent(in) :: callback
    integer(c_int) :: number
    procedure(evaluation), pointer :: p
    real(c_double), target :: values(1)
    type(c_ptr) :: nothing

    nothing = transfer(0_c_size_t, nothing)
    call c_f_procpointer(callback, p)
    values = 0
    number = p(values(1), 0_c_int, nothing, nothing)
  end function number_of

end program mirror_test
