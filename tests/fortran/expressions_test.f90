! SPDX-License-Identifier: BSD-3-Clause
!
! Operators and functions on expressions. Without a recording expressions are numbers, and have the
! values that the same formulas have for numbers.
program expressions_test
  use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_size_t, c_sizeof, dp => c_double
  use sfdae
  use test_support, only: check, finish, within
  implicit none

  interface
    !> Of mirror.c.
    function fill_expression(s) bind(c) result(bytes)
      import :: c_size_t, expression
      type(expression), intent(inout) :: s
      integer(c_size_t) :: bytes
    end function fill_expression
  end interface

  real(dp), parameter :: x = 0.7_dp, y = -1.3_dp
  type(expression) :: a, b

  a = x
  b = y
  call check_layout()
  call check_operators()
  call check_functions()
  call check_branches()
  call check_arrays()
  call finish()

contains

  !> Members and size are those of C.
  subroutine check_layout()
    type(expression) :: c

    call check(.not. c_associated(c%record) .and. within(c%value, 0.0_dp, 1.0_dp) .and. c%node == 0, &
      "expressions are zero at first")
    call check(fill_expression(c) == c_sizeof(c), "size of sfdae_expression")
    call check(c_associated(c%record) .and. within(c%value, 2.0_dp, 2.0_dp) .and. c%node == 3_c_int, &
      "members of sfdae_expression")
  end subroutine check_layout

  !> Between expressions, reals and integers.
  subroutine check_operators()
    call expect(a + b, x + y, "a + b")
    call expect(a + y, x + y, "a + y")
    call expect(x + b, x + y, "x + b")
    call expect(a + 2, x + 2, "a + 2")
    call expect(2 + a, 2 + x, "2 + a")
    call expect(a - b, x - y, "a - b")
    call expect(a - y, x - y, "a - y")
    call expect(x - b, x - y, "x - b")
    call expect(a - 2, x - 2, "a - 2")
    call expect(2 - a, 2 - x, "2 - a")
    call expect(a * b, x * y, "a * b")
    call expect(a * y, x * y, "a * y")
    call expect(x * b, x * y, "x * b")
    call expect(a * 2, x * 2, "a * 2")
    call expect(2 * a, 2 * x, "2 * a")
    call expect(a / b, x / y, "a / b")
    call expect(a / y, x / y, "a / y")
    call expect(x / b, x / y, "x / b")
    call expect(a / 2, x / 2, "a / 2")
    call expect(2 / a, 2 / x, "2 / a")
    call expect(a**b, x**y, "a**b")
    call expect(a**y, x**y, "a**y")
    call expect(x**b, x**y, "x**b")
    call expect(a**3, x**3, "a**3")
    call expect(b**2, y**2, "b**2")
    call expect(2**a, 2**x, "2**a")
    call expect(-a, -x, "-a")
    call expect(+a, x, "+a")
    call expect(-a * b + 3 * a**2, -x * y + 3 * x**2, "precedence")
  end subroutine check_operators

  !> Those of one and two arguments.
  subroutine check_functions()
    call expect(sqrt(a), sqrt(x), "sqrt")
    call expect(exp(a), exp(x), "exp")
    call expect(log(a), log(x), "log")
    call expect(sin(a), sin(x), "sin")
    call expect(cos(a), cos(x), "cos")
    call expect(tan(a), tan(x), "tan")
    call expect(asin(a), asin(x), "asin")
    call expect(acos(a), acos(x), "acos")
    call expect(atan(a), atan(x), "atan")
    call expect(sinh(a), sinh(x), "sinh")
    call expect(cosh(a), cosh(x), "cosh")
    call expect(tanh(a), tanh(x), "tanh")
    call expect(atan2(a, b), atan2(x, y), "atan2(a, b)")
    call expect(atan2(a, y), atan2(x, y), "atan2(a, y)")
    call expect(atan2(x, b), atan2(x, y), "atan2(x, b)")
  end subroutine check_functions

  !> Kinks and choices.
  subroutine check_branches()
    call expect(abs(a), x, "abs(a)")
    call expect(abs(b), -y, "abs(b)")
    call expect(min(a, b), y, "min(a, b)")
    call expect(min(a, y), y, "min(a, y)")
    call expect(min(x, b), y, "min(x, b)")
    call expect(max(a, b), x, "max(a, b)")
    call expect(max(a, y), x, "max(a, y)")
    call expect(max(x, b), x, "max(x, b)")
    call expect(choose(a, a, b), x, "choose(a, a, b)")
    call expect(choose(b, a, b), y, "choose(b, a, b)")
    call expect(choose(a, a, 5.0_dp), x, "choose(a, a, 5)")
    call expect(choose(b, 5.0_dp, b), y, "choose(b, 5, b)")
    call expect(choose(b, 5.0_dp, 6.0_dp), 6.0_dp, "choose(b, 5, 6)")
  end subroutine check_branches

  !> Element by element, the intrinsic functions on numbers included.
  subroutine check_arrays()
    type(expression) :: v(3)
    real(dp) :: w(3)
    integer :: i

    v = [1.0_dp, 2.0_dp, 3.0_dp]
    v = sin(v) - 2 * v(3:1:-1) + a
    w = [1.0_dp, 2.0_dp, 3.0_dp]
    w = sin(w) - 2 * w(3:1:-1) + x
    do i = 1, 3
      call expect(v(i), w(i), "arrays")
    end do
    v = 4
    call expect(v(2), 4.0_dp, "assignment of an integer")
  end subroutine check_arrays

  !> A plain number with the value of the formula for numbers.
  subroutine expect(found, expected, what)
    type(expression), intent(in) :: found
    real(dp), intent(in) :: expected
    character(len=*), intent(in) :: what

    call check(.not. c_associated(found%record), what // " is a number")
    call check(within(found%value, expected, abs(expected)), what)
  end subroutine expect

end program expressions_test
