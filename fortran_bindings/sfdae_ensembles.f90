! SPDX-License-Identifier: BSD-3-Clause
!
! Ensembles: many instances of one recorded problem, which differ in parameters and start values.
module sfdae_ensembles
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, &
    c_null_ptr, c_ptr, c_size_t, c_sizeof
  use sfdae_c, only: address_of_ensemble_monitor_function, c_ensemble_init, &
    c_ensemble_results_init, c_solve_ensemble
  use sfdae_control, only: compare_size
  use sfdae_conversions, only: flag, names_in_c, text_in
  use sfdae_types, only: sfdae_ensemble, sfdae_ensemble_progress, sfdae_ensemble_results, &
    sfdae_illegal_argument, sfdae_out_of_memory
  implicit none
  private

  public :: dae_ensemble, dae_ensemble_monitor, dae_ensemble_results
  public :: solve_ensemble_in_c

  !> Length of names of parameters and of messages, which are truncated.
  integer, parameter :: name_length = 128, message_length = 512

  !> Monitors an ensemble. Extend it: components are your data. See dae_ensemble%monitor.
  type, abstract :: dae_ensemble_monitor
  contains
    !> Called whenever an instance has ended.
    procedure(ensemble_monitor_function), deferred :: after_instance
  end type dae_ensemble_monitor

  abstract interface
    !> Called whenever an instance has ended, from any thread, but never concurrently.
    subroutine ensemble_monitor_function(self, progress, stop_now)
      import :: dae_ensemble_monitor, sfdae_ensemble_progress
      class(dae_ensemble_monitor), intent(inout) :: self
      !> Its instance counts from 1.
      type(sfdae_ensemble_progress), intent(in) :: progress
      !> .false. on entry; .true. stops all instances with sfdae_stopped.
      logical, intent(inout) :: stop_now
    end subroutine ensemble_monitor_function
  end interface

  !> N instances of a problem with n unknowns; see sfdae_solve_ensemble in C.
  type :: dae_ensemble
    !> P names of parameters that differ between instances; or none.
    character(len=name_length), allocatable :: parameter_names(:)
    !> P x N: column i is for instance i.
    real(c_double), allocatable :: parameters(:, :)
    !> Start time of all instances.
    real(c_double) :: t0 = 0
    !> n x N start values, made consistent as the options of the solver say.
    real(c_double), allocatable :: x0(:, :)
    !> n x N initial guesses of x', for the option xdot_is_guess; or none.
    real(c_double), allocatable :: xdot0(:, :)
    !> Times of the outputs, in the direction of integration. The first one may be t0.
    real(c_double), allocatable :: times(:)
    !> .true.: x' at the outputs is wanted, too.
    logical :: wants_xdot = .false.
    !> Number of threads, 1 ... 1024. 0: number of processors.
    integer(c_int) :: num_threads = 0
    !> Called whenever an instance has ended if associated.
    class(dae_ensemble_monitor), pointer :: monitor => null()
  end type dae_ensemble

  !> The outputs of an ensemble, and the results of its instances.
  type :: dae_ensemble_results
    !> n x outputs x N; 0 for outputs that were not reached.
    real(c_double), allocatable :: x(:, :, :)
    !> x' in the same shape, if it was wanted.
    real(c_double), allocatable :: xdot(:, :, :)
    !> N statuses: sfdae_ok, a warning, or the failure of the instance.
    integer(c_int), allocatable :: statuses(:)
    !> N numbers of outputs reached.
    integer(c_int), allocatable :: num_outputs(:)
    !> N messages about the statuses, blank for sfdae_ok.
    character(len=message_length), allocatable :: messages(:)
    !> Instances with status < 0.
    integer(c_int) :: num_failed = 0
    !> Number of complete index analyses.
    integer(c_int) :: num_analyses = 0
    !> Number of threads used.
    integer(c_int) :: num_threads = 0
  end type dae_ensemble_results

  !> Target of the `user` pointer of the C monitor.
  type :: monitor_holder
    class(dae_ensemble_monitor), pointer :: monitor => null()
  end type monitor_holder

contains

  !> sfdae_ensemble_monitor_function. 1 stops all.
  recursive function call_monitor(progress, user) bind(c, name="") result(outcome)
    type(sfdae_ensemble_progress), intent(in) :: progress
    type(c_ptr), value :: user
    integer(c_int) :: outcome
    type(monitor_holder), pointer :: to
    type(sfdae_ensemble_progress) :: from_one
    logical :: stop_now

    call c_f_pointer(user, to)
    from_one = progress
    from_one%instance = progress%instance + 1_c_int
    stop_now = .false.
    call to%monitor%after_instance(from_one, stop_now)
    outcome = flag(stop_now)
  end function call_monitor

  !> Solves an ensemble with the C solver at `handle`. A failure leaves the results unchanged.
  recursive subroutine solve_ensemble_in_c(handle, n, ensemble, results, status, complaint)
    type(c_ptr), intent(in) :: handle
    !> Number of unknowns.
    integer(c_int), intent(in) :: n
    type(dae_ensemble), target, intent(in) :: ensemble
    type(dae_ensemble_results), intent(inout) :: results
    integer(c_int), intent(out) :: status
    !> Error in the arrays; empty if there is none.
    character(len=:), allocatable, intent(inout) :: complaint
    type(sfdae_ensemble) :: c_ensemble
    type(sfdae_ensemble_results) :: c_results
    type(dae_ensemble_results), target :: found
    type(monitor_holder), target :: holder
    character(kind=c_char), allocatable, target :: names(:, :), texts(:, :)
    type(c_ptr), allocatable, target :: addresses(:)
    integer :: allocation

    status = sfdae_illegal_argument
    call check_arrays(ensemble, n, complaint)
    if (len(complaint) > 0) return
    if (allocated(ensemble%parameter_names)) then
      call names_in_c(ensemble%parameter_names, names, addresses)
    else
      allocate (addresses(1))
      addresses = c_null_ptr
    end if
    holder%monitor => ensemble%monitor
    call fill_ensemble(ensemble, addresses, holder, c_ensemble)
    call allocate_results(ensemble, n, found, texts, allocation)
    status = sfdae_out_of_memory
    complaint = "out of memory for the results"
    if (allocation /= 0) return
    complaint = ""
    call fill_results(found, texts, c_results)
    status = c_solve_ensemble(handle, c_ensemble, c_results)
    if (status < 0) return
    call convert_messages(texts, found%messages)
    found%num_failed = c_results%num_failed
    found%num_analyses = c_results%num_analyses
    found%num_threads = c_results%num_threads
    results = found
  end subroutine solve_ensemble_in_c

  !> Complains about arrays that are missing or have wrong sizes.
  subroutine check_arrays(ensemble, n, complaint)
    type(dae_ensemble), intent(in) :: ensemble
    integer(c_int), intent(in) :: n
    character(len=:), allocatable, intent(inout) :: complaint
    integer(c_int) :: instances, count

    if (.not. (allocated(ensemble%x0) .and. allocated(ensemble%times))) then
      complaint = "x0 or times is not allocated"
      return
    end if
    instances = size(ensemble%x0, 2, c_int)
    if (allocated(ensemble%parameter_names)) then
      if (.not. allocated(ensemble%parameters)) then
        complaint = "parameter_names is allocated, but parameters is not"
        return
      end if
      count = size(ensemble%parameter_names, kind=c_int)
      call compare_size("a row of parameters", size(ensemble%parameters, 2, c_int), instances, &
        complaint, "N")
      call compare_size("a column of parameters", size(ensemble%parameters, 1, c_int), count, &
        complaint, "P")
    end if
    if (allocated(ensemble%xdot0)) then
      call compare_size("a row of xdot0", size(ensemble%xdot0, 2, c_int), instances, complaint, "N")
      call compare_size("a column of xdot0", size(ensemble%xdot0, 1, c_int), n, complaint)
    end if
    call compare_size("a column of x0", size(ensemble%x0, 1, c_int), n, complaint)
  end subroutine check_arrays

  !> Describes an ensemble to C; the description points into the arguments.
  subroutine fill_ensemble(ensemble, addresses, holder, c)
    type(dae_ensemble), target, intent(in) :: ensemble
    type(c_ptr), contiguous, target, intent(in) :: addresses(:)
    type(monitor_holder), target, intent(in) :: holder
    type(sfdae_ensemble), intent(inout) :: c

    if (c_ensemble_init(c, c_sizeof(c)) < 0) return
    c%num_instances = size(ensemble%x0, 2, c_int)
    if (allocated(ensemble%parameter_names)) &
      c%num_parameters = size(ensemble%parameter_names, kind=c_int)
    c%parameter_names = c_loc(addresses)
    c%t0 = ensemble%t0
    c%num_times = size(ensemble%times, kind=c_int)
    c%num_threads = ensemble%num_threads
    if (size(ensemble%times) > 0) c%times = c_loc(ensemble%times)
    if (size(ensemble%x0) > 0) c%x0 = c_loc(ensemble%x0)
    if (allocated(ensemble%xdot0)) then
      if (size(ensemble%xdot0) > 0) c%xdot0 = c_loc(ensemble%xdot0)
    end if
    if (c%num_parameters > 0) then
      if (size(ensemble%parameters) > 0) c%parameters = c_loc(ensemble%parameters)
    end if
    if (associated(holder%monitor)) c%monitor = address_of_ensemble_monitor_function(call_monitor)
    c%monitor_user = c_loc(holder)
  end subroutine fill_ensemble

  !> Allocates the results of an ensemble.
  subroutine allocate_results(ensemble, n, found, texts, allocation)
    type(dae_ensemble), intent(in) :: ensemble
    integer(c_int), intent(in) :: n
    type(dae_ensemble_results), intent(inout) :: found
    character(kind=c_char), allocatable, intent(out) :: texts(:, :)
    !> 0, or the status of allocate.
    integer, intent(out) :: allocation
    integer :: outputs, instances

    outputs = size(ensemble%times)
    instances = size(ensemble%x0, 2)
    allocate (found%x(n, outputs, instances), found%statuses(instances), &
      found%num_outputs(instances), found%messages(instances), &
      texts(message_length, max(instances, 1)), stat=allocation)
    if (allocation /= 0) return
    if (ensemble%wants_xdot) allocate (found%xdot(n, outputs, instances), stat=allocation)
    if (allocation /= 0) return
    found%x = 0
    if (ensemble%wants_xdot) found%xdot = 0
    found%statuses = 0
    found%num_outputs = 0
    found%messages = ""
    texts = c_null_char
  end subroutine allocate_results

  !> Passes the addresses of the results to C.
  subroutine fill_results(found, texts, c)
    type(dae_ensemble_results), target, intent(in) :: found
    character(kind=c_char), contiguous, target, intent(in) :: texts(:, :)
    type(sfdae_ensemble_results), intent(inout) :: c

    if (c_ensemble_results_init(c, c_sizeof(c)) < 0) return
    c%messages = c_loc(texts)
    c%message_length = size(texts, 1, c_size_t)
    if (size(found%x) == 0) return
    c%x = c_loc(found%x)
    if (allocated(found%xdot)) c%xdot = c_loc(found%xdot)
    c%statuses = c_loc(found%statuses)
    c%num_outputs = c_loc(found%num_outputs)
  end subroutine fill_results

  !> Converts messages to Fortran strings.
  subroutine convert_messages(texts, messages)
    character(kind=c_char), intent(in) :: texts(:, :)
    character(len=message_length), intent(inout) :: messages(:)
    integer :: i

    do i = 1, size(messages)
      messages(i) = text_in(texts(:, i))
    end do
  end subroutine convert_messages

end module sfdae_ensembles
