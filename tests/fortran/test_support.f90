! SPDX-License-Identifier: BSD-3-Clause
!
! What the Fortran tests share: checks, and small problems with known solutions.
module test_support
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use, intrinsic :: iso_fortran_env, only: error_unit
  use sfdae, only: dae_monitor, dae_solver, linear_dae, sfdae_ok, &
    sfdae_order_not_available, sfdae_progress
  implicit none
  private

  public :: check, check_close, check_status, finish, within
  public :: mixed_dae, gear_petzold_dae, crossing_dae, cart_dae, reaction_dae, free_dae, nested_dae
  public :: counting_monitor

  !> What mixed_dae does once t > fail_from.
  integer, parameter, public :: fail_never = 0, fail_status = 1, fail_nan = 2

  !> x1' = -x1 + x3,  x2' = w x3,  0 = -x2 + sin w t:  mu = 1, d = 1, a = 2,
  !> x2 = sin w t,  x3 = cos w t,  x1 = (cos w t + w sin w t) / (1 + w^2) + c e^-t.
  type, extends(linear_dae) :: mixed_dae
    real(dp) :: omega = 1
    !> fail_...
    integer :: failure = fail_never
    real(dp) :: fail_from = 0
    !> Status for fail_status.
    integer(c_int) :: status = 0
    !> Number of failures after which all is well again.
    integer :: fail_times = huge(1)
    !> Highest derivative of f that is available.
    integer(c_int) :: available = huge(1_c_int)
    !> Calls counted, by function.
    integer :: calls_e = 0, calls_a = 0, calls_f = 0
    !> Largest t seen by eval_f.
    real(dp) :: largest_t = -huge(1.0_dp)
    !> Called and destroyed from within eval_f, if associated; what came of it.
    type(dae_solver), pointer :: probed => null()
    integer(c_int) :: probe_status = sfdae_ok
    integer(c_int) :: destroy_status = sfdae_ok
  contains
    procedure :: eval_e => mixed_e
    procedure :: eval_a => mixed_a
    procedure :: eval_f => mixed_f
    procedure :: exact => mixed_exact
  end type mixed_dae

  !> x1 + eta t x2 = e^-t,  x1' + eta t x2' + (1 + eta) x2 = 0:  mu = 1, d = 0, a = 2,
  !> x1 = (1 - eta t) e^-t,  x2 = e^-t.
  type, extends(linear_dae) :: gear_petzold_dae
    real(dp) :: eta = -1
    !> Added to the derivative of A(1, 2): a mistake in the callback.
    real(dp) :: mistake = 0
  contains
    procedure :: eval_e => gear_petzold_e
    procedure :: eval_a => gear_petzold_a
    procedure :: eval_f => gear_petzold_f
  end type gear_petzold_dae

  !> x1' = -x1,  (t - 1/2) x2' = x2:  d = 2, but d = 1, a = 1 at t = 1/2.
  type, extends(linear_dae) :: crossing_dae
  contains
    procedure :: eval_e => crossing_e
    procedure :: eval_a => crossing_a
  end type crossing_dae

  !> x1' = x2,  x2' = -x2 + x3:  d = 2, u = 1; x3 can be prescribed, it is cos t then.
  type, extends(linear_dae) :: cart_dae
  contains
    procedure :: eval_e => cart_e
    procedure :: eval_a => cart_a
    procedure :: eval_prescribed => cart_prescribed
  end type cart_dae

  !> x1' = -x1,  x2' = x1,  0 = x1 + x2 - 1 - leak t:  v = 1; no solution if leak /= 0.
  type, extends(linear_dae) :: reaction_dae
    real(dp) :: leak = 0
  contains
    procedure :: eval_e => reaction_e
    procedure :: eval_a => reaction_a
    procedure :: eval_f => reaction_f
  end type reaction_dae

  !> x1' = x2, one equation: u = 1.
  type, extends(linear_dae) :: free_dae
  contains
    procedure :: eval_e => free_e
    procedure :: eval_a => free_a
  end type free_dae

  !> x' = sin t, which is the second component of a mixed_dae that is solved in every call.
  type, extends(linear_dae) :: nested_dae
  contains
    procedure :: eval_e => nested_e
    procedure :: eval_a => nested_a
    procedure :: eval_f => nested_f
  end type nested_dae

  !> Counts steps and stops after some.
  type, extends(dae_monitor) :: counting_monitor
    integer :: calls = 0
    integer :: stop_after = huge(1)
    real(dp) :: t = 0
    real(dp) :: x1 = 0
    integer :: num_unknowns = 0
    integer :: highest_order = 0
  contains
    procedure :: after_step => count_step
  end type counting_monitor

  integer :: failures = 0

contains

  !> Notes a failure unless the condition holds.
  subroutine check(condition, what)
    logical, intent(in) :: condition
    character(len=*), intent(in) :: what

    if (condition) return
    failures = failures + 1
    write (error_unit, '(2a)') "failed: ", what
  end subroutine check

  !> Checks a status.
  subroutine check_status(status, expected, what)
    integer(c_int), intent(in) :: status
    integer(c_int), intent(in) :: expected
    character(len=*), intent(in) :: what
    character(len=40) :: numbers

    write (numbers, '(a,i0,a,i0)') ": status ", status, " instead of ", expected
    call check(status == expected, what // trim(numbers))
  end subroutine check_status

  !> Checks that the error is at most ten times the tolerances.
  subroutine check_close(x, exact, rtol, atol, what)
    real(dp), intent(in) :: x(:)
    real(dp), intent(in) :: exact(:)
    real(dp), intent(in) :: rtol
    real(dp), intent(in) :: atol
    character(len=*), intent(in) :: what
    character(len=40) :: number
    real(dp) :: error

    error = maxval(abs(x - exact) / (rtol * abs(exact) + atol))
    write (number, '(a,es9.2,a)') ": error ", error, " tolerances"
    call check(error <= 10, what // trim(number))
  end subroutine check_close

  !> Whether a and b differ by at most some rounding errors of numbers of a size.
  elemental function within(a, b, size) result(close)
    real(dp), intent(in) :: a
    real(dp), intent(in) :: b
    real(dp), intent(in) :: size
    logical :: close

    close = abs(a - b) <= 100 * epsilon(1.0_dp) * size
  end function within

  !> Ends the test.
  subroutine finish()
    if (failures > 0) error stop "there were failures"
  end subroutine finish

  !> E = diag(1, 1, 0).
  subroutine mixed_e(self, t, order, e, status)
    class(mixed_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    self%calls_e = self%calls_e + 1
    if (any(abs(e) > 0)) status = -77 ! zero on entry
    if (order > 0) return
    e(1, 1) = 1
    e(2, 2) = 1
  end subroutine mixed_e

  !> A = [-1 0 1; 0 0 w; 0 -1 0].
  subroutine mixed_a(self, t, order, a, status)
    class(mixed_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    self%calls_a = self%calls_a + 1
    if (any(abs(a) > 0)) status = -77
    if (order > 0) return
    a(1, :) = [-1, 0, 1]
    a(2, 3) = self%omega
    a(3, 2) = -1
  end subroutine mixed_a

  !> f = (0, 0, sin w t), with accidents.
  recursive subroutine mixed_f(self, t, order, f, status)
    class(mixed_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status
    real(dp) :: x(3)

    self%calls_f = self%calls_f + 1
    self%largest_t = max(self%largest_t, t)
    f(3) = self%omega**order * sin(self%omega * t + order * acos(0.0_dp))
    if (order > self%available) status = sfdae_order_not_available
    if (associated(self%probed)) then
      x = 0
      call self%probed%make_consistent(t, x, self%probe_status)
      call self%probed%destroy(self%destroy_status)
    end if
    if (self%failure == fail_never .or. t <= self%fail_from .or. self%fail_times == 0) return
    self%fail_times = self%fail_times - 1
    if (self%failure == fail_status) status = self%status
    if (self%failure == fail_nan) f(3) = ieee_value(f(3), ieee_quiet_nan)
  end subroutine mixed_f

  !> Solution through x1(0) = start.
  pure function mixed_exact(self, t, start) result(x)
    class(mixed_dae), intent(in) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: start
    real(dp) :: x(3)

    associate (w => self%omega)
      x(1) = (cos(w * t) + w * sin(w * t) + ((1 + w**2) * start - 1) * exp(-t)) / (1 + w**2)
      x(2) = sin(w * t)
      x(3) = cos(w * t)
    end associate
  end function mixed_exact

  !> E = [0 0; 1 eta t].
  subroutine gear_petzold_e(self, t, order, e, status)
    class(gear_petzold_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) e(2, :) = [1.0_dp, self%eta * t]
    if (order == 1) e(2, 2) = self%eta
  end subroutine gear_petzold_e

  !> A = -[1 eta t; 0 1 + eta].
  subroutine gear_petzold_a(self, t, order, a, status)
    class(gear_petzold_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) a(1, :) = [-1.0_dp, -self%eta * t]
    if (order == 0) a(2, 2) = -1 - self%eta
    if (order == 1) a(1, 2) = -self%eta + self%mistake
  end subroutine gear_petzold_a

  !> f = (e^-t, 0).
  subroutine gear_petzold_f(self, t, order, f, status)
    class(gear_petzold_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status

    f(1) = (-1)**order * exp(-t)
  end subroutine gear_petzold_f

  !> E = diag(1, t - 1/2).
  subroutine crossing_e(self, t, order, e, status)
    class(crossing_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) e(1, 1) = 1
    if (order == 0) e(2, 2) = t - 0.5_dp
    if (order == 1) e(2, 2) = 1
  end subroutine crossing_e

  !> A = diag(-1, 1).
  subroutine crossing_a(self, t, order, a, status)
    class(crossing_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order > 0) return
    a(1, 1) = -1
    a(2, 2) = 1
  end subroutine crossing_a

  !> E = [1 0 0; 0 1 0].
  subroutine cart_e(self, t, order, e, status)
    class(cart_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (any(shape(e) /= [self%num_equations, self%num_unknowns])) status = -1
    if (order > 0) return
    e(1, 1) = 1
    e(2, 2) = 1
  end subroutine cart_e

  !> A = [0 1 0; 0 -1 1].
  subroutine cart_a(self, t, order, a, status)
    class(cart_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (any(shape(a) /= [self%num_equations, self%num_unknowns])) status = -1
    if (order == 0) a = reshape([0.0_dp, 0.0_dp, 1.0_dp, -1.0_dp, 0.0_dp, 1.0_dp], [2, 3])
  end subroutine cart_a

  !> x3 = cos t.
  subroutine cart_prescribed(self, t, values, status)
    class(cart_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(inout) :: values(:)
    integer(c_int), intent(inout) :: status

    if (size(values) /= size(self%prescribed)) status = -1
    values(1) = cos(t)
  end subroutine cart_prescribed

  !> E = [1 0; 0 1; 0 0].
  subroutine reaction_e(self, t, order, e, status)
    class(reaction_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order > 0) return
    e(1, 1) = 1
    e(2, 2) = 1
  end subroutine reaction_e

  !> A = [-1 0; 1 0; 1 1].
  subroutine reaction_a(self, t, order, a, status)
    class(reaction_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order > 0) return
    a(1:3, 1) = [-1, 1, 1]
    a(3, 2) = 1
  end subroutine reaction_a

  !> f = (0, 0, -1 - leak t).
  subroutine reaction_f(self, t, order, f, status)
    class(reaction_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status

    if (order == 0) f(3) = -1 - self%leak * t
    if (order == 1) f(3) = -self%leak
  end subroutine reaction_f

  !> E = [1 0].
  subroutine free_e(self, t, order, e, status)
    class(free_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) e(1, 1) = 1
  end subroutine free_e

  !> A = [0 1].
  subroutine free_a(self, t, order, a, status)
    class(free_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) a(1, 2) = 1
  end subroutine free_a

  !> E = 1.
  subroutine nested_e(self, t, order, e, status)
    class(nested_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) e(1, 1) = 1
  end subroutine nested_e

  !> A = 0.
  subroutine nested_a(self, t, order, a, status)
    class(nested_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    a = 0
  end subroutine nested_a

  !> f = sin t, the hard way.
  recursive subroutine nested_f(self, t, order, f, status)
    class(nested_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status
    type(mixed_dae), target :: inner
    type(dae_solver) :: solver
    real(dp) :: t_reached, x(3)

    inner = mixed_dae(num_equations=3, num_unknowns=3)
    x = 0
    call solver%create(inner, status)
    if (status == sfdae_ok) call solver%start(t - 1, t, x, status)
    if (status >= sfdae_ok) call solver%advance(t, t_reached, x, status)
    f(1) = merge(x(2), sin(t + order * acos(0.0_dp)), order == 0)
    call solver%destroy()
  end subroutine nested_f

  !> Counts.
  subroutine count_step(self, progress, x, stop_now)
    class(counting_monitor), intent(inout) :: self
    type(sfdae_progress), intent(in) :: progress
    real(dp), intent(in) :: x(:)
    logical, intent(inout) :: stop_now

    self%calls = self%calls + 1
    self%t = progress%t
    self%x1 = x(1)
    self%num_unknowns = size(x)
    self%highest_order = max(self%highest_order, int(progress%order))
    if (self%calls >= self%stop_after) stop_now = .true.
  end subroutine count_step

end module test_support
