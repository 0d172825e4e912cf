! SPDX-License-Identifier: BSD-3-Clause
!
! Control of an integration: options, the monitor, events.
module sfdae_control
  use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_funptr, c_int, c_loc, c_long, &
    c_ptr, c_sizeof
  use sfdae_c, only: address_of_event_function, address_of_monitor_function, c_options_init
  use sfdae_conversions, only: flag, vector_at
  use sfdae_types, only: sfdae_conditions_events, sfdae_initial_nearest, sfdae_leading_automatic, sfdae_method_bdf, &
    sfdae_ok, sfdae_options, sfdae_output_consistent, sfdae_progress, sfdae_reduction_staged, &
    sfdae_structure_automatic
  implicit none
  private

  public :: dae_options, dae_monitor, dae_events
  public :: control_holder, fill_options, event_callback, compare_size

  ! ---- Options ------------------------------------------------------------------------------

  !> Monitors the integration. Extend it: components are your data. See dae_options%monitor.
  type, abstract :: dae_monitor
  contains
    !> Called after every accepted step.
    procedure(monitor_function), deferred :: after_step
  end type dae_monitor

  abstract interface
    !> Called after every accepted step.
    subroutine monitor_function(self, progress, x, stop_now)
      import :: c_double, dae_monitor, sfdae_progress
      class(dae_monitor), intent(inout) :: self
      type(sfdae_progress), intent(in) :: progress
      !> n values at progress%t.
      real(c_double), intent(in) :: x(:)
      !> .false. on entry; .true. stops the call that is running with sfdae_stopped.
      logical, intent(inout) :: stop_now
    end subroutine monitor_function
  end interface

  !> Options, with their defaults. The error of x(i) is kept near rtol |x(i)| + atol.
  type :: dae_options
    !> 0 <= rtol < 1, not both tolerances zero.
    real(c_double) :: rtol = 1.0e-6_c_double
    !> >= 0.
    real(c_double) :: atol = 1.0e-6_c_double
    !> n values that replace rtol, one for each component.
    real(c_double), allocatable :: rtol_vector(:)
    !> n values that replace atol.
    real(c_double), allocatable :: atol_vector(:)

    !> Highest strangeness index tried, 0 ... 12.
    integer(c_int) :: max_index = 5
    !> sfdae_reduction_staged or sfdae_reduction_svd.
    integer(c_int) :: reduction = sfdae_reduction_staged
    !> > 0, < 1: values below rank_tol * norm of the data count as zero. 0: chosen automatically.
    real(c_double) :: rank_tol = 0
    !> > 0: unit of time in which derivatives are compared. 0: chosen.
    real(c_double) :: time_scale = 0
    !> Derivatives that are not available (sfdae_order_not_available) come from finite differences.
    logical :: difference_derivatives = .false.
    !> > 0: spacing of the points for finite differences. 0: chosen.
    real(c_double) :: difference_step = 0

    !> sfdae_initial_nearest, sfdae_initial_fixed or sfdae_initial_accept.
    integer(c_int) :: initial_values = sfdae_initial_nearest
    !> For sfdae_initial_fixed: n flags, .true. if x(i) must not change.
    logical, allocatable :: fixed(:)
    !> n positive numbers w(i): sum (change(i) / w(i))**2 is minimized.
    real(c_double), allocatable :: initial_weights(:)

    !> Continue (sfdae_inconsistency_ignored) if redundant equations contradict each other.
    logical :: ignore_inconsistency = .false.
    !> Relative size above which a contradiction counts, > 0, < 1.
    real(c_double) :: consistency_tol = 1.0e-8_c_double

    !> Highest BDF order, 1 ... 5.
    integer(c_int) :: max_order = 5
    !> Size of the first step. 0: chosen.
    real(c_double) :: initial_step = 0
    !> Largest step. 0: no limit.
    real(c_double) :: max_step = 0
    !> Nothing is evaluated beyond stop_time.
    logical :: use_stop_time = .false.
    real(c_double) :: stop_time = 0
    !> Attempted steps in one call, >= 1.
    integer(c_long) :: max_steps = 100000
    !> Wall-clock time of one call in seconds; it returns sfdae_stopped then. 0: no limit.
    real(c_double) :: max_seconds = 0
    !> sfdae_leading_...
    integer(c_int) :: leading_term = sfdae_leading_automatic

    !> Called after every accepted step if associated. Its target must live as long as the solver.
    class(dae_monitor), pointer :: monitor => null()

    !> sfdae_method_bdf, sfdae_method_radau or sfdae_method_automatic; a change takes effect with
    !> the next start.
    integer(c_int) :: method = sfdae_method_bdf
    !> Radau: smallest number of stages, 1, 3, 5 or 7.
    integer(c_int) :: min_stages = 1
    !> Radau: largest number of stages, 1, 3, 5 or 7, >= min_stages.
    integer(c_int) :: max_stages = 7

    !> xdot of start and make_consistent is an initial guess of x' on entry, which selects a
    !> solution of a nonlinear problem if F(t, x, x') = 0 allows several x'. Zeros: no guess.
    logical :: xdot_is_guess = .false.
    !> x at outputs within steps: sfdae_output_consistent satisfies all constraints to machine
    !> precision; sfdae_output_interpolated is the method's polynomial alone, for curves.
    integer(c_int) :: output = sfdae_output_consistent
    !> Compares user-supplied derivatives with their functions once in every analysis;
    !> sfdae_wrong_derivatives if one clearly contradicts its function.
    logical :: check_derivatives = .true.
    !> Recorded equations: sfdae_structure_automatic omits unneeded rows of the derivative array and
    !> uses sparse matrices if it is large; sfdae_structure_required does the same or fails;
    !> sfdae_structure_off does neither.
    integer(c_int) :: structure = sfdae_structure_automatic
    !> sfdae_conditions_events: steps end at zeros of conditions (choose, abs, min, ...) on t alone,
    !> and at those of others if E x has to jump. sfdae_conditions_smooth: the error test alone
    !> chooses the steps; results are wrong without a warning if equations are not smooth enough.
    integer(c_int) :: conditions = sfdae_conditions_events
  end type dae_options

  ! ---- Events -------------------------------------------------------------------------------

  !> Events are zeros of functions of t, x and x'. Extend it: components are your data. See
  !> dae_solver%set_events.
  type, abstract :: dae_events
    !> Number of functions, 0: none.
    integer(c_int) :: num_events = 0
    !> num_events numbers: +1 only rising zeros count, in the direction of integration, -1 only
    !> falling ones, 0 both. Not allocated: both.
    integer(c_int), allocatable :: directions(:)
  contains
    !> Writes the event functions.
    procedure(event_function), deferred :: eval_g
  end type dae_events

  abstract interface
    !> Writes the event functions at a point.
    subroutine event_function(self, t, x, xdot, g, status)
      import :: c_double, c_int, dae_events
      class(dae_events), intent(inout) :: self
      real(c_double), intent(in) :: t
      !> n values.
      real(c_double), intent(in) :: x(:)
      !> n values of x'.
      real(c_double), intent(in) :: xdot(:)
      !> num_events entries, zero on entry.
      real(c_double), intent(inout) :: g(:)
      !> 0 on entry. > 0: cannot evaluate here. < 0: stop at once.
      integer(c_int), intent(inout) :: status
    end subroutine event_function
  end interface

  ! ---- Callbacks: from C to the bindings ----------------------------------------------------

  !> Copy of a solver's options and events; the `user` pointer of their callbacks points to it. It
  !> must stay in place as long as the solver.
  type :: control_holder
    class(dae_monitor), pointer :: monitor => null()
    class(dae_events), pointer :: events => null()
    !> num_events when the events were set.
    integer(c_int) :: num_events = 0
    !> n.
    integer(c_int) :: num_unknowns = 0
    !> dae_options%fixed in C's terms.
    integer(c_int), allocatable :: fixed(:)
  end type control_holder

contains

  !> sfdae_monitor_function. 1 stops the call.
  recursive function call_monitor(progress, user) bind(c, name="") result(outcome)
    type(sfdae_progress), intent(in) :: progress
    type(c_ptr), value :: user
    integer(c_int) :: outcome
    type(control_holder), pointer :: to
    logical :: stop_now

    call c_f_pointer(user, to)
    stop_now = .false.
    call to%monitor%after_step(progress, vector_at(progress%x, progress%num_unknowns), stop_now)
    outcome = flag(stop_now)
  end function call_monitor

  !> sfdae_event_function.
  recursive function call_eval_g(t, x, xdot, g, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: x, xdot, g, user
    integer(c_int) :: status
    type(control_holder), pointer :: to

    call c_f_pointer(user, to)
    status = sfdae_ok
    call to%events%eval_g(t, vector_at(x, to%num_unknowns), vector_at(xdot, to%num_unknowns), &
      vector_at(g, to%num_events), status)
  end function call_eval_g

  !> Address of the function that calls eval_g of the events in a control_holder.
  function event_callback() result(address)
    type(c_funptr) :: address

    address = address_of_event_function(call_eval_g)
  end function event_callback

  ! ---- Descriptions for C -------------------------------------------------------------------

  !> Describes the options to C and stores the monitor. c_options points into options and holder.
  subroutine fill_options(options, holder, c_options, complaint)
    !> Absent: defaults.
    type(dae_options), target, intent(in), optional :: options
    !> Its num_unknowns must be set.
    type(control_holder), target, intent(inout) :: holder
    !> Newly initialized.
    type(sfdae_options), intent(inout) :: c_options
    !> Error in the sizes of arrays; empty if there is none.
    character(len=:), allocatable, intent(out) :: complaint

    complaint = ""
    if (c_options_init(c_options, c_sizeof(c_options)) < 0) return
    if (.not. present(options)) return

    associate (n => holder%num_unknowns, c => c_options)
      call fill_vector("rtol_vector", options%rtol_vector, n, c%rtol_vector, complaint)
      call fill_vector("atol_vector", options%atol_vector, n, c%atol_vector, complaint)
      call fill_vector("initial_weights", options%initial_weights, n, c%initial_weights, complaint)
      if (allocated(options%fixed)) then
        holder%fixed = flag(options%fixed)
        call compare_size("fixed", size(holder%fixed, kind=c_int), n, complaint)
        if (size(holder%fixed) > 0) c%fixed = c_loc(holder%fixed)
      end if
    end associate

    c_options%rtol = options%rtol
    c_options%atol = options%atol
    c_options%max_index = options%max_index
    c_options%reduction = options%reduction
    c_options%rank_tol = options%rank_tol
    c_options%time_scale = options%time_scale
    c_options%difference_derivatives = flag(options%difference_derivatives)
    c_options%difference_step = options%difference_step
    c_options%initial_values = options%initial_values
    c_options%ignore_inconsistency = flag(options%ignore_inconsistency)
    c_options%consistency_tol = options%consistency_tol
    c_options%max_order = options%max_order
    c_options%initial_step = options%initial_step
    c_options%max_step = options%max_step
    c_options%use_stop_time = flag(options%use_stop_time)
    c_options%stop_time = options%stop_time
    c_options%max_steps = options%max_steps
    c_options%max_seconds = options%max_seconds
    c_options%leading_term = options%leading_term
    c_options%method = options%method
    c_options%min_stages = options%min_stages
    c_options%max_stages = options%max_stages
    c_options%xdot_is_guess = flag(options%xdot_is_guess)
    c_options%output = options%output
    c_options%check_derivatives = flag(options%check_derivatives)
    c_options%structure = options%structure
    c_options%conditions = options%conditions

    holder%monitor => options%monitor
    if (associated(options%monitor)) c_options%monitor = address_of_monitor_function(call_monitor)
    c_options%monitor_user = c_loc(holder)
  end subroutine fill_options

  !> Takes the address of an option that is set. Complains if it does not have n values.
  subroutine fill_vector(name, values, n, address, complaint)
    character(len=*), intent(in) :: name
    real(c_double), allocatable, target, intent(in) :: values(:)
    integer(c_int), intent(in) :: n
    type(c_ptr), intent(inout) :: address
    character(len=:), allocatable, intent(inout) :: complaint

    if (.not. allocated(values)) return
    call compare_size(name, size(values, kind=c_int), n, complaint)
    if (size(values) > 0) address = c_loc(values)
  end subroutine fill_vector

  !> Complains if an array does not have n entries.
  subroutine compare_size(name, length, n, complaint, symbol)
    !> Name of the array.
    character(len=*), intent(in) :: name
    !> Actual number of entries.
    integer(c_int), intent(in) :: length
    !> Required number of entries.
    integer(c_int), intent(in) :: n
    !> Replaced if these differ.
    character(len=:), allocatable, intent(inout) :: complaint
    !> Symbol of the required number; absent: n.
    character(len=*), intent(in), optional :: symbol
    character(len=12) :: found, expected

    if (length == n) return
    write (found, '(i0)') length
    write (expected, '(i0)') n
    complaint = name // " has " // trim(found) // " entries, but "
    if (present(symbol)) then
      complaint = complaint // symbol // " = " // trim(expected)
    else
      complaint = complaint // "n = " // trim(expected)
    end if
  end subroutine compare_size

end module sfdae_control
