! SPDX-License-Identifier: BSD-3-Clause
!
! Methods, and checkpoints: what is saved and restored goes on in every bit as if nothing had
! happened.
program checkpoint_test
  use, intrinsic :: iso_c_binding, only: c_int, dp => c_double
  use sfdae, only: dae_options, dae_solver, sfdae_illegal_argument, sfdae_method_automatic, &
    sfdae_method_bdf, sfdae_method_radau, sfdae_not_started, sfdae_ok, sfdae_statistics
  use test_support, only: check, check_close, check_status, finish, gear_petzold_dae, mixed_dae
  implicit none

  real(dp), parameter :: tol = 1.0e-6_dp
  integer(c_int) :: method

  call has_the_order_of_its_stages()
  call refuses_what_is_no_method()
  do method = sfdae_method_bdf, sfdae_method_automatic
    call goes_on_in_every_bit()
    call survives_a_text_file()
    call refuses_what_is_no_checkpoint()
  end do
  call needs_a_start()
  call finish()

contains

  !> Orders 1, 5, 9, 13 with 1, 3, 5, 7 stages.
  subroutine has_the_order_of_its_stages()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_options) :: options
    type(dae_solver) :: solver
    type(sfdae_statistics) :: statistics
    integer(c_int) :: stages, status
    real(dp) :: t, x(3)

    options%method = sfdae_method_radau
    do stages = 1, 7, 2
      options%min_stages = stages
      options%max_stages = stages
      call solver%create(problem, status, options)
      x = 0
      call solver%start(0.0_dp, 1.0_dp, x, status)
      call solver%advance(1.0_dp, t, x, status)
      call check_status(status, sfdae_ok, "advance by Radau")
      if (stages > 1) call check_close(x, problem%exact(1.0_dp, 0.0_dp), tol, tol, "x by Radau")
      call solver%get_statistics(statistics, status)
      call check(statistics%last_order == 2 * stages - 1, "order of Radau")
      call solver%destroy()
    end do
  end subroutine has_the_order_of_its_stages

  !> Options are checked.
  subroutine refuses_what_is_no_method()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_options) :: options
    type(dae_solver) :: solver
    integer(c_int) :: status

    options%method = 3
    call solver%create(problem, status, options)
    call check_status(status, sfdae_illegal_argument, "method")
    options = dae_options(min_stages=2)
    call solver%create(problem, status, options)
    call check_status(status, sfdae_illegal_argument, "min_stages")
    options = dae_options(min_stages=5, max_stages=3)
    call solver%create(problem, status, options)
    call check_status(status, sfdae_illegal_argument, "max_stages")
    call check(len(solver%message()) > 0, "words on max_stages")
  end subroutine refuses_what_is_no_method

  !> Saved, destroyed, created anew and restored before every output.
  subroutine goes_on_in_every_bit()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3, omega=2.0_dp)
    type(dae_solver) :: plain, broken
    type(dae_options) :: options
    real(dp), allocatable :: checkpoint(:)
    integer(c_int) :: status
    integer :: k
    real(dp) :: t, x(3), y(3), xdot(3), ydot(3)

    options%method = method
    call plain%create(problem, status, options)
    call broken%create(problem, status, options)
    x = 0
    y = 0
    call plain%start(0.0_dp, 4.0_dp, x, status)
    call broken%start(0.0_dp, 4.0_dp, y, status)
    do k = 1, 20
      call broken%save_checkpoint(checkpoint, status)
      call check_status(status, sfdae_ok, "save_checkpoint")
      call broken%destroy()
      call broken%create(problem, status, options)
      call broken%restore_checkpoint(checkpoint, status)
      call check_status(status, sfdae_ok, "restore_checkpoint")
      call plain%advance(0.2_dp * k, t, x, status, xdot)
      call broken%advance(0.2_dp * k, t, y, status, ydot)
      call check_status(status, sfdae_ok, "advance from a checkpoint")
      call check(all(abs(x - y) <= 0) .and. all(abs(xdot - ydot) <= 0), "every bit is the same")
      call check_close(y, problem%exact(t, 0.0_dp), tol, tol, "x from a checkpoint")
    end do
    call plain%destroy()
    call broken%destroy()
  end subroutine goes_on_in_every_bit

  !> 17 digits are enough.
  subroutine survives_a_text_file()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    type(dae_options) :: options
    real(dp), allocatable :: checkpoint(:), read_back(:)
    integer(c_int) :: status
    integer :: length, unit
    real(dp) :: t, x(3), y(3)

    options%method = method
    call solver%create(problem, status, options)
    x = 0
    call solver%start(0.0_dp, 4.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call solver%save_checkpoint(checkpoint, status)
    open (newunit=unit, status="scratch", action="readwrite", form="formatted")
    write (unit, *) size(checkpoint)
    write (unit, "(es25.16e3)") checkpoint
    rewind (unit)
    read (unit, *) length
    allocate (read_back(length))
    read (unit, *) read_back
    close (unit)
    call solver%advance(2.0_dp, t, x, status)
    call solver%restore_checkpoint(read_back, status)
    call check_status(status, sfdae_ok, "restore_checkpoint from a file")
    call solver%advance(2.0_dp, t, y, status)
    call check(all(abs(x - y) <= 0), "x from a file")
    call solver%destroy()
  end subroutine survives_a_text_file

  !> Damaged, truncated, of another problem; then nothing is started.
  subroutine refuses_what_is_no_checkpoint()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(gear_petzold_dae), target :: other = gear_petzold_dae(num_equations=2, num_unknowns=2)
    type(dae_solver) :: solver, stranger
    type(dae_options) :: options
    real(dp), allocatable :: checkpoint(:)
    integer(c_int) :: status
    integer :: i
    real(dp) :: t, x(3), undisturbed(3), intact

    options%method = method
    call solver%create(problem, status, options)
    x = 0
    call solver%start(0.0_dp, 4.0_dp, x, status)
    call solver%advance(1.0_dp, t, x, status)
    call solver%save_checkpoint(checkpoint, status)
    call solver%advance(2.0_dp, t, undisturbed, status)
    call solver%restore_checkpoint(checkpoint, status)
    do i = 1, size(checkpoint)
      intact = checkpoint(i)
      checkpoint(i) = intact + spacing(intact)
      call solver%restore_checkpoint(checkpoint, status)
      if (abs(intact) <= huge(intact)) call check_status(status, sfdae_illegal_argument, "damage")
      checkpoint(i) = intact
      call solver%restore_checkpoint(checkpoint(:i - 1), status)
      call check_status(status, sfdae_illegal_argument, "truncation")
      call check(len(solver%message()) > 0, "words on a damaged checkpoint")
    end do
    call solver%advance(2.0_dp, t, x, status)
    call check_status(status, sfdae_ok, "advance after refusals")
    call check(all(abs(x - undisturbed) <= 0), "refusals change nothing")
    call stranger%create(other, status, options)
    call stranger%restore_checkpoint(checkpoint, status)
    call check_status(status, sfdae_illegal_argument, "checkpoint of another problem")
    call stranger%destroy()
    call solver%restore_checkpoint(checkpoint, status)
    call check_status(status, sfdae_ok, "intact checkpoint")
    call solver%destroy()
  end subroutine refuses_what_is_no_checkpoint

  !> The array stays as it is if there is nothing to save.
  subroutine needs_a_start()
    type(mixed_dae), target :: problem = mixed_dae(num_equations=3, num_unknowns=3)
    type(dae_solver) :: solver
    real(dp), allocatable :: checkpoint(:)
    integer(c_int) :: status

    allocate (checkpoint(2), source=2.0_dp)
    call solver%save_checkpoint(checkpoint, status)
    call check_status(status, sfdae_illegal_argument, "no solver to save")
    call solver%restore_checkpoint(checkpoint, status)
    call check_status(status, sfdae_illegal_argument, "no solver to restore")
    call solver%create(problem, status)
    call solver%save_checkpoint(checkpoint, status)
    call check_status(status, sfdae_not_started, "nothing to save")
    call check(size(checkpoint) == 2 .and. abs(checkpoint(2) - 2) <= 0, "the array stays")
    call solver%destroy()
  end subroutine needs_a_start

end program checkpoint_test
