! SPDX-License-Identifier: BSD-3-Clause
!
! Intrinsic functions of arrays for expressions of recorded equations:
!
!     residual(1:3) = matmul(mass, xdot(4:6)) - force        ! mass: numbers or expressions
!     residual(4) = dot_product(x(1:3), x(1:3)) - 1
!
! They mean what the intrinsic functions mean. Arguments may have expressions or real(c_double), at
! least one of them expressions. Sums are formed from the first entry to the last. Shapes that do
! not agree are reported when the solver is created: sfdae_illegal_argument, with both shapes.
module sfdae_arrays
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_associated, c_double
  use sfdae_c, only: c_number, c_parameter
  use sfdae_conversions, only: text_in_c
  use sfdae_expressions, only: assignment(=), max, min, operator(*), operator(+), sqrt
  use sfdae_types, only: expression
  implicit none
  private

  public :: sum, dot_product, matmul, maxval, minval, norm2

  !> Sum of all entries, or along one dimension of a matrix: sum(a, dim). 0 if there are none.
  interface sum
    module procedure sum_1, sum_2, sum_along
  end interface sum

  !> a(1) b(1) + ... + a(n) b(n).
  interface dot_product
    module procedure dot_product_ee, dot_product_er, dot_product_re
  end interface dot_product

  !> Product of two matrices, of a matrix and a vector, or of a vector and a matrix.
  interface matmul
    module procedure matmul_22_ee, matmul_22_er, matmul_22_re
    module procedure matmul_21_ee, matmul_21_er, matmul_21_re
    module procedure matmul_12_ee, matmul_12_er, matmul_12_re
  end interface matmul

  !> The largest entry; it has kinks. The smallest number if there are no entries.
  interface maxval
    module procedure maxval_1, maxval_2
  end interface maxval

  !> The smallest entry; it has kinks. The largest number if there are no entries.
  interface minval
    module procedure minval_1, minval_2
  end interface minval

  !> Square root of the sum of the squares of all entries; no derivative at 0.
  interface norm2
    module procedure norm2_1, norm2_2
  end interface norm2

contains

  ! ---- Sums ---------------------------------------------------------------------------------

  function sum_1(a) result(v)
    type(expression), intent(in) :: a(:)
    type(expression) :: v
    integer :: i

    v = 0
    if (size(a) > 0) v = a(1)
    do i = 2, size(a)
      v = v + a(i)
    end do
  end function sum_1

  function sum_2(a) result(v)
    type(expression), intent(in) :: a(:, :)
    type(expression) :: v

    v = sum_1(reshape(a, [size(a)]))
  end function sum_2

  !> The sums of the columns (dim = 1) or of the rows (dim = 2).
  function sum_along(a, dim) result(v)
    type(expression), intent(in) :: a(:, :)
    !> 1 or 2; any other value is the mistake of an array without entries.
    integer, intent(in) :: dim
    type(expression) :: v(merge(size(a, 2), size(a, 1), dim == 1))
    integer :: i

    do i = 1, size(v)
      if (dim == 1) then
        v(i) = sum_1(a(:, i))
      else if (dim == 2) then
        v(i) = sum_1(a(i, :))
      else
        v(i) = mistake("sum(a, dim), whose dim is neither 1 nor 2,", reshape(a, [size(a)]))
      end if
    end do
  end function sum_along

  function norm2_1(a) result(v)
    type(expression), intent(in) :: a(:)
    type(expression) :: v

    v = sqrt(dot_product_ee(a, a))
  end function norm2_1

  function norm2_2(a) result(v)
    type(expression), intent(in) :: a(:, :)
    type(expression) :: v

    v = norm2_1(reshape(a, [size(a)]))
  end function norm2_2

  ! ---- Extrema ------------------------------------------------------------------------------

  function maxval_1(a) result(v)
    type(expression), intent(in) :: a(:)
    type(expression) :: v
    integer :: i

    v = -huge(1.0_c_double)
    if (size(a) > 0) v = a(1)
    do i = 2, size(a)
      v = max(v, a(i))
    end do
  end function maxval_1

  function maxval_2(a) result(v)
    type(expression), intent(in) :: a(:, :)
    type(expression) :: v

    v = maxval_1(reshape(a, [size(a)]))
  end function maxval_2

  function minval_1(a) result(v)
    type(expression), intent(in) :: a(:)
    type(expression) :: v
    integer :: i

    v = huge(1.0_c_double)
    if (size(a) > 0) v = a(1)
    do i = 2, size(a)
      v = min(v, a(i))
    end do
  end function minval_1

  function minval_2(a) result(v)
    type(expression), intent(in) :: a(:, :)
    type(expression) :: v

    v = minval_1(reshape(a, [size(a)]))
  end function minval_2

  ! ---- Products: e expression, r real ---------------------------------------------------------

  function dot_product_ee(a, b) result(v)
    type(expression), intent(in) :: a(:)
    type(expression), intent(in) :: b(:)
    type(expression) :: v
    integer :: i

    v = 0
    if (size(a) /= size(b)) then
      v = mistake(disagreement("dot_product", shape(a), shape(b)), a)
      return
    end if
    if (size(a) > 0) v = a(1) * b(1)
    do i = 2, size(a)
      v = v + a(i) * b(i)
    end do
  end function dot_product_ee

  function matmul_22_ee(a, b) result(v)
    type(expression), intent(in) :: a(:, :)
    type(expression), intent(in) :: b(:, :)
    type(expression) :: v(size(a, 1), size(b, 2))
    integer :: i, j

    if (size(a, 2) /= size(b, 1)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), reshape(a, [size(a)]))
      return
    end if
    do j = 1, size(b, 2)
      do i = 1, size(a, 1)
        v(i, j) = dot_product_ee(a(i, :), b(:, j))
      end do
    end do
  end function matmul_22_ee

  function matmul_21_ee(a, b) result(v)
    type(expression), intent(in) :: a(:, :)
    type(expression), intent(in) :: b(:)
    type(expression) :: v(size(a, 1))
    integer :: i

    if (size(a, 2) /= size(b)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), reshape(a, [size(a)]))
      return
    end if
    do i = 1, size(a, 1)
      v(i) = dot_product_ee(a(i, :), b)
    end do
  end function matmul_21_ee

  function matmul_12_ee(a, b) result(v)
    type(expression), intent(in) :: a(:)
    type(expression), intent(in) :: b(:, :)
    type(expression) :: v(size(b, 2))
    integer :: j

    if (size(a) /= size(b, 1)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), a)
      return
    end if
    do j = 1, size(b, 2)
      v(j) = dot_product_ee(a, b(:, j))
    end do
  end function matmul_12_ee

  function dot_product_er(a, b) result(v)
    type(expression), intent(in) :: a(:)
    real(c_double), intent(in) :: b(:)
    type(expression) :: v
    integer :: i

    v = 0
    if (size(a) /= size(b)) then
      v = mistake(disagreement("dot_product", shape(a), shape(b)), a)
      return
    end if
    if (size(a) > 0) v = a(1) * b(1)
    do i = 2, size(a)
      v = v + a(i) * b(i)
    end do
  end function dot_product_er

  function matmul_22_er(a, b) result(v)
    type(expression), intent(in) :: a(:, :)
    real(c_double), intent(in) :: b(:, :)
    type(expression) :: v(size(a, 1), size(b, 2))
    integer :: i, j

    if (size(a, 2) /= size(b, 1)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), reshape(a, [size(a)]))
      return
    end if
    do j = 1, size(b, 2)
      do i = 1, size(a, 1)
        v(i, j) = dot_product_er(a(i, :), b(:, j))
      end do
    end do
  end function matmul_22_er

  function matmul_21_er(a, b) result(v)
    type(expression), intent(in) :: a(:, :)
    real(c_double), intent(in) :: b(:)
    type(expression) :: v(size(a, 1))
    integer :: i

    if (size(a, 2) /= size(b)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), reshape(a, [size(a)]))
      return
    end if
    do i = 1, size(a, 1)
      v(i) = dot_product_er(a(i, :), b)
    end do
  end function matmul_21_er

  function matmul_12_er(a, b) result(v)
    type(expression), intent(in) :: a(:)
    real(c_double), intent(in) :: b(:, :)
    type(expression) :: v(size(b, 2))
    integer :: j

    if (size(a) /= size(b, 1)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), a)
      return
    end if
    do j = 1, size(b, 2)
      v(j) = dot_product_er(a, b(:, j))
    end do
  end function matmul_12_er

  function dot_product_re(a, b) result(v)
    real(c_double), intent(in) :: a(:)
    type(expression), intent(in) :: b(:)
    type(expression) :: v
    integer :: i

    v = 0
    if (size(a) /= size(b)) then
      v = mistake(disagreement("dot_product", shape(a), shape(b)), b)
      return
    end if
    if (size(a) > 0) v = a(1) * b(1)
    do i = 2, size(a)
      v = v + a(i) * b(i)
    end do
  end function dot_product_re

  function matmul_22_re(a, b) result(v)
    real(c_double), intent(in) :: a(:, :)
    type(expression), intent(in) :: b(:, :)
    type(expression) :: v(size(a, 1), size(b, 2))
    integer :: i, j

    if (size(a, 2) /= size(b, 1)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), reshape(b, [size(b)]))
      return
    end if
    do j = 1, size(b, 2)
      do i = 1, size(a, 1)
        v(i, j) = dot_product_re(a(i, :), b(:, j))
      end do
    end do
  end function matmul_22_re

  function matmul_21_re(a, b) result(v)
    real(c_double), intent(in) :: a(:, :)
    type(expression), intent(in) :: b(:)
    type(expression) :: v(size(a, 1))
    integer :: i

    if (size(a, 2) /= size(b)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), b)
      return
    end if
    do i = 1, size(a, 1)
      v(i) = dot_product_re(a(i, :), b)
    end do
  end function matmul_21_re

  function matmul_12_re(a, b) result(v)
    real(c_double), intent(in) :: a(:)
    type(expression), intent(in) :: b(:, :)
    type(expression) :: v(size(b, 2))
    integer :: j

    if (size(a) /= size(b, 1)) then
      v = mistake(disagreement("matmul", shape(a), shape(b)), reshape(b, [size(b)]))
      return
    end if
    do j = 1, size(b, 2)
      v(j) = dot_product_re(a, b(:, j))
    end do
  end function matmul_12_re

  ! ---- Mistakes -----------------------------------------------------------------------------

  !> Makes the creation of the solver fail, with a message that the value of this is not finite.
  function mistake(text, entries) result(v)
    character(len=*), intent(in) :: text
    !> The recording is that of any of these.
    type(expression), intent(in) :: entries(:)
    type(expression) :: v
    real(c_double) :: no_number
    integer :: i

    no_number = ieee_value(no_number, ieee_quiet_nan)
    v = c_number(no_number)
    do i = 1, size(entries)
      if (.not. c_associated(entries(i)%record)) cycle
      v = c_parameter(entries(i)%record, text_in_c(text), no_number)
      return
    end do
  end function mistake

  !> "matmul(a, b), whose shapes (2, 3) and (2) do not agree,"
  function disagreement(name, a, b) result(text)
    character(len=*), intent(in) :: name
    integer, intent(in) :: a(:)
    integer, intent(in) :: b(:)
    character(len=:), allocatable :: text

    text = name // "(a, b), whose shapes " // in_words(a) // " and " // in_words(b) // &
      " do not agree,"
  end function disagreement

  !> "(2, 3)"
  function in_words(sizes) result(text)
    integer, intent(in) :: sizes(:)
    character(len=:), allocatable :: text
    character(len=12) :: number
    integer :: i

    text = "("
    do i = 1, size(sizes)
      write (number, "(i0)") sizes(i)
      if (i > 1) text = text // ", "
      text = text // trim(number)
    end do
    text = text // ")"
  end function in_words

end module sfdae_arrays
