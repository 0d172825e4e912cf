! SPDX-License-Identifier: BSD-3-Clause
!
! Expressions of recorded equations: write F(t, x, x') once, as formulas with the usual operators
! and functions; sfdae computes values and derivatives of any order from the record.
!
!     residual(1) = xdot(1) - x(2)
!     residual(2) = xdot(2) + 9.81_dp * sin(x(1))
!
! Conventions
!  - Operators + - * / ** work between expressions, real(c_double) and default integers; with at
!    least one expression. Literals need their kind: 9.81_dp.
!  - Operators and functions are elemental: residual(1:3) = xdot(1:3) - x(4:6).
!  - There are no values to branch on while equations are recorded: see choose.
!  - An expression that has not been assigned to is the number 0. Only the library writes its
!    components.
!  - These are the functions on expressions of the C API; the module `sfdae` passes all of them on.
module sfdae_expressions
  use, intrinsic :: iso_c_binding, only: c_double
  use sfdae_c, only: c_abs, c_acos, c_add, c_asin, c_atan, c_atan2, c_choose, c_cos, c_cosh, &
    c_divide, c_exp, c_log, c_max, c_min, c_multiply, c_negate, c_number, c_parameter, c_power, &
    c_sin, c_sinh, c_sqrt, c_subtract, c_tan, c_tanh
  use sfdae_conversions, only: text_in_c
  use sfdae_types, only: expression
  implicit none
  private

  public :: expression, named_parameter, choose
  public :: assignment(=), operator(+), operator(-), operator(*), operator(/), operator(**)
  public :: sqrt, exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh
  public :: abs, min, max

  !> Numbers become expressions.
  interface assignment(=)
    module procedure assign_real, assign_integer
  end interface assignment(=)

  !> Sum, and the expression itself.
  interface operator(+)
    module procedure add_ee, add_er, add_re, add_ei, add_ie, identity
  end interface operator(+)

  !> Difference, and negation.
  interface operator(-)
    module procedure subtract_ee, subtract_er, subtract_re, subtract_ei, subtract_ie, negate
  end interface operator(-)

  !> Product.
  interface operator(*)
    module procedure multiply_ee, multiply_er, multiply_re, multiply_ei, multiply_ie
  end interface operator(*)

  !> Quotient.
  interface operator(/)
    module procedure divide_ee, divide_er, divide_re, divide_ei, divide_ie
  end interface operator(/)

  !> Power. Integer exponents up to 64 in size: for every base, by products.
  interface operator(**)
    module procedure power_ee, power_er, power_re, power_ei, power_ie
  end interface operator(**)

  !> Square root; no derivative at 0.
  interface sqrt
    module procedure sqrt_e
  end interface sqrt

  !> Exponential function.
  interface exp
    module procedure exp_e
  end interface exp

  !> Natural logarithm.
  interface log
    module procedure log_e
  end interface log

  !> Sine.
  interface sin
    module procedure sin_e
  end interface sin

  !> Cosine.
  interface cos
    module procedure cos_e
  end interface cos

  !> Tangent.
  interface tan
    module procedure tan_e
  end interface tan

  !> Inverse sine; no derivative at 1 and -1.
  interface asin
    module procedure asin_e
  end interface asin

  !> Inverse cosine; no derivative at 1 and -1.
  interface acos
    module procedure acos_e
  end interface acos

  !> Inverse tangent.
  interface atan
    module procedure atan_e
  end interface atan

  !> Hyperbolic sine.
  interface sinh
    module procedure sinh_e
  end interface sinh

  !> Hyperbolic cosine.
  interface cosh
    module procedure cosh_e
  end interface cosh

  !> Hyperbolic tangent.
  interface tanh
    module procedure tanh_e
  end interface tanh

  !> Absolute value; it has a kink.
  interface abs
    module procedure abs_e
  end interface abs

  !> Angle of the point (x, y), atan2(y, x).
  interface atan2
    module procedure atan2_ee, atan2_er, atan2_re
  end interface atan2

  !> The smaller one; it has a kink.
  interface min
    module procedure min_ee, min_er, min_re
  end interface min

  !> The larger one; it has a kink.
  interface max
    module procedure max_ee, max_er, max_re
  end interface max

  !> choose(c, a, b) is a if c > 0, else b; the other one need not be defined.
  interface choose
    module procedure choose_ee, choose_er, choose_re, choose_rr
  end interface choose

contains

  !> A constant with a name, whose value can be changed later without recording anew. The same name
  !> is the same parameter, and the first value counts.
  function named_parameter(t, name, value) result(v)
    !> Any expression of the recording, for example t.
    type(expression), intent(in) :: t
    character(len=*), intent(in) :: name
    real(c_double), intent(in) :: value
    type(expression) :: v

    v = c_parameter(t%record, text_in_c(name), value)
  end function named_parameter

  ! ---- Numbers ------------------------------------------------------------------------------

  impure elemental subroutine assign_real(v, a)
    type(expression), intent(out) :: v
    real(c_double), intent(in) :: a

    v = c_number(a)
  end subroutine assign_real

  impure elemental subroutine assign_integer(v, a)
    type(expression), intent(out) :: v
    integer, intent(in) :: a

    v = c_number(real(a, c_double))
  end subroutine assign_integer

  ! ---- Operators: e expression, r real, i integer -------------------------------------------

  impure elemental function add_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_add(a, b)
  end function add_ee

  impure elemental function add_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_add(a, c_number(b))
  end function add_er

  impure elemental function add_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_add(c_number(a), b)
  end function add_re

  impure elemental function add_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_add(a, c_number(real(b, c_double)))
  end function add_ei

  impure elemental function add_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_add(c_number(real(a, c_double)), b)
  end function add_ie

  impure elemental function subtract_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_subtract(a, b)
  end function subtract_ee

  impure elemental function subtract_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_subtract(a, c_number(b))
  end function subtract_er

  impure elemental function subtract_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_subtract(c_number(a), b)
  end function subtract_re

  impure elemental function subtract_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_subtract(a, c_number(real(b, c_double)))
  end function subtract_ei

  impure elemental function subtract_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_subtract(c_number(real(a, c_double)), b)
  end function subtract_ie

  impure elemental function multiply_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_multiply(a, b)
  end function multiply_ee

  impure elemental function multiply_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_multiply(a, c_number(b))
  end function multiply_er

  impure elemental function multiply_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_multiply(c_number(a), b)
  end function multiply_re

  impure elemental function multiply_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_multiply(a, c_number(real(b, c_double)))
  end function multiply_ei

  impure elemental function multiply_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_multiply(c_number(real(a, c_double)), b)
  end function multiply_ie

  impure elemental function divide_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_divide(a, b)
  end function divide_ee

  impure elemental function divide_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_divide(a, c_number(b))
  end function divide_er

  impure elemental function divide_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_divide(c_number(a), b)
  end function divide_re

  impure elemental function divide_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_divide(a, c_number(real(b, c_double)))
  end function divide_ei

  impure elemental function divide_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_divide(c_number(real(a, c_double)), b)
  end function divide_ie

  impure elemental function power_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_power(a, b)
  end function power_ee

  impure elemental function power_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_power(a, c_number(b))
  end function power_er

  impure elemental function power_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_power(c_number(a), b)
  end function power_re

  impure elemental function power_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_power(a, c_number(real(b, c_double)))
  end function power_ei

  impure elemental function power_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_power(c_number(real(a, c_double)), b)
  end function power_ie

  impure elemental function identity(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = a
  end function identity

  impure elemental function negate(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_negate(a)
  end function negate

  ! ---- Functions ----------------------------------------------------------------------------

  impure elemental function sqrt_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_sqrt(a)
  end function sqrt_e

  impure elemental function exp_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_exp(a)
  end function exp_e

  impure elemental function log_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_log(a)
  end function log_e

  impure elemental function sin_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_sin(a)
  end function sin_e

  impure elemental function cos_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_cos(a)
  end function cos_e

  impure elemental function tan_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_tan(a)
  end function tan_e

  impure elemental function asin_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_asin(a)
  end function asin_e

  impure elemental function acos_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_acos(a)
  end function acos_e

  impure elemental function atan_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_atan(a)
  end function atan_e

  impure elemental function sinh_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_sinh(a)
  end function sinh_e

  impure elemental function cosh_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_cosh(a)
  end function cosh_e

  impure elemental function tanh_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_tanh(a)
  end function tanh_e

  impure elemental function abs_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_abs(a)
  end function abs_e

  impure elemental function atan2_ee(y, x) result(v)
    type(expression), intent(in) :: y
    type(expression), intent(in) :: x
    type(expression) :: v

    v = c_atan2(y, x)
  end function atan2_ee

  impure elemental function atan2_er(y, x) result(v)
    type(expression), intent(in) :: y
    real(c_double), intent(in) :: x
    type(expression) :: v

    v = c_atan2(y, c_number(x))
  end function atan2_er

  impure elemental function atan2_re(y, x) result(v)
    real(c_double), intent(in) :: y
    type(expression), intent(in) :: x
    type(expression) :: v

    v = c_atan2(c_number(y), x)
  end function atan2_re

  impure elemental function min_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_min(a, b)
  end function min_ee

  impure elemental function min_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_min(a, c_number(b))
  end function min_er

  impure elemental function min_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_min(c_number(a), b)
  end function min_re

  impure elemental function max_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_max(a, b)
  end function max_ee

  impure elemental function max_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_max(a, c_number(b))
  end function max_er

  impure elemental function max_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_max(c_number(a), b)
  end function max_re

  impure elemental function choose_ee(c, a, b) result(v)
    type(expression), intent(in) :: c
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_choose(c, a, b)
  end function choose_ee

  impure elemental function choose_er(c, a, b) result(v)
    type(expression), intent(in) :: c
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_choose(c, a, c_number(b))
  end function choose_er

  impure elemental function choose_re(c, a, b) result(v)
    type(expression), intent(in) :: c
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_choose(c, c_number(a), b)
  end function choose_re

  impure elemental function choose_rr(c, a, b) result(v)
    type(expression), intent(in) :: c
    real(c_double), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_choose(c, c_number(a), c_number(b))
  end function choose_rr

end module sfdae_expressions
