! SPDX-License-Identifier: BSD-3-Clause
!
! Intrinsic functions of arrays on expressions: values as those of numbers, equations that are written
! with them, shapes that do not agree; second names of the module's names, and renamed ones.
module arrays_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  implicit none
  private

  public :: three_masses, mistaken

  !> M q'' = -K q + f with q(1) = sin t prescribed by the force f on the first mass:
  !> x = (q, v, f), mu = 2. M and K are numbers.
  type, extends(nonlinear_dae) :: three_masses
    real(dp) :: mass(3, 3) = reshape([2, 1, 0, 1, 3, 1, 0, 1, 4], [3, 3])
    real(dp) :: stiffness(3, 3) = reshape([5, -2, 0, -2, 4, -1, 0, -1, 3], [3, 3])
  contains
    procedure :: equations => write_masses
  end type three_masses

  !> With a product whose shapes do not agree.
  type, extends(nonlinear_dae) :: mistaken
    integer :: kind = 0
  contains
    procedure :: equations => write_mistake
  end type mistaken

contains

  subroutine write_masses(self, t, x, xdot, residual)
    class(three_masses), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1:3) = xdot(1:3) - x(4:6)
    residual(4:6) = matmul(self%mass, xdot(4:6)) + matmul(x(1:3), self%stiffness)
    residual(4) = residual(4) - x(7)
    residual(7) = x(1) - sin(t)
  end subroutine write_masses

  subroutine write_mistake(self, t, x, xdot, residual)
    class(mistaken), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)
    real(dp) :: numbers(3, 2)

    numbers = 1
    residual = xdot + x
    select case (self%kind)
    case (1)
      residual(1:3) = matmul(numbers, x(1:3))
    case (2)
      residual(1) = dot_product(x(1:2), x(1:3))
    case (3)
      residual(1:2) = matmul(x(1:2), numbers)
    case (4)
      residual(1:3) = sum(reshape(x, [3, 1]), 3)
    case (5)
      residual(1:2) = sum(matmul(numbers, reshape(x, [3, 1])), 2)
    end select
    associate (u1 => t) ! unused
    end associate
  end subroutine write_mistake

end module arrays_problem

!> A program that has the names of the module itself.
module own_names
  use, intrinsic :: iso_c_binding, only: dp => c_double
  use sfdae, only: sfdae_choose, sfdae_derivative, sfdae_expression, sfdae_external_value, &
    sfdae_named_parameter, sfdae_table, sfdae_time_derivative, expr => expression, lookup => table, &
    assignment(=), operator(*)
  implicit none
  private

  public :: twice_the_table

  type :: expression
    real(dp) :: table = 2
  end type expression

contains

  function twice_the_table(choose) result(derivative)
    type(sfdae_expression), intent(in) :: choose
    type(expr) :: derivative
    type(expression) :: own
    type(sfdae_expression) :: table

    table = lookup(choose, 1, [0.0_dp, 1.0_dp], [0.0_dp, 3.0_dp])
    derivative = own%table * sfdae_choose(choose, table, sfdae_table(choose, 1, [0.0_dp, 1.0_dp], &
      [0.0_dp, 7.0_dp]))
  end function twice_the_table

end module own_names

program arrays_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use arrays_problem, only: mistaken, three_masses
  use own_names, only: twice_the_table
  use sfdae
  use test_support, only: check, check_status, finish, within
  implicit none

  real(dp) :: a(2, 3), b(3, 2), c(3), d(2)
  type(expression) :: ea(2, 3), eb(3, 2), ec(3), ed(2)

  a = reshape([1.5_dp, -2.0_dp, 3.0_dp, 0.25_dp, -7.0_dp, 4.0_dp], [2, 3])
  b = reshape([2.0_dp, 0.5_dp, -1.0_dp, 3.0_dp, -4.0_dp, 6.0_dp], [3, 2])
  c = [1.0_dp, -3.0_dp, 2.5_dp]
  d = [4.0_dp, -0.5_dp]
  ea = a
  eb = b
  ec = c
  ed = d
  call check_sums()
  call check_products()
  call check_equations()
  call check_mistakes()
  call check_names()
  call finish()

contains

  subroutine expect(found, expected, what)
    type(expression), intent(in) :: found
    real(dp), intent(in) :: expected
    character(len=*), intent(in) :: what

    call check(within(found%value, expected, abs(expected) + 1), what)
  end subroutine expect

  subroutine expect_all(found, expected, what)
    type(expression), intent(in) :: found(:)
    real(dp), intent(in) :: expected(:)
    character(len=*), intent(in) :: what
    integer :: i

    call check(size(found) == size(expected), "size of " // what)
    do i = 1, min(size(found), size(expected))
      call expect(found(i), expected(i), what)
    end do
  end subroutine expect_all

  subroutine check_sums()
    type(expression) :: none(0), extreme

    call expect(sum(ec), sum(c), "sum")
    call expect(sum(ea), sum(a), "sum of a matrix")
    call expect_all(sum(ea, 1), sum(a, 1), "sums of columns")
    call expect_all(sum(ea, 2), sum(a, 2), "sums of rows")
    call expect(maxval(ec), maxval(c), "maxval")
    call expect(minval(ec), minval(c), "minval")
    call expect(maxval(ea), maxval(a), "maxval of a matrix")
    call expect(minval(ea), minval(a), "minval of a matrix")
    call expect(norm2(ec), norm2(c), "norm2")
    call expect(norm2(ea), norm2(a), "norm2 of a matrix")
    call expect(sum(none), 0.0_dp, "sum of nothing")
    call expect(norm2(none), 0.0_dp, "norm2 of nothing")
    call expect(dot_product(none, none), 0.0_dp, "dot_product of nothing")
    extreme = maxval(none)
    call check(abs(extreme%value + huge(1.0_dp)) <= 0, "maxval of nothing")
    extreme = minval(none)
    call check(abs(extreme%value - huge(1.0_dp)) <= 0, "minval of nothing")
  end subroutine check_sums

  subroutine check_products()
    call expect(dot_product(ec, 2 * ec), dot_product(c, 2 * c), "dot_product")
    call expect(dot_product(ec, c + 1), dot_product(c, c + 1), "dot_product with numbers")
    call expect(dot_product(c + 1, ec), dot_product(c + 1, c), "dot_product of numbers")
    call expect_all(flat(matmul(ea, eb)), flat_numbers(matmul(a, b)), "matmul")
    call expect_all(flat(matmul(ea, b)), flat_numbers(matmul(a, b)), "matmul with numbers")
    call expect_all(flat(matmul(a, eb)), flat_numbers(matmul(a, b)), "matmul of numbers")
    call expect_all(matmul(ea, ec), matmul(a, c), "matrix * vector")
    call expect_all(matmul(ea, c), matmul(a, c), "matrix * numbers")
    call expect_all(matmul(a, ec), matmul(a, c), "numbers * vector")
    call expect_all(matmul(ed, ea), matmul(d, a), "vector * matrix")
    call expect_all(matmul(ed, a), matmul(d, a), "vector * numbers")
    call expect_all(matmul(d, ea), matmul(d, a), "numbers * matrix")
  end subroutine check_products

  function flat(matrix) result(entries)
    type(expression), intent(in) :: matrix(:, :)
    type(expression) :: entries(size(matrix))

    entries = reshape(matrix, [size(matrix)])
  end function flat

  function flat_numbers(matrix) result(entries)
    real(dp), intent(in) :: matrix(:, :)
    real(dp) :: entries(size(matrix))

    entries = reshape(matrix, [size(matrix)])
  end function flat_numbers

  !> The residuals of the equations at the solution are zero, and q(1) = sin t.
  subroutine check_equations()
    type(three_masses), target :: problem
    type(dae_solver) :: solver
    type(sfdae_characteristics) :: found
    real(dp) :: t, x(7), xdot(7), forces(3)
    integer(c_int) :: status

    problem%num_equations = 7
    problem%num_unknowns = 7
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    x = 0
    x(4) = 1
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check(status >= 0, "start")
    call solver%get_characteristics(found, status)
    call check(found%strangeness_index == 2 .and. found%differential == 4, "index of the masses")
    call solver%advance(2.0_dp, t, x, status, xdot)
    call check_status(status, sfdae_ok, "advance")
    forces = matmul(problem%mass, xdot(4:6)) + matmul(problem%stiffness, x(1:3))
    forces(1) = forces(1) - x(7)
    call check(all(abs(forces) < 1.0e-4_dp), "balance of forces")
    call check(abs(x(1) - sin(2.0_dp)) < 1.0e-12_dp, "motion of the first mass")
    call check(abs(xdot(4) + sin(2.0_dp)) < 1.0e-4_dp, "acceleration of the first mass")
    call solver%destroy()
  end subroutine check_equations

  subroutine check_mistakes()
    character(len=60), parameter :: texts(5) = [character(len=60) :: &
      "matmul(a, b), whose shapes (3, 2) and (3) do not agree,", &
      "dot_product(a, b), whose shapes (2) and (3) do not agree,", &
      "matmul(a, b), whose shapes (2) and (3, 2) do not agree,", &
      "sum(a, dim), whose dim is neither 1 nor 2,", &
      "matmul(a, b), whose shapes (3, 2) and (3, 1) do not agree,"]
    type(mistaken), target :: problem
    type(dae_solver) :: solver
    character(len=:), allocatable :: text
    integer(c_int) :: status
    integer :: i

    problem%num_equations = 3
    problem%num_unknowns = 3
    do i = 1, 5
      problem%kind = i
      call sfdae_check_nonlinear(problem, text, status)
      call check_status(status, sfdae_illegal_argument, trim(texts(i)))
      call check(index(text, trim(texts(i)) // " is not finite") > 0, text)
    end do
    problem%kind = 0
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "no mistake")
    call solver%destroy()
  end subroutine check_mistakes

  subroutine check_names()
    type(sfdae_expression) :: half
    type(expression) :: doubled

    half = 0.5_dp
    doubled = twice_the_table(half)
    call expect(doubled, 3.0_dp, "own names")
  end subroutine check_names

end program arrays_test
