! SPDX-License-Identifier: BSD-3-Clause
!
! Linearization from Fortran: a pendulum in Cartesian coordinates at its lower equilibrium, length
! 1/2, mass 2.
module linearization_problems
  use, intrinsic :: iso_c_binding, only: dp => c_double
  use sfdae
  implicit none
  private

  public :: pendulum
  real(dp), parameter, public :: length = 0.5_dp, mass = 2, gravity = 9.81_dp

  type, extends(nonlinear_dae) :: pendulum
  contains
    procedure :: equations => pendulum_equations
  end type pendulum

contains

  subroutine pendulum_equations(self, t, x, xdot, residual)
    class(pendulum), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)

    residual(1) = xdot(1) - x(3)
    residual(2) = xdot(2) - x(4)
    residual(3) = mass * xdot(3) + x(1) * x(5) - named_parameter(t, "force", 0.0_dp)
    residual(4) = mass * xdot(4) + x(2) * x(5) + mass * gravity
    residual(5) = x(1)**2 + x(2)**2 - length**2
  end subroutine pendulum_equations

end module linearization_problems

program linearization_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  use linearization_problems, only: gravity, length, mass, pendulum
  use test_support, only: check, finish
  implicit none

  type(pendulum), target :: problem
  type(dae_solver) :: solver
  type(dae_linearization) :: choice
  type(dae_descriptor) :: descriptor
  integer(c_int) :: status

  problem%num_equations = 5
  problem%num_unknowns = 5
  call solver%create(problem, status)
  call check(status == sfdae_ok, "create")
  call solver%linearize(choice, descriptor, status)
  call check(status == sfdae_not_started, "there is no solution yet")
  choice%x = [0.0_dp, -length, 0.0_dp, 0.0_dp, mass * gravity / length]
  choice%xdot = spread(0.0_dp, 1, 5)
  choice%input_parameters = ["force"]
  choice%output_unknowns = [1_c_int]
  choice%output_rows = reshape([0.0_dp, 0.0_dp, 2.0_dp, 0.0_dp, 0.0_dp], [1, 5])
  call solver%linearize(choice, descriptor, status)
  call check(status == sfdae_ok, "linearize: " // solver%message())
  call check_descriptor()
  call check_matrices()
  call check_refusals()
  call descriptor%destroy(status)
  call solver%destroy(status)
  call finish()

contains

  subroutine check_descriptor()
    type(sfdae_spectrum) :: spectrum
    complex(dp), allocatable :: poles(:), zeros(:), H(:, :, :)
    real(dp), allocatable :: errors(:)
    real(dp) :: omega
    complex(dp) :: s(2), expected
    character(len=:), allocatable :: message

    omega = sqrt(gravity / length)
    call descriptor%get_poles(spectrum, poles, status, errors)
    call check(status == sfdae_ok .and. spectrum%num_finite == 2 .and. spectrum%num_infinite == 3 &
      .and. spectrum%strangeness_index == 2, "spectrum")
    call check(size(poles) == 2 .and. size(errors) == 2, "numbers of poles")
    call check(abs(poles(1) - cmplx(0, omega, dp)) < 1e-13_dp * omega, "first pole")
    call check(abs(poles(2) - cmplx(0, -omega, dp)) < 1e-13_dp * omega, "second pole")
    call descriptor%get_zeros(spectrum, zeros, status)
    call check(status == sfdae_ok .and. size(zeros) == 0, "no zeros are common to both outputs")
    s = [cmplx(0, 1, dp), cmplx(2, -3, dp)]
    call descriptor%get_transfer(s, H, status)
    call check(status == sfdae_ok .and. all(shape(H) == [2, 1, 2]), "shape of H")
    expected = 1 / (mass * (s(2)**2 + omega**2))
    call check(abs(H(1, 1, 2) - expected) < 1e-13_dp * abs(expected), "position")
    call check(abs(H(2, 1, 2) - 2 * s(2) * expected) < 1e-13_dp * abs(s(2) * expected), &
      "twice the velocity")
    call descriptor%get_transfer([cmplx(0, omega, dp)], H, status)
    call check(status == sfdae_singular, "a pole has no value")
    message = descriptor%message()
    call check(index(message, "a pole") > 0, "message of a pole: " // message)
  end subroutine check_descriptor

  subroutine check_matrices()
    type(dae_descriptor) :: copy
    type(sfdae_spectrum) :: spectrum
    complex(dp), allocatable :: poles(:)
    real(dp), allocatable :: E(:, :), A(:, :), B(:, :), C(:, :), D(:, :)
    integer(c_int) :: m, n, q, p

    call descriptor%get_sizes(m, n, q, p, status)
    call check(all([m, n, q, p] == [5, 5, 1, 2]), "sizes")
    call descriptor%get_matrices(E, A, B, C, D, status)
    call check(status == sfdae_ok .and. are(E(3, 3), mass) .and. are(B(3, 1), 1.0_dp), &
      "E and B")
    call check(are(C(1, 1), 1.0_dp) .and. are(C(2, 3), 2.0_dp) .and. are(maxval(abs(D)), 0.0_dp), &
      "C and D")
    call copy%create(E, A, status, B=B, C=C, D=D)
    call check(status == sfdae_ok, "create of matrices")
    call copy%get_poles(spectrum, poles, status)
    call check(status == sfdae_ok .and. size(poles) == 2, "poles of matrices")
    call copy%create(E, A(:, 1:4), status)
    call check(status == sfdae_illegal_argument, "matrices of other sizes")
    call copy%destroy(status)
  end subroutine check_matrices

  !> The same number, but for rounding errors.
  pure function are(a, b) result(equal)
    real(dp), intent(in) :: a, b
    logical :: equal

    equal = abs(a - b) <= epsilon(a) * abs(b)
  end function are

  subroutine check_refusals()
    character(len=:), allocatable :: message

    choice%input_unknowns = [6_c_int]
    call solver%linearize(choice, descriptor, status)
    call check(status == sfdae_illegal_argument, "unknown 6 of 5")
    deallocate (choice%input_unknowns)
    choice%x = [1.0_dp]
    call solver%linearize(choice, descriptor, status)
    message = solver%message()
    call check(status == sfdae_illegal_argument, "x is too short")
    call check(index(message, "x has 1") > 0, "message of x: " // message)
  end subroutine check_refusals

end program linearization_test
