! SPDX-License-Identifier: BSD-3-Clause
!
! The solver: analysis, initial values, integration, inspection.
module sfdae_solver
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_int, c_loc, &
    c_long, c_null_char, c_null_ptr, c_ptr, c_size_t, c_sizeof
  use sfdae_c, only: c_advance, c_analyze, c_analyze_at, c_certify, c_change_init, &
    c_characteristics_init, c_check_derivatives, c_check_multibody_derivatives, &
    c_check_total_derivatives, c_decision_init, c_derivative_check_init, c_destroy, &
    c_export_source, c_get_change, &
    c_get_characteristics, c_get_checkpoint_length, c_get_decision, c_get_derivative_array, &
    c_get_derivative_array_at, c_get_event_sensitivities, c_get_events, c_get_extended_system, &
    c_get_initial_report, c_get_jet, c_get_jump, c_get_multibody_report, c_get_num_decisions, &
    c_get_gradient, c_get_parameter, c_get_projectors, c_get_projectors_at, c_get_sensitivities, &
    c_get_sensitivity_statistics, c_get_singular_point, c_get_statistics, c_get_strangeness_free, &
    c_get_num_switches, c_get_strangeness_free_at, c_get_structure, c_get_switch, c_impact, &
    c_initial_report_init, c_interpolate, &
    c_jump, c_make_consistent, c_message, c_multibody_report_init, c_pass_singular_points, &
    c_record_solution, c_report, &
    c_request_stop, c_restore_checkpoint, c_save_checkpoint, c_sensitivity_statistics_init, &
    c_set_breakpoints, c_set_events, c_set_options, c_set_parameter, c_singular_point_init, &
    c_start, &
    c_statistics_init, c_switch_init, &
    c_status_name, c_step, c_structure_init, c_version
  use sfdae_control, only: compare_size, control_holder, dae_events, dae_monitor, dae_options, &
    event_callback, fill_options
  use sfdae_conversions, only: text_at, text_in, text_in_c
  use sfdae_ensembles, only: dae_ensemble, dae_ensemble_results, solve_ensemble_in_c
  use sfdae_linearizations, only: dae_descriptor, dae_linearization, linearize_in_c
  use sfdae_multibody, only: any_multibody_dae, multibody_holder
  use sfdae_problems, only: any_dae, linear_dae, linear_holder, nonlinear_holder, numeric_dae, &
    problem_holder, sparsity_pattern
  use sfdae_sensitivities, only: dae_sensitivities, set_sensitivities_in_c
  use sfdae_solutions, only: dae_solution
  use sfdae_types, only: sfdae_change, sfdae_characteristics, sfdae_decision, &
    sfdae_derivative_check, sfdae_illegal_argument, sfdae_initial_report, &
    sfdae_multibody_report, sfdae_ok, sfdae_options, sfdae_out_of_memory, &
    sfdae_sensitivity_statistics, sfdae_singular_point, sfdae_statistics, &
    sfdae_structure, sfdae_switch
  implicit none
  private

  public :: dae_solver
  public :: sfdae_check_linear, sfdae_check_nonlinear, sfdae_check_multibody
  public :: sfdae_status_name, sfdae_version

  !> Targets of C pointers. Allocated on the heap, so that they stay in place.
  type :: solver_holder
    class(problem_holder), allocatable :: problem
    type(control_holder) :: control
  end type solver_holder

  !> A solver. Never copy one, and destroy it before it goes out of scope.
  type :: dae_solver
    private
    !> The C solver.
    type(c_ptr) :: handle = c_null_ptr
    type(solver_holder), pointer :: holder => null()
    !> Requested sensitivities.
    integer(c_int) :: num_sensitivities = 0
    !> Message of this module about the last call; else the message of the library is used.
    character(len=:), allocatable :: complaint
  contains
    procedure :: create => solver_create
    procedure :: destroy => solver_destroy
    procedure :: set_options => solver_set_options
    procedure :: message => solver_message
    procedure :: request_stop => solver_request_stop
    procedure :: analyze => solver_analyze
    procedure :: analyze_at => solver_analyze_at
    procedure :: set_parameter => solver_set_parameter
    procedure :: get_parameter => solver_get_parameter
    procedure :: get_characteristics => solver_get_characteristics
    procedure :: get_num_decisions => solver_get_num_decisions
    procedure :: get_decision => solver_get_decision
    procedure :: get_change => solver_get_change
    procedure :: get_singular_point => solver_get_singular_point
    procedure :: pass_singular_points => solver_pass_singular_points
    procedure :: make_consistent => solver_make_consistent
    procedure :: get_initial_report => solver_get_initial_report
    procedure :: start => solver_start
    procedure :: advance => solver_advance
    procedure :: step => solver_step
    procedure :: solve_ensemble => solver_solve_ensemble
    procedure :: record => solver_record
    procedure :: stop_recording => solver_stop_recording
    procedure :: save_checkpoint => solver_save_checkpoint
    procedure :: restore_checkpoint => solver_restore_checkpoint
    procedure :: set_events => solver_set_events
    procedure :: get_events => solver_get_events
    procedure :: get_num_switches => solver_get_num_switches
    procedure :: get_switch => solver_get_switch
    procedure :: set_breakpoints => solver_set_breakpoints
    procedure :: get_jump => solver_get_jump
    procedure :: jump => solver_jump
    procedure :: impact => solver_impact
    procedure :: interpolate => solver_interpolate
    procedure :: set_sensitivities => solver_set_sensitivities
    procedure :: get_sensitivities => solver_get_sensitivities
    procedure :: get_gradient => solver_get_gradient
    procedure :: get_event_sensitivities => solver_get_event_sensitivities
    procedure :: get_sensitivity_statistics => solver_get_sensitivity_statistics
    procedure :: get_statistics => solver_get_statistics
    procedure :: report => solver_report
    procedure :: export_source => solver_export_source
    procedure :: get_jet => solver_get_jet
    procedure :: get_derivative_array => solver_get_derivative_array
    procedure :: get_projectors => solver_get_projectors
    procedure :: get_strangeness_free => solver_get_strangeness_free
    procedure :: get_extended_system => solver_get_extended_system
    procedure :: linearize => solver_linearize
    procedure :: certify => solver_certify
    procedure :: check_derivatives => solver_check_derivatives
    procedure :: check_total_derivatives => solver_check_total_derivatives
    procedure :: check_multibody_derivatives => solver_check_multibody_derivatives
    procedure :: get_multibody_report => solver_get_multibody_report
    procedure :: get_structure => solver_get_structure
    !> For internal use by the modules of sfdae: the address of the C solver and n.
    procedure :: in_c => solver_in_c
  end type dae_solver

contains

  ! ---- Without a solver ---------------------------------------------------------------------

  !> Version of the library in use, for example "0.2.0".
  function sfdae_version() result(version)
    character(len=:), allocatable :: version

    version = text_at(c_version())
  end function sfdae_version

  !> Name of a status as in C, for example "SFDAE_STEP_TOO_SMALL".
  function sfdae_status_name(status) result(name)
    !> sfdae_ok, ...; any other number is an "unknown status".
    integer(c_int), intent(in) :: status
    character(len=:), allocatable :: name

    name = text_at(c_status_name(status))
  end function sfdae_status_name

  !> Checks a linear problem with its options as create does and describes errors.
  recursive subroutine sfdae_check_linear(problem, text, status, options)
    !> Not changed.
    class(linear_dae), target, intent(inout) :: problem
    !> Description of the errors; empty if there are none.
    character(len=:), allocatable, intent(out) :: text
    !> As in create.
    integer(c_int), intent(out) :: status
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(linear_holder), target :: holder

    call check_problem(problem, holder, text, status, options)
  end subroutine sfdae_check_linear

  !> Checks any other problem with its options as create does; equations are recorded.
  recursive subroutine sfdae_check_nonlinear(problem, text, status, options)
    !> nonlinear_dae, recorded_linear_dae, derivative_dae or derivative_array_dae.
    class(any_dae), target, intent(inout) :: problem
    !> Description of the errors; empty if there are none.
    character(len=:), allocatable, intent(out) :: text
    !> As in create.
    integer(c_int), intent(out) :: status
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(nonlinear_holder), target :: holder

    call check_problem(problem, holder, text, status, options)
  end subroutine sfdae_check_nonlinear

  !> Checks a mechanical system with its options as create does; equations are recorded.
  recursive subroutine sfdae_check_multibody(problem, text, status, options)
    !> recorded_multibody_dae, multibody_dae or kinematic_multibody_dae.
    class(any_multibody_dae), target, intent(inout) :: problem
    !> Description of the errors; empty if there are none.
    character(len=:), allocatable, intent(out) :: text
    !> As in create.
    integer(c_int), intent(out) :: status
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(multibody_holder), target :: holder

    call check_problem(problem, holder, text, status, options)
  end subroutine sfdae_check_multibody

  !> Checks a problem with its options; the holder must be of the kind that it needs.
  recursive subroutine check_problem(problem, holder, text, status, options)
    class(any_dae), target, intent(inout) :: problem
    class(problem_holder), target, intent(inout) :: holder
    character(len=:), allocatable, intent(out) :: text
    integer(c_int), intent(out) :: status
    type(dae_options), target, intent(in), optional :: options
    type(control_holder), target :: control
    type(sfdae_options) :: c_options

    call holder%fill(problem)
    control%num_unknowns = holder%num_unknowns
    call fill_options(options, control, c_options, text)
    call check_names(problem, text)
    status = sfdae_illegal_argument
    if (len(text) == 0) call say_what_is_wrong(holder, c_options, text, status)
  end subroutine check_problem

  !> Complains about a wrong number of names, which C cannot detect.
  subroutine check_names(problem, complaint)
    class(any_dae), intent(in) :: problem
    !> Replaced if it is wrong.
    character(len=:), allocatable, intent(inout) :: complaint

    if (allocated(problem%equation_names)) &
      call compare_size("equation_names", size(problem%equation_names, kind=c_int), &
        problem%num_equations, complaint, "m")
    select type (problem)
    class is (linear_dae)
      call check_pattern(problem%pattern_e, "pattern_e", problem%num_unknowns, complaint)
      call check_pattern(problem%pattern_a, "pattern_a", problem%num_unknowns, complaint)
    class is (numeric_dae)
      call check_pattern(problem%pattern_f_x, "pattern_f_x", problem%num_unknowns, complaint)
      call check_pattern(problem%pattern_f_xdot, "pattern_f_xdot", problem%num_unknowns, complaint)
    class is (any_multibody_dae)
      if (allocated(problem%constraint_names)) &
        call compare_size("constraint_names", size(problem%constraint_names, kind=c_int), &
          problem%num_constraints + problem%num_nonholonomic, complaint, "nl + nk")
    end select
  end subroutine check_names

  !> Complains about a wrong number of columns, which C cannot detect, or a missing part.
  subroutine check_pattern(pattern, name, num_unknowns, complaint)
    type(sparsity_pattern), intent(in) :: pattern
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: num_unknowns
    !> Replaced if it is wrong.
    character(len=:), allocatable, intent(inout) :: complaint

    if (allocated(pattern%col_start) .neqv. allocated(pattern%row_index)) &
      complaint = name // " has one of col_start and row_index only"
    if (allocated(pattern%col_start)) call compare_size(name // "%col_start", &
      size(pattern%col_start, kind=c_int), num_unknowns + 1_c_int, complaint, "n + 1")
  end subroutine check_pattern

  !> Describes errors in a problem and its options; returns the status that create returns.
  recursive subroutine say_what_is_wrong(holder, c_options, text, status)
    class(problem_holder), intent(in) :: holder
    type(sfdae_options), intent(in) :: c_options
    character(len=:), allocatable, intent(out) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: buffer(1024)

    buffer = c_null_char
    status = holder%check(c_options, buffer)
    text = text_in(buffer)
  end subroutine say_what_is_wrong

  ! ---- Life ---------------------------------------------------------------------------------

  !> Creates the solver. A solver that exists already is refused: destroy it first.
  recursive subroutine solver_create(self, problem, status, options)
    class(dae_solver), intent(inout) :: self
    !> Must have the target attribute and live, in place, as long as the solver.
    class(any_dae), target, intent(inout) :: problem
    !> Failures: sfdae_illegal_argument, sfdae_empty_problem, sfdae_out_of_memory.
    integer(c_int), intent(out) :: status
    !> Copied. Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    type(sfdae_options) :: c_options

    status = sfdae_illegal_argument
    self%complaint = "the solver exists already: destroy it first"
    if (c_associated(self%handle)) return
    call allocate_holder(self%holder, problem, status)
    self%complaint = "out of memory for the solver"
    if (status < 0) return
    call self%holder%problem%fill(problem)
    self%holder%control%num_unknowns = self%holder%problem%num_unknowns
    call fill_options(options, self%holder%control, c_options, self%complaint)
    call check_names(problem, self%complaint)
    status = sfdae_illegal_argument
    if (len(self%complaint) == 0) then
      status = self%holder%problem%create(self%handle, c_options)
      if (status < 0) self%complaint = text_at(c_message(c_null_ptr))
    end if
    if (status < 0) deallocate (self%holder)
  end subroutine solver_create

  !> Allocates the targets of C pointers for this kind of problem.
  subroutine allocate_holder(holder, problem, status)
    type(solver_holder), pointer, intent(inout) :: holder
    class(any_dae), intent(in) :: problem
    !> sfdae_ok or sfdae_out_of_memory.
    integer(c_int), intent(out) :: status
    integer :: allocation

    status = sfdae_out_of_memory
    allocate (holder, stat=allocation)
    if (allocation /= 0) return
    select type (problem)
    class is (linear_dae)
      allocate (linear_holder :: holder%problem, stat=allocation)
    class is (any_multibody_dae)
      allocate (multibody_holder :: holder%problem, stat=allocation)
    class default
      allocate (nonlinear_holder :: holder%problem, stat=allocation)
    end select
    if (allocation == 0) then
      status = sfdae_ok
    else
      deallocate (holder)
    end if
  end subroutine allocate_holder

  !> Frees the solver. It need not exist.
  subroutine solver_destroy(self, status)
    class(dae_solver), intent(inout) :: self
    !> sfdae_busy if called from a callback of this solver; the call then has no effect.
    integer(c_int), intent(out), optional :: status
    integer(c_int) :: outcome

    outcome = c_destroy(self%handle)
    if (outcome == sfdae_ok) then
      if (associated(self%holder)) deallocate (self%holder)
      self%complaint = ""
    end if
    if (present(status)) status = outcome
  end subroutine solver_destroy

  !> Replaces the options; the point reached is kept. A change of max_index, reduction, rank_tol,
  !> time_scale, difference_derivatives, difference_step, leading_term or structure requires a new
  !> start.
  subroutine solver_set_options(self, options, status)
    class(dae_solver), intent(inout) :: self
    !> Copied.
    type(dae_options), target, intent(in) :: options
    integer(c_int), intent(out) :: status
    type(sfdae_options) :: c_options
    class(dae_monitor), pointer :: old_monitor

    call check_call(self, status)
    if (status < 0) return
    old_monitor => self%holder%control%monitor
    call fill_options(options, self%holder%control, c_options, self%complaint)
    status = sfdae_illegal_argument
    if (len(self%complaint) == 0) status = c_set_options(self%handle, c_options)
    if (status < 0) self%holder%control%monitor => old_monitor
  end subroutine solver_set_options

  !> Message of the last call: the event, its place, the numbers and a remedy.
  function solver_message(self) result(text)
    class(dae_solver), intent(in) :: self
    !> Empty after sfdae_ok.
    character(len=:), allocatable :: text

    text = ""
    if (allocated(self%complaint)) text = self%complaint
    if (len(text) == 0 .and. c_associated(self%handle)) text = text_at(c_message(self%handle))
  end function solver_message

  !> Stops the current call, or else the next one, with sfdae_stopped. May be called from other
  !> threads.
  subroutine solver_request_stop(self, status)
    class(dae_solver), intent(in) :: self
    integer(c_int), intent(out) :: status

    status = c_request_stop(self%handle)
  end subroutine solver_request_stop

  !> Changes a parameter of recorded equations, see named_parameter. The next advance continues from
  !> the point returned last, as at a jump of data; with sensitivities, start must be called first.
  subroutine solver_set_parameter(self, name, value, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(c_double), intent(in) :: value
    !> sfdae_illegal_argument if there is no such parameter or the value is not finite.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_set_parameter(self%handle, text_in_c(name), value)
  end subroutine solver_set_parameter

  !> The value of a parameter of recorded equations.
  subroutine solver_get_parameter(self, name, value, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(c_double), intent(inout) :: value
    !> sfdae_illegal_argument if there is no such parameter.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_parameter(self%handle, text_in_c(name), value)
  end subroutine solver_get_parameter

  ! ---- Index analysis -----------------------------------------------------------------------

  !> Detects the strangeness index at t and nearby toward the end of the interval. Discards the
  !> point reached: start must follow. Warning: sfdae_not_unique. Failures: callbacks, structure.
  recursive subroutine solver_analyze(self, t, toward, status, characteristics)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> /= t.
    real(c_double), intent(in) :: toward
    integer(c_int), intent(out) :: status
    type(sfdae_characteristics), intent(inout), optional :: characteristics
    type(sfdae_characteristics) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_characteristics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_analyze(self%handle, t, toward, found)
    if (status >= 0 .and. present(characteristics)) characteristics = found
  end subroutine solver_analyze

  !> Detects the strangeness index along the solution through a point near x, as required for
  !> nonlinear problems.
  recursive subroutine solver_analyze_at(self, t, toward, x, status, characteristics)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> /= t.
    real(c_double), intent(in) :: toward
    !> n values, which need not be consistent.
    real(c_double), contiguous, intent(in) :: x(:)
    integer(c_int), intent(out) :: status
    type(sfdae_characteristics), intent(inout), optional :: characteristics
    type(sfdae_characteristics) :: found

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    if (status == sfdae_ok) status = c_characteristics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_analyze_at(self%handle, t, toward, x, found)
    if (status >= 0 .and. present(characteristics)) characteristics = found
  end subroutine solver_analyze_at

  !> The characteristic values in use. sfdae_not_started before an analysis.
  subroutine solver_get_characteristics(self, characteristics, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_characteristics), intent(inout) :: characteristics
    integer(c_int), intent(out) :: status
    type(sfdae_characteristics) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_characteristics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_characteristics(self%handle, found)
    if (status >= 0) characteristics = found
  end subroutine solver_get_characteristics

  !> Number of rank decisions of the last analysis.
  subroutine solver_get_num_decisions(self, count, status)
    class(dae_solver), intent(inout) :: self
    integer(c_int), intent(inout) :: count
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_num_decisions(self%handle, count)
  end subroutine solver_get_num_decisions

  !> One rank decision of the last analysis.
  subroutine solver_get_decision(self, index, decision, status)
    class(dae_solver), intent(inout) :: self
    !> 1 ... number of decisions.
    integer(c_int), intent(in) :: index
    type(sfdae_decision), intent(inout) :: decision
    integer(c_int), intent(out) :: status
    type(sfdae_decision) :: found

    call check_call(self, status)
    if (status == sfdae_ok .and. index < 1) then
      status = sfdae_illegal_argument
      self%complaint = "decisions count from 1"
    end if
    if (status == sfdae_ok) status = c_decision_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_decision(self%handle, index - 1_c_int, found)
    if (status >= 0) decision = found
  end subroutine solver_get_decision

  !> The place of the change of characteristic values (after sfdae_characteristics_changed).
  subroutine solver_get_change(self, change, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_change), intent(inout) :: change
    !> sfdae_not_started if they did not change.
    integer(c_int), intent(out) :: status
    type(sfdae_change) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_change_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_change(self%handle, found)
    if (status >= 0) change = found
  end subroutine solver_get_change

  !> The singular point met last, whether it ended a call or was passed.
  !> point%component counts from 1; 0: none.
  subroutine solver_get_singular_point(self, point, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_singular_point), intent(inout) :: point
    !> sfdae_not_started if there was none since start.
    integer(c_int), intent(out) :: status
    type(sfdae_singular_point) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_singular_point_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_singular_point(self%handle, found)
    found%component = found%component + 1
    if (status >= 0) point = found
  end subroutine solver_get_singular_point

  !> Lets integrations pass at most this many singular points at which a smooth continuation is
  !> confirmed. branches.h explains the rules.
  subroutine solver_pass_singular_points(self, max_points, status)
    class(dae_solver), intent(inout) :: self
    !> 0: none.
    integer, intent(in) :: max_points
    integer(c_int), intent(out) :: status

    status = c_pass_singular_points(self%handle, int(max_points, c_long))
  end subroutine solver_pass_singular_points

  ! ---- Initial values -----------------------------------------------------------------------

  !> Makes x consistent at t according to the options; analyzes first, forward from t, if necessary.
  !> The point reached is unaffected. Failures: callbacks, structure, values.
  recursive subroutine solver_make_consistent(self, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n values, in: initial guess, out: consistent.
    real(c_double), contiguous, intent(inout) :: x(:)
    integer(c_int), intent(out) :: status
    !> n values: x'(t) of the solution through x, of minimum norm if the problem leaves it free.
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_point(self, x, status, xdot, xdot_address)
    if (status == sfdae_ok) status = c_make_consistent(self%handle, t, x, xdot_address)
  end subroutine solver_make_consistent

  !> Changes of the initial values by the last start or make_consistent.
  subroutine solver_get_initial_report(self, report, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_initial_report), intent(inout) :: report
    integer(c_int), intent(out) :: status
    type(sfdae_initial_report) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_initial_report_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_initial_report(self%handle, found)
    if (status < 0) return
    found%component = found%component + 1_c_int
    report = found
  end subroutine solver_get_initial_report

  ! ---- Integration --------------------------------------------------------------------------

  !> Starts or restarts at (t, x); analyzes if necessary and makes x consistent. Failures:
  !> callbacks, structure, values. A restart on an analyzed solver needs no new analysis.
  recursive subroutine solver_start(self, t, toward, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> Sets the direction of integration.
    real(c_double), intent(in) :: toward
    !> n values, in: initial guess, out: consistent.
    real(c_double), contiguous, intent(inout) :: x(:)
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_point(self, x, status, xdot, xdot_address)
    if (status == sfdae_ok) status = c_start(self%handle, t, toward, x, xdot_address)
  end subroutine solver_start

  !> Integrates to tout. Warnings and failures of the integration return the last accepted point.
  recursive subroutine solver_advance(self, tout, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    !> In the direction of integration, at or after the last point returned.
    real(c_double), intent(in) :: tout
    !> Point reached, tout if the call succeeded.
    real(c_double), intent(inout) :: t
    !> n values at t, which satisfy all constraints, hidden ones included.
    real(c_double), contiguous, intent(inout) :: x(:)
    !> Warnings: sfdae_stopped, sfdae_inconsistency_ignored, sfdae_event. Failures: callbacks,
    !> integration, ...
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_point(self, x, status, xdot, xdot_address)
    if (status == sfdae_ok) status = c_advance(self%handle, tout, t, x, xdot_address)
  end subroutine solver_advance

  !> Takes one step toward tout: sfdae_step_taken with the point reached, or sfdae_ok at tout.
  recursive subroutine solver_step(self, tout, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    !> In the direction of integration, at or after the last point returned.
    real(c_double), intent(in) :: tout
    !> Point reached.
    real(c_double), intent(inout) :: t
    !> n values at t.
    real(c_double), contiguous, intent(inout) :: x(:)
    !> Otherwise as in advance.
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_point(self, x, status, xdot, xdot_address)
    if (status == sfdae_ok) status = c_step(self%handle, tout, t, x, xdot_address)
  end subroutine solver_step

  !> Solves many instances of recorded equations on several threads. The solver is unchanged.
  recursive subroutine solver_solve_ensemble(self, ensemble, results, status)
    class(dae_solver), intent(inout) :: self
    !> The instances and outputs.
    type(dae_ensemble), target, intent(in) :: ensemble
    !> Replaced unless the call fails.
    type(dae_ensemble_results), intent(inout) :: results
    !> Warnings: sfdae_instances_failed, sfdae_stopped. Failure: sfdae_illegal_argument.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) call solve_ensemble_in_c(self%handle, &
      self%holder%problem%num_unknowns, ensemble, results, status, self%complaint)
  end subroutine solver_solve_ensemble

  !> The descriptor system of the problem, linearized at a point. An integration is unaffected.
  recursive subroutine solver_linearize(self, choice, descriptor, status)
    class(dae_solver), intent(inout) :: self
    !> The point, inputs and outputs.
    type(dae_linearization), target, intent(in) :: choice
    !> Replaced unless the call fails.
    class(dae_descriptor), intent(inout) :: descriptor
    !> sfdae_not_started if the solution is needed but unknown; callbacks.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) call linearize_in_c(self%handle, self%holder%problem%num_equations, &
      self%holder%problem%num_unknowns, choice, descriptor, status, self%complaint)
  end subroutine solver_linearize

  !> Records all following accepted steps in the solution.
  subroutine solver_record(self, solution, status)
    class(dae_solver), intent(inout) :: self
    !> Must have been created.
    type(dae_solution), intent(in) :: solution
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status /= sfdae_ok) return
    if (.not. c_associated(solution%address())) then
      status = sfdae_illegal_argument
      self%complaint = "the solution does not exist: create it first"
      return
    end if
    status = c_record_solution(self%handle, solution%address())
  end subroutine solver_record

  !> Stops recording steps.
  subroutine solver_stop_recording(self, status)
    class(dae_solver), intent(inout) :: self
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_record_solution(self%handle, c_null_ptr)
  end subroutine solver_stop_recording

  !> The analysis and the state of the integration as an array of plain numbers, to be stored,
  !> written to a file (17 digits) or passed to another process, without problem and options.
  subroutine solver_save_checkpoint(self, checkpoint, status)
    class(dae_solver), intent(inout) :: self
    !> Allocated as needed; its size changes from step to step.
    real(c_double), allocatable, intent(inout) :: checkpoint(:)
    !> sfdae_not_started if there is no integration.
    integer(c_int), intent(out) :: status
    real(c_double), allocatable :: found(:)
    integer(c_size_t) :: length
    integer :: allocation

    call check_call(self, status)
    length = 0
    if (status == sfdae_ok) status = c_get_checkpoint_length(self%handle, length)
    if (status < 0) return
    allocate (found(length), stat=allocation)
    if (allocation /= 0) then
      status = sfdae_out_of_memory
      self%complaint = "out of memory for the checkpoint"
      return
    end if
    status = c_save_checkpoint(self%handle, found, length)
    if (status >= 0) call move_alloc(found, checkpoint)
  end subroutine solver_save_checkpoint

  !> Continues from a checkpoint instead of start: call advance next. The solver must have been
  !> created with the problem and the options of the checkpoint (tolerances, limits and the monitor
  !> may differ); no callback is called.
  subroutine solver_restore_checkpoint(self, checkpoint, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: checkpoint(:)
    !> sfdae_illegal_argument if it is damaged or does not match; then nothing is started.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_restore_checkpoint(self%handle, checkpoint, &
      size(checkpoint, kind=c_size_t))
  end subroutine solver_restore_checkpoint

  !> From the point returned last or the next start on, advance and step return sfdae_event if an
  !> event function becomes zero or changes its sign: t is that zero or, up to roundoff, the first
  !> point after it. Each event is returned once. To change x there, call start.
  subroutine solver_set_events(self, events, status)
    class(dae_solver), intent(inout) :: self
    !> Must have the target attribute and live, in place, as long as it is in use; num_events must
    !> not change. num_events = 0: no events.
    class(dae_events), target, intent(inout) :: events
    integer(c_int), intent(out) :: status
    integer(c_int), allocatable, target :: directions(:)
    type(c_ptr) :: address

    call check_call(self, status)
    if (status < 0) return
    address = c_null_ptr
    if (allocated(events%directions)) then
      directions = events%directions
      status = sfdae_illegal_argument
      self%complaint = "directions has not num_events entries"
      if (size(directions) /= events%num_events) return
      self%complaint = ""
      if (size(directions) > 0) address = c_loc(directions)
    end if
    status = c_set_events(self%handle, events%num_events, event_callback(), address, &
      c_loc(self%holder%control))
    if (status < 0) return
    self%holder%control%events => events
    self%holder%control%num_events = events%num_events
  end subroutine solver_set_events

  !> The events at the point that was returned with sfdae_event.
  subroutine solver_get_events(self, which, status)
    class(dae_solver), intent(inout) :: self
    !> num_events entries: +1 for a rising function, -1 for a falling one, else 0.
    integer(c_int), contiguous, intent(inout) :: which(:)
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status < 0) return
    status = sfdae_illegal_argument
    self%complaint = "which has not num_events entries"
    if (size(which) /= self%holder%control%num_events) return
    self%complaint = ""
    status = c_get_events(self%handle, which)
  end subroutine solver_get_events

  !> Number of switches of conditions passed by the integration. events.h explains the rules.
  subroutine solver_get_num_switches(self, count, status)
    class(dae_solver), intent(inout) :: self
    integer(c_long), intent(inout) :: count
    !> sfdae_not_started if there is no integration.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_num_switches(self%handle, count)
  end subroutine solver_get_num_switches

  !> Switch number `index`, 1 ... count, ordered by time. result%condition also counts from 1.
  subroutine solver_get_switch(self, index, result, status, condition)
    class(dae_solver), intent(inout) :: self
    integer(c_long), intent(in) :: index
    type(sfdae_switch), intent(inout) :: result
    integer(c_int), intent(out) :: status
    !> C text, in which unknowns count from 0: "sin(t) - x[0] > 0".
    character(len=:), allocatable, intent(inout), optional :: condition
    character(kind=c_char) :: nothing(1)
    character(kind=c_char), allocatable :: buffer(:)
    integer(c_size_t) :: needed
    type(sfdae_switch) :: found

    call check_call(self, status)
    needed = 1
    if (status == sfdae_ok) status = c_switch_init(found, c_sizeof(found))
    if (status == sfdae_ok) &
      status = c_get_switch(self%handle, index - 1, found, nothing, 1_c_size_t, needed)
    if (status < 0) return
    result = found
    result%condition = result%condition + 1
    if (.not. present(condition)) return
    allocate (buffer(needed))
    status = c_get_switch(self%handle, index - 1, found, buffer, needed, needed)
    if (status >= 0) condition = text_in(buffer)
  end subroutine solver_get_switch

  !> Sets the times at which data have kinks or jumps: steps end there. modes.h explains the rules.
  subroutine solver_set_breakpoints(self, t, status, kinds)
    class(dae_solver), intent(inout) :: self
    !> Increasing; of size 0: no breakpoints.
    real(c_double), contiguous, intent(in) :: t(:)
    integer(c_int), intent(out) :: status
    !> sfdae_breakpoint_kink or sfdae_breakpoint_jump for each; absent: all are kinks.
    integer(c_int), contiguous, target, intent(in), optional :: kinds(:)
    type(c_ptr) :: address

    call check_call(self, status)
    if (status < 0) return
    address = c_null_ptr
    if (present(kinds)) then
      status = sfdae_illegal_argument
      self%complaint = "kinds has not as many entries as t"
      if (size(kinds) /= size(t)) return
      self%complaint = ""
      if (size(kinds) > 0) address = c_loc(kinds)
    end if
    status = c_set_breakpoints(self%handle, size(t, kind=c_int), t, address)
  end subroutine solver_set_breakpoints

  !> The last jump crossed at a breakpoint; sfdae_not_started if there was none.
  subroutine solver_get_jump(self, t, before, after, status, impulse)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(inout) :: t
    !> n values.
    real(c_double), contiguous, intent(inout) :: before(:)
    !> n values.
    real(c_double), contiguous, intent(inout) :: after(:)
    integer(c_int), intent(out) :: status
    !> n values: the factor of delta in each component.
    real(c_double), contiguous, target, intent(inout), optional :: impulse(:)
    type(c_ptr) :: address

    call check_before_and_after(self, before, after, status)
    address = c_null_ptr
    if (present(impulse)) then
      call check_entries(self, "impulse", size(impulse, kind=c_int), status)
      address = c_loc(impulse)
    end if
    if (status == sfdae_ok) status = c_get_jump(self%handle, t, before, after, address)
  end subroutine solver_get_jump

  !> The initial values of these equations at t after other equations led to `before`, computed from
  !> impulses of these equations. To continue, call start with `after`.
  recursive subroutine solver_jump(self, t, toward, before, after, status, impulses)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> In the direction of integration.
    real(c_double), intent(in) :: toward
    !> n values.
    real(c_double), contiguous, intent(in) :: before(:)
    !> n values.
    real(c_double), contiguous, intent(inout) :: after(:)
    integer(c_int), intent(out) :: status
    !> n rows, one column for each factor wanted: of delta, delta', ...
    real(c_double), contiguous, target, intent(inout), optional :: impulses(:, :)
    integer(c_int) :: orders
    type(c_ptr) :: address

    call check_before_and_after(self, before, after, status)
    address = c_null_ptr
    orders = 0
    if (present(impulses)) then
      call check_entries(self, "a column of impulses", size(impulses, 1, c_int), status)
      orders = size(impulses, 2, c_int)
      if (orders > 0) address = c_loc(impulses)
    end if
    if (status == sfdae_ok) &
      status = c_jump(self%handle, t, toward, before, after, orders, address)
  end subroutine solver_jump

  !> The velocities of a mechanical system after an impact.
  recursive subroutine solver_impact(self, t, before, after, status, restitution, impulses)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n values.
    real(c_double), contiguous, intent(in) :: before(:)
    !> n values.
    real(c_double), contiguous, intent(inout) :: after(:)
    integer(c_int), intent(out) :: status
    !> Coefficients of the nl + nk constraints, holonomic ones first, 0 to 1 each; absent: all 0.
    real(c_double), contiguous, target, intent(in), optional :: restitution(:)
    !> Impulses of the nl + nk constraints.
    real(c_double), contiguous, target, intent(inout), optional :: impulses(:)
    type(c_ptr) :: coefficients, forces

    call check_before_and_after(self, before, after, status)
    coefficients = c_null_ptr
    forces = c_null_ptr
    if (present(restitution)) then
      call check_constraints(self, "restitution", size(restitution, kind=c_int), status)
      coefficients = c_loc(restitution)
    end if
    if (present(impulses)) then
      call check_constraints(self, "impulses", size(impulses, kind=c_int), status)
      forces = c_loc(impulses)
    end if
    if (status == sfdae_ok) &
      status = c_impact(self%handle, t, coefficients, before, after, forces)
  end subroutine solver_impact

  !> The solution at any t within the last step. The point reached is unaffected.
  recursive subroutine solver_interpolate(self, t, x, status, xdot)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n values at t, which satisfy all constraints.
    real(c_double), contiguous, intent(inout) :: x(:)
    !> sfdae_illegal_argument if t lies outside of the last step.
    integer(c_int), intent(out) :: status
    !> n values: x'(t).
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: xdot_address

    call check_point(self, x, status, xdot, xdot_address)
    if (status == sfdae_ok) status = c_interpolate(self%handle, t, x, xdot_address)
  end subroutine solver_interpolate

  !> Requests derivatives of the solution with respect to parameters and start values, from the next
  !> start on.
  subroutine solver_set_sensitivities(self, wanted, status)
    class(dae_solver), intent(inout) :: self
    !> Without names: none.
    type(dae_sensitivities), target, intent(in) :: wanted
    !> sfdae_illegal_argument for equations that are not recorded, or unknown names.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status /= sfdae_ok) return
    call set_sensitivities_in_c(self%handle, .false., self%holder%problem%num_unknowns, wanted, &
      self%num_sensitivities, status, self%complaint)
  end subroutine solver_set_sensitivities

  !> S = dx/dp at t, the time returned by the last call or a time within the last step.
  recursive subroutine solver_get_sensitivities(self, t, s, status, sdot)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n x the number of parameters.
    real(c_double), contiguous, intent(inout) :: s(:, :)
    !> sfdae_not_started if there are none.
    integer(c_int), intent(out) :: status
    !> S', like s.
    real(c_double), contiguous, target, intent(inout), optional :: sdot(:, :)
    type(c_ptr) :: sdot_address

    call check_call(self, status)
    call check_entries(self, "a column of s", size(s, 1, c_int), status)
    call check_parameters(self, "a row of s", size(s, 2, c_int), status)
    sdot_address = c_null_ptr
    if (present(sdot)) then
      call check_entries(self, "a column of sdot", size(sdot, 1, c_int), status)
      call check_parameters(self, "a row of sdot", size(sdot, 2, c_int), status)
      if (size(sdot) > 0) sdot_address = c_loc(sdot)
    end if
    if (status == sfdae_ok) status = c_get_sensitivities(self%handle, t, s, sdot_address)
  end subroutine solver_get_sensitivities

  !> Gradients of functionals, with dae_sensitivities%adjoint: sum over k of S(t(k))^T w_k, one column for each
  !> functional.
  recursive subroutine solver_get_gradient(self, t, weights, gradient, status)
    class(dae_solver), intent(inout) :: self
    !> Times from the start to the time reached.
    real(c_double), contiguous, intent(in) :: t(:)
    !> n rows; a column for each time, for one functional after the other.
    real(c_double), contiguous, intent(in) :: weights(:, :)
    !> Number of parameters x number of functionals.
    real(c_double), contiguous, intent(inout) :: gradient(:, :)
    !> sfdae_not_started without the adjoint.
    integer(c_int), intent(out) :: status
    integer(c_int) :: points, functionals

    points = size(t, kind=c_int)
    functionals = size(gradient, 2, c_int)
    call check_call(self, status)
    call check_entries(self, "a column of weights", size(weights, 1, c_int), status)
    call check_parameters(self, "a column of gradient", size(gradient, 1, c_int), status)
    if (status == sfdae_ok .and. size(weights, 2, c_int) /= points * functionals) then
      call compare_size("a row of weights", size(weights, 2, c_int), points * functionals, &
        self%complaint, "number of points times that of functionals")
      status = sfdae_illegal_argument
    end if
    if (status == sfdae_ok) &
      status = c_get_gradient(self%handle, points, t, functionals, weights, gradient)
  end subroutine solver_get_gradient

  !> dt_e/dp of an event g(t, x, p) = 0 at t, at which advance has returned sfdae_event.
  recursive subroutine solver_get_event_sensitivities(self, t, g_t, g_x, dt, status, g_p)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> The partial derivative of g with respect to t.
    real(c_double), intent(in) :: g_t
    !> n partial derivatives with respect to x.
    real(c_double), contiguous, intent(in) :: g_x(:)
    !> One for each parameter.
    real(c_double), contiguous, intent(inout) :: dt(:)
    !> sfdae_singular if g does not change with t.
    integer(c_int), intent(out) :: status
    !> Partial derivatives of g with respect to the parameters; zero if absent.
    real(c_double), contiguous, target, intent(in), optional :: g_p(:)
    type(c_ptr) :: g_p_address

    call check_call(self, status)
    call check_entries(self, "g_x", size(g_x, kind=c_int), status)
    call check_parameters(self, "dt", size(dt, kind=c_int), status)
    g_p_address = c_null_ptr
    if (present(g_p)) then
      call check_parameters(self, "g_p", size(g_p, kind=c_int), status)
      if (size(g_p) > 0) g_p_address = c_loc(g_p)
    end if
    if (status == sfdae_ok) &
      status = c_get_event_sensitivities(self%handle, t, g_t, g_x, g_p_address, dt)
  end subroutine solver_get_event_sensitivities

  !> Refuses a call with an array that does not have one entry for each parameter.
  subroutine check_parameters(self, name, found, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: found
    !> If not sfdae_ok, the call has already been refused.
    integer(c_int), intent(inout) :: status

    if (status /= sfdae_ok .or. found == self%num_sensitivities) return
    call compare_size(name, found, self%num_sensitivities, self%complaint, "number of names")
    status = sfdae_illegal_argument
  end subroutine check_parameters

  !> Work for the sensitivities since start.
  subroutine solver_get_sensitivity_statistics(self, statistics, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_sensitivity_statistics), intent(inout) :: statistics
    integer(c_int), intent(out) :: status
    type(sfdae_sensitivity_statistics) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_sensitivity_statistics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_sensitivity_statistics(self%handle, found)
    if (status >= 0) statistics = found
  end subroutine solver_get_sensitivity_statistics

  !> Counts since start.
  subroutine solver_get_statistics(self, statistics, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_statistics), intent(inout) :: statistics
    integer(c_int), intent(out) :: status
    type(sfdae_statistics) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_statistics_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_statistics(self%handle, found)
    if (status >= 0) statistics = found
  end subroutine solver_get_statistics

  ! ---- Looking inside -----------------------------------------------------------------------

  !> The diagnostics report: index analysis with every rank decision, initial values, integration.
  subroutine solver_report(self, text, status)
    class(dae_solver), intent(inout) :: self
    !> Lines are separated by new_line('a').
    character(len=:), allocatable, intent(inout) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: nothing(1)
    character(kind=c_char), allocatable :: buffer(:)
    integer(c_size_t) :: needed

    call check_call(self, status)
    needed = 1
    if (status == sfdae_ok) status = c_report(self%handle, nothing, 1_c_size_t, needed)
    if (status < 0) return
    allocate (buffer(needed))
    status = c_report(self%handle, buffer, needed, needed)
    if (status >= 0) text = text_in(buffer)
  end subroutine solver_report

  !> Source text of a strangeness-free system F(t, z, z') = 0 with the solutions of recorded
  !> equations, for use without the library: functions whose names begin with `name`.
  subroutine solver_export_source(self, language, name, text, status)
    class(dae_solver), intent(inout) :: self
    !> sfdae_source_c, sfdae_source_fortran.
    integer(c_int), intent(in) :: language
    !> Letters, digits and underscores, beginning with a letter.
    character(len=*), intent(in) :: name
    !> Lines are separated by new_line('a').
    character(len=:), allocatable, intent(inout) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: nothing(1)
    character(kind=c_char), allocatable :: buffer(:)
    integer(c_size_t) :: needed

    call check_call(self, status)
    needed = 1
    if (status == sfdae_ok) status = c_export_source(self%handle, language, text_in_c(name), &
      nothing, 1_c_size_t, needed)
    if (status < 0) return
    allocate (buffer(needed))
    status = c_export_source(self%handle, language, text_in_c(name), buffer, needed, needed)
    if (status >= 0) text = text_in(buffer)
  end subroutine solver_export_source

  !> The jet of a level through (t, x), n x (level + 2): x, x', ..., x^(level + 1) in its columns.
  recursive subroutine solver_get_jet(self, t, level, status, jet, x)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> l >= 0.
    integer(c_int), intent(in) :: level
    integer(c_int), intent(out) :: status
    !> Allocated as needed.
    real(c_double), allocatable, intent(inout) :: jet(:, :)
    !> n consistent values; absent: those of the solution at t.
    real(c_double), contiguous, target, intent(in), optional :: x(:)
    real(c_double), allocatable :: found(:, :)
    type(c_ptr) :: x_address

    call check_optional_x(self, status, x, x_address)
    if (status < 0) return
    allocate (found(self%holder%problem%num_unknowns, max(level, 0_c_int) + 2))
    status = c_get_jet(self%handle, t, x_address, level, found)
    if (status >= 0) call move_alloc(found, jet)
  end subroutine solver_get_jet

  !> Derivative array M y = N x + g at t, with plain derivatives y = (x', x'', ...); of nonlinear
  !> problems M dy = N dx + g along the solution. Arrays are allocated as needed.
  recursive subroutine solver_get_derivative_array(self, t, level, status, m, n, g, jet)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> l >= 0.
    integer(c_int), intent(in) :: level
    integer(c_int), intent(out) :: status
    !> M, (l+1)m x (l+1)n, with blocks C(i,j) E^(i-j) - C(i,j+1) A^(i-j-1).
    real(c_double), allocatable, intent(inout), optional :: m(:, :)
    !> N, (l+1)m x n, with blocks A^(i).
    real(c_double), allocatable, intent(inout), optional :: n(:, :)
    !> (l+1)m entries f^(i).
    real(c_double), allocatable, intent(inout), optional :: g(:)
    !> n x (l+2): the derivative array for changes of this jet.
    real(c_double), contiguous, intent(in), optional :: jet(:, :)
    real(c_double), allocatable :: m_found(:, :), n_found(:, :), g_found(:)
    integer(c_size_t) :: rows, columns
    integer :: allocation

    call check_call(self, status)
    if (present(jet)) call check_jet(self, jet, level, status)
    if (status < 0) return
    rows = (level + 1_c_size_t) * self%holder%problem%num_equations
    columns = self%holder%problem%num_unknowns
    allocate (m_found(rows, (level + 1_c_size_t) * columns), n_found(rows, columns), &
      g_found(rows), stat=allocation)
    if (allocation /= 0) then
      status = sfdae_out_of_memory
      self%complaint = "out of memory for the derivative array"
      return
    end if
    if (present(jet)) then
      status = c_get_derivative_array_at(self%handle, t, jet, level, m_found, n_found, g_found)
    else
      status = c_get_derivative_array(self%handle, t, level, m_found, n_found, g_found)
    end if
    if (status < 0) return
    if (present(m)) call move_alloc(m_found, m)
    if (present(n)) call move_alloc(n_found, n)
    if (present(g)) call move_alloc(g_found, g)
  end subroutine solver_get_derivative_array

  !> Projectors at t for the derivative array of level mu, with orthonormal columns; for nonlinear
  !> problems along the solution. Arrays are allocated as needed. Requires an analysis.
  recursive subroutine solver_get_projectors(self, t, status, z1, z2, z3, t2, jet)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(out) :: status
    !> Z1, m x d: spans the range of E T2.
    real(c_double), allocatable, intent(inout), optional :: z1(:, :)
    !> Z2, (mu+1)m x a: Z2^T M = 0, A2 = Z2^T N has full row rank.
    real(c_double), allocatable, intent(inout), optional :: z2(:, :)
    !> Z3, (mu+1)m x vhat: Z3^T [M N] = 0.
    real(c_double), allocatable, intent(inout), optional :: z3(:, :)
    !> T2, n x (n-a): A2 T2 = 0.
    real(c_double), allocatable, intent(inout), optional :: t2(:, :)
    !> n x (mu+2): the projectors at this jet.
    real(c_double), contiguous, intent(in), optional :: jet(:, :)
    type(sfdae_characteristics) :: sizes
    real(c_double), allocatable :: z1_found(:, :), t2_found(:, :)
    real(c_double), allocatable, target :: z2_found(:, :), z3_found(:, :)
    type(c_ptr) :: z2_address, z3_address, vhat_address
    integer(c_int) :: rows, m, n
    integer(c_int), target :: vhat

    call self%get_characteristics(sizes, status)
    if (present(jet)) call check_jet(self, jet, level_of_jets(self, sizes, &
      present(z2) .or. present(z3)), status)
    if (status < 0) return
    m = self%holder%problem%num_equations
    n = self%holder%problem%num_unknowns
    rows = (sizes%strangeness_index + 1_c_int) * m
    allocate (z1_found(m, sizes%differential), z2_found(rows, sizes%algebraic))
    allocate (z3_found(rows, rows - sizes%algebraic), t2_found(n, n - sizes%algebraic))
    vhat = 0
    ! Z2 and Z3 are not always available, so they are computed only on request.
    z2_address = c_null_ptr
    z3_address = c_null_ptr
    vhat_address = c_null_ptr
    if (present(z2)) z2_address = c_loc(z2_found)
    if (present(z3)) then
      z3_address = c_loc(z3_found)
      vhat_address = c_loc(vhat)
    end if
    if (present(jet)) then
      status = c_get_projectors_at(self%handle, t, jet, z1_found, z2_address, z3_address, &
        t2_found, vhat_address)
    else
      status = c_get_projectors(self%handle, t, z1_found, z2_address, z3_address, t2_found, &
        vhat_address)
    end if
    if (status < 0) return
    if (present(z1)) call move_alloc(z1_found, z1)
    if (present(z2)) call move_alloc(z2_found, z2)
    if (present(z3)) z3 = z3_found(:, 1:vhat)
    if (present(t2)) call move_alloc(t2_found, t2)
  end subroutine solver_get_projectors

  !> Strangeness-free system at t: E1 x' = A1 x + f1, 0 = A2 x + f2; of nonlinear problems for
  !> changes along the solution. Arrays are allocated as needed. Needs an analysis.
  recursive subroutine solver_get_strangeness_free(self, t, status, e1, a1, f1, a2, f2, &
    residual, jet)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(out) :: status
    !> E1 = Z1^T E, d x n.
    real(c_double), allocatable, intent(inout), optional :: e1(:, :)
    !> A1 = Z1^T A, d x n.
    real(c_double), allocatable, intent(inout), optional :: a1(:, :)
    !> f1 = Z1^T f, d entries.
    real(c_double), allocatable, intent(inout), optional :: f1(:)
    !> A2 = Z2^T N, a x n.
    real(c_double), allocatable, intent(inout), optional :: a2(:, :)
    !> f2 = Z2^T g, a entries.
    real(c_double), allocatable, intent(inout), optional :: f2(:)
    !> Max norm of Z3^T g, the contradiction of redundant equations.
    real(c_double), intent(inout), optional :: residual
    !> n x (mu+2), of mechanical systems n x 2: the system for changes of this jet.
    real(c_double), contiguous, intent(in), optional :: jet(:, :)
    type(sfdae_characteristics) :: sizes
    real(c_double), allocatable :: e1_found(:, :), a1_found(:, :), a2_found(:, :)
    real(c_double), allocatable :: f1_found(:), f2_found(:)
    real(c_double) :: residual_found

    call self%get_characteristics(sizes, status)
    if (present(jet)) call check_jet(self, jet, level_of_jets(self, sizes, .false.), status)
    if (status < 0) return
    associate (d => sizes%differential, a => sizes%algebraic, n => self%holder%problem%num_unknowns)
      allocate (e1_found(d, n), a1_found(d, n), f1_found(d), a2_found(a, n), f2_found(a))
    end associate
    residual_found = 0
    if (present(jet)) then
      status = c_get_strangeness_free_at(self%handle, t, jet, e1_found, a1_found, f1_found, &
        a2_found, f2_found, residual_found)
    else
      status = c_get_strangeness_free(self%handle, t, e1_found, a1_found, f1_found, a2_found, &
        f2_found, residual_found)
    end if
    if (status < 0) return
    if (present(e1)) call move_alloc(e1_found, e1)
    if (present(a1)) call move_alloc(a1_found, a1)
    if (present(f1)) call move_alloc(f1_found, f1)
    if (present(a2)) call move_alloc(a2_found, a2)
    if (present(f2)) call move_alloc(f2_found, f2)
    if (present(residual)) residual = residual_found
  end subroutine solver_get_strangeness_free

  !> The extended system of a mechanical system at (t, x): E X' = A X + f for changes of
  !> X = (x, wq, wv). Arrays are allocated as needed.
  recursive subroutine solver_get_extended_system(self, t, status, qq, qv, e, a, f, w, x)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(out) :: status
    !> [Q1 Q2] of positions, nq x nq.
    real(c_double), allocatable, intent(inout), optional :: qq(:, :)
    !> [Q1 Q2] of velocities, nv x nv.
    real(c_double), allocatable, intent(inout), optional :: qv(:, :)
    !> E and A, square, with one row for each entry of X.
    real(c_double), allocatable, intent(inout), optional :: e(:, :)
    real(c_double), allocatable, intent(inout), optional :: a(:, :)
    !> The inhomogeneity f.
    real(c_double), allocatable, intent(inout), optional :: f(:)
    !> (wq, wv): derivatives of the dependent directions.
    real(c_double), allocatable, intent(inout), optional :: w(:)
    !> n values; absent: those of the solution at t.
    real(c_double), contiguous, target, intent(in), optional :: x(:)
    type(sfdae_multibody_report) :: report
    real(c_double), allocatable :: qq_found(:, :), qv_found(:, :), e_found(:, :), a_found(:, :)
    real(c_double), allocatable :: f_found(:), w_found(:)
    type(c_ptr) :: x_address
    integer(c_int) :: given, rq, rv, nq, nv, order

    call check_optional_x(self, status, x, x_address)
    if (status == sfdae_ok) call self%get_multibody_report(report, status)
    if (status < 0) return
    given = report%holonomic + report%nonholonomic
    rv = given - report%redundant
    nv = report%degrees_of_freedom + rv
    nq = self%holder%problem%num_unknowns - nv - given
    rq = nq - report%position_freedom
    order = self%holder%problem%num_unknowns + rq + rv
    allocate (qq_found(nq, nq), qv_found(nv, nv), e_found(order, order), a_found(order, order))
    allocate (f_found(order), w_found(rq + rv))
    status = c_get_extended_system(self%handle, t, x_address, qq_found, qv_found, e_found, &
      a_found, f_found, w_found)
    if (status < 0) return
    if (present(qq)) call move_alloc(qq_found, qq)
    if (present(qv)) call move_alloc(qv_found, qv)
    if (present(e)) call move_alloc(e_found, e)
    if (present(a)) call move_alloc(a_found, a)
    if (present(f)) call move_alloc(f_found, f)
    if (present(w)) call move_alloc(w_found, w)
  end subroutine solver_get_extended_system

  !> Certifies the ranks of the analysis by perturbed copies of the data.
  recursive subroutine solver_certify(self, distance, status)
    class(dae_solver), intent(inout) :: self
    !> Approximate smallest relative change of the data that changes the characteristic values.
    real(c_double), intent(out) :: distance
    integer(c_int), intent(out) :: status

    distance = 0.0_c_double
    call check_call(self, status)
    if (status == sfdae_ok) status = c_certify(self%handle, distance)
  end subroutine solver_certify

  !> Compares derivatives supplied by callbacks near t with finite differences of the next lower
  !> order; the message describes mismatches. Orders that are not available are skipped.
  recursive subroutine solver_check_derivatives(self, t, max_order, check, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> Highest order compared, >= 1.
    integer(c_int), intent(in) :: max_order
    !> The worst mismatch.
    type(sfdae_derivative_check), intent(inout) :: check
    integer(c_int), intent(out) :: status
    type(sfdae_derivative_check) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_derivative_check_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_check_derivatives(self%handle, t, max_order, found)
    if (status >= 0) check = from_one(found)
  end subroutine solver_check_derivatives

  !> Compares derivatives from a derivative_dae or derivative_array_dae along a jet with finite
  !> differences.
  recursive subroutine solver_check_total_derivatives(self, t, derivatives, check, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n x (highest order compared + 2): x, x', x'', ..., preferably without zeros.
    real(c_double), contiguous, intent(in) :: derivatives(:, :)
    !> The worst mismatch.
    type(sfdae_derivative_check), intent(inout) :: check
    integer(c_int), intent(out) :: status
    type(sfdae_derivative_check) :: found
    integer(c_int) :: max_order

    call check_call(self, status)
    call check_entries(self, "a column of derivatives", size(derivatives, 1, c_int), status)
    if (status == sfdae_ok) status = c_derivative_check_init(found, c_sizeof(found))
    max_order = size(derivatives, 2, c_int) - 2_c_int
    if (status == sfdae_ok) status = c_check_total_derivatives(self%handle, t, derivatives, &
      max_order, found)
    if (status >= 0) check = from_one(found)
  end subroutine solver_check_total_derivatives

  !> Compares derivatives supplied by a multibody_dae with finite differences near (t, q, v).
  recursive subroutine solver_check_multibody_derivatives(self, t, q, v, check, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> nq positions.
    real(c_double), contiguous, intent(in) :: q(:)
    !> nv velocities.
    real(c_double), contiguous, intent(in) :: v(:)
    !> The worst mismatch.
    type(sfdae_derivative_check), intent(inout) :: check
    integer(c_int), intent(out) :: status
    type(sfdae_derivative_check) :: found

    call check_call(self, status)
    if (status < 0) return
    select type (system => self%holder%problem)
    class is (multibody_holder)
      call compare_size("q", size(q, kind=c_int), system%callbacks%nq, self%complaint, "nq")
      call compare_size("v", size(v, kind=c_int), system%callbacks%nv, self%complaint, "nv")
      if (len(self%complaint) > 0) status = sfdae_illegal_argument
    end select
    if (status == sfdae_ok) status = c_derivative_check_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_check_multibody_derivatives(self%handle, t, q, v, found)
    if (status >= 0) check = from_one(found)
  end subroutine solver_check_multibody_derivatives

  !> Constraints, freedom and partition of a mechanical system at the point reached.
  subroutine solver_get_multibody_report(self, report, status)
    class(dae_solver), intent(inout) :: self
    type(sfdae_multibody_report), intent(inout) :: report
    !> sfdae_not_started before an analysis, sfdae_illegal_argument for other problems.
    integer(c_int), intent(out) :: status
    type(sfdae_multibody_report) :: found

    call check_call(self, status)
    if (status == sfdae_ok) status = c_multibody_report_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_multibody_report(self%handle, found)
    if (status >= 0) report = found
  end subroutine solver_get_multibody_report

  !> Structural analysis of recorded equations and its numerical confirmation; the message describes
  !> a mismatch. n entries in every array.
  recursive subroutine solver_get_structure(self, structure, status, differentiations, orders, &
    assigned, block)
    class(dae_solver), intent(inout) :: self
    !> doubtful_block: 0 if there is none.
    type(sfdae_structure), intent(inout) :: structure
    !> sfdae_illegal_argument for other problems.
    integer(c_int), intent(out) :: status
    !> Number of differentiations of each equation.
    integer(c_int), allocatable, intent(inout), optional :: differentiations(:)
    !> Highest derivative of each unknown; without a matching, -1: outside the overdetermined part.
    integer(c_int), allocatable, intent(inout), optional :: orders(:)
    !> The unknown matched with each equation; 0: none.
    integer(c_int), allocatable, intent(inout), optional :: assigned(:)
    !> The block of each equation; without a matching, 0: outside the overdetermined part.
    integer(c_int), allocatable, intent(inout), optional :: block(:)
    type(sfdae_structure) :: found
    integer(c_int), allocatable :: found_in(:, :)
    integer :: allocation

    call check_call(self, status)
    if (status /= sfdae_ok) return
    allocate (found_in(self%holder%problem%num_unknowns, 4), stat=allocation)
    status = sfdae_out_of_memory
    if (allocation == 0) status = c_structure_init(found, c_sizeof(found))
    if (status == sfdae_ok) status = c_get_structure(self%handle, found, found_in(:, 1), &
      found_in(:, 2), found_in(:, 3), found_in(:, 4))
    if (status < 0) return
    found%doubtful_block = found%doubtful_block + 1_c_int
    structure = found
    if (present(differentiations)) differentiations = found_in(:, 1)
    if (present(orders)) orders = found_in(:, 2)
    if (present(assigned)) assigned = found_in(:, 3) + 1_c_int
    if (present(block)) block = found_in(:, 4) + 1_c_int
  end subroutine solver_get_structure

  ! ---- Checks before a call -----------------------------------------------------------------

  !> The address of the C solver, null if there is none, and n.
  subroutine solver_in_c(self, address, num_unknowns)
    class(dae_solver), intent(in) :: self
    type(c_ptr), intent(out) :: address
    integer(c_int), intent(out) :: num_unknowns

    address = self%handle
    num_unknowns = 0
    if (c_associated(self%handle)) num_unknowns = self%holder%problem%num_unknowns
  end subroutine solver_in_c

  !> Before every call on a solver: refuses the call if the solver does not exist.
  subroutine check_call(self, status)
    class(dae_solver), intent(inout) :: self
    !> sfdae_ok or sfdae_illegal_argument.
    integer(c_int), intent(out) :: status

    status = sfdae_ok
    self%complaint = ""
    if (c_associated(self%handle)) return
    status = sfdae_illegal_argument
    self%complaint = "the solver does not exist: create it first"
  end subroutine check_call

  !> Refuses a call with an array that does not have n entries.
  subroutine check_entries(self, name, length, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: length
    !> If not sfdae_ok, the call has already been refused.
    integer(c_int), intent(inout) :: status

    if (status /= sfdae_ok) return
    call compare_size(name, length, self%holder%problem%num_unknowns, self%complaint)
    if (len(self%complaint) > 0) status = sfdae_illegal_argument
  end subroutine check_entries

  !> Refuses a call with x or xdot that do not have n entries.
  subroutine check_point(self, x, status, xdot, xdot_address)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: x(:)
    integer(c_int), intent(out) :: status
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    !> Null if xdot is absent.
    type(c_ptr), intent(out) :: xdot_address

    call check_call(self, status)
    call check_entries(self, "x", size(x, kind=c_int), status)
    xdot_address = c_null_ptr
    if (.not. present(xdot)) return
    call check_entries(self, "xdot", size(xdot, kind=c_int), status)
    xdot_address = c_loc(xdot)
  end subroutine check_point

  !> Refuses a call with values before and after a jump that do not have n entries.
  subroutine check_before_and_after(self, before, after, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: before(:)
    real(c_double), intent(in) :: after(:)
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    call check_entries(self, "before", size(before, kind=c_int), status)
    call check_entries(self, "after", size(after, kind=c_int), status)
  end subroutine check_before_and_after

  !> Refuses a call with an array that does not have one entry for each constraint of a mechanical
  !> system.
  subroutine check_constraints(self, name, length, status)
    class(dae_solver), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: length
    !> If not sfdae_ok, the call has already been refused.
    integer(c_int), intent(inout) :: status

    if (status /= sfdae_ok) return
    select type (system => self%holder%problem)
    class is (multibody_holder)
      call compare_size(name, length, system%callbacks%nl + system%callbacks%nk, self%complaint, &
        "nl + nk")
    end select
    if (len(self%complaint) > 0) status = sfdae_illegal_argument
  end subroutine check_constraints

  !> Refuses a call with x that does not have n entries.
  subroutine check_optional_x(self, status, x, x_address)
    class(dae_solver), intent(inout) :: self
    integer(c_int), intent(out) :: status
    real(c_double), contiguous, target, intent(in), optional :: x(:)
    !> Null if x is absent.
    type(c_ptr), intent(out) :: x_address

    call check_call(self, status)
    x_address = c_null_ptr
    if (.not. present(x)) return
    call check_entries(self, "x", size(x, kind=c_int), status)
    x_address = c_loc(x)
  end subroutine check_optional_x

  !> Refuses a call with a jet that is too small for its level.
  subroutine check_jet(self, jet, level, status)
    class(dae_solver), intent(inout) :: self
    real(c_double), intent(in) :: jet(:, :)
    integer(c_int), intent(in) :: level
    !> If not sfdae_ok, the call has already been refused.
    integer(c_int), intent(inout) :: status

    call check_entries(self, "a column of jet", size(jet, 1, c_int), status)
    if (status /= sfdae_ok .or. size(jet, 2) >= level + 2) return
    self%complaint = "jet has too few columns for this level"
    status = sfdae_illegal_argument
  end subroutine check_jet

  !> Level of the jets for projectors and the strangeness-free system.
  integer(c_int) function level_of_jets(self, sizes, of_array) result(level)
    class(dae_solver), intent(in) :: self
    type(sfdae_characteristics), intent(in) :: sizes
    !> Z2 or Z3 are requested.
    logical, intent(in) :: of_array

    level = 0
    if (.not. associated(self%holder)) return
    level = sizes%strangeness_index
    select type (system => self%holder%problem)
    class is (multibody_holder)
      if (.not. of_array) level = 0
    end select
  end function level_of_jets

  !> A mismatch with rows and columns that count from 1.
  function from_one(found) result(check)
    type(sfdae_derivative_check), intent(in) :: found
    type(sfdae_derivative_check) :: check

    check = found
    if (check%function == c_null_char) then
      check%function = ' '
    else
      check%row = check%row + 1_c_int
      check%column = check%column + 1_c_int
    end if
  end function from_one

end module sfdae_solver
