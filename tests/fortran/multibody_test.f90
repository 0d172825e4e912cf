! SPDX-License-Identifier: BSD-3-Clause
!
! Mechanical systems. The pendulum of length and gravity 1,
!
!     q'' = (0, -1) - lambda q,   0 = (|q|^2 - 1) / 2,   lambda = |v|^2 - q_2,
!
! whose energy |v|^2 / 2 + q_2 is conserved; and a skate on a plane that is inclined along the first
! coordinate, turning with unit speed from rest:
!
!     x = sin^2(t) / 2,  y = (t - sin t cos t) / 2,  theta = t
!
! (Ju. I. Neimark, N. A. Fufaev: Dynamics of Nonholonomic Systems. AMS, 1972.)
module multibody_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  implicit none
  private

  public :: recorded_pendulum, pendulum, skate, gliding_skate

  !> Gravity is the parameter "g".
  type, extends(recorded_multibody_dae) :: recorded_pendulum
  contains
    procedure :: equations => pendulum_equations
  end type recorded_pendulum

  type, extends(multibody_dae) :: pendulum
    !> Added to gamma.
    real(dp) :: mistake = 0
  contains
    procedure :: forces => pendulum_forces
    procedure :: constraints => pendulum_constraints
    procedure :: constraint_jacobian => pendulum_jacobian
    procedure :: constraint_curvature => pendulum_curvature
  end type pendulum

  !> With a condition on velocities.
  type, extends(recorded_multibody_dae) :: skate
  contains
    procedure :: equations => skate_equations
  end type skate

  !> With the speed along the blade and that of turning as velocities.
  type, extends(kinematic_multibody_dae) :: gliding_skate
  contains
    procedure :: forces => skate_forces
    procedure :: kinematics => skate_kinematics
  end type gliding_skate

contains

  subroutine pendulum_equations(self, t, q, v, to)
    class(recorded_pendulum), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: q(:)
    type(expression), intent(in) :: v(:)
    type(multibody_formulas), intent(in) :: to

    to%mass(1, 1) = 1
    to%mass(2, 2) = 1
    to%forces(2) = -named_parameter(t, "g", 1.0_dp)
    to%constraints(1) = (q(1)**2 + q(2)**2 - 1) * 0.5_dp
  end subroutine pendulum_equations

  subroutine pendulum_forces(self, t, q, v, vector, status)
    class(pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(in) :: v(:)
    real(dp), intent(inout) :: vector(:)
    integer(c_int), intent(inout) :: status

    vector(2) = -1
  end subroutine pendulum_forces

  subroutine pendulum_constraints(self, t, q, vector, status)
    class(pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(inout) :: vector(:)
    integer(c_int), intent(inout) :: status

    vector(1) = (dot_product(q, q) - 1) / 2
  end subroutine pendulum_constraints

  subroutine pendulum_jacobian(self, t, q, matrix, status)
    class(pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(inout) :: matrix(:, :)
    integer(c_int), intent(inout) :: status

    matrix(1, :) = q
  end subroutine pendulum_jacobian

  subroutine pendulum_curvature(self, t, q, v, vector, status)
    class(pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(in) :: v(:)
    real(dp), intent(inout) :: vector(:)
    integer(c_int), intent(inout) :: status

    vector(1) = dot_product(v, v) + self%mistake
  end subroutine pendulum_curvature

  subroutine skate_equations(self, t, q, v, to)
    class(skate), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: q(:)
    type(expression), intent(in) :: v(:)
    type(multibody_formulas), intent(in) :: to
    integer :: i

    do i = 1, 3
      to%mass(i, i) = 1
    end do
    to%forces(1) = 1
    to%nonholonomic_matrix(1, 1) = sin(q(3))
    to%nonholonomic_matrix(1, 2) = -cos(q(3))
  end subroutine skate_equations

  subroutine skate_forces(self, t, q, v, vector, status)
    class(gliding_skate), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(in) :: v(:)
    real(dp), intent(inout) :: vector(:)
    integer(c_int), intent(inout) :: status

    vector(1) = cos(q(3))
  end subroutine skate_forces

  subroutine skate_kinematics(self, t, q, matrix, status)
    class(gliding_skate), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(inout) :: matrix(:, :)
    integer(c_int), intent(inout) :: status

    matrix(1:2, 1) = [cos(q(3)), sin(q(3))]
    matrix(3, 2) = 1
  end subroutine skate_kinematics

end module multibody_problems

program multibody_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  use multibody_problems, only: gliding_skate, pendulum, recorded_pendulum, skate
  use test_support, only: check, check_close, check_status, finish
  implicit none

  call swing_recorded()
  call swing_evaluated()
  call glide()
  call check_curvature()
  call refuse_mistakes()
  call finish()

contains

  subroutine swing_recorded()
    type(recorded_pendulum), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: gravity

    problem%num_positions = 2
    problem%num_constraints = 1
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create")
    call check(problem%num_unknowns == 5, "unknowns are counted")
    call swing(solver, 1.0_dp)
    call solver%set_parameter("g", 2.0_dp, status)
    call check_status(status, sfdae_ok, "set_parameter")
    call solver%get_parameter("g", gravity, status)
    call check(gravity > 1.5_dp, "get_parameter")
    call swing(solver, 2.0_dp)
    call solver%destroy()
  end subroutine swing_recorded

  !> With and without gamma.
  subroutine swing_evaluated()
    type(pendulum), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status

    problem%num_positions = 2
    problem%num_constraints = 1
    call solver%create(problem, status)
    call swing(solver, 1.0_dp)
    call solver%destroy()
    problem%has_constraint_curvature = .true.
    call solver%create(problem, status)
    call swing(solver, 1.0_dp)
    call solver%destroy()
  end subroutine swing_evaluated

  !> From rest at the height 0 to t = 3.
  subroutine swing(solver, gravity)
    type(dae_solver), intent(inout) :: solver
    real(dp), intent(in) :: gravity
    type(sfdae_multibody_report) :: report
    real(dp) :: t, x(5)
    integer(c_int) :: status

    x = [1, 0, 0, 0, 0]
    call solver%start(0.0_dp, 3.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%advance(3.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check(abs(norm2(x(1:2)) - 1) <= 1.0e-12_dp, "length")
    call check(abs(dot_product(x(1:2), x(3:4))) <= 1.0e-12_dp, "velocity along the circle")
    call check(abs(dot_product(x(3:4), x(3:4)) / 2 + gravity * x(2)) <= 1.0e-4_dp, "energy")
    call check(abs(dot_product(x(3:4), x(3:4)) - gravity * x(2) - x(5)) <= 1.0e-10_dp, "force")
    call solver%get_multibody_report(report, status)
    call check_status(status, sfdae_ok, "get_multibody_report")
    call check(report%holonomic == 1 .and. report%degrees_of_freedom == 1, "report")
  end subroutine swing

  subroutine glide()
    type(skate), target :: constrained
    type(gliding_skate), target :: gliding
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(7), y(5), exact(3)

    exact = [sin(4.0_dp)**2 / 2, (4 - sin(4.0_dp) * cos(4.0_dp)) / 2, 4.0_dp]
    constrained%num_positions = 3
    constrained%num_nonholonomic = 1
    call solver%create(constrained, status)
    x = [0, 0, 0, 0, 0, 1, 0]
    call solver%start(0.0_dp, 4.0_dp, x, status)
    call solver%advance(4.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check_close(x(1:3), exact, 1.0e-6_dp, 1.0e-6_dp, "skate")
    call solver%destroy()

    gliding%num_positions = 3
    gliding%num_velocities = 2
    call solver%create(gliding, status)
    y = [0, 0, 0, 0, 1]
    call solver%start(0.0_dp, 4.0_dp, y, status)
    call solver%advance(4.0_dp, t, y, status)
    call check_status(status, sfdae_ok, "advance")
    call check_close(y(1:3), exact, 1.0e-6_dp, 1.0e-6_dp, "skate without constraint")
    call solver%destroy()
  end subroutine glide

  subroutine check_curvature()
    type(pendulum), target :: problem
    type(dae_solver) :: solver
    type(sfdae_derivative_check) :: found
    integer(c_int) :: status

    problem%num_positions = 2
    problem%num_constraints = 1
    problem%has_constraint_curvature = .true.
    call solver%create(problem, status)
    call solver%check_multibody_derivatives(0.0_dp, [0.6_dp, 0.7_dp], [1.0_dp, 2.0_dp], found, status)
    call check_status(status, sfdae_ok, "check_multibody_derivatives")
    call check(found%suspicious == 0, "gamma is right")
    problem%mistake = 1.0e-3_dp
    call solver%check_multibody_derivatives(0.0_dp, [0.6_dp, 0.7_dp], [1.0_dp, 2.0_dp], found, status)
    call check(found%suspicious == 1 .and. found%function == 'C', "gamma is wrong")
    call check(found%row == 1 .and. found%column == 1, "place of the mistake")
    call solver%check_multibody_derivatives(0.0_dp, [0.6_dp], [1.0_dp, 2.0_dp], found, status)
    call check_status(status, sfdae_illegal_argument, "q of a wrong size")
    call check(index(solver%message(), "nq = 2") > 0, solver%message())
    call solver%destroy()
  end subroutine check_curvature

  !> What has not been overridden is missed.
  subroutine refuse_mistakes()
    type(gliding_skate), target :: problem
    type(dae_solver) :: solver
    character(len=:), allocatable :: text
    integer(c_int) :: status
    real(dp) :: x(6)

    call sfdae_check_multibody(problem, text, status)
    call check_status(status, sfdae_empty_problem, "no positions")
    call check(len(text) > 0, "words")
    problem%num_positions = 3
    problem%num_velocities = 2
    problem%num_constraints = 1
    call solver%create(problem, status)
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_callback_stopped, "constraints are missing")
    call solver%destroy()
  end subroutine refuse_mistakes

end program multibody_test
