! SPDX-License-Identifier: BSD-3-Clause
!> A linear problem whose E ignores the order of the derivative asked for:
!>
!>     x1' = -x1,   x2 = x1
module wrong_derivatives_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: linear_dae
  implicit none
  private

  public :: careless

  !> Its E is that of every order.
  type, extends(linear_dae) :: careless
  contains
    procedure :: eval_e
    procedure :: eval_a
  end type careless

contains

  !> diag(1, 0), whatever the order.
  subroutine eval_e(self, t, order, e, status)
    class(careless), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    e(1, 1) = 1
  end subroutine eval_e

  !> [-1 0; 1 -1]
  subroutine eval_a(self, t, order, a, status)
    class(careless), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order > 0) return
    a(1, 1) = -1
    a(2, 1) = 1
    a(2, 2) = -1
  end subroutine eval_a

end module wrong_derivatives_problem

!> The mistake is named; without the check it is not.
program wrong_derivatives_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use test_support, only: check, check_status, finish
  use sfdae, only: dae_options, dae_solver, sfdae_ok, sfdae_statistics, sfdae_wrong_derivatives
  use wrong_derivatives_problem, only: careless
  implicit none

  type(careless), target :: problem = careless(num_equations=2, num_unknowns=2)
  type(dae_solver) :: solver
  type(dae_options) :: options
  type(sfdae_statistics) :: statistics
  integer(c_int) :: status
  real(dp) :: x(2)

  call solver%create(problem, status)
  call check_status(status, sfdae_ok, "create")
  x = 1
  call solver%start(0.0_dp, 1.0_dp, x, status)
  call check_status(status, sfdae_wrong_derivatives, "start")
  call check(index(solver%message(), "derivative 1 of E contradicts") > 0, "message")
  options%check_derivatives = .false.
  call solver%set_options(options, status)
  call solver%start(0.0_dp, 1.0_dp, x, status)
  call check(status /= sfdae_wrong_derivatives, "start without the check")
  call solver%get_statistics(statistics, status)
  call check(statistics%check_calls > 0, "calls of the first start")
  call solver%destroy()
  call finish()
end program wrong_derivatives_test
