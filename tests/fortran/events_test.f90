! SPDX-License-Identifier: BSD-3-Clause
!
! Events from Fortran: mixed_dae has x2 = sin w t, x3 = cos w t.
module event_functions
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_events
  implicit none
  private

  !> x2, t - 2 and x2' - 1/2.
  type, extends(dae_events), public :: three_events
    !> Called, and what eval_g reports from t = 1 on.
    integer :: calls = 0
    integer(c_int) :: status = 0
    integer :: wrong_sizes = 0
  contains
    procedure :: eval_g
  end type three_events

contains

  subroutine eval_g(self, t, x, xdot, g, status)
    class(three_events), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: x(:)
    real(dp), intent(in) :: xdot(:)
    real(dp), intent(inout) :: g(:)
    integer(c_int), intent(inout) :: status

    self%calls = self%calls + 1
    if (size(x) /= 3 .or. size(xdot) /= 3 .or. size(g) /= 3) self%wrong_sizes = 1
    if (any(abs(g) > 0)) self%wrong_sizes = 1
    g = [x(2), t - 2, xdot(2) - 0.5_dp]
    if (t >= 1) status = self%status
  end subroutine eval_g

end module event_functions

program events_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use event_functions, only: three_events
  use sfdae, only: dae_options, dae_solver, sfdae_callback_failed, sfdae_callback_stopped, &
    sfdae_event, sfdae_illegal_argument, sfdae_method_bdf, sfdae_method_radau, sfdae_ok, &
    sfdae_statistics
  use test_support, only: check, check_status, finish, mixed_dae
  implicit none

  real(dp), parameter :: tol = 1.0e-7_dp, pi = acos(-1.0_dp)
  integer(c_int) :: method

  do method = sfdae_method_bdf, sfdae_method_radau
    call finds_them_in_order()
    call reports_failures()
  end do
  call checks_sizes()
  call finish()

contains

  subroutine open_solver(solver, problem)
    type(dae_solver), intent(inout) :: solver
    type(mixed_dae), target, intent(inout) :: problem
    type(dae_options) :: options
    integer(c_int) :: status
    real(dp) :: x(3)

    options%method = method
    options%rtol = tol
    options%atol = tol
    call solver%create(problem, status, options)
    call check_status(status, sfdae_ok, "create")
    x = [0.5_dp, 0.0_dp, 1.0_dp]
    call solver%start(0.0_dp, 4.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
  end subroutine open_solver

  !> x2' = cos t falls through 1/2 at pi / 3, t rises through 2, x2 falls through 0 at pi.
  subroutine finds_them_in_order()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(three_events), target :: events = three_events(num_events=3)
    type(dae_solver) :: solver
    type(sfdae_statistics) :: statistics
    real(dp), parameter :: expected(3) = [pi / 3, 2.0_dp, pi]
    integer, parameter :: wanted(3, 3) = reshape([0, 0, -1, 0, 1, 0, -1, 0, 0], [3, 3])
    real(dp) :: t, x(3), xdot(3), middle
    integer(c_int) :: status, which(3)
    integer :: k

    events%calls = 0
    call open_solver(solver, problem)
    call solver%set_events(events, status)
    call check_status(status, sfdae_ok, "set_events")
    do k = 1, 3
      call solver%advance(4.0_dp, t, x, status, xdot)
      call check_status(status, sfdae_event, "advance to an event")
      call check(abs(t - expected(k)) <= merge(1.0e-3_dp, 100 * tol, k == 1), "time of the event")
      call solver%get_events(which, status)
      call check_status(status, sfdae_ok, "get_events")
      call check(all(which == wanted(:, k)), "which event")
      if (k == 1) call check(abs(xdot(2) - 0.5_dp) <= 1.0e-12_dp, "x' at the event")
      call solver%get_statistics(statistics, status)
      middle = statistics%t_internal - 0.5_dp * statistics%last_step
      call solver%interpolate(middle, x, status, xdot)
      call check_status(status, sfdae_ok, "interpolate")
      call check(abs(x(2) - sin(middle)) <= 1.0e-12_dp, "x between")
    end do
    call solver%interpolate(middle - 10, x, status)
    call check_status(status, sfdae_illegal_argument, "interpolate outside of the step")
    call solver%advance(4.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance to the end")
    call check(events%calls > 0 .and. events%wrong_sizes == 0, "calls")

    ! No events any more.
    events%num_events = 0
    call solver%set_events(events, status)
    call check_status(status, sfdae_ok, "set_events to none")
    call solver%advance(7.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance without events")
    events%num_events = 3
    call solver%destroy()
  end subroutine finds_them_in_order

  subroutine reports_failures()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(three_events), target :: events = three_events(num_events=3)
    type(dae_solver) :: solver
    real(dp) :: t, x(3)
    integer(c_int) :: status

    events%directions = [0_c_int, 0_c_int, 1_c_int]
    call open_solver(solver, problem)
    call solver%set_events(events, status)
    call check_status(status, sfdae_ok, "set_events with directions")
    events%status = 1
    call solver%advance(4.0_dp, t, x, status)
    call check_status(status, sfdae_callback_failed, "events that cannot be evaluated")
    call check(t < 1 .and. abs(x(2) - sin(t)) <= 1.0e-12_dp, "point before the failure")
    events%status = -1
    call solver%advance(4.0_dp, t, x, status)
    call check_status(status, sfdae_callback_stopped, "events that stop")
    events%status = 0
    call solver%advance(4.0_dp, t, x, status)
    call check_status(status, sfdae_event, "advance after failures")
    call check(abs(t - 2) <= 1.0e-15_dp, "the event that counts first")
    call solver%destroy()
  end subroutine reports_failures

  subroutine checks_sizes()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(three_events), target :: events = three_events(num_events=3)
    type(dae_solver) :: solver
    integer(c_int) :: status, which(2)

    which = 7
    call solver%set_events(events, status)
    call check_status(status, sfdae_illegal_argument, "set_events without a solver")
    call open_solver(solver, problem)
    events%directions = [1_c_int, 1_c_int]
    call solver%set_events(events, status)
    call check_status(status, sfdae_illegal_argument, "two directions for three events")
    call check(len(solver%message()) > 0, "message")
    deallocate (events%directions)
    call solver%set_events(events, status)
    call check_status(status, sfdae_ok, "set_events")
    call solver%get_events(which, status)
    call check_status(status, sfdae_illegal_argument, "two entries for three events")
    call check(all(which == 7), "which is untouched")
    call solver%destroy()
  end subroutine checks_sizes

end program events_test
