! SPDX-License-Identifier: BSD-3-Clause
!
! Hybrid systems: modes, transitions between them, and an integration across all of them.
module sfdae_hybrids
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, &
    c_loc, c_long, c_null_ptr, c_ptr, c_size_t, c_sizeof
  use sfdae_c, only: address_of_equations_function, address_of_event_function, &
    address_of_jump_function, c_add_mode, c_add_switch, c_add_transition, c_advance_hybrid, &
    c_advance_to_transition, c_create_hybrid, c_destroy_hybrid, c_get_accumulation, &
    c_get_current_mode, c_get_hybrid_checkpoint_length, c_get_hybrid_message, &
    c_get_hybrid_gradient, c_get_hybrid_sensitivities, c_get_hybrid_statistics, c_get_mode, &
    c_get_num_passages, c_get_passage, c_get_passage_sensitivities, c_get_passage_values, c_mode_init, &
    c_passage_init, c_record_hybrid, c_report_hybrid, c_request_stop_hybrid, &
    c_restore_hybrid_checkpoint, c_save_hybrid_checkpoint, c_start_hybrid, c_statistics_init, &
    c_transition_init
  use sfdae_control, only: compare_size
  use sfdae_conversions, only: text_at, text_in, text_in_c, vector_at
  use sfdae_expressions, only: expression
  use sfdae_sensitivities, only: dae_sensitivities, set_sensitivities_in_c
  use sfdae_solutions, only: dae_solution
  use sfdae_solver, only: dae_solver
  use sfdae_types, only: sfdae_illegal_argument, sfdae_mode, sfdae_ok, sfdae_out_of_memory, &
    sfdae_passage, sfdae_statistics, sfdae_transition, sfdae_transition_condition, &
    sfdae_transition_time
  implicit none
  private

  public :: dae_hybrid, dae_switch, dae_transition

  !> A transition between modes. Extend it: components are your data. hybrid.h explains the rules.
  type :: dae_transition
    !> The source mode, from 1 on.
    integer(c_int) :: from = 0
    !> The target mode.
    integer(c_int) :: to = 0
    !> sfdae_transition_condition, _zero or _time.
    integer(c_int) :: kind = sfdae_transition_condition
    !> Direction of zeros: +1 rising, -1 falling, 0 both.
    integer(c_int) :: direction = 0
    !> For sfdae_transition_time.
    real(c_double) :: time = 0
    !> .true.: the transition requires eval_guard > 0.
    logical :: has_guard = .false.
    !> .true.: eval_jump gives the values after it; else they follow from impulses.
    logical :: has_jump = .false.
  contains
    !> The condition, or the function with the zeros.
    procedure :: eval => transition_eval
    !> The guard.
    procedure :: eval_guard => transition_eval
    !> Values after the transition.
    procedure :: eval_jump => transition_eval_jump
  end type dae_transition

  !> A surface between two modes that may both lead toward it. hybrid.h explains the rules.
  type, abstract :: dae_switch
    !> The mode for negative values of the surface function, from 1 on.
    integer(c_int) :: below = 0
    !> The mode for positive values.
    integer(c_int) :: above = 0
  contains
    !> The function of the surface as a formula; called once.
    procedure(surface_procedure), deferred :: surface
  end type dae_switch

  abstract interface
    !> Writes g(t, x), which is zero at the surface.
    subroutine surface_procedure(self, t, x, g)
      import :: dae_switch, expression
      class(dae_switch), intent(inout) :: self
      type(expression), intent(in) :: t
      !> n unknowns.
      type(expression), intent(in) :: x(:)
      !> Undefined on entry.
      type(expression), intent(inout) :: g
    end subroutine surface_procedure
  end interface

  !> Target of the C pointer while a switch is added.
  type :: switch_holder
    class(dae_switch), pointer :: switch => null()
    integer(c_int) :: num_unknowns = 0
  end type switch_holder

  !> Target of the C pointer for a transition. Allocated on the heap, so that it stays in place.
  type :: transition_holder
    class(dae_transition), pointer :: transition => null()
    integer(c_int) :: num_unknowns = 0
    type(transition_holder), pointer :: next => null()
  end type transition_holder

  !> A hybrid system. Never copy one, and destroy it before its solvers and before it goes out of
  !> scope.
  type :: dae_hybrid
    private
    type(c_ptr) :: handle = c_null_ptr
    integer(c_int) :: num_unknowns = 0
    !> Requested sensitivities.
    integer(c_int) :: num_sensitivities = 0
    type(transition_holder), pointer :: transitions => null()
    !> Message of this module about the last call; else the message of the library is used.
    character(len=:), allocatable :: complaint
  contains
    procedure :: create => hybrid_create
    procedure :: destroy => hybrid_destroy
    procedure :: message => hybrid_message
    procedure :: add_mode => hybrid_add_mode
    procedure :: add_transition => hybrid_add_transition
    procedure :: add_switch => hybrid_add_switch
    procedure :: start => hybrid_start
    procedure :: advance => hybrid_advance
    procedure :: advance_to_transition => hybrid_advance_to_transition
    procedure :: record => hybrid_record
    procedure :: stop_recording => hybrid_stop_recording
    procedure :: request_stop => hybrid_request_stop
    procedure :: set_sensitivities => hybrid_set_sensitivities
    procedure :: get_sensitivities => hybrid_get_sensitivities
    procedure :: get_passage_sensitivities => hybrid_get_passage_sensitivities
    procedure :: get_gradient => hybrid_get_gradient
    procedure :: get_current_mode => hybrid_get_current_mode
    procedure :: get_mode => hybrid_get_mode
    procedure :: get_num_passages => hybrid_get_num_passages
    procedure :: get_passage => hybrid_get_passage
    procedure :: get_passage_values => hybrid_get_passage_values
    procedure :: get_accumulation => hybrid_get_accumulation
    procedure :: get_statistics => hybrid_get_statistics
    procedure :: report => hybrid_report
    procedure :: save_checkpoint => hybrid_save_checkpoint
    procedure :: restore_checkpoint => hybrid_restore_checkpoint
  end type dae_hybrid

contains

  ! ---- Transitions --------------------------------------------------------------------------

  !> Placeholder for an unused function.
  subroutine transition_eval(self, t, x, xdot, g, status)
    class(dae_transition), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n values.
    real(c_double), intent(in) :: x(:)
    !> n values of x'.
    real(c_double), intent(in) :: xdot(:)
    !> Zero on entry.
    real(c_double), intent(inout) :: g
    !> 0 on entry. > 0: cannot evaluate here. < 0: stop at once.
    integer(c_int), intent(inout) :: status

    g = 0
    if (self%from < 0 .or. t > huge(t) .or. size(x) /= size(xdot)) status = -1
  end subroutine transition_eval

  !> Leaves the values unchanged.
  subroutine transition_eval_jump(self, t, before, after, status)
    class(dae_transition), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n values.
    real(c_double), intent(in) :: before(:)
    !> n values; on entry, those before the transition.
    real(c_double), intent(inout) :: after(:)
    !> 0 on entry; other values end the integration.
    integer(c_int), intent(inout) :: status

    after = before
    if (self%from < 0 .or. t > huge(t)) status = -1
  end subroutine transition_eval_jump

  !> sfdae_event_function of the transition.
  recursive function call_eval(t, x, xdot, g, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: x, xdot, g, user
    integer(c_int) :: status
    type(transition_holder), pointer :: to
    real(c_double), pointer :: value

    call c_f_pointer(user, to)
    call c_f_pointer(g, value)
    status = sfdae_ok
    call to%transition%eval(t, vector_at(x, to%num_unknowns), vector_at(xdot, to%num_unknowns), &
      value, status)
  end function call_eval

  !> sfdae_event_function of the guard.
  recursive function call_guard(t, x, xdot, g, user) bind(c, name="") result(status)
    real(c_double), value :: t
    type(c_ptr), value :: x, xdot, g, user
    integer(c_int) :: status
    type(transition_holder), pointer :: to
    real(c_double), pointer :: value

    call c_f_pointer(user, to)
    call c_f_pointer(g, value)
    status = sfdae_ok
    call to%transition%eval_guard(t, vector_at(x, to%num_unknowns), &
      vector_at(xdot, to%num_unknowns), value, status)
  end function call_guard

  !> sfdae_jump_function.
  recursive function call_jump(t, from, to, before, after, user) bind(c, name="") result(status)
    real(c_double), value :: t
    integer(c_int), value :: from, to
    type(c_ptr), value :: before, after, user
    integer(c_int) :: status
    type(transition_holder), pointer :: holder

    call c_f_pointer(user, holder)
    status = sfdae_ok
    if (from < 0 .or. to < 0) status = -1
    call holder%transition%eval_jump(t, vector_at(before, holder%num_unknowns), &
      vector_at(after, holder%num_unknowns), status)
  end function call_jump

  !> sfdae_equations_function of the surface of a switch.
  recursive function call_surface(record, t, x, xdot, residual, user) bind(c, name="") &
    result(status)
    type(c_ptr), value :: record
    type(expression), value :: t
    type(c_ptr), value :: x, xdot, residual, user
    integer(c_int) :: status
    type(switch_holder), pointer :: to
    type(expression), pointer :: unknowns(:), value

    call c_f_pointer(user, to)
    call c_f_pointer(x, unknowns, [to%num_unknowns])
    call c_f_pointer(residual, value)
    call to%switch%surface(t, unknowns, value)
    status = merge(sfdae_ok, sfdae_illegal_argument, c_associated(record) .and. c_associated(xdot))
  end function call_surface

  ! ---- Modes and transitions ----------------------------------------------------------------

  !> Creates a hybrid system without modes; an existing one is destroyed.
  subroutine hybrid_create(self, status)
    class(dae_hybrid), intent(inout) :: self
    integer(c_int), intent(out) :: status

    call self%destroy(status)
    if (status == sfdae_ok) status = c_create_hybrid(self%handle)
  end subroutine hybrid_create

  !> Destroys it and releases its solvers.
  subroutine hybrid_destroy(self, status)
    class(dae_hybrid), intent(inout) :: self
    integer(c_int), intent(out) :: status
    type(transition_holder), pointer :: next

    self%complaint = ""
    status = c_destroy_hybrid(self%handle)
    if (status < 0) return
    self%num_unknowns = 0
    self%num_sensitivities = 0
    do while (associated(self%transitions))
      next => self%transitions%next
      deallocate (self%transitions)
      self%transitions => next
    end do
  end subroutine hybrid_destroy

  !> Message of the last call; a message of a solver begins with its mode, counted from 0.
  function hybrid_message(self) result(message)
    class(dae_hybrid), intent(in) :: self
    character(len=:), allocatable :: message

    message = ""
    if (allocated(self%complaint)) message = self%complaint
    if (len(message) == 0) message = text_at(c_get_hybrid_message(self%handle))
  end function hybrid_message

  !> Adds a mode; numbers begin with 1.
  subroutine hybrid_add_mode(self, solver, status, name, mode)
    class(dae_hybrid), intent(inout) :: self
    !> Must live as long as the hybrid system; its `destroy` is refused until then.
    class(dae_solver), intent(in) :: solver
    integer(c_int), intent(out) :: status
    !> For messages and the report.
    character(len=*), intent(in), optional :: name
    !> Its number.
    integer(c_int), intent(inout), optional :: mode
    type(c_ptr) :: address
    integer(c_int) :: num_unknowns, number

    call check_call(self, status)
    if (status < 0) return
    call solver%in_c(address, num_unknowns)
    if (present(name)) then
      status = c_add_mode(self%handle, address, text_in_c(name), number)
    else
      status = c_add_mode(self%handle, address, text_in_c(""), number)
    end if
    if (status < 0) return
    self%num_unknowns = num_unknowns
    if (present(mode)) mode = number + 1
  end subroutine hybrid_add_mode

  !> Adds a transition; numbers begin with 1.
  subroutine hybrid_add_transition(self, transition, status, number)
    class(dae_hybrid), intent(inout) :: self
    !> Must have the target attribute and live, in place, as long as the hybrid system.
    class(dae_transition), target, intent(inout) :: transition
    integer(c_int), intent(out) :: status
    !> Its number.
    integer(c_int), intent(inout), optional :: number
    type(transition_holder), pointer :: holder
    type(sfdae_transition) :: c
    integer(c_int) :: added
    integer :: outcome

    call check_call(self, status)
    if (status < 0) return
    status = sfdae_out_of_memory
    allocate (holder, stat=outcome)
    if (outcome /= 0) return
    holder%transition => transition
    holder%num_unknowns = self%num_unknowns
    status = c_transition_init(c, c_sizeof(c))
    c%from = transition%from - 1
    c%to = transition%to - 1
    c%kind = transition%kind
    c%direction = transition%direction
    c%time = transition%time
    c%user = c_loc(holder)
    if (c%kind /= sfdae_transition_time) c%function = address_of_event_function(call_eval)
    if (transition%has_guard) c%guard = address_of_event_function(call_guard)
    if (transition%has_jump) c%jump = address_of_jump_function(call_jump)
    status = c_add_transition(self%handle, c, added)
    if (status < 0) then
      deallocate (holder)
      return
    end if
    holder%next => self%transitions
    self%transitions => holder
    if (present(number)) number = added + 1
  end subroutine hybrid_add_transition

  !> Adds the switch between two modes, and the mode of the motion along its surface.
  recursive subroutine hybrid_add_switch(self, switch, status, name, mode)
    class(dae_hybrid), intent(inout) :: self
    !> Not needed after the call.
    class(dae_switch), target, intent(inout) :: switch
    integer(c_int), intent(out) :: status
    !> Name of the sliding mode.
    character(len=*), intent(in), optional :: name
    !> Its number.
    integer(c_int), intent(inout), optional :: mode
    type(switch_holder), target :: holder
    integer(c_int) :: number

    call check_call(self, status)
    if (status < 0) return
    holder%switch => switch
    holder%num_unknowns = self%num_unknowns
    if (present(name)) then
      status = c_add_switch(self%handle, switch%below - 1, switch%above - 1, &
        address_of_equations_function(call_surface), c_loc(holder), text_in_c(name), number)
    else
      status = c_add_switch(self%handle, switch%below - 1, switch%above - 1, &
        address_of_equations_function(call_surface), c_loc(holder), text_in_c(""), number)
    end if
    if (status >= 0 .and. present(mode)) mode = number + 1
  end subroutine hybrid_add_switch

  ! ---- Integration --------------------------------------------------------------------------

  !> Starts at (t, x) in a mode; x and xdot become consistent.
  recursive subroutine hybrid_start(self, mode, t, toward, x, status, xdot)
    class(dae_hybrid), intent(inout) :: self
    integer(c_int), intent(in) :: mode
    real(c_double), intent(in) :: t
    !> Not t: sets the direction of integration.
    real(c_double), intent(in) :: toward
    !> n values.
    real(c_double), contiguous, intent(inout) :: x(:)
    integer(c_int), intent(out) :: status
    !> n values.
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: slopes

    call check_point(self, x, slopes, status, xdot)
    if (status == sfdae_ok) &
      status = c_start_hybrid(self%handle, mode - 1, t, toward, x, slopes)
  end subroutine hybrid_start

  !> Integrates to tout across all transitions. After failures t, x and xdot are the point reached;
  !> sfdae_zeno if transitions accumulate.
  recursive subroutine hybrid_advance(self, tout, t, x, status, xdot)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), intent(in) :: tout
    real(c_double), intent(inout) :: t
    !> n values.
    real(c_double), contiguous, intent(inout) :: x(:)
    integer(c_int), intent(out) :: status
    !> n values.
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: slopes

    call check_point(self, x, slopes, status, xdot)
    if (status == sfdae_ok) status = c_advance_hybrid(self%handle, tout, t, x, slopes)
  end subroutine hybrid_advance

  !> Integrates to the next transition (sfdae_event), with the values after it, or to tout.
  recursive subroutine hybrid_advance_to_transition(self, tout, t, x, status, xdot)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), intent(in) :: tout
    real(c_double), intent(inout) :: t
    !> n values.
    real(c_double), contiguous, intent(inout) :: x(:)
    integer(c_int), intent(out) :: status
    !> n values.
    real(c_double), contiguous, target, intent(inout), optional :: xdot(:)
    type(c_ptr) :: slopes

    call check_point(self, x, slopes, status, xdot)
    if (status == sfdae_ok) status = c_advance_to_transition(self%handle, tout, t, x, slopes)
  end subroutine hybrid_advance_to_transition

  !> Requests derivatives of the solution with respect to parameters and start values, from the next
  !> start on, over all modes.
  subroutine hybrid_set_sensitivities(self, wanted, status)
    class(dae_hybrid), intent(inout) :: self
    !> Without names: none.
    type(dae_sensitivities), target, intent(in) :: wanted
    !> sfdae_illegal_argument for modes that are not recorded, or unknown names.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status /= sfdae_ok) return
    call set_sensitivities_in_c(self%handle, .true., self%num_unknowns, wanted, &
      self%num_sensitivities, status, self%complaint)
  end subroutine hybrid_set_sensitivities

  !> S = dx/dp at t, the time returned by the last call or a time within the last step of this mode.
  recursive subroutine hybrid_get_sensitivities(self, t, s, status, sdot)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), intent(in) :: t
    !> n x the number of parameters.
    real(c_double), contiguous, intent(inout) :: s(:, :)
    !> sfdae_not_started if there are none.
    integer(c_int), intent(out) :: status
    !> S', like s.
    real(c_double), contiguous, target, intent(inout), optional :: sdot(:, :)
    type(c_ptr) :: sdot_address

    call check_call(self, status)
    call check_size(self, "a column of s", size(s, 1, c_int), self%num_unknowns, "n", status)
    call check_parameters(self, "a row of s", size(s, 2, c_int), status)
    sdot_address = c_null_ptr
    if (present(sdot)) then
      call check_size(self, "a column of sdot", size(sdot, 1, c_int), self%num_unknowns, "n", &
        status)
      call check_parameters(self, "a row of sdot", size(sdot, 2, c_int), status)
      if (size(sdot) > 0) sdot_address = c_loc(sdot)
    end if
    if (status == sfdae_ok) status = c_get_hybrid_sensitivities(self%handle, t, s, sdot_address)
  end subroutine hybrid_get_sensitivities

  !> dt/dp of the last transition, one for each parameter.
  subroutine hybrid_get_passage_sensitivities(self, dt, status)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), contiguous, intent(inout) :: dt(:)
    !> sfdae_not_started if there was no transition, or there are no sensitivities.
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    call check_parameters(self, "dt", size(dt, kind=c_int), status)
    if (status == sfdae_ok) status = c_get_passage_sensitivities(self%handle, dt)
  end subroutine hybrid_get_passage_sensitivities

  !> Gradients of functionals, with dae_sensitivities%adjoint: sum over k of S(t(k))^T w_k, one
  !> column for each functional.
  recursive subroutine hybrid_get_gradient(self, t, weights, gradient, status)
    class(dae_hybrid), intent(inout) :: self
    !> Times from the start to the time reached; at a transition, the one after it.
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
    call check_size(self, "a column of weights", size(weights, 1, c_int), self%num_unknowns, "n", &
      status)
    call check_size(self, "a row of weights", size(weights, 2, c_int), points * functionals, &
      "number of points times that of functionals", status)
    call check_parameters(self, "a column of gradient", size(gradient, 1, c_int), status)
    if (status == sfdae_ok) status = c_get_hybrid_gradient(self%handle, points, t, functionals, &
      weights, gradient)
  end subroutine hybrid_get_gradient

  !> Refuses a call with an array of wrong size.
  subroutine check_size(self, name, found, expected, symbol, status)
    class(dae_hybrid), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: found
    integer(c_int), intent(in) :: expected
    !> Required number of entries.
    character(len=*), intent(in) :: symbol
    !> If not sfdae_ok, the call has already been refused.
    integer(c_int), intent(inout) :: status

    if (status /= sfdae_ok .or. found == expected) return
    call compare_size(name, found, expected, self%complaint, symbol)
    status = sfdae_illegal_argument
  end subroutine check_size

  !> Refuses a call with an array that does not have one entry for each parameter.
  subroutine check_parameters(self, name, found, status)
    class(dae_hybrid), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(c_int), intent(in) :: found
    !> If not sfdae_ok, the call has already been refused.
    integer(c_int), intent(inout) :: status

    call check_size(self, name, found, self%num_sensitivities, "number of names", status)
  end subroutine check_parameters

  !> Records all following accepted steps in all modes in the solution.
  subroutine hybrid_record(self, solution, status)
    class(dae_hybrid), intent(inout) :: self
    class(dae_solution), intent(in) :: solution
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_record_hybrid(self%handle, solution%address())
  end subroutine hybrid_record

  !> Stops recording steps.
  subroutine hybrid_stop_recording(self, status)
    class(dae_hybrid), intent(inout) :: self
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_record_hybrid(self%handle, c_null_ptr)
  end subroutine hybrid_stop_recording

  !> Stops the current call, or else the next one.
  subroutine hybrid_request_stop(self, status)
    class(dae_hybrid), intent(in) :: self
    integer(c_int), intent(out) :: status

    status = c_request_stop_hybrid(self%handle)
  end subroutine hybrid_request_stop

  ! ---- Inspection ---------------------------------------------------------------------------

  !> The current mode; sfdae_not_started before a start.
  subroutine hybrid_get_current_mode(self, mode, status)
    class(dae_hybrid), intent(inout) :: self
    integer(c_int), intent(inout) :: mode
    integer(c_int), intent(out) :: status
    integer(c_int) :: number

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_current_mode(self%handle, number)
    if (status == sfdae_ok) mode = number + 1
  end subroutine hybrid_get_current_mode

  !> A mode and its statistics since the start.
  subroutine hybrid_get_mode(self, mode, result, status)
    class(dae_hybrid), intent(inout) :: self
    integer(c_int), intent(in) :: mode
    type(sfdae_mode), intent(inout) :: result
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_mode_init(result, c_sizeof(result))
    if (status == sfdae_ok) status = c_get_mode(self%handle, mode - 1, result)
  end subroutine hybrid_get_mode

  !> Number of transitions since the start.
  subroutine hybrid_get_num_passages(self, count, status)
    class(dae_hybrid), intent(inout) :: self
    integer(c_long), intent(inout) :: count
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_num_passages(self%handle, count)
  end subroutine hybrid_get_num_passages

  !> A transition that happened, from 1 on. Modes, the transition and components in it also count
  !> from 1; components are 0 if there is none.
  subroutine hybrid_get_passage(self, index, result, status)
    class(dae_hybrid), intent(inout) :: self
    integer(c_long), intent(in) :: index
    type(sfdae_passage), intent(inout) :: result
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_passage_init(result, c_sizeof(result))
    if (status == sfdae_ok) status = c_get_passage(self%handle, index - 1, result)
    if (status < 0) return
    result%transition = result%transition + 1
    result%from = result%from + 1
    result%to = result%to + 1
    result%impulse_component = result%impulse_component + 1
    result%changed_component = result%changed_component + 1
  end subroutine hybrid_get_passage

  !> Values before and after the last transition.
  subroutine hybrid_get_passage_values(self, before, after, status, impulse)
    class(dae_hybrid), intent(inout) :: self
    !> n values.
    real(c_double), contiguous, intent(inout) :: before(:)
    !> n values.
    real(c_double), contiguous, intent(inout) :: after(:)
    integer(c_int), intent(out) :: status
    !> n values: the factor of delta in each component.
    real(c_double), contiguous, target, intent(inout), optional :: impulse(:)
    type(c_ptr) :: address, unused

    call check_point(self, before, address, status, impulse)
    if (status == sfdae_ok) call check_point(self, after, unused, status)
    if (status == sfdae_ok) status = c_get_passage_values(self%handle, before, after, address)
  end subroutine hybrid_get_passage_values

  !> After sfdae_zeno: the time at which transitions accumulate.
  subroutine hybrid_get_accumulation(self, t, status)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), intent(inout) :: t
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_get_accumulation(self%handle, t)
  end subroutine hybrid_get_accumulation

  !> Counts over all modes.
  subroutine hybrid_get_statistics(self, result, status)
    class(dae_hybrid), intent(inout) :: self
    type(sfdae_statistics), intent(inout) :: result
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) status = c_statistics_init(result, c_sizeof(result))
    if (status == sfdae_ok) status = c_get_hybrid_statistics(self%handle, result)
  end subroutine hybrid_get_statistics

  !> Modes and the last transitions as text.
  subroutine hybrid_report(self, text, status)
    class(dae_hybrid), intent(inout) :: self
    !> Lines are separated by new_line('a').
    character(len=:), allocatable, intent(inout) :: text
    integer(c_int), intent(out) :: status
    character(kind=c_char) :: nothing(1)
    character(kind=c_char), allocatable :: buffer(:)
    integer(c_size_t) :: needed

    call check_call(self, status)
    needed = 1
    if (status == sfdae_ok) status = c_report_hybrid(self%handle, nothing, 1_c_size_t, needed)
    if (status < 0) return
    allocate (buffer(needed))
    status = c_report_hybrid(self%handle, buffer, needed, needed)
    if (status >= 0) text = text_in(buffer)
  end subroutine hybrid_report

  !> The state of the run as numbers.
  subroutine hybrid_save_checkpoint(self, checkpoint, status)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), allocatable, intent(inout) :: checkpoint(:)
    integer(c_int), intent(out) :: status
    real(c_double), allocatable :: values(:)
    integer(c_size_t) :: length

    call check_call(self, status)
    length = 0
    if (status == sfdae_ok) status = c_get_hybrid_checkpoint_length(self%handle, length)
    if (status < 0) return
    allocate (values(length))
    status = c_save_hybrid_checkpoint(self%handle, values, length)
    if (status == sfdae_ok) call move_alloc(values, checkpoint)
  end subroutine hybrid_save_checkpoint

  !> Continues from a checkpoint instead of start, with the same modes and transitions.
  subroutine hybrid_restore_checkpoint(self, checkpoint, status)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), contiguous, intent(in) :: checkpoint(:)
    integer(c_int), intent(out) :: status

    call check_call(self, status)
    if (status == sfdae_ok) &
      status = c_restore_hybrid_checkpoint(self%handle, checkpoint, size(checkpoint, kind=c_size_t))
  end subroutine hybrid_restore_checkpoint

  ! ---- Checks -------------------------------------------------------------------------------

  !> Refuses calls before create.
  subroutine check_call(self, status)
    class(dae_hybrid), intent(inout) :: self
    !> sfdae_ok or sfdae_illegal_argument.
    integer(c_int), intent(out) :: status

    status = sfdae_ok
    self%complaint = ""
    if (c_associated(self%handle)) return
    status = sfdae_illegal_argument
    self%complaint = "the hybrid system does not exist: create it first"
  end subroutine check_call

  !> Refuses a call with arrays that do not have n entries.
  subroutine check_point(self, x, address, status, more)
    class(dae_hybrid), intent(inout) :: self
    real(c_double), intent(in) :: x(:)
    !> Address of `more`, null if it is absent.
    type(c_ptr), intent(out) :: address
    integer(c_int), intent(out) :: status
    real(c_double), contiguous, target, intent(inout), optional :: more(:)

    address = c_null_ptr
    call check_call(self, status)
    if (status < 0 .or. self%num_unknowns == 0) return
    call compare_size("x", size(x, kind=c_int), self%num_unknowns, self%complaint)
    if (present(more)) then
      call compare_size("xdot", size(more, kind=c_int), self%num_unknowns, self%complaint)
      address = c_loc(more)
    end if
    if (len(self%complaint) > 0) status = sfdae_illegal_argument
  end subroutine check_point

end module sfdae_hybrids
