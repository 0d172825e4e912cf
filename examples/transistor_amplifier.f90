! SPDX-License-Identifier: BSD-3-Clause
!
! A two-transistor amplifier as nodal analysis gives it, one equation for each of the nodes 1 ... 8,
! with the signal 0.1 V sin(200 pi t) at the input and 6 V supply. Currents into a node add up to 0:
!
!     node 1:  (U_in - u1) / R0 + C1 (u2 - u1)' = 0
!     node 2:  (6 - u2) / R - u2 / R + C1 (u1 - u2)' - 0.01 I(u2 - u3) = 0, and so on
!
! A transistor with the voltage u between base and emitter takes 0.01 I(u) from the base and
! 0.99 I(u) from the collector, I(u) = 1e-6 A (exp(u / 26 mV) - 1). Strangeness index 0, d = 5,
! a = 3. Reference values: test set for IVP solvers.
module amplifier_problem
  use, intrinsic :: iso_c_binding, only: dp => c_double
  use sfdae
  implicit none
  type, extends(nonlinear_dae) :: amplifier_dae
  contains
    procedure :: equations
  end type amplifier_dae
contains
  subroutine equations(self, t, x, xdot, residual)
    class(amplifier_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)
    integer, parameter :: from(3) = [1, 4, 7], base(2) = [2, 5]
    real(dp), parameter :: r0 = 1000, r = 9000, c(3) = [1.0e-6_dp, 3.0e-6_dp, 5.0e-6_dp]
    type(expression) :: current(2), charging(3)
    current = 1.0e-6_dp * (exp((x(base) - x(base + 1)) / 0.026_dp) - 1)
    charging = c * (xdot(from + 1) - xdot(from))
    residual(1) = (0.1_dp * sin(200 * acos(-1.0_dp) * t) - x(1)) / r0
    residual(2:8) = -x(2:8) / r ! resistors to the ground, and to the supply
    residual([2, 5]) = residual([2, 5]) + (6 - x([2, 5])) / r - 0.01_dp * current
    residual([4, 7]) = (6 - x([4, 7])) / r - 0.99_dp * current
    residual([3, 6]) = residual([3, 6]) + current - [2.0e-6_dp, 4.0e-6_dp] * xdot([3, 6])
    residual(from) = residual(from) + charging
    residual(from + 1) = residual(from + 1) - charging
  end subroutine equations
end module amplifier_problem

program transistor_amplifier
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver
  use amplifier_problem, only: amplifier_dae
  implicit none
  type(amplifier_dae), target :: problem = amplifier_dae(num_equations=8, num_unknowns=8)
  type(dae_solver) :: solver
  real(dp) :: t, u(8) = [0, 3, 3, 6, 3, 3, 6, 0], error
  integer(c_int) :: status
  call solver%create(problem, status)
  if (status >= 0) call solver%start(0.0_dp, 0.2_dp, u, status)
  if (status >= 0) call solver%advance(0.2_dp, t, u, status)
  if (status < 0) print '(a)', solver%message()
  if (status < 0) error stop "failed"
  error = maxval(abs(u(7:8) - [4.770927631616772_dp, 1.236995868091548_dp]))
  print '(a,2f10.6,a,es8.1)', "u7, u8 =", u(7:8), "   error", error
  if (.not. error < 1.0e-4_dp) error stop "wrong"
  call solver%destroy()
end program transistor_amplifier
