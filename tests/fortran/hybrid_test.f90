! SPDX-License-Identifier: BSD-3-Clause
!
! Hybrid systems from Fortran.
module hybrid_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_switch, dae_transition, expression, nonlinear_dae, assignment(=), operator(+), &
    operator(-), operator(*)
  implicit none
  private

  !> Two capacitors, 1 and 3 F, and a switch: x1' + x1 + x3 = 0, 3 x2' - x3 = 0.
  type, extends(nonlinear_dae), public :: capacitors_dae
    real(dp) :: closed = 0
  contains
    procedure :: equations => capacitors_equations
  end type capacitors_dae

  !> x1' = x2, x2' = -9.81.
  type, extends(nonlinear_dae), public :: flight_dae
  contains
    procedure :: equations => flight_equations
  end type flight_dae

  !> x' = -2 right of x = y, else 2; y' = 1.5 right of it, else -3.
  type, extends(nonlinear_dae), public :: corner_dae
    real(dp) :: right = 0
  contains
    procedure :: equations => corner_equations
  end type corner_dae

  !> x = y.
  type, extends(dae_switch), public :: diagonal
  contains
    procedure :: surface => diagonal_surface
  end type diagonal

  !> Where the voltages differ by 2.
  type, extends(dae_transition), public :: closing
  contains
    procedure :: eval => closing_eval
    procedure :: eval_guard => closing_guard
  end type closing

  !> At the ground.
  type, extends(dae_transition), public :: bounce
  contains
    procedure :: eval => bounce_eval
    procedure :: eval_jump => bounce_jump
  end type bounce

contains

  subroutine capacitors_equations(self, t, x, xdot, residual)
    class(capacitors_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) + x(1) + x(3)
    residual(2) = 3 * xdot(2) - x(3)
    residual(3) = self%closed * (x(1) - x(2)) + (1 - self%closed) * x(3)
  end subroutine capacitors_equations

  subroutine flight_equations(self, t, x, xdot, residual)
    class(flight_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) - x(2)
    residual(2) = xdot(2) + 9.81_dp
  end subroutine flight_equations

  subroutine corner_equations(self, t, x, xdot, residual)
    class(corner_dae), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) - 2 + 4 * self%right
    residual(2) = xdot(2) + 3 - 4.5_dp * self%right
  end subroutine corner_equations

  subroutine diagonal_surface(self, t, x, g)
    class(diagonal), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(inout) :: g

    g = x(1) - x(2)
  end subroutine diagonal_surface

  subroutine closing_eval(self, t, x, xdot, g, status)
    class(closing), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: x(:)
    real(dp), intent(in) :: xdot(:)
    real(dp), intent(inout) :: g
    integer(c_int), intent(inout) :: status

    g = 2 - x(1) + x(2)
  end subroutine closing_eval

  subroutine closing_guard(self, t, x, xdot, g, status)
    class(closing), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: x(:)
    real(dp), intent(in) :: xdot(:)
    real(dp), intent(inout) :: g
    integer(c_int), intent(inout) :: status

    g = -xdot(1)
  end subroutine closing_guard

  subroutine bounce_eval(self, t, x, xdot, g, status)
    class(bounce), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: x(:)
    real(dp), intent(in) :: xdot(:)
    real(dp), intent(inout) :: g
    integer(c_int), intent(inout) :: status

    g = x(1)
  end subroutine bounce_eval

  subroutine bounce_jump(self, t, before, after, status)
    class(bounce), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: before(:)
    real(dp), intent(inout) :: after(:)
    integer(c_int), intent(inout) :: status

    after(2) = -0.7_dp * before(2)
  end subroutine bounce_jump

end module hybrid_problems

program hybrid_test
  use, intrinsic :: iso_c_binding, only: c_int, c_long, dp => c_double
  use sfdae, only: dae_hybrid, dae_sensitivities, dae_solution, dae_solver, sfdae_event, sfdae_illegal_argument, &
    sfdae_mode, sfdae_not_started, sfdae_ok, sfdae_passage, sfdae_statistics, &
    sfdae_transition_zero, sfdae_zeno
  use hybrid_problems, only: bounce, capacitors_dae, closing, corner_dae, diagonal, flight_dae
  use test_support, only: check, check_status, finish
  implicit none

  call keeps_charge()
  call accumulates()
  call slides()
  call bounces_with_sensitivities()
  call finish()

contains

  !> A mode that bounces off the ground.
  subroutine make_bouncing(problem, ground, solver, hybrid)
    type(flight_dae), target, intent(inout) :: problem
    type(bounce), target, intent(inout) :: ground
    type(dae_solver), intent(inout) :: solver
    type(dae_hybrid), intent(inout) :: hybrid
    integer(c_int) :: status

    problem%num_equations = 2
    problem%num_unknowns = 2
    call solver%create(problem, status)
    call hybrid%create(status)
    call hybrid%add_mode(solver, status)
    ground%from = 1
    ground%to = 1
    ground%kind = sfdae_transition_zero
    ground%direction = -1
    ground%has_jump = .true.
    call hybrid%add_transition(ground, status)
    call check_status(status, sfdae_ok, "a ball that bounces")
  end subroutine make_bouncing

  !> From height h: the first bounce at sqrt(2 h / g).
  subroutine bounces_with_sensitivities()
    real(dp), parameter :: g = 9.81_dp, h = 2.0_dp, e = 0.7_dp
    type(flight_dae), target :: problem
    type(bounce), target :: ground
    type(dae_solver) :: solver
    type(dae_hybrid) :: hybrid
    type(dae_sensitivities) :: wanted
    integer(c_int) :: status
    real(dp) :: t, x(2), s(2, 1), sdot(2, 1), dt(1), wrong(2, 2), first, slope
    real(dp) :: weights(2, 2), gradient(1, 2)

    call hybrid%set_sensitivities(wanted, status)
    call check_status(status, sfdae_illegal_argument, "before create")
    call make_bouncing(problem, ground, solver, hybrid)
    wanted%parameter_names = [""]
    allocate (wanted%directions(2, 1))
    wanted%directions(:, 1) = [1.0_dp, 0.0_dp]
    call hybrid%set_sensitivities(wanted, status)
    call check_status(status, sfdae_ok, "set_sensitivities")
    call hybrid%get_sensitivities(0.0_dp, s, status)
    call check_status(status, sfdae_not_started, "S before start")
    x = [h, 0.0_dp]
    call hybrid%start(1, 0.0_dp, 1.0_dp, x, status)
    call hybrid%get_passage_sensitivities(dt, status)
    call check_status(status, sfdae_not_started, "no transition")
    call hybrid%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call hybrid%get_sensitivities(1.0_dp, s, status, sdot)
    call check_status(status, sfdae_ok, "get_sensitivities")
    first = sqrt(2 * h / g)
    slope = 1 / (g * first)
    ! x = e g t1 (t - t1) - g/2 (t - t1)**2
    call check(abs(s(1, 1) - slope * (e * g * (1 - 2 * first) + g * (1 - first))) < 1.0e-4_dp, "dx/dh")
    call check(abs(s(2, 1) - slope * g * (1 + e)) < 1.0e-4_dp, "dv/dh")
    call check(abs(sdot(1, 1) - s(2, 1)) < 1.0e-4_dp, "their slope")
    call hybrid%get_passage_sensitivities(dt, status)
    call check(status == sfdae_ok .and. abs(dt(1) - slope) < 1.0e-5_dp, "dt/dh")
    call hybrid%get_sensitivities(1.0_dp, wrong, status)
    call check_status(status, sfdae_illegal_argument, "too many columns")
    ! The same by the adjoint: both components at the end, as functionals.
    wanted%adjoint = .true.
    call hybrid%set_sensitivities(wanted, status)
    call check_status(status, sfdae_ok, "the adjoint")
    x = [h, 0.0_dp]
    call hybrid%start(1, 0.0_dp, 1.0_dp, x, status)
    call hybrid%advance(1.0_dp, t, x, status)
    weights = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
    call hybrid%get_gradient([1.0_dp], weights, gradient, status)
    call check_status(status, sfdae_ok, "get_gradient")
    call check(maxval(abs(gradient(1, :) - s(:, 1))) < 1.0e-4_dp, "gradients are rows of S")
    call hybrid%get_gradient([1.0_dp], weights(:1, :), gradient, status)
    call check_status(status, sfdae_illegal_argument, "too few weights")
    call hybrid%get_gradient([1.0_dp], weights, wrong, status)
    call check_status(status, sfdae_illegal_argument, "too many parameters")
    wanted%parameter_names = ["mass"]
    call hybrid%set_sensitivities(wanted, status)
    call check_status(status, sfdae_illegal_argument, "an unknown name")
    call solver%set_sensitivities(wanted, status)
    call check_status(status, sfdae_illegal_argument, "of a mode")
    call hybrid%destroy(status)
    call solver%destroy(status)
  end subroutine bounces_with_sensitivities

  subroutine slides()
    type(corner_dae), target :: problems(2)
    type(dae_solver) :: solvers(2)
    type(dae_hybrid) :: hybrid
    type(diagonal) :: surface
    type(sfdae_passage) :: passage
    integer(c_int) :: status, number
    real(dp) :: t, x(2)
    integer :: k

    call hybrid%add_switch(surface, status)
    call check_status(status, sfdae_illegal_argument, "add_switch before create")
    call hybrid%create(status)
    do k = 1, 2
      problems(k)%num_equations = 2
      problems(k)%num_unknowns = 2
      problems(k)%right = k - 1
      call solvers(k)%create(problems(k), status)
      call hybrid%add_mode(solvers(k), status)
    end do
    call hybrid%add_switch(surface, status)
    call check_status(status, sfdae_illegal_argument, "modes that there are not")
    surface%below = 1
    surface%above = 2
    call hybrid%add_switch(surface, status, "along", number)
    call check_status(status, sfdae_ok, "add_switch")
    call check(number == 3, "the sliding mode")
    x = [1.5_dp, 1.0_dp]
    call hybrid%start(2, 0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call hybrid%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance along the surface")
    call check(maxval(abs(x - 217.0_dp / 238.0_dp)) < 1.0e-5_dp, "x(1) = y(1) = 217 / 238")
    call hybrid%get_passage(1_c_long, passage, status)
    call check(passage%from == 2 .and. passage%to == 3 .and. passage%transition == 2, "to the surface")
    call hybrid%destroy(status)
    do k = 1, 2
      call solvers(k)%destroy(status)
      call check_status(status, sfdae_ok, "destroy")
    end do
  end subroutine slides

  subroutine keeps_charge()
    type(capacitors_dae), target :: problems(2)
    type(dae_solver) :: solvers(2)
    type(dae_hybrid) :: hybrid
    type(closing), target :: close
    type(dae_solution) :: solution
    type(sfdae_mode) :: mode
    type(sfdae_passage) :: passage
    type(sfdae_statistics) :: statistics
    integer(c_int) :: status, number
    integer(c_long) :: count
    real(dp) :: t, x(3), xdot(3), y(3), before(3), after(3), impulse(3), short(2)
    real(dp), allocatable :: checkpoint(:)
    character(len=:), allocatable :: text
    integer :: k

    x = [4.0_dp, 0.0_dp, 0.0_dp]
    call hybrid%start(1, 0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_illegal_argument, "start before create")
    call hybrid%create(status)
    call check_status(status, sfdae_ok, "create")
    do k = 1, 2
      problems(k)%num_equations = 3
      problems(k)%num_unknowns = 3
      problems(k)%closed = k - 1
      call solvers(k)%create(problems(k), status)
      call hybrid%add_mode(solvers(k), status, trim(merge("open  ", "closed", k == 1)), number)
      call check_status(status, sfdae_ok, "add_mode")
      call check(number == k, "modes count from 1")
    end do
    close%from = 1
    close%to = 5
    call hybrid%add_transition(close, status)
    call check_status(status, sfdae_illegal_argument, "a mode that there is not")
    close%to = 2
    close%has_guard = .true.
    call hybrid%add_transition(close, status, number)
    call check_status(status, sfdae_ok, "add_transition")
    call check(number == 1, "transitions count from 1")
    call solution%create(status)
    call hybrid%record(solution, status)
    call check_status(status, sfdae_ok, "record")
    short = 0
    call hybrid%start(1, 0.0_dp, 2.0_dp, short, status)
    call check_status(status, sfdae_illegal_argument, "x too short")
    call hybrid%start(1, 0.0_dp, 2.0_dp, x, status, xdot)
    call check_status(status, sfdae_ok, "start")
    call hybrid%get_accumulation(t, status)
    call check_status(status, sfdae_not_started, "nothing accumulates")
    call hybrid%advance_to_transition(2.0_dp, t, x, status)
    call check_status(status, sfdae_event, "advance_to_transition")
    call check(abs(t - log(2.0_dp)) < 1.0e-5_dp, "when the switch closes")
    call check(maxval(abs(x(1:2) - 0.5_dp)) < 1.0e-5_dp, "the charge is kept")
    call hybrid%get_current_mode(number, status)
    call check(number == 2, "the mode")
    call hybrid%get_num_passages(count, status)
    call check(count == 1, "one transition")
    call hybrid%get_passage(1_c_long, passage, status)
    call check_status(status, sfdae_ok, "get_passage")
    call check(passage%from == 1 .and. passage%to == 2 .and. passage%impulse_component == 3, "from 1")
    call hybrid%get_passage_values(before, after, status, impulse)
    call check_status(status, sfdae_ok, "get_passage_values")
    call check(abs(impulse(3) - 1.5_dp) < 1.0e-5_dp, "the charge that flows")
    call hybrid%save_checkpoint(checkpoint, status)
    call check_status(status, sfdae_ok, "save_checkpoint")
    call hybrid%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check(abs(x(1) - 0.5_dp * exp(-(2 - log(2.0_dp)) / 4)) < 1.0e-4_dp, "the end")
    call solution%evaluate(0.5_dp, y, status)
    call check(abs(y(1) - 4 * exp(-0.5_dp)) < 1.0e-4_dp, "the solution before")
    call hybrid%get_mode(2, mode, status)
    call check(mode%strangeness_index == 1 .and. mode%num_analyses == 1, "the index of the mode")
    call hybrid%get_statistics(statistics, status)
    call check(statistics%steps > mode%steps, "steps of all modes")
    call hybrid%report(text, status)
    call check(index(text, "(closed)") > 0, "the report")
    call hybrid%restore_checkpoint(checkpoint, status)
    call check_status(status, sfdae_ok, "restore_checkpoint")
    call hybrid%stop_recording(status)
    call hybrid%advance(2.0_dp, t, y, status)
    call check(all(abs(x - y) <= 0), "the same from a checkpoint")
    call solution%destroy(status)
    call hybrid%destroy(status)
    call check_status(status, sfdae_ok, "destroy")
    do k = 1, 2
      call solvers(k)%destroy(status)
      call check_status(status, sfdae_ok, "destroy a solver")
    end do
  end subroutine keeps_charge

  subroutine accumulates()
    type(flight_dae), target :: problem
    type(bounce), target :: ground
    type(dae_solver) :: solver
    type(dae_hybrid) :: hybrid
    integer(c_int) :: status
    real(dp) :: t, x(2), limit

    call make_bouncing(problem, ground, solver, hybrid)
    x = [0.0_dp, 5.0_dp]
    call hybrid%start(1, 0.0_dp, 10.0_dp, x, status)
    call hybrid%advance(10.0_dp, t, x, status)
    call check_status(status, sfdae_zeno, "bounces accumulate")
    call check(index(hybrid%message(), "accumulate") > 0, "the message")
    call hybrid%get_accumulation(limit, status)
    call check(abs(limit - 10 / (9.81_dp * 0.3_dp)) < 1.0e-3_dp, "where they do")
    call hybrid%destroy(status)
    call solver%destroy(status)
  end subroutine accumulates

end program hybrid_test
