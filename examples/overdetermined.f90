! SPDX-License-Identifier: BSD-3-Clause
!
! More equations than unknowns: a reaction together with its conservation law, k = 1 + sin(t) / 2.
!
!     x1' = -k x1,   x2' = k x1,   0 = x1 + x2 - 1 - leak t
!
! leak = 0: the derivative of the law follows from the other equations. mu = 1, d = 1, a = 1,
! v = 1, and x1 = x1(0) exp(-t - (1 - cos t) / 2), x2 = 1 - x1; the law holds to rounding.
! leak /= 0: the equations contradict each other, there is no solution, and the solver says so.
module overdetermined_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: linear_dae
  implicit none
  type, extends(linear_dae) :: reaction
    real(dp) :: leak = 0
  contains
    procedure :: eval_e, eval_a, eval_f
  end type reaction
contains
  subroutine eval_e(self, t, order, e, status)
    class(reaction), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order ! constant: only order 0 is asked for
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status
    e(1, 1) = 1
    e(2, 2) = 1
  end subroutine eval_e
  subroutine eval_a(self, t, order, a, status)
    class(reaction), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status
    a(1:2, 1) = [-1, 1] * (merge(1, 0, order == 0) + sin(t + order * acos(0.0_dp)) / 2)
    if (order == 0) a(3, :) = 1
  end subroutine eval_a
  subroutine eval_f(self, t, order, f, status)
    class(reaction), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status
    if (order == 0) f(3) = -1 - self%leak * t
    if (order == 1) f(3) = -self%leak
  end subroutine eval_f
end module overdetermined_problem

program overdetermined
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver, sfdae_inconsistent_equations
  use overdetermined_problem, only: reaction
  implicit none
  type(reaction), target :: problem = &
    reaction(num_equations=3, num_unknowns=2, constant_e=.true.)
  type(dae_solver) :: solver
  real(dp) :: t, x(2), error
  integer(c_int) :: status
  integer :: k
  call solver%create(problem, status)
  x = [0.9_dp, 0.1_dp]
  if (status >= 0) call solver%start(0.0_dp, 3.0_dp, x, status)
  print '(a)', "   t       x1          x2      x1+x2-1   error/tolerance"
  do k = 1, 3
    if (status >= 0) call solver%advance(1.0_dp * k, t, x, status)
    if (status < 0) print '(a)', solver%message()
    if (status < 0) error stop "failed"
    error = abs(x(1) - 0.9_dp * exp(-t - (1 - cos(t)) / 2)) / (1.0e-6_dp * (1 + x(1)))
    print '(f5.1,2f12.8,es10.1,f10.2)', t, x, sum(x) - 1, error
    if (error > 10 .or. abs(sum(x) - 1) > 1.0e-14_dp) error stop "wrong"
  end do
  problem%leak = 0.1_dp
  call solver%start(0.0_dp, 3.0_dp, x, status)
  print '(2a)', "with a leak: ", solver%message()
  if (status /= sfdae_inconsistent_equations) error stop "the contradiction went unnoticed"
  call solver%destroy()
end program overdetermined
