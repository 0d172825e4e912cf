! SPDX-License-Identifier: BSD-3-Clause
!
! Switches of conditions that an integration has passed, from Fortran.
module switching_problems
  use sfdae, only: choose, expression, nonlinear_dae, assignment(=), operator(<), operator(>), &
    operator(-)
  implicit none
  private

  !> x1' = 1 if x1 < 0.5, else 2; x2' = x3 and x2 = 3 where t > 0.75, else 0.
  type, extends(nonlinear_dae), public :: switching_dae
  contains
    procedure :: equations => switching_equations
  end type switching_dae

contains

  subroutine switching_equations(self, t, x, xdot, residual)
    class(switching_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) - choose(x(1) < 0.5d0, 1.0d0, 2.0d0)
    residual(2) = xdot(2) - x(3)
    residual(3) = x(2) - choose(t > 0.75d0, 3.0d0, 0.0d0)
  end subroutine switching_equations

end module switching_problems

program switches_test
  use, intrinsic :: iso_c_binding, only: c_int, c_long, dp => c_double
  use sfdae, only: dae_solver, sfdae_illegal_argument, sfdae_not_started, sfdae_ok, sfdae_switch
  use switching_problems, only: switching_dae
  use test_support, only: check, check_status, finish
  implicit none
  type(switching_dae), target :: problem
  type(dae_solver) :: solver
  type(sfdae_switch) :: passed
  character(len=:), allocatable :: condition
  integer(c_int) :: status
  integer(c_long) :: count
  real(dp) :: t, x(3)

  problem%num_equations = 3
  problem%num_unknowns = 3
  call solver%create(problem, status)
  call check_status(status, sfdae_ok, "create")
  count = -1
  call solver%get_num_switches(count, status)
  call check_status(status, sfdae_not_started, "no integration")
  x = 0
  call solver%start(0.0_dp, 1.0_dp, x, status)
  call check_status(status, sfdae_ok, "start")
  call solver%advance(1.0_dp, t, x, status)
  call check_status(status, sfdae_ok, "advance")
  call solver%get_num_switches(count, status)
  call check(count == 2, "two switches")
  call solver%get_switch(1_c_long, passed, status, condition)
  call check_status(status, sfdae_ok, "the first switch")
  call check(abs(passed%t - 0.5_dp) < 1.0e-4_dp .and. passed%jumps == 0, "its time")
  call check(passed%condition == 1, "its number")
  call check(condition == "0.5 - x[0] > 0", "its condition")
  call solver%get_switch(2_c_long, passed, status)
  call check_status(status, sfdae_ok, "the second switch")
  call check(abs(passed%t - 0.75_dp) < 1.0e-12_dp .and. passed%jumps == 1, "a jump")
  call check(passed%before < 0.5_dp .and. passed%after > 0.5_dp, "its branches")
  call solver%get_switch(3_c_long, passed, status)
  call check_status(status, sfdae_illegal_argument, "no third switch")
  call solver%get_switch(0_c_long, passed, status)
  call check_status(status, sfdae_illegal_argument, "switches count from 1")
  call solver%destroy(status)
  call finish()
end program switches_test
