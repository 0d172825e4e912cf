! SPDX-License-Identifier: BSD-3-Clause
!
! Integration: start, advance, step, restart, options that act on it, monitor, stops.
program integration_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_options, dae_solver, sfdae_illegal_argument, sfdae_inconsistency_ignored, &
    sfdae_inconsistent_equations, sfdae_leading_identity, sfdae_max_steps, sfdae_not_unique, &
    sfdae_ok, sfdae_prescription_singular, sfdae_reduction_svd, sfdae_statistics, &
    sfdae_step_taken, sfdae_stopped, sfdae_values_changed
  use test_support, only: cart_dae, check, check_close, check_status, counting_monitor, finish, &
    gear_petzold_dae, mixed_dae, reaction_dae
  implicit none

  real(dp), parameter :: tol = 1.0e-6_dp

  call advances_with_derivatives()
  call returns_through_strided_arrays()
  call steps_one_by_one()
  call restarts_and_turns_round()
  call keeps_two_solvers_apart()
  call obeys_vector_tolerances()
  call obeys_integration_options()
  call reduces_by_svd()
  call stops_when_monitor_says_so()
  call stops_on_request()
  call prescribes_components()
  call sees_contradictions()
  call finish()

contains

  !> x and x' at every output, from values that are not consistent.
  subroutine advances_with_derivatives()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3, omega=2.0_dp)
    type(dae_solver) :: solver
    type(sfdae_statistics) :: statistics
    integer(c_int) :: status
    integer :: k
    real(dp) :: t, x(3), xdot(3), exact(3)

    call solver%create(problem, status)
    x = [1.0_dp, 3.0_dp, -4.0_dp]
    call solver%start(0.0_dp, 5.0_dp, x, status, xdot)
    call check_status(status, sfdae_values_changed, "start")
    call check_close(x, problem%exact(0.0_dp, 1.0_dp), 1.0e-13_dp, 1.0e-13_dp, "x of start")
    call check_close(xdot, [0.0_dp, 2.0_dp, 0.0_dp], 1.0e-13_dp, 1.0e-13_dp, "x' of start")
    do k = 1, 5
      call solver%advance(real(k, dp), t, x, status, xdot)
      call check_status(status, sfdae_ok, "advance")
      exact = problem%exact(t, 1.0_dp)
      call check(abs(t - k) <= 0, "t = tout")
      call check_close(x, exact, tol, tol, "x")
      call check_close(x(2:), exact(2:), 1.0e-13_dp, 1.0e-13_dp, "constraints hold to rounding")
      call check_close(xdot(1:1), [exact(3) - exact(1)], 10 * tol, 10 * tol, "x1'")
    end do
    call solver%get_statistics(statistics, status)
    call check_status(status, sfdae_ok, "get_statistics")
    call check(statistics%steps > 5 .and. statistics%last_order >= 1, "statistics")
    call check(statistics%evaluations_e <= problem%calls_e, "calls of eval_e")
    call check(statistics%evaluations_a <= problem%calls_a, "calls of eval_a")
    call check(statistics%evaluations_f <= problem%calls_f, "calls of eval_f")
    ! Calls that check derivatives are counted apart.
    call check(statistics%evaluations_e + statistics%evaluations_a + statistics%evaluations_f + &
      statistics%check_calls == problem%calls_e + problem%calls_a + problem%calls_f, "all calls")
    call solver%destroy()
  end subroutine advances_with_derivatives

  !> Actual arguments need not be contiguous.
  subroutine returns_through_strided_arrays()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, table(4, 3)

    table = -1
    call solver%create(problem, status)
    call solver%start(0.0_dp, 1.0_dp, table(1, :), status, table(2, :))
    call check_status(status, sfdae_values_changed, "start with strided arrays")
    call check(abs(table(2, 2) - 1) <= 1.0e-13_dp, "x' in a strided array")
    table(3, :) = table(1, :)
    call solver%advance(1.0_dp, t, table(3, :), status, table(4, :))
    call check_close(table(3, 2:), [sin(1.0_dp), cos(1.0_dp)], 1.0e-13_dp, 1.0e-13_dp, "strided x")
    call check_close(table(4, 2:2), [cos(1.0_dp)], 10 * tol, 10 * tol, "strided x'")
    call check(abs(table(1, 3) - 1) <= 1.0e-13_dp, "other rows stay")
    call solver%destroy()
  end subroutine returns_through_strided_arrays

  !> One-step mode ends at tout with sfdae_ok.
  subroutine steps_one_by_one()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    type(sfdae_statistics) :: statistics
    integer(c_int) :: status
    integer :: k
    real(dp) :: t, t_old, x(3), xdot(3)

    call solver%create(problem, status)
    x = [1, 0, 1]
    call solver%start(0.0_dp, 1.0_dp, x, status)
    t_old = 0
    do k = 1, 10000
      call solver%step(1.0_dp, t, x, status, xdot)
      if (status /= sfdae_step_taken) exit
      call check(t > t_old .and. t < 1, "steps go forward")
      t_old = t
    end do
    call check_status(status, sfdae_ok, "last step")
    call check(k > 3 .and. abs(t - 1) <= 0, "steps end at tout")
    call check_close(x, problem%exact(1.0_dp, 1.0_dp), tol, tol, "x after steps")
    call solver%get_statistics(statistics, status)
    call check(statistics%steps >= k - 1 .and. statistics%first_step > 0, "count of steps")
    call solver%destroy()
  end subroutine steps_one_by_one

  !> Restart on a living solver, then backward.
  subroutine restarts_and_turns_round()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    type(sfdae_statistics) :: statistics
    integer(c_int) :: status
    real(dp) :: t, x(3)

    call solver%create(problem, status)
    x = 0
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_close(x, problem%exact(1.0_dp, 0.0_dp), tol, tol, "x before the restart")
    x(1) = x(1) + 1 ! a jump
    call solver%start(t, 2.0_dp, x, status)
    call solver%advance(2.0_dp, t, x, status)
    call check_close(x, problem%exact(2.0_dp, exp(1.0_dp)), tol, 2 * tol, "x after the restart")
    call solver%start(t, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start backward")
    call solver%advance(1.0_dp, t, x, status)
    call check_close(x, problem%exact(1.0_dp, exp(1.0_dp)), tol, 5 * tol, "x backward")
    call solver%get_statistics(statistics, status)
    call check(statistics%last_step < 0, "steps backward are negative")
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_illegal_argument, "advance against the direction")
    call solver%destroy()
  end subroutine restarts_and_turns_round

  !> Two solvers, in turn, each as if it were alone.
  subroutine keeps_two_solvers_apart()
    type(mixed_dae), target :: first = mixed_dae(num_equations=3, num_unknowns=3)
    type(gear_petzold_dae), target :: second = &
      gear_petzold_dae(num_equations=2, num_unknowns=2, eta=0.7_dp)
    type(dae_solver) :: solvers(2), alone
    integer(c_int) :: status
    integer :: k
    real(dp) :: t, x(3), y(2), z(3)

    x = 0
    y = 0
    z = 0
    call solvers(1)%create(first, status)
    call solvers(2)%create(second, status)
    call alone%create(first, status)
    call solvers(1)%start(0.0_dp, 1.0_dp, x, status)
    call solvers(2)%start(0.0_dp, 1.0_dp, y, status)
    call alone%start(0.0_dp, 1.0_dp, z, status)
    do k = 1, 10
      call solvers(1)%advance(0.1_dp * k, t, x, status)
      call check_status(status, sfdae_ok, "first solver")
      call solvers(2)%advance(0.1_dp * k, t, y, status)
      call check_status(status, sfdae_ok, "second solver")
      call check_close(y, [1 - 0.7_dp * t, 1.0_dp] * exp(-t), 1.0e-13_dp, 1.0e-13_dp, "second x")
    end do
    do k = 1, 10
      call alone%advance(0.1_dp * k, t, z, status)
    end do
    call check(all(abs(x - z) <= 0), "the first solver does not notice the second")
    call solvers(1)%destroy()
    call solvers(2)%destroy()
    call alone%destroy()
  end subroutine keeps_two_solvers_apart

  !> A tight tolerance for x1 alone costs what tight tolerances cost; a loose one does not.
  subroutine obeys_vector_tolerances()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_options) :: options
    type(dae_solver) :: solver
    type(sfdae_statistics) :: loose, tight
    integer(c_int) :: status
    real(dp) :: t, x(3)

    options%rtol_vector = [0.0_dp, 1.0e-2_dp, 1.0e-2_dp]
    options%atol_vector = [1.0e-3_dp, 1.0e-2_dp, 1.0e-2_dp]
    call solver%create(problem, status, options)
    x = 0
    call solver%start(0.0_dp, 3.0_dp, x, status)
    call solver%advance(3.0_dp, t, x, status)
    call solver%get_statistics(loose, status)
    options%atol_vector(1) = 1.0e-9_dp
    call solver%set_options(options, status)
    call check_status(status, sfdae_ok, "new tolerances")
    x = 0
    call solver%start(0.0_dp, 3.0_dp, x, status)
    call solver%advance(3.0_dp, t, x, status)
    call check_close(x, problem%exact(3.0_dp, 0.0_dp), 0.0_dp, 1.0e-9_dp, "tight x1")
    call solver%get_statistics(tight, status)
    call check(tight%steps > 2 * loose%steps, "tolerances of x1 act")
    call solver%destroy()
  end subroutine obeys_vector_tolerances

  !> First step, largest step, order, stop time, number of steps, leading term.
  subroutine obeys_integration_options()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(counting_monitor), target :: monitor
    type(dae_options) :: options
    type(dae_solver) :: solver
    type(sfdae_statistics) :: statistics
    integer(c_int) :: status
    real(dp) :: t, x(3)

    options%initial_step = 1.0e-5_dp
    options%max_step = 0.0625_dp
    options%max_order = 2
    options%use_stop_time = .true.
    options%stop_time = 1
    options%leading_term = sfdae_leading_identity
    options%monitor => monitor
    call solver%create(problem, status, options)
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    problem%largest_t = 0
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance to the stop time")
    call check(problem%largest_t <= 1, "nothing is evaluated beyond stop_time")
    call solver%get_statistics(statistics, status)
    call check(abs(statistics%first_step) <= 1.0e-5_dp, "initial_step")
    call check(statistics%steps >= 16, "max_step")
    call check(monitor%highest_order <= 2 .and. monitor%calls == statistics%steps, "max_order")

    options = dae_options(max_steps=3)
    call solver%set_options(options, status)
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_max_steps, "max_steps")
    call check(t > 0 .and. t < 1, "point reached")
    call check_close(x, problem%exact(t, 0.0_dp), tol, tol, "x at the point reached")
    options%max_steps = 1000
    call solver%set_options(options, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance again")
    call check_close(x, problem%exact(1.0_dp, 0.0_dp), tol, tol, "x after more steps")
    call solver%destroy()
  end subroutine obeys_integration_options

  !> The classical reduction, with constant matrices: E and A are asked for once.
  subroutine reduces_by_svd()
    type(mixed_dae), target :: problem = &
      mixed_dae(num_equations=3, num_unknowns=3, constant_e=.true., constant_a=.true.)
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3)

    options%reduction = sfdae_reduction_svd
    call solver%create(problem, status, options)
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance")
    call check_close(x, problem%exact(1.0_dp, 0.0_dp), tol, tol, "x by SVD")
    call check(problem%calls_e == 1 .and. problem%calls_a == 1, "constant matrices")
    call solver%destroy()
  end subroutine reduces_by_svd

  !> The monitor sees every step and can stop.
  subroutine stops_when_monitor_says_so()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(counting_monitor), target :: monitor
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3)

    monitor%stop_after = 4
    options%monitor => monitor
    call solver%create(problem, status, options)
    x = 0
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_stopped, "stopped by the monitor")
    call check(monitor%calls == 4 .and. monitor%num_unknowns == 3, "the monitor's calls")
    call check(abs(monitor%t - t) <= 0 .and. abs(monitor%x1 - x(1)) <= 0, "the monitor's point")
    monitor%stop_after = huge(1)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "repeated")
    call check_close(x, problem%exact(1.0_dp, 0.0_dp), tol, tol, "x after the stop")
    call solver%destroy()
  end subroutine stops_when_monitor_says_so

  !> A request stops the next call, once.
  subroutine stops_on_request()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3)

    call solver%create(problem, status)
    x = 0
    call solver%request_stop(status)
    call check_status(status, sfdae_ok, "request_stop")
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_stopped, "start stopped")
    call solver%start(0.0_dp, 1.0_dp, x, status)
    call check_status(status, sfdae_ok, "start repeated")
    call solver%request_stop(status)
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_stopped, "advance stopped")
    call solver%advance(1.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance repeated")
    call solver%destroy()
  end subroutine stops_on_request

  !> x3 of the cart: free, prescribed; x1 cannot be.
  subroutine prescribes_components()
    type(cart_dae), target :: problem = cart_dae(num_equations=2, num_unknowns=3, has_f=.false.)
    type(mixed_dae), target :: silent = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(3), c

    call solver%create(problem, status)
    x = [0.0_dp, 1.0_dp, 0.25_dp]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_not_unique, "a free component")
    call check(len(solver%message()) > 0, "words on a free component")
    call solver%advance(2.0_dp, t, x, status)
    c = 0.75_dp * exp(-2.0_dp)
    call check_close(x, [1.25_dp - c, 0.25_dp + c, 0.25_dp], tol, tol, "held constant")
    call solver%destroy()

    problem%prescribed = [3]
    call solver%create(problem, status)
    x = [0, 1, 0]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check(abs(x(3) - 1) <= 1.0e-14_dp, "prescribed component at the start")
    call solver%advance(2.0_dp, t, x, status)
    call check(status >= 0, "advance with a prescribed component")
    c = 0.5_dp * exp(-2.0_dp)
    call check_close(x, [(sin(t) - cos(t)) / 2 + 1 - c, (sin(t) + cos(t)) / 2 + c, cos(t)], &
      tol, tol, "prescribed")
    call solver%destroy()

    silent%prescribed = [1] ! u = 0: nothing is free
    call solver%create(silent, status)
    if (status >= 0) call solver%analyze(0.0_dp, 1.0_dp, status)
    call check_status(status, sfdae_prescription_singular, "nothing to prescribe")
    call solver%destroy()
  end subroutine prescribes_components

  !> Redundant equations that contradict each other.
  subroutine sees_contradictions()
    type(reaction_dae), target :: problem = reaction_dae(num_equations=3, num_unknowns=2)
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status
    real(dp) :: t, x(2)

    call solver%create(problem, status)
    x = [0.9_dp, 0.1_dp]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "redundant equations")
    call check_close(x, [0.0_dp, 1.0_dp] + [0.9_dp, -0.9_dp] * exp(-2.0_dp), tol, tol, "x")
    problem%leak = 0.1_dp
    x = [0.9_dp, 0.1_dp]
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_inconsistent_equations, "contradiction")
    options%ignore_inconsistency = .true.
    call solver%set_options(options, status)
    call solver%start(0.0_dp, 2.0_dp, x, status)
    call check_status(status, sfdae_inconsistency_ignored, "contradiction ignored at the start")
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_inconsistency_ignored, "contradiction ignored")
    call solver%destroy()
  end subroutine sees_contradictions

end program integration_test
