! SPDX-License-Identifier: BSD-3-Clause
!
! Gear and Petzold's example (1984), with a parameter eta:
!
!     0 = -x1 - eta t x2 + e^-t,   x1' + eta t x2' = -(1 + eta) x2
!
! Strangeness index 1, d = 0, a = 2 for every eta: row 1, differentiated, and row 2 give x2 = e^-t,
! hence x1 = (1 - eta t) e^-t. Implicit Euler on the equations as they stand is unstable for
! eta < -1/2; the solver integrates the strangeness-free system instead and does not mind.
module gear_petzold_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: linear_dae
  implicit none
  type, extends(linear_dae) :: gear_petzold_dae
    real(dp) :: eta = 0
  contains
    procedure :: eval_e, eval_a, eval_f
  end type gear_petzold_dae
contains
  subroutine eval_e(self, t, order, e, status)
    class(gear_petzold_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status
    if (order == 0) e(2, :) = [1.0_dp, self%eta * t]
    if (order == 1) e(2, 2) = self%eta
  end subroutine eval_e
  subroutine eval_a(self, t, order, a, status)
    class(gear_petzold_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status
    if (order == 0) a(1, :) = [-1.0_dp, -self%eta * t]
    if (order == 0) a(2, 2) = -1 - self%eta
    if (order == 1) a(1, 2) = -self%eta
  end subroutine eval_a
  subroutine eval_f(self, t, order, f, status)
    class(gear_petzold_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status
    f(1) = (-1)**order * exp(-t)
  end subroutine eval_f
end module gear_petzold_problem

program gear_petzold
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver, sfdae_characteristics
  use gear_petzold_problem, only: gear_petzold_dae
  implicit none
  type(gear_petzold_dae), target :: problem = gear_petzold_dae(num_equations=2, num_unknowns=2)
  type(dae_solver) :: solver
  type(sfdae_characteristics) :: c
  real(dp) :: t, x(2), error
  integer(c_int) :: status
  integer :: k
  print '(a)', "   eta  mu  d  a      x1(3)        x2(3)     error"
  do k = -2, 2
    problem%eta = 1.5_dp * k
    x = 0
    call solver%create(problem, status)
    if (status >= 0) call solver%start(0.0_dp, 3.0_dp, x, status)
    if (status >= 0) call solver%advance(3.0_dp, t, x, status)
    if (status < 0) print '(a)', solver%message()
    if (status < 0) error stop "failed"
    call solver%get_characteristics(c, status)
    error = maxval(abs(x - [1 - problem%eta * t, 1.0_dp] * exp(-t)))
    print '(f6.1,i4,2i3,2f13.8,es10.1)', problem%eta, c%strangeness_index, c%differential, &
      c%algebraic, x, error
    if (error > 1.0e-12_dp .or. c%strangeness_index /= 1) error stop "wrong"
    call solver%destroy()
  end do
end program gear_petzold
