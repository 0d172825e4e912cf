! SPDX-License-Identifier: BSD-3-Clause
!
! A pendulum of length and mass 1 in Cartesian coordinates, 2 x5 the force in the rod:
!
!     x1' = x3,  x2' = x4,  x3' = -2 x1 x5,  x4' = -2 x2 x5 - g,  0 = x1^2 + x2^2 - 1
!
! Strangeness index 2 (differentiation index 3), d = 2, a = 3. The energy is an invariant.
module pendulum_problem
  use, intrinsic :: iso_c_binding, only: dp => c_double
  use sfdae
  implicit none
  real(dp), parameter :: g = 9.81_dp
  type, extends(nonlinear_dae) :: pendulum_dae
  contains
    procedure :: equations
  end type pendulum_dae
contains
  subroutine equations(self, t, x, xdot, residual)
    class(pendulum_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)
    residual(1:2) = xdot(1:2) - x(3:4)
    residual(3:4) = xdot(3:4) + 2 * x(1:2) * x(5) + [0.0_dp, g]
    residual(5) = x(1)**2 + x(2)**2 - 1
  end subroutine equations
end module pendulum_problem

program pendulum
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_options, dae_solver, sfdae_characteristics, sfdae_method_radau
  use pendulum_problem, only: g, pendulum_dae
  implicit none
  type(pendulum_dae), target :: problem = pendulum_dae(num_equations=5, num_unknowns=5)
  type(dae_options) :: options
  type(dae_solver) :: solver
  type(sfdae_characteristics) :: c
  real(dp) :: t, x(5) = [0.6_dp, -0.8_dp, 0.0_dp, 0.0_dp, 0.0_dp], energy
  integer(c_int) :: status
  integer :: k
  options = dae_options(rtol=1.0e-9_dp, atol=1.0e-9_dp, method=sfdae_method_radau)
  call solver%create(problem, status, options)
  if (status >= 0) call solver%start(0.0_dp, 10.0_dp, x, status)
  do k = 1, 10
    if (status >= 0) call solver%advance(1.0_dp * k, t, x, status)
    if (status < 0) print '(a)', solver%message()
    if (status < 0) error stop "failed"
    energy = sum(x(3:4)**2) / 2 + g * (x(2) + 0.8_dp)
    print '(a,f5.1,a,2f10.6,a,es8.1)', "t =", t, "   position", x(1:2), "   error of energy", energy
    if (.not. abs(energy) < 1.0e-6_dp) error stop "wrong energy"
    if (.not. abs(sum(x(1:2)**2) - 1) < 1.0e-12_dp) error stop "wrong length"
  end do
  call solver%get_characteristics(c, status)
  if (c%strangeness_index /= 2 .or. c%differential /= 2) error stop "wrong index"
  call solver%destroy()
end program pendulum
