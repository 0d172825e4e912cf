! SPDX-License-Identifier: BSD-3-Clause
!
! The theory's objects of nonlinear problems and mechanical systems by their defining properties.
! The pendulum of length, mass and gravity 1, positions x1, x2, velocities x3, x4:
!
!     x1' = x3,  x2' = x4,  x3' = -x1 x5,  x4' = -x2 x5 - 1,  0 = (x1^2 + x2^2 - 1) / 2
!
! mu = 2, d = 2, a = 3.
module theory_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  implicit none
  private

  public :: nonlinear_pendulum, mechanical_pendulum, evaluated_pendulum

  type, extends(nonlinear_dae) :: nonlinear_pendulum
  contains
    procedure :: equations => nonlinear_equations
  end type nonlinear_pendulum

  type, extends(recorded_multibody_dae) :: mechanical_pendulum
  contains
    procedure :: equations => mechanical_equations
  end type mechanical_pendulum

  type, extends(multibody_dae) :: evaluated_pendulum
  contains
    procedure :: forces => pendulum_forces
    procedure :: constraints => pendulum_constraints
    procedure :: constraint_jacobian => pendulum_jacobian
  end type evaluated_pendulum

contains

  subroutine nonlinear_equations(self, t, x, xdot, residual)
    class(nonlinear_pendulum), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1:2) = xdot(1:2) - x(3:4)
    residual(3:4) = xdot(3:4) + x(1:2) * x(5)
    residual(4) = residual(4) + 1
    residual(5) = (x(1)**2 + x(2)**2 - 1) * 0.5_dp
  end subroutine nonlinear_equations

  subroutine mechanical_equations(self, t, q, v, to)
    class(mechanical_pendulum), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: q(:)
    type(expression), intent(in) :: v(:)
    type(multibody_formulas), intent(in) :: to

    to%mass(1, 1) = 1
    to%mass(2, 2) = 1
    to%forces(2) = -1
    to%constraints(1) = (q(1)**2 + q(2)**2 - 1) * 0.5_dp
  end subroutine mechanical_equations

  subroutine pendulum_forces(self, t, q, v, vector, status)
    class(evaluated_pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(in) :: v(:)
    real(dp), intent(inout) :: vector(:)
    integer(c_int), intent(inout) :: status

    vector(2) = -1
  end subroutine pendulum_forces

  subroutine pendulum_constraints(self, t, q, vector, status)
    class(evaluated_pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(inout) :: vector(:)
    integer(c_int), intent(inout) :: status

    vector(1) = (dot_product(q, q) - 1) / 2
  end subroutine pendulum_constraints

  subroutine pendulum_jacobian(self, t, q, matrix, status)
    class(evaluated_pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    real(dp), intent(in) :: q(:)
    real(dp), intent(inout) :: matrix(:, :)
    integer(c_int), intent(inout) :: status

    matrix(1, :) = q
  end subroutine pendulum_jacobian

end module theory_problems

program theory_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  use theory_problems, only: evaluated_pendulum, mechanical_pendulum, nonlinear_pendulum
  use test_support, only: check, check_status, finish
  implicit none

  !> Entries of all matrices are below 10, sums have up to 15 terms, pivots are of order 1.
  real(dp), parameter :: rounding = 1.0e4_dp * epsilon(1.0_dp)

  call of_a_nonlinear_problem()
  call of_a_recorded_system()
  call of_an_evaluated_system()
  call finish()

contains

  subroutine of_a_nonlinear_problem()
    type(nonlinear_pendulum), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp), allocatable :: m(:, :), t2(:, :), jet(:, :), narrow(:, :)
    real(dp) :: t, x(5), short(4)

    problem%num_equations = 5
    problem%num_unknowns = 5
    call solver%create(problem, status)
    allocate (m(1, 1), narrow(5, 2))
    m = 77
    narrow = 0
    short = 0
    call solver%get_derivative_array(0.0_dp, 0_c_int, status, m)
    call check_status(status, sfdae_not_started, "array before an analysis")
    call solver%get_projectors(0.0_dp, status, t2=t2)
    call check_status(status, sfdae_not_started, "projectors before an analysis")
    call check(m(1, 1) > 76 .and. .not. allocated(t2), "results of failed calls")
    x = [0.8_dp, -0.6_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call check_objects(solver, 0.0_dp)
    call solver%advance(1.0_dp, t, x, status)
    call check_objects(solver, 1.0_dp)
    call solver%get_jet(1.0_dp, 2_c_int, status, jet, x)
    call check_status(status, sfdae_ok, "get_jet at x")
    call check(all(abs(jet(:, 1) - x) <= 0), "x stays")
    call solver%get_jet(1.0_dp, 2_c_int, status, jet, short)
    call check_status(status, sfdae_illegal_argument, "x of a wrong size")
    call solver%get_projectors(1.0_dp, status, t2=t2, jet=narrow)
    call check_status(status, sfdae_illegal_argument, "a jet of a low level")
    call solver%get_extended_system(1.0_dp, status)
    call check_status(status, sfdae_illegal_argument, "no mechanical system")
    call solver%destroy()
  end subroutine of_a_nonlinear_problem

  subroutine of_a_recorded_system()
    type(mechanical_pendulum), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp), allocatable :: qv(:, :), e(:, :), a(:, :), f(:), w(:)
    real(dp) :: t, x(5)

    problem%num_positions = 2
    problem%num_constraints = 1
    call solver%create(problem, status)
    x = [0.8_dp, -0.6_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call check_objects(solver, 0.0_dp)
    call solver%advance(1.0_dp, t, x, status)
    call check_objects(solver, 1.0_dp)
    call solver%get_extended_system(1.0_dp, status, qv=qv, e=e, a=a, f=f, w=w)
    call check_status(status, sfdae_ok, "get_extended_system")
    call check(all(shape(e) == 7) .and. all(shape(a) == 7) .and. size(w) == 2, "sizes")
    call check(maxval(abs(matmul(transpose(qv), qv) - unit(2))) <= rounding, "partition")
    call check(maxval(abs(f)) <= rounding, "what is left of the extended system")
    ! v' = (0, -1) - q lambda
    call check(abs(w(2) - dot_product(qv(:, 2), [0.0_dp, -1.0_dp] - x(1:2) * x(5))) <= rounding, &
      "accelerations along Q2")
    call solver%destroy()
  end subroutine of_a_recorded_system

  !> Without the array.
  subroutine of_an_evaluated_system()
    type(evaluated_pendulum), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp), allocatable :: z1(:, :), z2(:, :), t2(:, :), a2(:, :), f1(:), f2(:), jet(:, :)
    real(dp) :: x(5)

    problem%num_positions = 2
    problem%num_constraints = 1
    call solver%create(problem, status)
    x = [0.8_dp, -0.6_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%get_projectors(0.0_dp, status, z1=z1, z2=z2)
    call check_status(status, sfdae_order_missing, "Z2 without formulas")
    call check(.not. allocated(z1) .and. .not. allocated(z2), "results of a failed call")
    call solver%get_jet(0.0_dp, 0_c_int, status, jet)
    call check_status(status, sfdae_ok, "get_jet")
    call solver%get_projectors(0.0_dp, status, z1=z1, t2=t2, jet=jet)
    call check_status(status, sfdae_ok, "get_projectors without Z2")
    call solver%get_strangeness_free(0.0_dp, status, f1=f1, a2=a2, f2=f2, jet=jet)
    call check_status(status, sfdae_ok, "get_strangeness_free")
    call check(maxval(abs(matmul(a2, t2))) <= rounding, "A2 T2 = 0")
    call check(maxval(abs(f1)) <= rounding .and. maxval(abs(f2)) <= rounding, "residuals")
    call solver%destroy()
  end subroutine of_an_evaluated_system

  !> At a jet of the solution, and without it.
  subroutine check_objects(solver, t)
    type(dae_solver), intent(inout) :: solver
    real(dp), intent(in) :: t
    real(dp), allocatable :: m(:, :), n(:, :), g(:), z1(:, :), z2(:, :), z3(:, :), t2(:, :)
    real(dp), allocatable :: e1(:, :), a2(:, :), f1(:), f2(:), jet(:, :)
    integer(c_int) :: status

    call solver%get_jet(t, 2_c_int, status, jet)
    call check_status(status, sfdae_ok, "get_jet")
    if (status /= sfdae_ok) return
    call solver%get_derivative_array(t, 2_c_int, status, m, n, g, jet)
    call check_status(status, sfdae_ok, "get_derivative_array")
    call solver%get_projectors(t, status, z1, z2, z3, t2, jet)
    call check_status(status, sfdae_ok, "get_projectors")
    call solver%get_strangeness_free(t, status, e1=e1, f1=f1, a2=a2, f2=f2, jet=jet)
    call check_status(status, sfdae_ok, "get_strangeness_free")
    call check(all(shape(jet) == [5, 4]) .and. all(shape(z2) == [15, 3]) .and. &
      size(z3, 2) == 0, "sizes")
    call check(maxval(abs(g)) <= rounding, "F_mu = 0")
    call check(maxval(abs(matmul(transpose(z2), m))) <= rounding, "Z2^T M = 0")
    call check(maxval(abs(matmul(transpose(z2), z2) - unit(3))) <= rounding, "Z2 is orthonormal")
    call check(maxval(abs(matmul(transpose(z1), z1) - unit(2))) <= rounding, "Z1 is orthonormal")
    call check(maxval(abs(matmul(matmul(transpose(z2), n), t2))) <= rounding, "Z2^T N T2 = 0")
    call check(maxval(abs(matmul(a2, t2))) <= rounding, "A2 T2 = 0")
    call check(maxval(abs(matmul(transpose(z1), m(1:5, 1:5)) - e1)) <= rounding, "E1 = Z1^T E")
    call check(maxval(abs(f1)) <= rounding .and. maxval(abs(f2)) <= rounding, "residuals")
    call solver%get_derivative_array(t, 2_c_int, status, m)
    call solver%get_projectors(t, status, z2=z2)
    call check(maxval(abs(matmul(transpose(z2), m))) <= rounding, "Z2^T M = 0 of the solution")
  end subroutine check_objects

  pure function unit(n) result(matrix)
    integer, intent(in) :: n
    real(dp) :: matrix(n, n)
    integer :: i

    matrix = 0
    do i = 1, n
      matrix(i, i) = 1
    end do
  end function unit

end program theory_test
