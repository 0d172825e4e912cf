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
!  - Names that programs are likely to use themselves have a second name: sfdae_choose,
!    sfdae_derivative, sfdae_expression, sfdae_external_value, sfdae_named_parameter, sfdae_table,
!    sfdae_time_derivative.
module sfdae_expressions
  use, intrinsic :: iso_c_binding, only: c_double, c_funloc, c_int, c_ptr
  use sfdae_c, only: c_abs, c_acos, c_add, c_and, c_asin, c_atan, c_atan2, c_choose, c_cos, c_cosh, &
    c_derivative, c_divide, c_exp, c_external, c_floor, c_greater, c_greater_equal, c_less, &
    c_less_equal, c_log, c_log10, c_max, c_min, c_modulo, c_multiply, c_negate, c_not, c_number, &
    c_or, c_parameter, c_power, c_sign, c_sin, c_sinh, c_sqrt, c_subtract, c_table, c_tan, c_tanh, &
    c_time_derivative
  use sfdae_conversions, only: text_in_c
  use sfdae_types, only: expression, sfdae_expression => expression
  implicit none
  private

  public :: expression, named_parameter, choose
  public :: assignment(=), operator(+), operator(-), operator(*), operator(/), operator(**)
  public :: sqrt, exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh
  public :: abs, min, max, log10, floor, sign, modulo
  public :: operator(<), operator(<=), operator(>), operator(>=)
  public :: operator(.and.), operator(.or.), operator(.not.)
  public :: derivative, time_derivative, table, external_value
  public :: sfdae_choose, sfdae_derivative, sfdae_expression, sfdae_external_value, &
    sfdae_named_parameter, sfdae_table, sfdae_time_derivative

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

  !> 1 if it holds, else 0; for choose.
  interface operator(<)
    module procedure less_ee, less_er, less_re, &
      less_ei, less_ie
  end interface operator(<)

  !> 1 if it holds, else 0.
  interface operator(<=)
    module procedure less_equal_ee, less_equal_er, less_equal_re, &
      less_equal_ei, less_equal_ie
  end interface operator(<=)

  !> 1 if it holds, else 0.
  interface operator(>)
    module procedure greater_ee, greater_er, greater_re, &
      greater_ei, greater_ie
  end interface operator(>)

  !> 1 if it holds, else 0.
  interface operator(>=)
    module procedure greater_equal_ee, greater_equal_er, greater_equal_re, &
      greater_equal_ei, greater_equal_ie
  end interface operator(>=)

  !> 1 if both are true, which is > 0, else 0.
  interface operator(.and.)
    module procedure and_ee
  end interface operator(.and.)

  !> 1 if one is true, else 0.
  interface operator(.or.)
    module procedure or_ee
  end interface operator(.or.)

  !> 1 if it is not true, else 0.
  interface operator(.not.)
    module procedure not_e
  end interface operator(.not.)

  !> Decimal logarithm.
  interface log10
    module procedure log10_e
  end interface log10

  !> The largest integer up to it; it jumps.
  interface floor
    module procedure floor_e
  end interface floor

  !> 1 if it is > 0, 0 if it is 0, else -1.
  interface sign
    module procedure sign_e
  end interface sign

  !> a - b floor(a / b): for inputs of period b.
  interface modulo
    module procedure modulo_ee, modulo_er, modulo_re
  end interface modulo

  ! ---- Second names -------------------------------------------------------------------------

  !> choose.
  interface sfdae_choose
    module procedure choose_ee, choose_er, choose_re, choose_rr
  end interface sfdae_choose

  !> derivative.
  interface sfdae_derivative
    module procedure derivative
  end interface sfdae_derivative

  !> time_derivative.
  interface sfdae_time_derivative
    module procedure time_derivative
  end interface sfdae_time_derivative

  !> table.
  interface sfdae_table
    module procedure table
  end interface sfdae_table

  !> external_value.
  interface sfdae_external_value
    module procedure external_value
  end interface sfdae_external_value

  !> named_parameter.
  interface sfdae_named_parameter
    module procedure named_parameter
  end interface sfdae_named_parameter

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

  impure elemental function less_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_less(a, b)
  end function less_ee

  impure elemental function less_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_less(a, c_number(b))
  end function less_er

  impure elemental function less_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_less(c_number(a), b)
  end function less_re

  impure elemental function less_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_less(a, c_number(real(b, c_double)))
  end function less_ei

  impure elemental function less_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_less(c_number(real(a, c_double)), b)
  end function less_ie

  impure elemental function less_equal_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_less_equal(a, b)
  end function less_equal_ee

  impure elemental function less_equal_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_less_equal(a, c_number(b))
  end function less_equal_er

  impure elemental function less_equal_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_less_equal(c_number(a), b)
  end function less_equal_re

  impure elemental function less_equal_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_less_equal(a, c_number(real(b, c_double)))
  end function less_equal_ei

  impure elemental function less_equal_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_less_equal(c_number(real(a, c_double)), b)
  end function less_equal_ie

  impure elemental function greater_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_greater(a, b)
  end function greater_ee

  impure elemental function greater_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_greater(a, c_number(b))
  end function greater_er

  impure elemental function greater_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_greater(c_number(a), b)
  end function greater_re

  impure elemental function greater_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_greater(a, c_number(real(b, c_double)))
  end function greater_ei

  impure elemental function greater_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_greater(c_number(real(a, c_double)), b)
  end function greater_ie

  impure elemental function greater_equal_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_greater_equal(a, b)
  end function greater_equal_ee

  impure elemental function greater_equal_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_greater_equal(a, c_number(b))
  end function greater_equal_er

  impure elemental function greater_equal_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_greater_equal(c_number(a), b)
  end function greater_equal_re

  impure elemental function greater_equal_ei(a, b) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: b
    type(expression) :: v

    v = c_greater_equal(a, c_number(real(b, c_double)))
  end function greater_equal_ei

  impure elemental function greater_equal_ie(a, b) result(v)
    integer, intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_greater_equal(c_number(real(a, c_double)), b)
  end function greater_equal_ie

  impure elemental function and_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_and(a, b)
  end function and_ee

  impure elemental function or_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_or(a, b)
  end function or_ee

  impure elemental function not_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_not(a)
  end function not_e

  impure elemental function log10_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_log10(a)
  end function log10_e

  impure elemental function floor_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_floor(a)
  end function floor_e

  impure elemental function sign_e(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_sign(a)
  end function sign_e

  impure elemental function modulo_ee(a, b) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_modulo(a, b)
  end function modulo_ee

  impure elemental function modulo_er(a, b) result(v)
    type(expression), intent(in) :: a
    real(c_double), intent(in) :: b
    type(expression) :: v

    v = c_modulo(a, c_number(b))
  end function modulo_er

  impure elemental function modulo_re(a, b) result(v)
    real(c_double), intent(in) :: a
    type(expression), intent(in) :: b
    type(expression) :: v

    v = c_modulo(c_number(a), b)
  end function modulo_re

  ! ---- Derivatives, tables, functions of the program's --------------------------------------

  !> The derivative of a formula by t, an unknown, the derivative of an unknown or a parameter.
  impure elemental function derivative(a, variable) result(v)
    type(expression), intent(in) :: a
    type(expression), intent(in) :: variable
    type(expression) :: v

    v = c_derivative(a, variable)
  end function derivative

  !> The total derivative along time of a formula in t and x, in which x' appears.
  impure elemental function time_derivative(a) result(v)
    type(expression), intent(in) :: a
    type(expression) :: v

    v = c_time_derivative(a)
  end function time_derivative

  !> The value at a of the spline of degree 1, 3, 5 or 7 through the points (x(i), y(i)), at least
  !> degree + 1 of them, x increasing; sfdae_table in C explains it.
  function table(a, degree, x, y) result(v)
    type(expression), intent(in) :: a
    integer, intent(in) :: degree
    real(c_double), intent(in) :: x(:)
    !> As many as x.
    real(c_double), intent(in) :: y(:)
    type(expression) :: v
    integer(c_int) :: count

    count = merge(int(size(x), c_int), 0_c_int, size(x) == size(y))
    v = c_table(a, int(degree, c_int), count, x, y)
  end function table

  !> The value of a function of the program's, which writes its partial derivatives, at expressions;
  !> sfdae_external in C explains it.
  function external_value(name, f, arguments, user) result(v)
    !> For messages.
    character(len=*), intent(in) :: name
    interface
      !> Writes all partial derivatives of an order: addresses of k and of k**order numbers.
      function f(order, arguments, derivatives, user) bind(c) result(status)
        import :: c_int, c_ptr
        integer(c_int), value :: order
        type(c_ptr), value :: arguments
        type(c_ptr), value :: derivatives
        type(c_ptr), value :: user
        integer(c_int) :: status
      end function f
    end interface
    type(expression), intent(in) :: arguments(:)
    !> Handed to the function.
    type(c_ptr), intent(in) :: user
    type(expression) :: v
    type(expression), allocatable :: list(:)

    allocate (list(max(1, size(arguments))))
    list(1:size(arguments)) = arguments
    v = c_external(text_in_c(name), c_funloc(f), int(size(arguments), c_int), list, user)
  end function external_value

end module sfdae_expressions
