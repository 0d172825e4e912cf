! SPDX-License-Identifier: BSD-3-Clause
!
! The first example of GELDA's documentation (Kunkel, Mehrmann, Rath, Weickert, 1995), for any t:
!
!     0           = -x1 + t x2 + e^-t
!     x1' - t x2' = 0                         exact solution  x1 = (1 + t) e^-t,  x2 = e^-t
!
! Strangeness index 1, d = 0, a = 2: initial values cannot be chosen. The solution is unique
! although the matrix pencil (E(t), A(t)) is singular for every t.
module gelda_document_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: linear_dae
  implicit none
  type, extends(linear_dae) :: document_dae
  contains
    procedure :: eval_e, eval_a, eval_f
  end type document_dae
contains
  subroutine eval_e(self, t, order, e, status)
    class(document_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status
    if (order == 0) e(2, :) = [1.0_dp, -t]
    if (order == 1) e(2, 2) = -1
  end subroutine eval_e
  subroutine eval_a(self, t, order, a, status)
    class(document_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status
    if (order == 0) a(1, :) = [-1.0_dp, t]
    if (order == 1) a(1, 2) = 1
  end subroutine eval_a
  subroutine eval_f(self, t, order, f, status)
    class(document_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status
    f(1) = (-1)**order * exp(-t)
  end subroutine eval_f
end module gelda_document_problem

program gelda_document
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver, sfdae_characteristics, sfdae_ok
  use gelda_document_problem, only: document_dae
  implicit none
  type(document_dae), target :: problem = document_dae(num_equations=2, num_unknowns=2)
  type(dae_solver) :: solver
  type(sfdae_characteristics) :: c
  real(dp) :: t, x(2), error
  integer(c_int) :: status
  integer :: k
  call solver%create(problem, status)
  if (status >= 0) call solver%analyze(0.0_dp, 2.0_dp, status, c)
  print '(3(a,i0))', "mu = ", c%strangeness_index, ", d = ", c%differential, ", a = ", c%algebraic
  x = [5, -3] ! anything: the start finds the consistent values
  if (status >= 0) call solver%start(0.0_dp, 2.0_dp, x, status)
  do k = 1, 4
    if (status >= 0) call solver%advance(0.5_dp * k, t, x, status)
    if (status /= sfdae_ok) print '(a)', solver%message()
    if (status /= sfdae_ok) error stop "failed"
    error = maxval(abs(x - [1 + t, 1.0_dp] * exp(-t)))
    print '(a,f4.1,a,2f13.9,a,es8.1)', "t =", t, "   x =", x, "   error", error
    if (error > 1.0e-12_dp) error stop "wrong"
  end do
  call solver%destroy()
end program gelda_document
