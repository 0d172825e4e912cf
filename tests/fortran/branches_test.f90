! SPDX-License-Identifier: BSD-3-Clause
!
! Singular points from Fortran: what they are, and one that is passed.
module branching_problems
  use, intrinsic :: iso_c_binding, only: c_int
  use sfdae, only: expression, nonlinear_dae, assignment(=), operator(+), operator(-), operator(*)
  implicit none
  private

  !> x1' = x2, x1^2 + x2^2 = 1: sin t, cos t; at pi/2 another solution begins, x1 = 1.
  type, extends(nonlinear_dae), public :: circle_dae
  contains
    procedure :: equations => circle_equations
  end type circle_dae

  !> x1' = -1, x2^2 = x1: x2 = sqrt(1 - t) ends at t = 1.
  type, extends(nonlinear_dae), public :: fold_dae
  contains
    procedure :: equations => fold_equations
  end type fold_dae

contains

  subroutine circle_equations(self, t, x, xdot, residual)
    class(circle_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) - x(2)
    residual(2) = x(1) * x(1) + x(2) * x(2) - 1
  end subroutine circle_equations

  subroutine fold_equations(self, t, x, xdot, residual)
    class(fold_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) + 1
    residual(2) = x(2) * x(2) - x(1)
  end subroutine fold_equations

end module branching_problems

program branches_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver, sfdae_characteristics_changed, sfdae_illegal_argument, &
    sfdae_not_started, sfdae_ok, sfdae_part_differential, sfdae_singular_crossing, &
    sfdae_singular_fold, sfdae_singular_point
  use branching_problems, only: circle_dae, fold_dae
  use test_support, only: check, check_status, finish
  implicit none

  call passes_crossings()
  call ends_at_folds()
  call finish()

contains

  subroutine passes_crossings()
    type(circle_dae), target :: problem
    type(dae_solver) :: solver
    type(sfdae_singular_point) :: point
    integer(c_int) :: status
    real(dp) :: t, x(2)

    problem%num_equations = 2
    problem%num_unknowns = 2
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    x = [0.0_dp, 1.0_dp]
    call solver%start(0.0_dp, 3.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%get_singular_point(point, status)
    call check_status(status, sfdae_not_started, "no singular point yet")
    call solver%pass_singular_points(-1, status)
    call check_status(status, sfdae_illegal_argument, "less than none")
    call solver%pass_singular_points(1, status)
    call check_status(status, sfdae_ok, "pass_singular_points")
    call solver%advance(3.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check(maxval(abs(x - [sin(3.0_dp), cos(3.0_dp)])) < 1.0e-3_dp, "the smooth branch")
    call solver%get_singular_point(point, status)
    call check_status(status, sfdae_ok, "get_singular_point")
    call check(point%kind == sfdae_singular_crossing .and. point%passed == 1, "a crossing")
    call check(point%component == 0 .and. point%count == 1, "the only one")
    call check(abs(point%t - 0.5_dp * acos(-1.0_dp)) < 1.0e-3_dp, "its time")
    call solver%destroy(status)
  end subroutine passes_crossings

  subroutine ends_at_folds()
    type(fold_dae), target :: problem
    type(dae_solver) :: solver
    type(sfdae_singular_point) :: point
    integer(c_int) :: status
    real(dp) :: t, x(2)

    problem%num_equations = 2
    problem%num_unknowns = 2
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    x = 1
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%pass_singular_points(5, status)
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_characteristics_changed, "advance")
    call solver%get_singular_point(point, status)
    call check_status(status, sfdae_ok, "get_singular_point")
    call check(point%kind == sfdae_singular_fold, "a fold")
    call check(point%part == sfdae_part_differential, "of the differential part")
    call check(point%component == 2 .and. abs(point%exponent - 0.5_dp) < 0.1_dp, "a square root")
    call check(abs(point%t - 1) < 1.0e-3_dp .and. point%passed == 0, "the end")
    call solver%destroy(status)
  end subroutine ends_at_folds

end program branches_test
