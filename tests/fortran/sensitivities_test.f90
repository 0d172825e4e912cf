! SPDX-License-Identifier: BSD-3-Clause
!
! Sensitivities from Fortran: x1' = p x2, x2' = -p x1, 0 = z**3 + z - c x1, from (x0, 0, z):
! x1 = x0 cos(p t).
module sensitivity_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  implicit none
  private

  public :: oscillator, first_component

  type, extends(nonlinear_dae) :: oscillator
  contains
    procedure :: equations => oscillator_equations
  end type oscillator

  !> Zeros of x1.
  type, extends(dae_events) :: first_component
  contains
    procedure :: eval_g
  end type first_component

contains

  subroutine oscillator_equations(self, t, x, xdot, residual)
    class(oscillator), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)
    type(expression) :: p

    p = named_parameter(t, "p", 1.5_dp)
    residual(1) = xdot(1) - p * x(2)
    residual(2) = xdot(2) + p * x(1)
    residual(3) = x(3)**3 + x(3) - named_parameter(t, "c", 2.0_dp) * x(1)
  end subroutine oscillator_equations

  subroutine eval_g(self, t, x, xdot, g, status)
    class(first_component), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: x(:)
    real(dp), intent(in) :: xdot(:)
    real(dp), intent(inout) :: g(:)
    integer(c_int), intent(inout) :: status

    g(1) = x(1)
  end subroutine eval_g

end module sensitivity_problems

program sensitivities_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  use sensitivity_problems, only: first_component, oscillator
  use test_support, only: check, finish
  implicit none

  real(dp), parameter :: p = 1.5_dp, c = 2.0_dp
  type(oscillator), target :: problem
  type(first_component), target :: events
  type(dae_solver) :: solver, other, tested
  type(dae_options) :: options
  type(dae_sensitivities) :: wanted
  type(sfdae_sensitivity_statistics) :: statistics
  real(dp) :: x(3), s(3, 3), sdot(3, 3), wrong(3, 2), dt(3), t, slope
  real(dp) :: gradient(3, 2), s_other(3, 3)
  real(dp), allocatable :: checkpoint(:)
  integer(c_int) :: status

  problem%num_equations = 3
  problem%num_unknowns = 3
  options%rtol = 1.0e-9_dp
  options%atol = 1.0e-9_dp
  call solver%create(problem, status, options)
  call check(status == sfdae_ok, "create")

  wanted%parameter_names = [character(len=4) :: "p", "c", ""]
  allocate (wanted%directions(3, 3))
  wanted%directions = 0
  wanted%directions(1, 3) = 1
  call solver%set_sensitivities(wanted, status)
  call check(status == sfdae_ok, "set_sensitivities")
  call solver%get_sensitivities(0.0_dp, s, status)
  call check(status == sfdae_not_started, "before start")

  x = [1, 0, 0]
  call solver%start(0.0_dp, 3.0_dp, x, status)
  call check(status == sfdae_ok, "start")
  call solver%advance(0.7_dp, t, x, status)
  call check(status == sfdae_ok, "advance")
  call solver%get_sensitivities(t, s, status, sdot)
  call check(status == sfdae_ok, "get_sensitivities")
  slope = 1 / (3 * x(3)**2 + 1)
  call check(near(s(1, 1), -t * sin(p * t), 1.0e-6_dp), "dx1/dp")
  call check(near(s(3, 1), -c * slope * t * sin(p * t), 1.0e-6_dp), "dz/dp")
  call check(near(s(3, 2), slope * cos(p * t), 1.0e-6_dp), "dz/dc")
  call check(near(s(1, 3), cos(p * t), 1.0e-6_dp), "dx1/dx0")
  call check(near(sdot(1, 3), -p * sin(p * t), 1.0e-5_dp), "its slope")
  call solver%get_sensitivity_statistics(statistics, status)
  call check(status == sfdae_ok .and. statistics%count == 3 .and. statistics%linearizations > 0, &
    "statistics")

  ! Another solver goes on from a checkpoint, if it is asked for the same.
  call solver%save_checkpoint(checkpoint, status)
  call check(status == sfdae_ok, "save_checkpoint")
  call other%create(problem, status, options)
  call other%restore_checkpoint(checkpoint, status)
  call check(status == sfdae_illegal_argument, "not asked for")
  call other%set_sensitivities(wanted, status)
  call other%restore_checkpoint(checkpoint, status)
  call check(status == sfdae_ok, "restore_checkpoint")
  call other%get_sensitivities(t, s_other, status)
  call check(status == sfdae_ok .and. all(abs(s_other - s) <= 0), &
    "S from a checkpoint")
  call other%destroy()
  deallocate (checkpoint)

  ! cos(p t) = 0 at t = pi / (2 p).
  events%num_events = 1
  call solver%set_events(events, status)
  call solver%advance(3.0_dp, t, x, status)
  call check(status == sfdae_event, "event")
  call solver%get_event_sensitivities(t, 0.0_dp, [1.0_dp, 0.0_dp, 0.0_dp], dt, status)
  call check(status == sfdae_ok .and. near(dt(1), -t / p, 1.0e-6_dp), "time of the event")
  call solver%get_event_sensitivities(t, 0.0_dp, [1.0_dp, 0.0_dp, 0.0_dp], dt, status, &
    [-1.0_dp, 0.0_dp, 0.0_dp])
  call check(status == sfdae_ok .and. near(dt(1), -(t + 1) / p, 1.0e-6_dp), "of a level")

  call solver%get_sensitivities(t, wrong, status)
  call check(status == sfdae_illegal_argument, "too few columns")
  call check(len(solver%message()) > 0, "message")
  call solver%get_event_sensitivities(t, 0.0_dp, [1.0_dp], dt, status)
  call check(status == sfdae_illegal_argument, "too few derivatives")
  wanted%parameter_names(1) = "none"
  call solver%set_sensitivities(wanted, status)
  call check(status == sfdae_illegal_argument, "unknown name")
  wanted%parameter_names(1) = "p"
  wanted%scales = [1.0_dp]
  call solver%set_sensitivities(wanted, status)
  call check(status == sfdae_illegal_argument, "too few scales")

  ! Steps of Radau for S as well, as if it were 1000 times as large.
  wanted%scales = [1000.0_dp, 1000.0_dp, 1000.0_dp]
  wanted%error_test = .true.
  options%method = sfdae_method_radau
  call tested%create(problem, status, options)
  call tested%set_sensitivities(wanted, status)
  call check(status == sfdae_ok, "set_sensitivities with an error test")
  x = [1, 0, 0]
  call tested%start(0.0_dp, 3.0_dp, x, status)
  call tested%advance(0.7_dp, t, x, status)
  call tested%get_sensitivities(t, s, status)
  call check(status == sfdae_ok .and. near(s(1, 1), -t * sin(p * t), 1.0e-8_dp), "tested dx1/dp")
  call tested%destroy(status)
  wanted%error_test = .false.

  ! The gradient of x1 + z at 0.7 and of x1 at 0.
  deallocate (wanted%scales)
  wanted%adjoint = .true.
  wanted%max_kept_steps = 1
  call solver%set_sensitivities(wanted, status)
  call check(status == sfdae_illegal_argument, "one step kept")
  wanted%max_kept_steps = 30
  call solver%set_sensitivities(wanted, status)
  call check(status == sfdae_ok, "set_sensitivities with the adjoint")
  x = [1, 0, 0]
  call solver%start(0.0_dp, 3.0_dp, x, status)
  call solver%advance(0.7_dp, t, x, status)
  slope = 1 / (3 * x(3)**2 + 1)
  call solver%get_gradient([0.0_dp, t], reshape([real(dp) :: 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 0], &
    [3, 4]), gradient, status)
  call check(status == sfdae_ok, "get_gradient")
  call check(near(gradient(1, 1), -(1 + c * slope) * t * sin(p * t), 1.0e-6_dp), "by p")
  call check(near(gradient(2, 1), slope * cos(p * t), 1.0e-6_dp), "by c")
  call check(near(gradient(3, 2), 1.0_dp, 1.0e-12_dp), "by the start value")
  call solver%get_sensitivity_statistics(statistics, status)
  call check(status == sfdae_ok .and. statistics%kept_steps > 0, "steps kept")
  call check(statistics%checkpoints > 0, "checkpoints")
  call solver%get_gradient([0.7_dp], reshape([real(dp) :: 1, 0, 0], [3, 1]), gradient, status)
  call check(status == sfdae_illegal_argument, "too few weights")
  call solver%get_gradient([0.3_dp], reshape([real(dp) :: 1, 0, 0], [3, 1]), gradient(:, 1:1), status)
  call check(status == sfdae_ok, "get_gradient within a step")
  call check(near(gradient(1, 1), -0.3_dp * sin(0.3_dp * p), 1.0e-6_dp), "by p within a step")
  call solver%get_gradient([0.8_dp], reshape([real(dp) :: 1, 0, 0], [3, 1]), gradient(:, 1:1), status)
  call check(status == sfdae_illegal_argument, "no step has led there")

  call solver%set_sensitivities(dae_sensitivities(), status)
  call check(status == sfdae_ok, "none any more")
  call solver%start(0.0_dp, 3.0_dp, x, status)
  call solver%get_sensitivity_statistics(statistics, status)
  call check(status == sfdae_ok .and. statistics%count == 0, "no statistics")
  call solver%destroy(status)
  call finish()

contains

  pure logical function near(a, b, tolerance)
    real(dp), intent(in) :: a
    real(dp), intent(in) :: b
    real(dp), intent(in) :: tolerance

    near = abs(a - b) <= tolerance
  end function near
end program sensitivities_test
