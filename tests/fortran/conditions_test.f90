! SPDX-License-Identifier: BSD-3-Clause
!
! Conditions that procedures declare, from Fortran: a divider of two capacitors whose source steps
! where a clock unknown passes 1. Its exact solution has vm(2) = exp(-1/2) / 2.
module divider_problems
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sfdae, only: derivative_dae, linear_dae
  implicit none
  private

  !> Unknowns vs, vm, i, clock: i = vs' - vm' = vm' + vm, vs = 1 if clock > 1, else 0, clock' = 1.
  type, extends(linear_dae), public :: linear_divider
  contains
    procedure :: eval_e
    procedure :: eval_a
    procedure :: eval_f
    procedure :: eval_conditions => linear_conditions
  end type linear_divider

  !> The same by its residuals.
  type, extends(derivative_dae), public :: divider
  contains
    procedure :: total_derivative
    procedure :: eval_conditions => divider_conditions
  end type divider

contains

  subroutine eval_e(self, t, order, e, status)
    class(linear_divider), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(c_double), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => status) ! unused
    end associate
    if (order == 0) e(1, 1:2) = [-1, 1]
    if (order == 0) e(2, 1:2) = [1, -2]
    if (order == 0) e(4, 4) = 1
  end subroutine eval_e

  subroutine eval_a(self, t, order, a, status)
    class(linear_divider), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(c_double), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => status) ! unused
    end associate
    if (order > 0) return
    a(1, 3) = -1
    a(2, 2) = 1
    a(3, 1) = -1
  end subroutine eval_a

  subroutine eval_f(self, t, order, f, status)
    class(linear_divider), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(c_double), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status

    associate (u1 => t, u2 => status) ! unused
    end associate
    if (order > 0) return
    f(3) = self%branches(1)
    f(4) = 1
  end subroutine eval_f

  subroutine linear_conditions(self, t, x, xdot, g, status)
    class(linear_divider), intent(inout) :: self
    real(c_double), intent(in) :: t, x(:), xdot(:)
    real(c_double), intent(inout) :: g(:)
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => xdot, u4 => status) ! unused
    end associate
    g(1) = x(4) - 1
  end subroutine linear_conditions

  subroutine total_derivative(self, t, order, x, f, f_x, f_xdot, status)
    class(divider), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(c_double), intent(in) :: x(:, 0:)
    real(c_double), intent(inout) :: f(:)
    real(c_double), intent(inout), optional :: f_x(:, :), f_xdot(:, :)
    integer(c_int), intent(inout) :: status
    real(c_double) :: e(4, 4), a(4, 4)

    associate (u1 => t, u2 => status) ! unused
    end associate
    e = 0
    e(1, 1:2) = [-1, 1]
    e(2, 1:2) = [1, -2]
    e(4, 4) = 1
    a = 0
    a(1, 3) = -1
    a(2, 2) = 1
    a(3, 1) = -1
    f = matmul(e, x(:, order + 1)) - matmul(a, x(:, order))
    if (order == 0) f(3:4) = f(3:4) - [real(self%branches(1), c_double), 1.0_c_double]
    if (present(f_x) .and. order == 0) f_x = -a
    if (present(f_xdot) .and. order == 0) f_xdot = e
  end subroutine total_derivative

  subroutine divider_conditions(self, t, x, xdot, g, status)
    class(divider), intent(inout) :: self
    real(c_double), intent(in) :: t, x(:), xdot(:)
    real(c_double), intent(inout) :: g(:)
    integer(c_int), intent(inout) :: status

    associate (u1 => self, u2 => t, u3 => xdot, u4 => status) ! unused
    end associate
    g(1) = x(4) - 1
  end subroutine divider_conditions

end module divider_problems

program conditions_test
  use, intrinsic :: iso_c_binding, only: c_int, c_long, dp => c_double
  use divider_problems, only: divider, linear_divider
  use sfdae, only: dae_options, dae_solver, sfdae_conditions_events, sfdae_conditions_smooth, &
    sfdae_ok, sfdae_switch
  use sfdae_problems, only: any_dae
  use test_support, only: check, check_status, finish
  implicit none
  type(linear_divider), target :: linear
  type(divider), target :: nonlinear
  type(dae_options) :: options

  call check(options%conditions == sfdae_conditions_events, "events are the default")
  call check(sfdae_conditions_smooth /= sfdae_conditions_events, "there are others")
  linear%num_equations = 4
  linear%num_unknowns = 4
  linear%num_conditions = 1
  call run(linear)
  nonlinear%num_equations = 4
  nonlinear%num_unknowns = 4
  nonlinear%num_conditions = 1
  call run(nonlinear)
  call check(size(nonlinear%branches) == 1 .and. nonlinear%branches(1) == 1, "the last branch")
  call finish()

contains

  subroutine run(problem)
    class(any_dae), target, intent(inout) :: problem
    type(dae_solver) :: solver
    type(sfdae_switch) :: passed
    integer(c_int) :: status
    integer(c_long) :: count
    real(dp) :: t, x(4)

    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    x = 0
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check(abs(x(2) - 0.5_dp * exp(-0.5_dp)) < 1.0e-5_dp, "the divider")
    call solver%get_num_switches(count, status)
    call check(count == 1, "one switch")
    call solver%get_switch(1_c_long, passed, status)
    call check(abs(passed%t - 1) < 1.0e-6_dp .and. passed%jumps == 1, "its time and its jump")
    call solver%destroy(status)
  end subroutine run

end program conditions_test
