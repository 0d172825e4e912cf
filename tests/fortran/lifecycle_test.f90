! SPDX-License-Identifier: BSD-3-Clause
!
! Life cycle, wrong use and words: nothing of this integrates far.
program lifecycle_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae
  use test_support, only: check, check_close, check_status, counting_monitor, finish, mixed_dae
  implicit none

  call words()
  call refuses_wrong_problems()
  call refuses_wrong_options()
  call refuses_calls_without_solver()
  call refuses_arrays_of_wrong_size()
  call lives_a_thousand_times()
  call replaces_options()
  call finish()

contains

  !> Names and versions come from the library.
  subroutine words()
    character(len=20) :: expected

    write (expected, '(i0,2(".",i0))') sfdae_version_major, sfdae_version_minor, &
      sfdae_version_patch
    call check(sfdae_version() == trim(expected), "version of module and library")
    call check(sfdae_status_name(sfdae_ok) == "SFDAE_OK", "name of sfdae_ok")
    call check(sfdae_status_name(sfdae_step_too_small) == "SFDAE_STEP_TOO_SMALL", "name of -41")
    call check(sfdae_status_name(-12345_c_int) == "unknown status", "name of no status")
  end subroutine words

  !> create and sfdae_check_linear say the same, and in words.
  subroutine refuses_wrong_problems()
    type(mixed_dae), target :: problem
    type(dae_solver) :: solver
    integer(c_int) :: status
    character(len=:), allocatable :: text

    call sfdae_check_linear(problem, text, status)
    call check_status(status, sfdae_empty_problem, "check of an empty problem")
    call check(len(text) > 0, "words on an empty problem")
    call solver%create(problem, status)
    call check_status(status, sfdae_empty_problem, "an empty problem")
    call check(solver%message() == text, "message of create")

    problem%num_equations = 3
    problem%num_unknowns = 3
    call sfdae_check_linear(problem, text, status)
    call check_status(status, sfdae_ok, "check of a good problem")
    call check(len(text) == 0, "no words on a good problem")

    problem%prescribed = [0] ! components count from 1
    call solver%create(problem, status)
    call check_status(status, sfdae_illegal_argument, "prescribed component 0")
    problem%prescribed = [4]
    call solver%create(problem, status)
    call check_status(status, sfdae_illegal_argument, "prescribed component n + 1")
    call check(len(solver%message()) > 0, "words on a prescribed component")
    problem%prescribed = [2, 2]
    call solver%create(problem, status)
    call check_status(status, sfdae_illegal_argument, "a component prescribed twice")

    deallocate (problem%prescribed)
    allocate (problem%prescribed(0))
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "no component prescribed")
    call solver%create(problem, status)
    call check_status(status, sfdae_illegal_argument, "create twice")
    call check(index(solver%message(), "destroy") > 0, "words on create twice")
    call solver%destroy(status)
    call check_status(status, sfdae_ok, "destroy")
    call solver%destroy(status)
    call check_status(status, sfdae_ok, "destroy twice")
    call solver%create(problem, status)
    call check_status(status, sfdae_ok, "create after destroy")
    call solver%destroy()
  end subroutine refuses_wrong_problems

  !> Values out of range, arrays of wrong size.
  subroutine refuses_wrong_options()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status
    character(len=:), allocatable :: text

    options%rtol = -1
    call refused(problem, options, "negative rtol")
    options = dae_options(atol_vector=[1.0_dp, 1.0_dp])
    call refused(problem, options, "atol_vector of 2 values")
    call sfdae_check_linear(problem, text, status, options)
    call check(text == "atol_vector has 2 entries, but n = 3", "words on atol_vector")
    options = dae_options(rtol_vector=[1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp] / 10)
    call refused(problem, options, "rtol_vector of 4 values")
    options = dae_options(initial_weights=[1.0_dp])
    call refused(problem, options, "initial_weights of 1 value")
    options = dae_options(initial_weights=[1.0_dp, 0.0_dp, 1.0_dp])
    call refused(problem, options, "a weight of 0")
    options = dae_options(initial_values=sfdae_initial_fixed, fixed=[.true., .false.])
    call refused(problem, options, "fixed of 2 flags")
    options = dae_options(initial_values=sfdae_initial_fixed)
    call refused(problem, options, "fixed missing")
    options = dae_options(max_index=13)
    call refused(problem, options, "max_index = 13")
    options = dae_options(max_steps=0)
    call refused(problem, options, "max_steps = 0")
    options = dae_options(rtol_vector=[0.1_dp, 0.2_dp, 0.3_dp], fixed=[.true., .true., .false.])
    call solver%create(problem, status, options)
    call check_status(status, sfdae_ok, "vectors of the right sizes")
    call solver%destroy()
  end subroutine refuses_wrong_options

  !> Checks that create and sfdae_check_linear refuse options, with the same words.
  subroutine refused(problem, options, what)
    type(mixed_dae), target, intent(inout) :: problem
    type(dae_options), intent(in) :: options
    character(len=*), intent(in) :: what
    type(dae_solver) :: solver
    integer(c_int) :: status
    character(len=:), allocatable :: text

    call sfdae_check_linear(problem, text, status, options)
    call check_status(status, sfdae_illegal_argument, "check: " // what)
    call solver%create(problem, status, options)
    call check_status(status, sfdae_illegal_argument, what)
    call check(len(text) > 0, "words on " // what)
    call check(solver%message() == text, "message on " // what)
  end subroutine refused

  !> Every procedure, before create.
  subroutine refuses_calls_without_solver()
    type(dae_solver) :: solver
    type(dae_options) :: options
    type(sfdae_characteristics) :: characteristics
    type(sfdae_decision) :: decision
    type(sfdae_change) :: change
    type(sfdae_initial_report) :: initial
    type(sfdae_statistics) :: statistics
    type(sfdae_derivative_check) :: derivatives
    character(len=:), allocatable :: text
    integer(c_int) :: status(16), count
    real(dp) :: t, x(3)

    call check(len(solver%message()) == 0, "message without solver")
    t = 7
    x = 7
    count = 7
    call solver%set_options(options, status(1))
    call solver%analyze(0.0_dp, 1.0_dp, status(2))
    call solver%get_characteristics(characteristics, status(3))
    call solver%get_num_decisions(count, status(4))
    call solver%get_decision(1_c_int, decision, status(5))
    call solver%get_change(change, status(6))
    call solver%make_consistent(0.0_dp, x, status(7))
    call solver%get_initial_report(initial, status(8))
    call solver%start(0.0_dp, 1.0_dp, x, status(9))
    call solver%advance(1.0_dp, t, x, status(10))
    call solver%step(1.0_dp, t, x, status(11))
    call solver%get_statistics(statistics, status(12))
    call solver%report(text, status(13))
    call solver%get_derivative_array(0.0_dp, 0_c_int, status(14))
    call solver%get_projectors(0.0_dp, status(15))
    call solver%get_strangeness_free(0.0_dp, status(16))
    call check(all(status == sfdae_illegal_argument), "calls without solver")
    call check(index(solver%message(), "create") > 0, "words on calls without solver")
    call solver%check_derivatives(0.0_dp, 1_c_int, derivatives, status(1))
    call solver%request_stop(status(2))
    call check(all(status(1:2) == sfdae_illegal_argument), "two more calls without solver")
    call check(all(abs([t, x] - 7) <= 0) .and. count == 7, "outputs of refused calls")
    call check(.not. allocated(text), "report of a refused call")
  end subroutine refuses_calls_without_solver

  !> x and xdot have n entries, everywhere.
  subroutine refuses_arrays_of_wrong_size()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3), few(2), many(4)

    x = 0
    few = 0
    many = 0
    call solver%create(problem, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_not_started, "advance before start")
    call check(len(solver%message()) > 0, "words on advance before start")
    call solver%make_consistent(0.0_dp, few, status)
    call check_status(status, sfdae_illegal_argument, "x too short")
    call check(solver%message() == "x has 2 entries, but n = 3", "words on x")
    call solver%start(0.0_dp, 1.0_dp, x, status, many)
    call check_status(status, sfdae_illegal_argument, "xdot too long")
    call check(solver%message() == "xdot has 4 entries, but n = 3", "words on xdot")
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start")
    call check(len(solver%message()) == 0, "words on success")
    call solver%advance(1.0_dp, t, many, status)
    call check_status(status, sfdae_illegal_argument, "x too long")
    call solver%step(1.0_dp, t, x, status, few)
    call check_status(status, sfdae_illegal_argument, "xdot too short")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance after refusals")
    call solver%destroy()
  end subroutine refuses_arrays_of_wrong_size

  !> No memory is lost; run it with a leak checker.
  subroutine lives_a_thousand_times()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(counting_monitor), target :: monitor
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status
    integer :: k, good
    real(dp) :: x(3)

    options%atol_vector = [1.0e-3_dp, 1.0e-4_dp, 1.0e-5_dp]
    options%monitor => monitor
    good = 0
    x = 0
    do k = 1, 1000
      call solver%create(problem, status, options)
      if (status == sfdae_ok) call solver%start(0.0_dp, 1.0_dp, x, status)
      if (status == sfdae_ok) call solver%destroy(status)
      if (status == sfdae_ok) good = good + 1
    end do
    call check(good == 1000, "a thousand lives")
  end subroutine lives_a_thousand_times

  !> set_options takes effect, or leaves everything as it was.
  subroutine replaces_options()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(counting_monitor), target :: first, second
    type(dae_options) :: options
    type(dae_solver) :: solver
    type(sfdae_initial_report) :: report
    integer(c_int) :: status
    integer :: calls
    real(dp) :: t, x(3)

    options%monitor => first
    call solver%create(problem, status, options)
    x = [0, 0, 1]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%advance(0.5_dp, t, x, status)
    call check(first%calls > 0, "first monitor")

    options%monitor => second
    options%atol_vector = [1.0_dp]
    call solver%set_options(options, status)
    call check_status(status, sfdae_illegal_argument, "set_options with atol_vector of 1 value")
    deallocate (options%atol_vector)
    options%max_order = 6
    call solver%set_options(options, status)
    call check_status(status, sfdae_illegal_argument, "set_options with max_order = 6")
    call check(len(solver%message()) > 0, "words on max_order")
    calls = first%calls
    call solver%advance(1.0_dp, t, x, status)
    call check(first%calls > calls .and. second%calls == 0, "monitor after refused options")

    options%max_order = 1
    calls = first%calls
    call solver%set_options(options, status)
    call check_status(status, sfdae_ok, "set_options")
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance after set_options")
    call check(first%calls == calls .and. second%calls > 0, "second monitor")
    call check_close(x, problem%exact(2.0_dp, 0.0_dp), 2.0e-5_dp, 2.0e-5_dp, "order 1")

    options = dae_options(initial_values=sfdae_initial_accept)
    call solver%set_options(options, status)
    x = [1, 5, 1]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_inconsistent_values, "inconsistent values")
    call check(all(abs(x - [1, 5, 1]) <= 0), "inconsistent values stay")
    call check(len(solver%message()) > 0, "words on inconsistent values")

    options = dae_options(initial_values=sfdae_initial_fixed, fixed=[.true., .true., .false.])
    call solver%set_options(options, status)
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_fixed_values, "fixed values against the constraints")
    x(2) = 0
    x(3) = 9
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "fixed values")
    call check_close(x, [1.0_dp, 0.0_dp, 1.0_dp], 1.0e-13_dp, 1.0e-13_dp, "values of start")
    call solver%get_initial_report(report, status)
    call check_status(status, sfdae_ok, "get_initial_report")
    call check(report%component == 3, "component that changed counts from 1")
    call check(abs(report%largest_change - 8) <= 1.0e-12_dp, "largest change")
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%get_initial_report(report, status)
    call check(report%largest_change <= 1.0e-13_dp, "nothing to change")
    if (abs(report%largest_change) <= 0) call check(report%component == 0, "no component")
    call solver%destroy()
  end subroutine replaces_options

end program lifecycle_test
