! SPDX-License-Identifier: BSD-3-Clause
!
! A nonlinear problem given by its derivative array, and the splitting of its Jacobian. The pendulum of
! length and mass 1, with positions x1, x2 and velocities x3, x4:
!
!     x1' = x3,  x2' = x4,  x3' = -2 x1 x5,  x4' = -2 x2 x5 - g,  0 = x1^2 + x2^2 - 1
!
! mu = 2, d = 2, a = 3. Energy (x3^2 + x4^2) / 2 + g x2 is conserved.
module array_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: derivative_array_dae, sfdae_order_not_available
  implicit none
  private

  public :: array_pendulum, gravity

  real(dp), parameter :: gravity = 9.81_dp

  type, extends(derivative_array_dae) :: array_pendulum
    !> Row and column of an entry that is changed, if the array has it.
    integer :: row = 0, column = 0
    !> Calls with and without the Jacobian.
    integer :: with_jacobian = 0, without = 0
    integer(c_int) :: highest = 0, available = huge(1_c_int)
  contains
    procedure :: derivative_array => pendulum_array
  end type array_pendulum

contains

  !> Partial derivatives of each term. Column l n + j is that of the derivative of order l of x(j).
  subroutine pendulum_array(self, t, order, x, f, jacobian, status)
    class(array_pendulum), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(in) :: x(:, 0:)
    real(dp), intent(inout) :: f(:)
    real(dp), intent(inout), optional :: jacobian(:, :)
    integer(c_int), intent(inout) :: status
    real(dp) :: binomial
    integer :: k, l, r

    self%highest = max(self%highest, order)
    if (order > self%available) status = sfdae_order_not_available
    if (present(jacobian)) self%with_jacobian = self%with_jacobian + 1
    if (.not. present(jacobian)) self%without = self%without + 1
    do k = 0, order
      r = 5 * k
      f(r+1:r+4) = x(1:4, k + 1)
      f(r+1:r+2) = f(r+1:r+2) - x(3:4, k)
      if (k == 0) f(4:5) = f(4:5) + [gravity, -1.0_dp]
      binomial = 1
      do l = 0, k
        f(r+3:r+4) = f(r+3:r+4) + 2 * binomial * x(1:2, l) * x(5, k - l)
        f(r+5) = f(r+5) + binomial * dot_product(x(1:2, l), x(1:2, k - l))
        if (present(jacobian)) call add_terms(binomial)
        binomial = binomial * (k - l) / (l + 1)
      end do
      if (.not. present(jacobian)) cycle
      do l = 1, 4
        jacobian(r + l, r + 5 + l) = 1
      end do
      jacobian(r + 1, r + 3) = -1
      jacobian(r + 2, r + 4) = -1
    end do
    if (present(jacobian) .and. self%row > 0) then
      if (self%row <= size(jacobian, 1) .and. self%column <= size(jacobian, 2)) &
        jacobian(self%row, self%column) = jacobian(self%row, self%column) + 1.0e-3_dp
    end if

  contains

    subroutine add_terms(c)
      real(dp), intent(in) :: c

      jacobian(r + 3, 5 * l + 1) = 2 * c * x(5, k - l)
      jacobian(r + 4, 5 * l + 2) = 2 * c * x(5, k - l)
      jacobian(r+3:r+4, 5 * l + 5) = 2 * c * x(1:2, k - l)
      jacobian(r + 5, 5*l+1:5*l+2) = 2 * c * x(1:2, k - l)
    end subroutine add_terms
  end subroutine pendulum_array

end module array_problems

program derivative_array_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use array_problems, only: array_pendulum, gravity
  use sfdae
  use test_support, only: check, check_status, finish
  implicit none

  real(dp), parameter :: tol = 1.0e-8_dp

  call arrays_are_used()
  call contradictions_are_reported()
  call derivatives_are_compared()
  call jacobians_are_split()
  call finish()

contains

  function pendulum() result(problem)
    type(array_pendulum) :: problem

    problem%num_equations = 5
    problem%num_unknowns = 5
  end function pendulum

  subroutine arrays_are_used()
    type(array_pendulum), target :: problem
    type(dae_solver) :: solver
    type(dae_options) :: options
    type(sfdae_characteristics) :: found
    real(dp) :: t, x(5)
    integer(c_int) :: status

    problem = pendulum()
    options%rtol = tol
    options%atol = tol
    call solver%create(problem, status, options)
    call check_status(status, sfdae_ok, "create")
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call solver%get_characteristics(found, status)
    call check(found%strangeness_index == 2 .and. found%differential == 2, "index")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check(abs(x(1)**2 + x(2)**2 - 1) < 1.0e-13_dp, "length")
    call check(abs(dot_product(x(3:4), x(3:4)) / 2 + gravity * x(2)) < 1.0e3_dp * tol, "energy")
    call check(problem%with_jacobian > 0 .and. problem%without > 0, "the Jacobian may be absent")
    call check(problem%highest == 3, "orders up to mu + 1")
    problem%available = 1
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_order_missing, "order 2 is not available")
    call solver%destroy()
  end subroutine arrays_are_used

  subroutine contradictions_are_reported()
    type(array_pendulum), target :: problem
    type(dae_solver) :: solver
    real(dp) :: x(5)
    integer(c_int) :: status

    problem = pendulum()
    problem%row = 4
    problem%column = 12
    call solver%create(problem, status)
    x = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_wrong_derivatives, "a wrong block")
    call check(index(solver%message(), "row 3, column 11 of the Jacobian") == 1, solver%message())
    call check(all(abs(x - [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]) <= 0), "x untouched")
    call solver%destroy()
  end subroutine contradictions_are_reported

  subroutine derivatives_are_compared()
    type(array_pendulum), target :: problem
    type(dae_solver) :: solver
    type(sfdae_derivative_check) :: found
    real(dp) :: jet(5, 4)
    integer(c_int) :: status
    integer :: i

    problem = pendulum()
    jet = reshape([(cos(1.0_dp * i), i=1, 20)], [5, 4])
    call solver%create(problem, status)
    call solver%check_total_derivatives(0.3_dp, jet, found, status)
    call check_status(status, sfdae_ok, "check_total_derivatives")
    call check(found%suspicious == 0, "right derivatives")
    problem%row = 14
    problem%column = 5
    call solver%check_total_derivatives(0.3_dp, jet, found, status)
    call check(found%suspicious == 1 .and. found%row == 4 .and. found%column == 5 .and. &
      found%order == 2 .and. found%function == 'x', "F_x of order 2")
    call solver%destroy()
  end subroutine derivatives_are_compared

  subroutine jacobians_are_split()
    type(array_pendulum) :: problem
    real(dp) :: jet(5, 0:3), f(15), jacobian(15, 20), f_x(5, 5, 3), f_xdot(5, 5, 3)
    character(len=:), allocatable :: text
    integer(c_int) :: status
    integer :: i

    jet = reshape([(sin(1.0_dp * i), i=1, 20)], [5, 4])
    f = 0
    jacobian = 0
    status = sfdae_ok
    call problem%derivative_array(0.0_dp, 2_c_int, jet, f, jacobian, status)
    call sfdae_split_derivative_array(jacobian, f_x, f_xdot, text, status)
    call check_status(status, sfdae_ok, "split")
    call check(len(text) == 0, "no message")
    do i = 1, 3
      call check(all(abs(f_x(3:4, 5, i) - 2 * jet(1:2, i - 1)) <= 0), "F_x")
      call check(nint(f_x(1, 3, i)) == merge(-1, 0, i == 1), "constant entry of F_x")
      call check(i == 1 .or. all(abs(f_xdot(:, :, i)) <= 0), "F_x'")
    end do
    call check(nint(f_xdot(4, 4, 1)) == 1 .and. abs(f_xdot(5, 5, 1)) <= 0, "F_x' of order 0")
    f_x = 7
    jacobian(4, 12) = 1
    call sfdae_split_derivative_array(jacobian, f_x, f_xdot, text, status)
    call check_status(status, sfdae_wrong_derivatives, "a contradiction")
    call check(index(text, "row 3, column 11 ") == 1 .and. all(abs(f_x - 7) <= 0), text)
    call sfdae_split_derivative_array(jacobian(:, 1:15), f_x, f_xdot, text, status)
    call check_status(status, sfdae_illegal_argument, "a Jacobian of wrong size")
    call sfdae_split_derivative_array(jacobian, f_x, f_xdot(:, :, 1:2), text, status)
    call check_status(status, sfdae_illegal_argument, "f_xdot of wrong size")
    call check(index(text, "f_xdot") > 0, text)
  end subroutine jacobians_are_split

end program derivative_array_test
