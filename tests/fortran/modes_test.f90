! SPDX-License-Identifier: BSD-3-Clause
!
! Jumps, impacts and breakpoints from Fortran.
module switched_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: expression, multibody_formulas, nonlinear_dae, recorded_multibody_dae, &
    assignment(=), operator(+), operator(-), operator(*), linear_dae
  implicit none
  private

  !> Two capacitors, 1 and 3 F, connected: x1' + x1 + x3 = 0, 3 x2' - x3 = 0, x1 = x2.
  type, extends(nonlinear_dae), public :: capacitors_dae
  contains
    procedure :: equations => capacitors_equations
  end type capacitors_dae

  !> A mass of 2 at a wall, q = 0.
  type, extends(recorded_multibody_dae), public :: wall_dae
  contains
    procedure :: equations => wall_equations
  end type wall_dae

  !> x1' = x2, 0 = x1 - s(t) with the step s from 0 to 1 at t = 1/2: x2 has an impulse there.
  type, extends(linear_dae), public :: step_dae
  contains
    procedure :: eval_e => step_e
    procedure :: eval_a => step_a
    procedure :: eval_f => step_f
  end type step_dae

contains

  subroutine capacitors_equations(self, t, x, xdot, residual)
    class(capacitors_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) + x(1) + x(3)
    residual(2) = 3 * xdot(2) - x(3)
    residual(3) = x(1) - x(2)
  end subroutine capacitors_equations

  subroutine wall_equations(self, t, q, v, to)
    class(wall_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: q(:)
    type(expression), intent(in) :: v(:)
    type(multibody_formulas), intent(in) :: to

    to%mass(1, 1) = 2
    to%constraints(1) = q(1)
  end subroutine wall_equations

  subroutine step_e(self, t, order, e, status)
    class(step_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) e(1, 1) = 1
  end subroutine step_e

  subroutine step_a(self, t, order, a, status)
    class(step_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) then
      a(1, 2) = 1
      a(2, 1) = 1
    end if
  end subroutine step_a

  subroutine step_f(self, t, order, f, status)
    class(step_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status

    if (order == 0 .and. t >= 0.5_dp) f(2) = -1
  end subroutine step_f

end module switched_problems

program modes_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver, sfdae_breakpoint_jump, sfdae_illegal_argument, sfdae_not_started, &
    sfdae_ok
  use switched_problems, only: capacitors_dae, step_dae, wall_dae
  use test_support, only: check, check_status, finish
  implicit none

  call keeps_charge()
  call reverses_velocities()
  call crosses_jumps()
  call finish()

contains

  subroutine keeps_charge()
    type(capacitors_dae), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: after(3), impulses(3, 2), short(2)

    problem%num_equations = 3
    problem%num_unknowns = 3
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    call solver%jump(0.0_dp, 1.0_dp, [2.0_dp, 0.0_dp, 0.0_dp], after, status, impulses)
    call check_status(status, sfdae_ok, "jump")
    call check(maxval(abs(after(1:2) - 0.5_dp)) < 1.0e-12_dp, "the charge is kept")
    call check(abs(impulses(3, 1) - 1.5_dp) < 1.0e-12_dp, "the charge that flows")
    call check(all(abs(impulses(:, 2)) <= 0), "no derivative of delta")
    call solver%jump(0.0_dp, 1.0_dp, [2.0_dp, 0.0_dp], after, status)
    call check_status(status, sfdae_illegal_argument, "before too short")
    call solver%jump(0.0_dp, 1.0_dp, [2.0_dp, 0.0_dp, 0.0_dp], short, status)
    call check_status(status, sfdae_illegal_argument, "after too short")
    call solver%impact(0.0_dp, [2.0_dp, 0.0_dp, 0.0_dp], after, status)
    call check_status(status, sfdae_illegal_argument, "no mechanical system")
    call solver%destroy(status)
  end subroutine keeps_charge

  subroutine reverses_velocities()
    type(wall_dae), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: after(3), impulse(1)

    problem%num_positions = 1
    problem%num_constraints = 1
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    call solver%impact(0.0_dp, [0.0_dp, -3.0_dp, 0.0_dp], after, status, [0.5_dp], impulse)
    call check_status(status, sfdae_ok, "impact")
    call check(abs(after(2) - 1.5_dp) < 1.0e-12_dp, "half of the velocity")
    call check(abs(impulse(1) + 9.0_dp) < 1.0e-12_dp, "the impulse")
    call solver%impact(0.0_dp, [0.0_dp, -3.0_dp, 0.0_dp], after, status, [0.5_dp, 0.5_dp])
    call check_status(status, sfdae_illegal_argument, "restitution too long")
    call solver%destroy(status)
  end subroutine reverses_velocities

  subroutine crosses_jumps()
    type(step_dae), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(2), before(2), after(2), impulse(2)

    problem%num_equations = 2
    problem%num_unknowns = 2
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    call solver%set_breakpoints([0.5_dp], status, [sfdae_breakpoint_jump, sfdae_breakpoint_jump])
    call check_status(status, sfdae_illegal_argument, "too many kinds")
    call solver%set_breakpoints([0.5_dp, 0.5_dp], status)
    call check_status(status, sfdae_illegal_argument, "the same time twice")
    call solver%set_breakpoints([0.5_dp], status, [sfdae_breakpoint_jump])
    call check_status(status, sfdae_ok, "set_breakpoints")
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%get_jump(t, before, after, status)
    call check_status(status, sfdae_not_started, "no jump yet")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check(maxval(abs(x - [1.0_dp, 0.0_dp])) < 1.0e-9_dp, "the solution after it")
    call solver%get_jump(t, before, after, status, impulse)
    call check_status(status, sfdae_ok, "get_jump")
    call check(abs(t - 0.5_dp) < 1.0e-12_dp, "its time")
    call check(abs(before(1)) < 1.0e-12_dp .and. abs(after(1) - 1) < 1.0e-12_dp, "its values")
    call check(abs(impulse(2) - 1) < 1.0e-9_dp, "its impulse")
    call solver%destroy(status)
  end subroutine crosses_jumps

end program modes_test
