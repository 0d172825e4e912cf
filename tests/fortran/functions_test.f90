! SPDX-License-Identifier: BSD-3-Clause
!
! Comparisons, jumps, derivatives, tables and functions of the program's in recorded equations; the
! solution over a whole run.
module functions_problem
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_null_ptr, c_ptr, dp => c_double
  use sfdae
  implicit none

  !> A pendulum, q'' = -g_q lambda - e_2, 0 = g(q), with the derivative of lambda g by q, and two
  !> unknowns that are a table of t and a function of the program's at t.
  type, extends(nonlinear_dae) :: derived_pendulum
  contains
    procedure :: equations => write_equations
  end type derived_pendulum

contains

  subroutine write_equations(self, t, x, xdot, residual)
    class(derived_pendulum), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)
    type(expression) :: g

    g = x(1)**2 + x(2)**2 - 1
    residual(1:2) = xdot(1:2) - x(3:4)
    residual(3:4) = xdot(3:4) + derivative(x(5) * g, x(1:2))
    residual(4) = residual(4) + 1
    residual(5) = g
    residual(6) = x(6) - table(t, 3, [0.0_dp, 1.0_dp, 2.0_dp, 3.0_dp], [0.0_dp, 1.0_dp, 8.0_dp, 27.0_dp])
    residual(7) = x(7) - external_value("square", square, [t], c_null_ptr) &
      - time_derivative(t * t) + choose(t < 9.0_dp .and. .not. (t > 8), sign(t + 1), 0.0_dp)
  end subroutine write_equations

  !> a^2 and its derivatives.
  function square(order, arguments, derivatives, user) bind(c) result(status)
    integer(c_int), value :: order
    type(c_ptr), value :: arguments
    type(c_ptr), value :: derivatives
    type(c_ptr), value :: user
    integer(c_int) :: status
    real(dp), pointer :: a(:), d(:)

    call c_f_pointer(arguments, a, [1])
    call c_f_pointer(derivatives, d, [1])
    if (order == 0) d(1) = a(1)**2
    if (order == 1) d(1) = 2 * a(1)
    if (order == 2) d(1) = 2
    status = 0
  end function square

end module functions_problem

program functions_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use functions_problem, only: derived_pendulum
  use sfdae
  use test_support, only: check, check_status, finish, within
  implicit none

  call check_numbers()
  call check_run()
  call finish()

contains

  subroutine expect(found, expected, what)
    type(expression), intent(in) :: found
    real(dp), intent(in) :: expected
    character(len=*), intent(in) :: what

    call check(within(found%value, expected, abs(expected) + 1), what)
  end subroutine expect

  subroutine check_numbers()
    type(expression) :: a, b

    a = 2.5_dp
    b = -1
    call expect(log10(a * 40), 2.0_dp, "log10")
    call expect(floor(a), 2.0_dp, "floor")
    call expect(sign(b), -1.0_dp, "sign")
    call expect(modulo(b, a), 1.5_dp, "modulo of expressions")
    call expect(modulo(b, 2.0_dp), 1.0_dp, "modulo by a number")
    call expect(modulo(7.0_dp, a), 2.0_dp, "modulo of a number")
    call expect(a < b, 0.0_dp, "a < b")
    call expect(a <= 2.5_dp, 1.0_dp, "a <= real")
    call expect(1 > b, 1.0_dp, "integer > b")
    call expect(b >= 0, 0.0_dp, "b >= integer")
    call expect((a > b) .and. (b > a), 0.0_dp, ".and.")
    call expect((a > b) .or. (b > a), 1.0_dp, ".or.")
    call expect(.not. (a > b), 0.0_dp, ".not.")
    call expect(table(a, 1, [2.0_dp, 3.0_dp], [4.0_dp, 6.0_dp]), 5.0_dp, "table")
  end subroutine check_numbers

  subroutine check_run()
    type(derived_pendulum), target :: problem
    type(dae_solver) :: solver
    type(dae_solution) :: solution, loaded
    type(sfdae_characteristics) :: found
    real(dp) :: t, x(7), xdot(7), at(7), start, end
    real(dp), allocatable :: saved(:)
    integer(c_int) :: status, n

    problem%num_equations = 7
    problem%num_unknowns = 7
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    call solver%record(solution, status)
    call check_status(status, sfdae_illegal_argument, "a solution that was not created")
    call solution%create(status)
    call check_status(status, sfdae_ok, "create a solution")
    call solver%record(solution, status)
    call check_status(status, sfdae_ok, "record")
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%get_characteristics(found, status)
    call check(found%strangeness_index == 2, "index of the pendulum")
    call solver%advance(2.0_dp, t, x, status, xdot)
    call check_status(status, sfdae_ok, "advance")
    call check(abs(x(3)**2 + x(4)**2 + 2 * x(2)) < 1e-4_dp, "energy of the pendulum")
    call check(abs(x(6) - 8) < 1e-10_dp, "a cubic table")
    call check(abs(x(7) - 4 - 4 + 1) < 1e-10_dp, "a function of the program's")
    call solution%get_range(n, start, end, status)
    call check(status == sfdae_ok .and. n == 7 .and. end >= 2, "range")
    call solution%evaluate(1.5_dp, at, status, xdot)
    call check(status == sfdae_ok .and. abs(at(6) - 1.5_dp**3) < 1e-4_dp, "evaluate")
    call solution%evaluate(-1.0_dp, at, status)
    call check_status(status, sfdae_illegal_argument, "outside")
    call solution%save(saved, status)
    call loaded%load(saved, status)
    call check_status(status, sfdae_ok, "load")
    call loaded%evaluate(1.5_dp, x, status)
    call check(all(abs(x - at) <= 0), "the solution loaded")
    saved(size(saved)) = saved(size(saved)) + 1
    call loaded%load(saved, status)
    call check_status(status, sfdae_illegal_argument, "a damaged solution")
    call solution%get_accuracy(start, end, status)
    call check(status == sfdae_ok .and. start >= 0 .and. start < 1, "accuracy")
    call solution%cut(1.5_dp, status)
    call check_status(status, sfdae_ok, "cut")
    call solution%evaluate(1.6_dp, at, status)
    call check_status(status, sfdae_illegal_argument, "after the cut")
    call solver%stop_recording(status)
    call check_status(status, sfdae_ok, "stop recording")
    call loaded%destroy(status)
    call solution%destroy(status)
    call solver%destroy(status)
    call check_status(status, sfdae_ok, "destroy")
  end subroutine check_run

end program functions_test
