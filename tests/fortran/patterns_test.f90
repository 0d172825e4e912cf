! SPDX-License-Identifier: BSD-3-Clause
!> The nonlinear equations
!>
!>     x1' = -x2,   0 = x2^3 + x2 - x1
!>
!> by values of the entries of their Jacobians, or by differences, with patterns and without; and
!> x1' = -x1, 0 = x1 - x2 as a
!> linear problem with entries.
module patterns_problem
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: derivative_dae, linear_dae, sfdae_order_not_available
  implicit none
  private

  public :: cubic, decay

  type, extends(derivative_dae) :: cubic
    logical :: was_asked = .false.
  contains
    procedure :: total_derivative
  end type cubic

  type, extends(linear_dae) :: decay
  contains
    procedure :: eval_e
    procedure :: eval_a
  end type decay

contains

  subroutine total_derivative(self, t, order, x, f, f_x, f_xdot, status)
    class(cubic), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(in) :: x(:, 0:)
    real(dp), intent(inout) :: f(:)
    real(dp), intent(inout), optional :: f_x(:, :), f_xdot(:, :)
    integer(c_int), intent(inout) :: status

    if (order > 1) then
      status = sfdae_order_not_available
    else if (order == 1) then
      f = [x(1, 2) + x(2, 1), (3*x(2, 0)**2 + 1)*x(2, 1) - x(1, 1)]
      if (present(f_x)) f_x(3, 1) = 6*x(2, 0)*x(2, 1)
    else
      f = [x(1, 1) + x(2, 0), x(2, 0)**3 + x(2, 0) - x(1, 0)]
      if (present(f_x)) then
        self%was_asked = .true.
        f_x(:, 1) = [-1.0_dp, 1.0_dp, 3*x(2, 0)**2 + 1]
      end if
      if (present(f_xdot)) f_xdot(1, 1) = 1
    end if
  end subroutine total_derivative

  subroutine eval_e(self, t, order, e, status)
    class(decay), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: e(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) e(1, 1) = 1
  end subroutine eval_e

  !> Entries (1, 1), (2, 1), (2, 2).
  subroutine eval_a(self, t, order, a, status)
    class(decay), intent(inout) :: self
    real(dp), intent(in) :: t
    integer(c_int), intent(in) :: order
    real(dp), intent(inout) :: a(:, :)
    integer(c_int), intent(inout) :: status

    if (order == 0) a(:, 1) = [-1.0_dp, 1.0_dp, -1.0_dp]
  end subroutine eval_a

end module patterns_problem

!> Patterns count from 1; their lengths are checked.
program patterns_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use test_support, only: check, check_status, finish
  use sfdae, only: dae_options, dae_solver, sfdae_check_nonlinear, sfdae_illegal_argument, &
    sfdae_matrices_compressed, sfdae_matrices_differences, sfdae_ok, sfdae_structure_required, &
    sparsity_pattern
  use patterns_problem, only: cubic, decay
  implicit none

  type(cubic), target :: problem
  type(decay), target :: linear
  integer(c_int) :: status
  real(dp) :: x(2), invariant
  character(len=:), allocatable :: text

  problem%num_equations = 2
  problem%num_unknowns = 2
  problem%pattern_f_x = sparsity_pattern([1, 2, 4], [2, 1, 2])
  problem%pattern_f_xdot = sparsity_pattern([1, 2, 2], [1])
  problem%matrices = sfdae_matrices_compressed
  call run_nonlinear("compressed")
  call check(problem%was_asked, "entries are asked for")
  problem%was_asked = .false.
  problem%matrices = sfdae_matrices_differences
  call run_nonlinear("differences")
  call check(.not. problem%was_asked, "differences ask for nothing")
  deallocate (problem%pattern_f_x%col_start, problem%pattern_f_x%row_index)
  deallocate (problem%pattern_f_xdot%col_start, problem%pattern_f_xdot%row_index)
  call run_nonlinear("residuals alone")
  call check(.not. problem%was_asked, "differences without patterns ask for nothing")
  problem%pattern_f_x = sparsity_pattern([1, 2, 4], [2, 1, 2])
  call run_linear()
  problem%pattern_f_xdot = sparsity_pattern([1, 2], [1])
  call sfdae_check_nonlinear(problem, text, status)
  call check_status(status, sfdae_illegal_argument, "a column too few")
  call check(index(text, "pattern_f_xdot%col_start has 2 entries") > 0, text)
  problem%pattern_f_xdot = sparsity_pattern([1, 2, 2], [3])
  call sfdae_check_nonlinear(problem, text, status)
  call check_status(status, sfdae_illegal_argument, "a row out of range")
  deallocate (text)
  call finish()

contains

  !> With v = x2: log v + 3/2 v^2 + t stays.
  subroutine run_nonlinear(name)
    character(len=*), intent(in) :: name
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp) :: t

    if (allocated(problem%pattern_f_x%col_start)) options%structure = sfdae_structure_required
    options%rtol = 1e-8_dp
    options%atol = 1e-8_dp
    call solver%create(problem, status, options)
    call check_status(status, sfdae_ok, "create: " // name)
    x = [2.0_dp, 1.0_dp]
    t = 0
    call solver%start(t, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start: " // name)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance: " // name)
    invariant = log(x(2)) + 1.5_dp*x(2)**2 + t
    call check(abs(invariant - 1.5_dp) < 1e-6_dp, "invariant: " // name)
    call solver%destroy()
  end subroutine run_nonlinear

  subroutine run_linear()
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp) :: t

    linear%num_equations = 2
    linear%num_unknowns = 2
    linear%has_f = .false.
    linear%pattern_e = sparsity_pattern([1, 2, 2], [1])
    linear%pattern_a = sparsity_pattern([1, 3, 4], [1, 2, 2])
    linear%matrices = sfdae_matrices_compressed
    options%structure = sfdae_structure_required
    call solver%create(linear, status, options)
    call check_status(status, sfdae_ok, "create: linear")
    x = 1
    t = 0
    call solver%start(t, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start: linear")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance: linear")
    call check(all(abs(x - exp(-1.0_dp)) < 1e-5_dp), "exp(-1)")
    call solver%destroy()
  end subroutine run_linear

end program patterns_test
