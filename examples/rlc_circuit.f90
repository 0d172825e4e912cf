! SPDX-License-Identifier: BSD-3-Clause
!
! Modified nodal analysis: a source sin t from node 1 to ground, a capacitor (1) parallel to it, and
! R, L, C (all 1) in series from node 1 by nodes 2 and 3 to ground. x = (e1, e2, e3, iL, iV):
!
!     e1' = e2 - e1 - iV,   0 = e1 - e2 - iL,   e3' = iL,   iL' = e2 - e3,   0 = sin t - e1
!
! The capacitor at the source makes iV depend on (sin t)': strangeness index 1, d = 2, a = 3.
! Check: e3 fulfils q'' + q' + q = sin t; from q = q' = 0 at t = 0, with w = sqrt(3) / 2,
!     q = -cos t + e^(-t/2) (cos w t + sin(w t) / (2 w)), iL = q', e2 = e1 - iL, iV = -cos t - iL.
module rlc_circuit_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: linear_dae
  implicit none
  type, extends(linear_dae) :: circuit
  contains
    procedure :: eval_e, eval_a, eval_f
  end type circuit
contains
  subroutine eval_e(self, t, order, e, status)
    class(circuit), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order ! constant: only order 0 is asked for
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status
    e(1, 1) = 1
    e(3, 3) = 1
    e(4, 4) = 1
  end subroutine eval_e
  subroutine eval_a(self, t, order, a, status)
    class(circuit), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status
    a(1, :) = [-1, 1, 0, 0, -1]
    a(2, :) = [1, -1, 0, -1, 0]
    a(3, :) = [0, 0, 0, 1, 0]
    a(4, :) = [0, 1, -1, 0, 0]
    a(5, :) = [-1, 0, 0, 0, 0]
  end subroutine eval_a
  subroutine eval_f(self, t, order, f, status)
    class(circuit), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status
    f(5) = sin(t + order * acos(0.0_dp))
  end subroutine eval_f
end module rlc_circuit_problem

program rlc_circuit
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_options, dae_solver, sfdae_initial_fixed
  use rlc_circuit_problem, only: circuit
  implicit none
  real(dp), parameter :: w = sqrt(0.75_dp)
  type(circuit), target :: problem = &
    circuit(num_equations=5, num_unknowns=5, constant_e=.true., constant_a=.true.)
  type(dae_options) :: options
  type(dae_solver) :: solver
  real(dp) :: t, x(5), q, i, error
  integer(c_int) :: status
  integer :: k
  options%initial_values = sfdae_initial_fixed
  options%fixed = [.false., .false., .true., .true., .false.] ! e3 and iL stay, the rest follows
  x = [9, 9, 0, 0, 9]
  call solver%create(problem, status, options)
  if (status >= 0) call solver%start(0.0_dp, 10.0_dp, x, status)
  print '(a)', "    t       e1         e2         e3         iL         iV    error/tolerance"
  do k = 0, 5
    if (status >= 0) call solver%advance(2.0_dp * k, t, x, status)
    if (status < 0) print '(a)', solver%message()
    if (status < 0) error stop "failed"
    q = -cos(t) + exp(-t / 2) * (cos(w * t) + sin(w * t) / (2 * w))
    i = sin(t) - exp(-t / 2) * sin(w * t) / w
    error = maxval(abs(x - [sin(t), sin(t) - i, q, i, -cos(t) - i]) / (1.0e-6_dp * (1 + abs(x))))
    print '(f6.1,5f11.6,f10.2)', t, x, error
    if (error > 10) error stop "wrong"
  end do
  call solver%destroy()
end program rlc_circuit
