! SPDX-License-Identifier: BSD-3-Clause
!
! Names of equations and constraints in messages. x' = -x, y = log(x - 1/2) has no value for
! x = 1/4; two rods of different lengths from one point to another contradict each other.
module named_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  implicit none
  private

  public :: tank, level, rods

  type, extends(nonlinear_dae) :: tank
  contains
    procedure :: equations => tank_equations
  end type tank

  !> 0 = x - 1, 0 = x - 2.
  type, extends(linear_dae) :: level
  contains
    procedure :: eval_e => level_e
    procedure :: eval_a => level_a
    procedure :: eval_f => level_f
  end type level

  type, extends(recorded_multibody_dae) :: rods
  contains
    procedure :: equations => rods_equations
  end type rods

contains

  subroutine tank_equations(self, t, x, xdot, residual)
    class(tank), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) + x(1)
    residual(2) = x(2) - log(x(1) - 0.5_dp)
  end subroutine tank_equations

  subroutine level_e(self, t, order, e, status)
    class(level), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status
  end subroutine level_e

  subroutine level_a(self, t, order, a, status)
    class(level), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) a = 1
  end subroutine level_a

  subroutine level_f(self, t, order, f, status)
    class(level), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: f(:)
    integer(c_int), intent(inout) :: status

    if (order == 0) f = [-1.0_dp, -2.0_dp]
  end subroutine level_f

  subroutine rods_equations(self, t, q, v, to)
    class(rods), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: q(:)
    type(expression), intent(in) :: v(:)
    type(multibody_formulas), intent(in) :: to

    to%mass(1, 1) = 1
    to%mass(2, 2) = 1
    to%constraints(1) = q(1)**2 + q(2)**2 - 1
    to%constraints(2) = q(1)**2 + q(2)**2 - 4
  end subroutine rods_equations

end module named_problems

program equation_names_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use named_problems, only: level, rods, tank
  use sfdae
  use test_support, only: check, check_status, finish
  implicit none

  call check_nonlinear()
  call check_linear()
  call check_multibody()
  call check_wrong_numbers()
  call finish()

contains

  !> The start fails, and its message has some of the words.
  subroutine check_start(solver, x, expected, words, what)
    type(dae_solver), intent(inout) :: solver
    real(dp), intent(in) :: x(:)
    integer(c_int), intent(in) :: expected
    character(len=*), intent(in) :: words(:)
    character(len=*), intent(in) :: what
    character(len=:), allocatable :: message
    real(dp) :: guess(size(x))
    integer(c_int) :: status
    integer :: i

    guess = x
    call solver%start(0.0_dp, 1.0_dp, guess, status)
    call check_status(status, expected, "start with " // what)
    message = solver%message()
    call check(any([(index(message, trim(words(i))) > 0, i=1, size(words))]), what)
    call solver%destroy(status)
  end subroutine check_start

  subroutine check_nonlinear()
    type(tank), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status

    problem%num_equations = 2
    problem%num_unknowns = 2
    problem%equation_names = [character(len=20) :: "balance of mass", "level"]
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create a nonlinear problem")
    problem%equation_names = "" ! they are copied
    call check_start(solver, [0.25_dp, 0.0_dp], sfdae_not_finite, &
      ["equation 1 (level)"], "name of a nonlinear equation")
  end subroutine check_nonlinear

  subroutine check_linear()
    type(level), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status

    problem%num_equations = 2
    problem%num_unknowns = 1
    problem%equation_names = [character(len=9) :: "", "high tide"]
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create a linear problem")
    call check_start(solver, [0.0_dp], sfdae_inconsistent_equations, &
      ["equations 0 and 1 (high tide) that cannot hold"], "names of linear equations")
  end subroutine check_linear

  subroutine check_multibody()
    type(rods), target :: problem
    type(dae_solver) :: solver
    real(dp) :: x(6)
    integer(c_int) :: status

    problem%num_positions = 2
    problem%num_constraints = 2
    problem%constraint_names = [character(len=9) :: "short rod", "long rod"]
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create a mechanical system")
    x = 0
    x(1) = 1
    call check_start(solver, x, sfdae_inconsistent_equations, &
      [character(len=13) :: "0 (short rod)", "1 (long rod)"], "name of a constraint")
  end subroutine check_multibody

  subroutine check_wrong_numbers()
    type(tank), target :: problem
    type(rods), target :: system
    type(dae_solver) :: solver
    character(len=:), allocatable :: text
    integer(c_int) :: status

    problem%num_equations = 2
    problem%num_unknowns = 2
    problem%equation_names = [character(len=4) :: "only"]
    call solver%create(problem, status)
    call check_status(status, sfdae_illegal_argument, "one name for two equations")
    call check(index(solver%message(), "equation_names has 1 entries, but m = 2") > 0, &
      "words on names")
    call sfdae_check_nonlinear(problem, text, status)
    call check(status == sfdae_illegal_argument .and. index(text, "equation_names") > 0, &
      "check of names")
    system%num_positions = 2
    system%num_constraints = 2
    system%constraint_names = [character(len=1) :: "a", "b", "c"]
    call solver%create(system, status)
    call check_status(status, sfdae_illegal_argument, "three names for two constraints")
    call check(index(solver%message(), "constraint_names has 3 entries") > 0, &
      "words on names of constraints")
  end subroutine check_wrong_numbers

end program equation_names_test
