! SPDX-License-Identifier: BSD-3-Clause
! Which torques u move the hand of a robot arm with two links and an elastic joint along a path?
!
!     x1' = v1,  x2' = v2,  x3' = v3
!     v1' = 2 c (v1+v3)^2 + d v1^2 + (2 x3 - x2)(a + 2 b) + a (u1 - u2)
!     v2' = -2 c (v1+v3)^2 - d v1^2 + (2 x3 - x2)(1 - 3 a - 2 b) - a u1 + (a + 1) u2
!     v3' = -2 c (v1+v3)^2 - d v1^2 + (2 x3 - x2)(a - 9 b) - 2 c v1^2 - d (v1+v3)^2 - (a+b)(u1 - u2)
!     cos x1 + cos(x1+x3) = cos(1 - e^t) + cos(1 - t),  the same with sines
!     a = 2 / (2 - cos^2 x3),  b = a/2 cos x3,  c = a/2 sin x3,  d = c cos x3
!
! Strangeness index 4, d = 0, a = 8; x1 = 1 - e^t, x3 = e^t - t. De Luca, Isidori (1987).
module robot_arm_problem
  use sfdae
  implicit none
  type, extends(nonlinear_dae) :: robot_arm_dae
  contains
    procedure :: equations
  end type robot_arm_dae
contains
  subroutine equations(self, t, x, xdot, residual)
    class(robot_arm_dae), intent(inout) :: self
    type(expression), intent(in) :: t, x(:), xdot(:)
    type(expression), intent(inout) :: residual(:)
    type(expression) :: a, b, c, d, first, both, spring
    a = 2 / (2 - cos(x(3))**2)
    b = a / 2 * cos(x(3)); c = a / 2 * sin(x(3)); d = c * cos(x(3))
    first = x(4)**2; both = (x(4) + x(6))**2
    spring = 2 * x(3) - x(2)
    associate (u1 => x(7), u2 => x(8), r => residual)
      r(1:3) = xdot(1:3) - x(4:6)
      r(4) = xdot(4) - (2 * c * both + d * first + spring * (a + 2 * b) + a * (u1 - u2))
      r(5) = xdot(5) + 2 * c * both + d * first - spring * (1 - 3 * a - 2 * b) + a * u1 &
        - (a + 1) * u2
      r(6) = xdot(6) + 2 * c * both + d * first - spring * (a - 9 * b) + 2 * c * first + d * both &
        + (a + b) * (u1 - u2)
      r(7) = cos(x(1)) + cos(x(1) + x(3)) - cos(1 - exp(t)) - cos(1 - t)
      r(8) = sin(x(1)) + sin(x(1) + x(3)) - sin(1 - exp(t)) - sin(1 - t)
    end associate
  end subroutine equations
end module robot_arm_problem

program robot_arm
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver
  use robot_arm_problem, only: robot_arm_dae
  implicit none
  type(robot_arm_dae), target :: problem = robot_arm_dae(num_equations=8, num_unknowns=8)
  type(dae_solver) :: solver
  real(dp) :: t, x(8) = [0, 1, 1, 0, 0, 0, 0, 0], error ! roughly: start finds consistent values
  integer(c_int) :: status
  call solver%create(problem, status)
  if (status >= 0) call solver%start(0.0_dp, 1.0_dp, x, status)
  if (status >= 0) call solver%advance(1.0_dp, t, x, status)
  if (status < 0) print '(a)', solver%message()
  if (status < 0) error stop "failed"
  error = maxval(abs(x([1, 3, 4, 6]) - [1 - exp(t), exp(t) - t, -exp(t), exp(t) - 1]))
  print '(a,2f12.8,a,es8.1)', "torques", x(7:8), "   error", error
  if (.not. error < 1.0e-11_dp) error stop "wrong"
  call solver%destroy()
end program robot_arm
