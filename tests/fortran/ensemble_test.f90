! SPDX-License-Identifier: BSD-3-Clause
!
! Ensembles from Fortran: x1' = x2, x2' = -p**2 x1, 0 = z**3 + z - x1, from (1, 0): x1 = cos(p t).
module ensemble_problems
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  implicit none
  private

  public :: oscillator, counter

  type, extends(nonlinear_dae) :: oscillator
  contains
    procedure :: equations => oscillator_equations
  end type oscillator

  !> Counts instances, and stops after some.
  type, extends(dae_ensemble_monitor) :: counter
    integer :: count = 0
    integer :: last = 1000
    integer :: sum_of_instances = 0
  contains
    procedure :: after_instance => count_instance
  end type counter

contains

  subroutine oscillator_equations(self, t, x, xdot, residual)
    class(oscillator), intent(inout) :: self
    type(expression), intent(in) :: t
    type(expression), intent(in) :: x(:)
    type(expression), intent(in) :: xdot(:)
    type(expression), intent(inout) :: residual(:)
    type(expression) :: p

    p = named_parameter(t, "p", 1.0_dp)
    residual(1) = xdot(1) - x(2)
    residual(2) = xdot(2) + p**2 * x(1)
    residual(3) = x(3)**3 + x(3) - x(1)
  end subroutine oscillator_equations

  subroutine count_instance(self, progress, stop_now)
    class(counter), intent(inout) :: self
    type(sfdae_ensemble_progress), intent(in) :: progress
    logical, intent(inout) :: stop_now

    self%count = self%count + 1
    self%sum_of_instances = self%sum_of_instances + progress%instance
    stop_now = self%count >= self%last
  end subroutine count_instance

end module ensemble_problems

program ensemble_test
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  use ensemble_problems, only: counter, oscillator
  use test_support, only: check, finish
  implicit none

  integer, parameter :: instances = 5
  type(oscillator), target :: problem
  type(dae_solver) :: solver
  type(dae_ensemble_results) :: nothing
  integer(c_int) :: status

  problem%num_equations = 3
  problem%num_unknowns = 3
  call solver%create(problem, status)
  call check(status == sfdae_ok, "create")
  call test_solution()
  call test_threads()
  call test_failure()
  call test_monitor()
  call test_refusals()
  call solver%destroy(status)
  call solver%solve_ensemble(oscillators(), nothing, status)
  call check(status == sfdae_illegal_argument, "without a solver")
  call finish()

contains

  function oscillators() result(ensemble)
    type(dae_ensemble) :: ensemble
    integer :: i

    allocate (ensemble%parameter_names(1), ensemble%parameters(1, instances), &
      ensemble%x0(3, instances), ensemble%times(2))
    ensemble%parameter_names = "p"
    do i = 1, instances
      ensemble%parameters(1, i) = 1 + 0.25_dp * i
      ensemble%x0(:, i) = [1.0_dp, 0.0_dp, 0.5_dp]
    end do
    ensemble%times = [0.5_dp, 2.0_dp]
    ensemble%num_threads = 2
  end function oscillators

  !> Errors of phases stay far below 1000 tolerances.
  subroutine test_solution()
    type(dae_ensemble) :: ensemble
    type(dae_ensemble_results) :: results
    integer :: i, k

    ensemble = oscillators()
    ensemble%wants_xdot = .true.
    call solver%solve_ensemble(ensemble, results, status)
    call check(status == sfdae_ok, "status of the ensemble")
    call check(solver%message() == "", "message of the ensemble")
    call check(all(shape(results%x) == [3, 2, instances]), "shape of x")
    call check(all(results%statuses == sfdae_ok), "statuses")
    call check(all(results%num_outputs == 2), "num_outputs")
    call check(all(results%messages == ""), "messages")
    call check(results%num_failed == 0 .and. results%num_analyses == 1, "summary")
    do i = 1, instances
      do k = 1, 2
        associate (x => results%x(:, k, i), p => ensemble%parameters(1, i), t => ensemble%times(k))
          call check(abs(x(1) - cos(p * t)) < 1.0e-3_dp, "x1 = cos(p t)")
          call check(abs(x(3)**3 + x(3) - x(1)) < 1.0e-12_dp, "the constraint")
          call check(abs(results%xdot(1, k, i) - x(2)) < 1.0e-3_dp, "x1' = x2")
        end associate
      end do
    end do
  end subroutine test_solution

  subroutine test_threads()
    type(dae_ensemble) :: ensemble
    type(dae_ensemble_results) :: one, several

    ensemble = oscillators()
    ensemble%num_threads = 1
    call solver%solve_ensemble(ensemble, one, status)
    ensemble%num_threads = 3
    call solver%solve_ensemble(ensemble, several, status)
    call check(all(abs(one%x - several%x) <= 0), "the same whatever the number of threads")
    call check(.not. allocated(one%xdot), "x' was not wanted")
  end subroutine test_threads

  subroutine test_failure()
    type(dae_ensemble) :: ensemble
    type(dae_ensemble_results) :: results

    ensemble = oscillators()
    ensemble%x0(2, 3) = ieee_value(1.0_dp, ieee_quiet_nan)
    call solver%solve_ensemble(ensemble, results, status)
    call check(status == sfdae_instances_failed, "some failed")
    call check(results%num_failed == 1 .and. count(results%statuses == sfdae_ok) == instances - 1, &
      "one failed")
    call check(results%statuses(3) == sfdae_illegal_argument, "the third one failed")
    call check(index(results%messages(3), "x contains NaN or Inf") == 1, "why it failed")
    call check(results%num_outputs(3) == 0, "it has no outputs")
    call check(all(abs(results%x(:, :, 3)) <= 0), "what it has not is zero")
  end subroutine test_failure

  subroutine test_monitor()
    type(dae_ensemble) :: ensemble
    type(dae_ensemble_results) :: results
    type(counter), target :: watch

    ensemble = oscillators()
    ensemble%monitor => watch
    call solver%solve_ensemble(ensemble, results, status)
    call check(watch%count == instances .and. watch%sum_of_instances == 15, "every instance once")
    watch%last = instances + 1
    ensemble%num_threads = 1
    call solver%solve_ensemble(ensemble, results, status)
    call check(status == sfdae_stopped, "stopped by the monitor")
    call check(results%statuses(1) == sfdae_ok .and. all(results%statuses(2:) == sfdae_stopped), &
      "after the first one")
  end subroutine test_monitor

  subroutine test_refusals()
    type(dae_ensemble) :: ensemble
    type(dae_ensemble_results) :: results

    results%num_failed = 77
    call refuse(ensemble, results, "x0 or times is not allocated")
    ensemble = oscillators()
    ensemble%x0 = reshape([1.0_dp, 2.0_dp], [2, 1])
    call refuse(ensemble, results, "a column of x0 has 2 entries, but n = 3")
    ensemble = oscillators()
    ensemble%parameter_names = ["p", "q"]
    call refuse(ensemble, results, "a column of parameters has 1 entries, but P = 2")
    ensemble = oscillators()
    ensemble%parameters = reshape([1.0_dp], [1, 1])
    call refuse(ensemble, results, "a row of parameters has 1 entries, but N = 5")
    ensemble = oscillators()
    ensemble%parameter_names = ["q"]
    call refuse(ensemble, results, "there is no parameter ""q"" in the equations.")
    ensemble = oscillators()
    ensemble%times = [real(dp) ::]
    call refuse(ensemble, results, "num_times = 0; it must be >= 1.")
  end subroutine test_refusals

  subroutine refuse(ensemble, results, why)
    type(dae_ensemble), intent(in) :: ensemble
    type(dae_ensemble_results), intent(inout) :: results
    character(len=*), intent(in) :: why

    call solver%solve_ensemble(ensemble, results, status)
    call check(status == sfdae_illegal_argument, "refused: " // why)
    call check(solver%message() == why, solver%message() // " /= " // why)
    call check(results%num_failed == 77, "results stay")
  end subroutine refuse

end program ensemble_test
