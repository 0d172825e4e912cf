! SPDX-License-Identifier: BSD-3-Clause
!
! Nonlinear problems. The pendulum of length and mass 1, with positions x1, x2 and velocities x3, x4:
!
!     x1' = x3,  x2' = x4,  x3' = -2 x1 x5,  x4' = -2 x2 x5 - g,  0 = x1^2 + x2^2 - 1
!
! mu = 2, d = 2, a = 3. Energy (x3^2 + x4^2) / 2 + g x2 is conserved.
module nonlinear_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  implicit none
  private

  public :: pendulum_dae, differentiated_pendulum, pushed_mass, growing_dae, squared_slope, &
    gravity

  real(dp), parameter :: gravity = 9.81_dp

  !> Recorded. Gravity is the parameter "g".
  type, extends(nonlinear_dae) :: pendulum_dae
    !> Equations that are not written.
    integer :: forgotten = 0
  contains
    procedure :: equations => pendulum_equations
  end type pendulum_dae

  !> With total derivatives by the rule of Leibniz.
  type, extends(derivative_dae) :: differentiated_pendulum
    !> What is wrong with order 1: 'F', 'x' or 'd'.
    character :: mistake = ' '
    !> Calls with and without Jacobians.
    integer :: with_jacobians = 0, without = 0
    !> Status from this time on.
    real(dp) :: fail_from = huge(1.0_dp)
  contains
    procedure :: total_derivative => pendulum_derivative
  end type differentiated_pendulum

  !> x1' = x2, x2' = x3, 0 = x1 - sin t: which force moves a unit mass along sin t?
  type, extends(recorded_linear_dae) :: pushed_mass
  contains
    procedure :: linear_equations => pushed_mass_equations
  end type pushed_mass

  !> x1' = x1 x2 with x2 = cos t prescribed: x1 = exp(sin t).
  type, extends(nonlinear_dae) :: growing_dae
  contains
    procedure :: equations => growing_equations
    procedure :: eval_prescribed => growing_prescribed
  end type growing_dae

  !> x'**2 = 1.
  type, extends(nonlinear_dae) :: squared_slope
  contains
    procedure :: equations => squared_slope_equations
  end type squared_slope

contains

  subroutine squared_slope_equations(self, t, x, xdot, residual)
    class(squared_slope), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1)**2 - 1
  end subroutine squared_slope_equations

  subroutine pendulum_equations(self, t, x, xdot, residual)
    class(pendulum_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1:2) = xdot(1:2) - x(3:4)
    residual(3:4) = xdot(3:4) + 2 * x(1:2) * x(5)
    residual(4) = residual(4) + named_parameter(t, "g", gravity)
    if (self%forgotten == 0) residual(5) = x(1)**2 + x(2)**2 - 1
  end subroutine pendulum_equations

  subroutine pendulum_derivative(self, t, order, x, f, f_x, f_xdot, status)
    class(differentiated_pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(in) :: x(:, 0:)
    real(dp), intent(inout) :: f(:)
    real(dp), intent(inout), optional :: f_x(:, :)
    real(dp), intent(inout), optional :: f_xdot(:, :)
    integer(c_int), intent(inout) :: status
    real(dp) :: binomial
    integer :: i

    f(1:4) = x(1:4, order + 1)
    f(1:2) = f(1:2) - x(3:4, order)
    if (order == 0) f(4:5) = f(4:5) + [gravity, -1.0_dp]
    binomial = 1
    do i = 0, order
      f(3:4) = f(3:4) + 2 * binomial * x(1:2, i) * x(5, order - i)
      f(5) = f(5) + binomial * dot_product(x(1:2, i), x(1:2, order - i))
      binomial = binomial * (order - i) / (i + 1)
    end do
    if (order == 1 .and. self%mistake == 'F') f(4) = f(4) + 1.0e-3_dp
    if (present(f_x)) then
      if (order == 0) f_x(1, 3) = -1
      if (order == 0) f_x(2, 4) = -1
      f_x(3, 1) = 2 * x(5, order)
      f_x(4, 2) = 2 * x(5, order)
      f_x(3:4, 5) = 2 * x(1:2, order)
      f_x(5, 1:2) = 2 * x(1:2, order)
      if (order == 1 .and. self%mistake == 'x') f_x(3, 5) = 0
    end if
    if (present(f_xdot) .and. order == 0) then
      do i = 1, 4
        f_xdot(i, i) = 1
      end do
    end if
    if (present(f_xdot) .and. order == 1 .and. self%mistake == 'd') f_xdot(2, 4) = 1
    self%with_jacobians = self%with_jacobians + merge(1, 0, present(f_x))
    self%without = self%without + merge(0, 1, present(f_x))
    if (t > self%fail_from) status = -1
  end subroutine pendulum_derivative

  subroutine pushed_mass_equations(self, t, e, a, f)
    class(pushed_mass), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(inout) :: e(:, :)
    type(expression), intent(inout) :: a(:, :)
    type(expression), intent(inout) :: f(:)

    e(1, 1) = 1
    e(2, 2) = 1
    a(1, 2) = 1
    a(2, 3) = 1
    a(3, 1) = 1
    f(3) = -sin(t)
  end subroutine pushed_mass_equations

  subroutine growing_equations(self, t, x, xdot, residual)
    class(growing_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) - x(1) * x(2)
  end subroutine growing_equations

  subroutine growing_prescribed(self, t, values, status)
    class(growing_dae), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(inout) :: values(:)
    integer(c_int), intent(inout) :: status

    values = cos(t)
  end subroutine growing_prescribed

end module nonlinear_problems

program nonlinear_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  use nonlinear_problems, only: differentiated_pendulum, gravity, growing_dae, pendulum_dae, &
    pushed_mass, squared_slope
  use test_support, only: check, check_close, check_status, finish
  implicit none

  real(dp), parameter :: tol = 1.0e-8_dp

  call solves_the_recorded_pendulum(sfdae_method_bdf)
  call solves_the_recorded_pendulum(sfdae_method_radau)
  call parameters_have_names()
  call derivatives_of_the_user_do_the_same()
  call mistakes_in_derivatives_are_found()
  call failures_of_derivatives_are_passed_on()
  call linear_equations_are_solved_as_such()
  call structure_is_certified()
  call components_are_prescribed()
  call only_constraints_are_differentiated()
  call slopes_are_guessed()
  call forces_are_found()
  call refuses_wrong_use()
  call finish()

contains

  !> Constraints hold to rounding; energy, constraints and characteristic values are right.
  subroutine solves_the_recorded_pendulum(method)
    integer(c_int), intent(in) :: method
    type(pendulum_dae), target :: problem
    type(dae_solver) :: solver
    type(dae_options) :: options
    type(sfdae_characteristics) :: c
    type(sfdae_statistics) :: statistics
    real(dp) :: t, x(5), xdot(5)
    integer(c_int) :: status

    problem%num_equations = 5
    problem%num_unknowns = 5
    options%rtol = tol
    options%atol = tol
    options%method = method
    call solver%create(problem, status, options)
    call check_status(status, sfdae_ok, "create")
    x = [1.1_dp, 0.1_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%analyze_at(0.0_dp, 1.0_dp, x, status, c)
    call check_status(status, sfdae_ok, "analyze_at")
    call check(c%strangeness_index == 2 .and. c%differential == 2 .and. c%algebraic == 3, &
      "characteristic values of the pendulum")
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status, xdot)
    call check_status(status, sfdae_ok, "start")
    call check_close(xdot(1:4), [0.0_dp, 0.0_dp, 0.0_dp, -gravity], tol, tol, "x' at the start")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check_pendulum(x, gravity)
    call solver%get_statistics(statistics, status)
    call check(statistics%evaluations_residual > 0 .and. statistics%linearizations > 0, "counts")
    call solver%destroy()
  end subroutine solves_the_recorded_pendulum

  !> The kinematics once, the constraint twice; too few are told, wrong numbers of counts refused.
  subroutine only_constraints_are_differentiated()
    type(pendulum_dae), target :: problem
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp) :: t, x(5)
    integer(c_int) :: status

    problem%num_equations = 5
    problem%num_unknowns = 5
    options%rtol = tol
    options%atol = tol
    problem%differentiations = [1_c_int, 1_c_int, 0_c_int, 0_c_int, 2_c_int]
    call solver%create(problem, status, options)
    call check_status(status, sfdae_ok, "create with differentiations")
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance with differentiations")
    call check_pendulum(x, gravity)
    call solver%destroy()
    problem%differentiations(5) = 1
    call solver%create(problem, status, options)
    call solver%start(1.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_index_too_high, "too few differentiations")
    call solver%destroy()
    problem%differentiations = [1_c_int, 2_c_int]
    call solver%create(problem, status, options)
    call check_status(status, sfdae_illegal_argument, "two counts for five equations")
    call solver%destroy()
  end subroutine only_constraints_are_differentiated

  !> Energy to 100 tolerances of its size, all constraints to rounding.
  subroutine check_pendulum(x, g)
    real(dp), intent(in) :: x(5)
    real(dp), intent(in) :: g

    call check_close([sum(x(3:4)**2) / 2 + g * x(2)], [0.0_dp], 0.0_dp, 10 * g * tol, "energy")
    call check(abs(sum(x(1:2)**2) - 1) < 1.0e-12_dp, "position constraint")
    call check(abs(dot_product(x(1:2), x(3:4))) < 1.0e-11_dp, "velocity constraint")
    call check(abs(sum(x(3:4)**2) - 2 * x(5) - g * x(2)) < 1.0e-10_dp, "acceleration constraint")
  end subroutine check_pendulum

  !> They can be changed.
  subroutine parameters_have_names()
    type(pendulum_dae), target :: problem
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp) :: t, x(5), g
    integer(c_int) :: status

    problem%num_equations = 5
    problem%num_unknowns = 5
    options%rtol = tol
    options%atol = tol
    call solver%create(problem, status, options)
    g = 0
    call solver%get_parameter("g", g, status)
    call check(abs(g - gravity) <= 0, "value of g")
    call solver%set_parameter("g ", 1.62_dp, status)
    call check_status(status, sfdae_ok, "set_parameter")
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_pendulum(x, 1.62_dp)
    call solver%set_parameter("h", 1.0_dp, status)
    call check_status(status, sfdae_illegal_argument, "no such parameter")
    call check(len(solver%message()) > 0, "words on the parameter")
    call solver%get_parameter("h", g, status)
    call check_status(status, sfdae_illegal_argument, "value of no parameter")
    call check(abs(g - gravity) <= 0, "value left alone")
    call solver%destroy()
  end subroutine parameters_have_names

  !> The same pendulum.
  subroutine derivatives_of_the_user_do_the_same()
    type(differentiated_pendulum), target :: problem
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp) :: t, x(5)
    integer(c_int) :: status

    problem%num_equations = 5
    problem%num_unknowns = 5
    options%rtol = tol
    options%atol = tol
    call solver%create(problem, status, options)
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start with derivatives of the user")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance with derivatives of the user")
    call check_pendulum(x, gravity)
    call check(problem%with_jacobians > 0, "Jacobians are asked for")
    call check(problem%without > 0, "Jacobians are absent")
    call solver%destroy()
  end subroutine derivatives_of_the_user_do_the_same

  !> And located; right ones are not suspected.
  subroutine mistakes_in_derivatives_are_found()
    character, parameter :: mistakes(4) = [' ', 'F', 'x', 'd']
    integer, parameter :: rows(4) = [0, 4, 3, 2], columns(4) = [0, 1, 5, 4]
    type(differentiated_pendulum), target :: problem
    type(dae_solver) :: solver
    type(sfdae_derivative_check) :: found
    real(dp) :: jet(5, 4)
    integer(c_int) :: status
    integer :: i, k

    problem%num_equations = 5
    problem%num_unknowns = 5
    jet = reshape([(cos(1.0_dp * i), i=1, 20)], [5, 4])
    call solver%create(problem, status)
    do k = 1, 4
      problem%mistake = mistakes(k)
      call solver%check_total_derivatives(0.3_dp, jet, found, status)
      call check_status(status, sfdae_ok, "check_total_derivatives")
      call check(found%suspicious == merge(0, 1, k == 1), "mistake " // mistakes(k))
      if (k > 1) call check(found%function == mistakes(k) .and. found%order == 1 .and. &
        found%row == rows(k) .and. found%column == columns(k), "place of mistake " // mistakes(k))
    end do
    call solver%check_total_derivatives(0.3_dp, jet(1:4, :), found, status)
    call check_status(status, sfdae_illegal_argument, "jet of wrong size")
    call solver%check_total_derivatives(0.3_dp, jet(:, 1:1), found, status)
    call check_status(status, sfdae_illegal_argument, "jet without x'")
    call solver%destroy()
  end subroutine mistakes_in_derivatives_are_found

  !> The last good point is returned.
  subroutine failures_of_derivatives_are_passed_on()
    type(differentiated_pendulum), target :: problem
    type(dae_solver) :: solver
    real(dp) :: t, x(5)
    integer(c_int) :: status

    problem%num_equations = 5
    problem%num_unknowns = 5
    problem%fail_from = 0.5_dp
    call solver%create(problem, status)
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start before the failure")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_callback_stopped, "advance into the failure")
    call check(t > 0 .and. t <= 0.5_dp, "the last good point")
    call check(abs(sum(x(1:2)**2) - 1) < 1.0e-5_dp, "x at the last good point")
    call solver%destroy()
  end subroutine failures_of_derivatives_are_passed_on

  !> They have projectors and need no x.
  subroutine linear_equations_are_solved_as_such()
    type(pushed_mass), target :: problem
    type(dae_solver) :: solver
    type(sfdae_characteristics) :: c
    type(sfdae_derivative_check) :: found
    real(dp) :: t, x(3)
    real(dp), allocatable :: t2(:, :)
    integer(c_int) :: status

    problem%num_equations = 3
    problem%num_unknowns = 3
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    call solver%analyze(0.0_dp, 1.0_dp, status, c)
    call check_status(status, sfdae_ok, "analyze")
    call check(c%strangeness_index == 2 .and. c%algebraic == 3, "index of the pushed mass")
    x = 0
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%advance(2.0_dp, t, x, status)
    call check_close(x, [sin(2.0_dp), cos(2.0_dp), -sin(2.0_dp)], tol, tol, "the pushed mass")
    call solver%check_derivatives(0.5_dp, 2_c_int, found, status)
    call check(status == sfdae_ok .and. found%suspicious == 0, "check_derivatives")
    call solver%get_projectors(0.5_dp, status, t2=t2)
    call check(size(t2, 1) == 3 .and. size(t2, 2) == 0, "T2")
    call solver%destroy()
  end subroutine linear_equations_are_solved_as_such

  !> What follows from the unknowns that the equations of the pendulum contain.
  subroutine structure_is_certified()
    type(pendulum_dae) :: problem
    type(dae_solver) :: solver
    type(sfdae_structure) :: structure
    integer(c_int), allocatable :: counts(:), orders(:), assigned(:), block(:)
    character(len=:), allocatable :: text
    real(dp) :: x(5)
    integer(c_int) :: status
    integer :: i

    problem%num_equations = 5
    problem%num_unknowns = 5
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    call solver%get_structure(structure, status)
    call check_status(status, sfdae_ok, "get_structure")
    call check(structure%verdict == sfdae_structure_unchecked, "not checked yet")
    x = [0.6_dp, -0.8_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%get_structure(structure, status, counts, orders, assigned, block)
    call check_status(status, sfdae_ok, "get_structure")
    call check(structure%verdict == sfdae_structure_certified .and. structure%is_followed == 1 &
      .and. structure%freedom == 2 .and. structure%doubtful_block == 0, "certified")
    call check(all(counts == [1, 1, 0, 0, 2]), "differentiations")
    call check(all(orders == [2, 2, 1, 1, 0]), "orders")
    call check(all(block == 1), "one block")
    call check(all([(count(assigned == i) == 1, i=1, 5)]), "every unknown is assigned once")
    call solver%export_source(sfdae_source_fortran, "pendulum", text, status)
    call check_status(status, sfdae_ok, "export_source")
    call check(index(text, "module pendulum_model"//new_line('a')) > 0, "source text")
    call check(index(text, "pendulum_size = 9") > 0 .and. index(text, achar(0)) == 0, "its size")
    call solver%export_source(sfdae_source_c, "no name", text, status)
    call check_status(status, sfdae_illegal_argument, "export_source")
    call check(len(text) > 1000, "the text stays")
    call solver%destroy()
  end subroutine structure_is_certified

  !> One of two unknowns is free.
  subroutine components_are_prescribed()
    type(growing_dae), target :: problem
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp) :: t, x(2)
    integer(c_int) :: status

    problem%num_equations = 1
    problem%num_unknowns = 2
    problem%prescribed = [2]
    options%rtol = tol
    options%atol = tol
    call solver%create(problem, status, options)
    x = 1
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%advance(2.0_dp, t, x, status)
    call check_close(x, [exp(sin(2.0_dp)), cos(2.0_dp)], tol, tol, "the prescribed growth")
    call solver%destroy()
  end subroutine components_are_prescribed

  !> In words.
  !> Either branch of x'**2 = 1.
  subroutine slopes_are_guessed()
    type(squared_slope), target :: problem
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp) :: t, slope, x(1), xdot(1)
    integer(c_int) :: status
    integer :: k

    problem%num_equations = 1
    problem%num_unknowns = 1
    options%xdot_is_guess = .true.
    do k = -1, 1, 2
      slope = real(k, dp)
      call solver%create(problem, status, options)
      call check_status(status, sfdae_ok, "create")
      x = 2
      xdot = 0.5_dp * slope
      call solver%start(0.0_dp, 1.0_dp, x, status, xdot)
      call check_status(status, sfdae_ok, "start with a slope")
      call check_close(xdot, [slope], 1.0e-13_dp, 1.0e-13_dp, "slope at the start")
      call solver%advance(1.0_dp, t, x, status)
      call check_status(status, sfdae_ok, "advance")
      call check_close(x, [2 + slope], 1.0e-5_dp, 1.0e-5_dp, "branch")
      call solver%destroy()
    end do
  end subroutine slopes_are_guessed

  !> A force that is not known changes nothing else; a position off the circle does, and that is said.
  subroutine forces_are_found()
    type(pendulum_dae), target :: problem
    type(dae_solver) :: solver
    real(dp) :: x(5)
    integer(c_int) :: status

    problem%num_equations = 5
    problem%num_unknowns = 5
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    x = [0.6_dp, -0.8_dp, 0.8_dp, 0.6_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start without the force")
    call check_close(x, [0.6_dp, -0.8_dp, 0.8_dp, 0.6_dp, (1 + 0.8_dp * gravity) / 2], &
      1.0e-13_dp, 1.0e-13_dp, "start values")
    x(1) = 0.7_dp
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_values_changed, "start beside the circle")
    call check(index(solver%message(), " changed from ") > 0, "words on the change")
    call solver%destroy()
  end subroutine forces_are_found

  subroutine refuses_wrong_use()
    type(pendulum_dae), target :: problem
    type(dae_solver) :: solver
    real(dp) :: x(4), jet(5, 3)
    type(sfdae_derivative_check) :: found
    integer(c_int) :: status
    character(len=:), allocatable :: text

    call sfdae_check_nonlinear(problem, text, status)
    call check_status(status, sfdae_empty_problem, "check of an empty problem")
    problem%num_equations = 5
    problem%num_unknowns = 5
    problem%forgotten = 1
    call sfdae_check_nonlinear(problem, text, status)
    call check_status(status, sfdae_illegal_argument, "check of a forgotten equation")
    call solver%create(problem, status)
    call check_status(status, sfdae_illegal_argument, "a forgotten equation")
    call check(solver%message() == text .and. index(text, "residual[4]") > 0, "words on it")
    problem%forgotten = 0
    problem%prescribed = [6]
    call solver%create(problem, status)
    call check_status(status, sfdae_illegal_argument, "a component that is not there")
    deallocate (problem%prescribed)
    call sfdae_check_nonlinear(problem, text, status)
    call check(status == sfdae_ok .and. len(text) == 0, "no words on a good problem")

    call solver%set_parameter("g", 1.0_dp, status)
    call check_status(status, sfdae_illegal_argument, "no solver")
    call solver%create(problem, status)
    x = 1
    call solver%analyze_at(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_illegal_argument, "too few values")
    call solver%analyze(0.0_dp, 1.0_dp, status)
    call check_status(status, sfdae_illegal_argument, "analyze without x")
    jet = 1
    call solver%check_total_derivatives(0.0_dp, jet, found, status)
    call check_status(status, sfdae_illegal_argument, "derivatives are the library's")
    call solver%destroy()
  end subroutine refuses_wrong_use

end program nonlinear_test
