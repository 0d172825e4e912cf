! SPDX-License-Identifier: BSD-3-Clause
!
! x1' = x2,  0 = x1 - sin t;  index 2:  x1 = sin t,  x2 = cos t, exact up to rounding errors.
module sine_problem
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sfdae, only: linear_dae
  implicit none
  private

  type, extends(linear_dae), public :: sine_dae
  contains
    procedure :: eval_e
    procedure :: eval_a
    procedure :: eval_f
  end type sine_dae

contains

  subroutine eval_e(self, t, order, e, status)
    class(sine_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(c_double), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) e(1, 1) = 1
  end subroutine eval_e

  subroutine eval_a(self, t, order, a, status)
    class(sine_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(c_double), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) then
      a(1, 2) = 1
      a(2, 1) = 1
    end if
  end subroutine eval_a

  subroutine eval_f(self, t, order, f, status)
    class(sine_dae), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(c_double), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status

    f(2) = -sin(t + order*acos(0.0_c_double))
  end subroutine eval_f

end module sine_problem

program consumer
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use sfdae, only: dae_solver, sfdae_ok, sfdae_version
  use sine_problem, only: sine_dae
  implicit none
  type(sine_dae), target :: problem
  type(dae_solver) :: solver
  real(c_double) :: t, x(2), error
  integer(c_int) :: status

  problem%num_equations = 2
  problem%num_unknowns = 2
  t = 0
  x = 0
  call solver%create(problem, status)
  if (status == sfdae_ok) call solver%start(t, 2.0_c_double, x, status)
  if (status == sfdae_ok) call solver%advance(2.0_c_double, t, x, status)
  error = abs(x(1) - sin(t)) + abs(x(2) - cos(t))
  print '(*(g0, 1x))', 'sfdae', sfdae_version(), solver%message(), 't', t, 'error', error
  if (status /= sfdae_ok .or. t /= 2 .or. error > 1e-12_c_double) error stop 1
  call solver%destroy(status)
end program consumer
