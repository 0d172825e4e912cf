! SPDX-License-Identifier: BSD-3-Clause
!
! bouncing_bead.c in Fortran: a bead on a wire y = x bounces off a stop at y = 0, with r = 0.8.
!
!     x' = u,   y' = v,   u' = -lambda,   v' = -g + lambda,   0 = y - x
!
! Strangeness index 2. Impact k is at T (1 + 2 r + ... + 2 r^(k-1)), T = 2 / sqrt(g), from rest at 1.
module bead_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_events, linear_dae
  implicit none
  real(dp), parameter :: g = 9.81_dp, r = 0.8_dp
  type, extends(linear_dae) :: bead_dae
  contains
    procedure :: eval_e, eval_a, eval_f
  end type bead_dae
  type, extends(dae_events) :: stop_events
  contains
    procedure :: eval_g
  end type stop_events
contains
  subroutine eval_e(self, t, order, e, status)
    class(bead_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status
    integer :: i
    if (order == 0) forall (i = 1:4) e(i, i) = 1
  end subroutine eval_e
  subroutine eval_a(self, t, order, a, status)
    class(bead_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status
    if (order > 0) return
    a(1, 3) = 1
    a(2, 4) = 1
    a(3:4, 5) = [-1, 1]
    a(5, 1:2) = [-1, 1]
  end subroutine eval_a
  subroutine eval_f(self, t, order, f, status)
    class(bead_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status
    if (order == 0) f(4) = -g
  end subroutine eval_f
  subroutine eval_g(self, t, x, xdot, g, status)
    class(stop_events), intent(inout) :: self
    real(dp), intent(in) :: t, x(:), xdot(:)
    real(dp), intent(inout) :: g(:)
    integer(c_int), intent(inout) :: status
    g(1) = x(2)
  end subroutine eval_g
end module bead_problem

program bouncing_bead
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_solver, sfdae_event, sfdae_ok
  use bead_problem, only: bead_dae, g, r, stop_events
  implicit none
  real(dp), parameter :: tend = 3
  type(bead_dae), target :: problem = bead_dae(num_equations=5, num_unknowns=5)
  type(stop_events), target :: stops = stop_events(num_events=1)
  type(dae_solver) :: solver
  real(dp) :: t, x(5), impact, flight, error
  integer(c_int) :: status
  stops%directions = [-1_c_int]
  x = [1, 1, 0, 0, 0]
  flight = 2 / sqrt(g)
  impact = flight
  error = 0
  call solver%create(problem, status)
  if (status >= 0) call solver%set_events(stops, status)
  if (status >= 0) call solver%start(0.0_dp, tend, x, status)
  do while (status >= 0)
    call solver%advance(tend, t, x, status)
    if (status /= sfdae_event) exit
    print '(a,f9.6,a,f10.6)', "impact at t = ", t, ", v = ", x(4)
    error = max(error, abs(t - impact), abs(x(2)))
    flight = r * flight
    impact = impact + 2 * flight
    x(3:4) = -r * x(3:4)
    call solver%start(t, tend, x, status)
  end do
  print '(a,es8.1)', solver%message() // "error", error
  call solver%destroy()
  if (status /= sfdae_ok .or. error > 1.0e-4_dp .or. impact <= tend) error stop "wrong"
end program bouncing_bead
