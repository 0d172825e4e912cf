! SPDX-License-Identifier: BSD-3-Clause
!
! Callbacks that fail, and callbacks that use solvers.
program callback_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_options, dae_solver, sfdae_busy, sfdae_callback_failed, &
    sfdae_callback_stopped, sfdae_not_finite, sfdae_ok, sfdae_order_missing, sfdae_statistics
  use test_support, only: check, check_close, check_status, fail_nan, fail_never, fail_status, &
    finish, free_dae, mixed_dae, nested_dae
  implicit none

  real(dp), parameter :: tol = 1.0e-6_dp

  call failures_end_the_call(fail_status, -3_c_int, sfdae_callback_stopped)
  call failures_end_the_call(fail_status, 7_c_int, sfdae_callback_failed)
  call failures_end_the_call(fail_nan, 0_c_int, sfdae_not_finite)
  call passing_failures_shorten_steps()
  call missing_orders()
  call missing_prescribed_values()
  call solver_is_busy_in_its_callbacks()
  call callbacks_may_use_other_solvers()
  call finish()

contains

  !> At the start, and along the way: the last good point is returned and can be started from.
  subroutine failures_end_the_call(failure, status_of_callback, expected)
    integer, intent(in) :: failure
    integer(c_int), intent(in) :: status_of_callback
    integer(c_int), intent(in) :: expected
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3)

    problem%failure = failure
    problem%status = status_of_callback
    problem%fail_from = -1
    call solver%create(problem, status)
    x = 7
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, expected, "failure at the start")
    call check(len(solver%message()) > 0, "words on the failure")
    call check(all(abs(x - 7) <= 0), "x after a failed start")

    problem%fail_from = 1
    x = 0
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_ok, "start before the failure")
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, expected, "failure along the way")
    call check(t <= 1, "point before the failure")
    call check_close(x, problem%exact(t, 0.0_dp), tol, tol, "x before the failure")

    problem%failure = fail_never
    call solver%start(t, 2.0_dp, x, status)
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "after the failure")
    call check_close(x, problem%exact(2.0_dp, 0.0_dp), tol, tol, "x after the failure")
    call solver%destroy()
  end subroutine failures_end_the_call

  !> A positive status is answered by a smaller step.
  subroutine passing_failures_shorten_steps()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    type(sfdae_statistics) :: statistics
    integer(c_int) :: status
    real(dp) :: t, x(3)

    problem%failure = fail_status
    problem%status = 1
    problem%fail_from = 1
    problem%fail_times = 2
    call solver%create(problem, status)
    x = 0
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance past a passing failure")
    call check(problem%fail_times == 0, "it did fail")
    call check_close(x, problem%exact(2.0_dp, 0.0_dp), tol, tol, "x past a passing failure")
    call solver%get_statistics(statistics, status)
    call check(statistics%other_failures >= 1, "the failure is counted")
    call solver%destroy()
  end subroutine passing_failures_shorten_steps

  !> Derivatives that are not available are a failure, or come from differences.
  subroutine missing_orders()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3)

    problem%available = 0
    call solver%create(problem, status)
    x = 0
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_order_missing, "f' is missing")
    call check(len(solver%message()) > 0, "words on the missing order")
    options%difference_derivatives = .true.
    call solver%set_options(options, status)
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_ok, "f' from differences")
    call solver%advance(2.0_dp, t, x, status)
    call check_close(x, problem%exact(2.0_dp, 0.0_dp), 10 * tol, 10 * tol, "x by differences")
    call solver%destroy()
  end subroutine missing_orders

  !> Whoever prescribes components has to override eval_prescribed.
  subroutine missing_prescribed_values()
    type(free_dae), target :: problem = free_dae(num_equations=1, num_unknowns=2)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: x(2)

    problem%prescribed = [2]
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_callback_stopped, "eval_prescribed not overridden")
    call solver%destroy()
  end subroutine missing_prescribed_values

  !> It can be neither used nor destroyed.
  subroutine solver_is_busy_in_its_callbacks()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver), target :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3)

    call solver%create(problem, status)
    problem%probed => solver
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start of a probed solver")
    call check_status(problem%probe_status, sfdae_busy, "make_consistent in a callback")
    call check_status(problem%destroy_status, sfdae_busy, "destroy in a callback")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance of a probed solver")
    call check_close(x, problem%exact(1.0_dp, 0.0_dp), tol, tol, "x of a probed solver")
    call solver%destroy()
  end subroutine solver_is_busy_in_its_callbacks

  !> x' = f(t), where another solver finds f(t) = sin t in every call.
  subroutine callbacks_may_use_other_solvers()
    type(nested_dae), target :: problem = nested_dae(num_equations=1, num_unknowns=1)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(1)

    call solver%create(problem, status)
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "a solver in a callback")
    call check_close(x, [1 - cos(1.0_dp)], tol, tol, "x from another solver")
    call solver%destroy()
  end subroutine callbacks_may_use_other_solvers

end program callback_test
