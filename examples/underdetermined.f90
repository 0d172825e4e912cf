! SPDX-License-Identifier: BSD-3-Clause
!
! Fewer equations than unknowns: a cart with position p, velocity v and friction b, and a driving
! force F that no equation determines. mu = 0, d = 2, u = 1.
!
!     p' = v,   v' = -b v + F
!
! F is an input: prescribed as cos t. Then v = (b cos t + sin t) / (1 + b^2) + c e^(-b t) and
! b p = sin t - v + (b p + v at t = 0).
module underdetermined_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: linear_dae
  implicit none
  type, extends(linear_dae) :: cart
    real(dp) :: b = 0.5_dp
  contains
    procedure :: eval_e, eval_a, eval_prescribed
  end type cart
contains
  subroutine eval_e(self, t, order, e, status)
    class(cart), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order ! constant: only order 0 is asked for
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status
    e(1, 1) = 1
    e(2, 2) = 1
  end subroutine eval_e
  subroutine eval_a(self, t, order, a, status)
    class(cart), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status
    a(1, 2) = 1
    a(2, :) = [0.0_dp, -self%b, 1.0_dp]
  end subroutine eval_a
  subroutine eval_prescribed(self, t, values, status)
    class(cart), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(inout) :: values(:)
    integer(c_int), intent(inout) :: status
    values(1) = cos(t)
  end subroutine eval_prescribed
end module underdetermined_problem

program underdetermined
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver
  use underdetermined_problem, only: cart
  implicit none
  type(cart), target :: problem = cart(num_equations=2, num_unknowns=3, has_f=.false., &
    constant_e=.true., constant_a=.true.)
  type(dae_solver) :: solver
  real(dp) :: t, x(3), exact(3), error
  integer(c_int) :: status
  integer :: k
  problem%prescribed = [3] ! F is the third unknown
  call solver%create(problem, status)
  x = [0, 1, 0] ! p = 0, v = 1; F(0) is corrected to 1
  if (status >= 0) call solver%start(0.0_dp, 5.0_dp, x, status)
  print '(a)', "   t       p           v           F    error/tolerance"
  do k = 0, 5
    if (status >= 0) call solver%advance(1.0_dp * k, t, x, status)
    if (status < 0) print '(a)', solver%message()
    if (status < 0) error stop "failed"
    exact(3) = cos(t)
    associate (b => problem%b)
      exact(2) = (b * cos(t) + sin(t) + (1 - b + b**2) * exp(-b * t)) / (1 + b**2)
      exact(1) = (sin(t) - exact(2) + 1) / b
    end associate
    error = maxval(abs(x - exact) / (1.0e-6_dp * (1 + abs(exact))))
    print '(f5.1,3f12.8,f10.2)', t, x, error
    if (error > 10) error stop "wrong"
  end do
  call solver%destroy()
end program underdetermined
