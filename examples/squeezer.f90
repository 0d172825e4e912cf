! SPDX-License-Identifier: BSD-3-Clause
!
! Andrews' squeezing mechanism, seven bodies in a plane with six constraints, from recorded formulas:
!
!     M(q) v' = f(q, v) - g_q(q)**T lambda,   0 = g(q),   q = (beta, theta, gamma, phi, delta, omega, epsilon)
!
! W. Schiehlen (ed.): Multibody Systems Handbook. Springer, 1990; data and reference values: IVP test set.
module squeezer_problem
  use, intrinsic :: iso_c_binding, only: dp => c_double
  use sfdae
  implicit none
  real(dp), parameter :: m1 = .04325_dp, m2 = .00365_dp, m3 = .02373_dp, m4 = .00706_dp, m5 = .0705_dp, &
    m6 = .00706_dp, m7 = .05498_dp, i1 = 2.194e-6_dp, i2 = 4.41e-7_dp, i3 = 5.255e-6_dp, &
    i4 = 5.667e-7_dp, i5 = 1.169e-5_dp, i6 = 5.667e-7_dp, i7 = 1.912e-5_dp, xa = -.06934_dp, &
    ya = -.00227_dp, xb = -.03635_dp, yb = .03273_dp, xc = .014_dp, yc = .072_dp, c0 = 4530.0_dp, &
    l0 = .07785_dp, motor = .033_dp, d = .028_dp, da = .0115_dp, e = .02_dp, ra = .00092_dp, &
    rr = .007_dp, ss = .035_dp, sa = .01874_dp, sb = .01043_dp, sc = .018_dp, sd = .02_dp, &
    ta = .02308_dp, tb = .00916_dp, u = .04_dp, ua = .01228_dp, ub = .00449_dp, zf = .02_dp, &
    zt = .04_dp, ee = .00579_dp, zz = .00579_dp
  type, extends(recorded_multibody_dae) :: squeezer_dae
  contains
    procedure :: equations
  end type squeezer_dae
contains
  subroutine equations(self, t, q, v, to)
    class(squeezer_dae), intent(inout) :: self
    type(expression), intent(in) :: t, q(:), v(:)
    type(multibody_formulas), intent(in) :: to
    type(expression) :: x, y, s, c, spring
    associate (m => to%mass, f => to%forces, g => to%constraints)
      m(1, 1) = m1 * ra**2 + m2 * (rr**2 + da**2) + i1 + i2 - 2 * m2 * da * rr * cos(q(2))
      m(2, 1) = m2 * da**2 + i2 - m2 * da * rr * cos(q(2))
      m(2, 2) = m2 * da**2 + i2
      m(3, 3) = m3 * (sa**2 + sb**2) + i3
      m(4, 4) = m4 * ee**2 + i4
      m(5, 4) = m4 * ee**2 + i4 + m4 * zt * ee * sin(q(4))
      m(5, 5) = m4 * (zt**2 + ee**2) + m5 * (ta**2 + tb**2) + i4 + i5 + 2 * m4 * zt * ee * sin(q(4))
      m(6, 6) = m6 * zz**2 + i6
      m(7, 6) = m6 * zz**2 + i6 - m6 * u * zz * sin(q(6))
      m(7, 7) = m6 * (zz**2 + u**2) + m7 * (ua**2 + ub**2) + i6 + i7 - 2 * m6 * u * zz * sin(q(6))
      m(1, 2) = m(2, 1); m(4, 5) = m(5, 4); m(6, 7) = m(7, 6)
      s = sin(q(3)); c = cos(q(3)); x = sd * c + sc * s + (xb - xc); y = sd * s - sc * c + (yb - yc)
      spring = c0 * (l0 / sqrt(x**2 + y**2) - 1)
      f(1) = motor - m2 * da * rr * v(2) * (v(2) + 2 * v(1)) * sin(q(2))
      f(2) = m2 * da * rr * v(1)**2 * sin(q(2))
      f(3) = spring * (x * (sc * c - sd * s) + y * (sd * c + sc * s))
      f(4) = m4 * zt * ee * v(5)**2 * cos(q(4))
      f(5) = -m4 * zt * ee * v(4) * (v(4) + 2 * v(5)) * cos(q(4))
      f(6) = -m6 * u * zz * v(7)**2 * cos(q(6))
      f(7) = m6 * u * zz * v(6) * (v(6) + 2 * v(7)) * cos(q(6))
      x = rr * cos(q(1)) - d * cos(q(1) + q(2)); y = rr * sin(q(1)) - d * sin(q(1) + q(2))
      g(1) = x - ss * s - xb
      g(2) = y + ss * c - yb
      g(3) = x - e * sin(q(4) + q(5)) - zt * cos(q(5)) - xa
      g(4) = y + e * cos(q(4) + q(5)) - zt * sin(q(5)) - ya
      g(5) = x - zf * cos(q(6) + q(7)) - u * sin(q(7)) - xa
      g(6) = y - zf * sin(q(6) + q(7)) + u * cos(q(7)) - ya
    end associate
  end subroutine equations
end module squeezer_problem

program squeezer
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_options, dae_solver, sfdae_method_radau, sfdae_multibody_report
  use squeezer_problem, only: squeezer_dae
  implicit none
  type(squeezer_dae), target :: problem = squeezer_dae(num_positions=7, num_constraints=6)
  type(dae_options) :: options
  type(dae_solver) :: solver
  type(sfdae_multibody_report) :: report
  real(dp) :: t, x(20) = 0, error
  real(dp), parameter :: at_start(7) = [-0.0617138900142764496_dp, 0.0_dp, 0.455279819163070380_dp, &
    0.222668390165885885_dp, 0.487364979543842550_dp, -0.222668390165885885_dp, 1.23054744454982119_dp]
  real(dp), parameter :: at_end(7) = [15.8107711951537071_dp, -15.7563710584118394_dp, &
    0.0408222401196458049_dp, -0.534730116342079594_dp, 0.524409965879954069_dp, &
    0.534730116342079594_dp, 1.04808074104193787_dp]
  integer(c_int) :: status
  options = dae_options(rtol=1.0e-9_dp, atol=1.0e-9_dp, method=sfdae_method_radau)
  x(1:7) = at_start
  call solver%create(problem, status, options)
  if (status >= 0) call solver%start(0.0_dp, 0.03_dp, x, status)
  if (status >= 0) call solver%advance(0.03_dp, t, x, status)
  if (status < 0) print '(a)', solver%message()
  if (status < 0) error stop "failed"
  call solver%get_multibody_report(report, status)
  error = maxval(abs(x(1:7) - at_end))
  print '(a,7f10.6)', "angles", x(1:7)
  print '(a,es8.1,a,i0)', "error ", error, "   degrees of freedom ", report%degrees_of_freedom
  if (.not. error < 1.0e-6_dp .or. report%degrees_of_freedom /= 1) error stop "wrong"
  call solver%destroy()
end program squeezer
