! SPDX-License-Identifier: BSD-3-Clause
!
! Sensitivities: derivatives of the solution by parameters and start values.
module sfdae_sensitivities
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_loc, c_long, c_null_ptr, &
    c_ptr, c_sizeof
  use sfdae_c, only: c_sensitivity_options_init, c_set_hybrid_sensitivities, c_set_sensitivities
  use sfdae_control, only: compare_size
  use sfdae_conversions, only: flag, names_in_c
  use sfdae_types, only: sfdae_illegal_argument, sfdae_ok, sfdae_sensitivity_options
  implicit none
  private

  public :: dae_sensitivities
  public :: set_sensitivities_in_c

  !> Length of names of parameters.
  integer, parameter :: name_length = 128

  !> The derivatives of the solution that are requested; see sfdae_set_sensitivities in C.
  type :: dae_sensitivities
    !> p names; blank: a column that only changes start values.
    character(len=name_length), allocatable :: parameter_names(:)
    !> n x p: derivatives of the initial guess of x; or none, for zero.
    real(c_double), allocatable :: directions(:, :)
    !> Steps are controlled for the sensitivities, too.
    logical :: error_test = .false.
    !> Typical sizes of the parameters, for the error test; or none, for 1.
    real(c_double), allocatable :: scales(:)
    !> Steps are stored for get_gradient instead.
    logical :: adjoint = .false.
    !> With the adjoint: maximum number stored at a time, earlier ones are recomputed; 0: all.
    integer(c_long) :: max_kept_steps = 0
  end type dae_sensitivities

contains

  !> Requests sensitivities from the C solver at `handle`, or from the hybrid system.
  subroutine set_sensitivities_in_c(handle, is_hybrid, n, wanted, number, status, complaint)
    type(c_ptr), intent(in) :: handle
    logical, intent(in) :: is_hybrid
    !> Number of unknowns.
    integer(c_int), intent(in) :: n
    type(dae_sensitivities), target, intent(in) :: wanted
    !> Number of sensitivities; unchanged if the request is refused.
    integer(c_int), intent(inout) :: number
    integer(c_int), intent(out) :: status
    !> Error in the arrays; empty if there is none.
    character(len=:), allocatable, intent(inout) :: complaint
    type(sfdae_sensitivity_options) :: options
    character(kind=c_char), allocatable, target :: names(:, :)
    type(c_ptr), allocatable :: addresses(:)
    type(c_ptr) :: directions
    integer(c_int) :: count
    integer :: k

    count = 0
    if (allocated(wanted%parameter_names)) count = size(wanted%parameter_names, kind=c_int)
    status = sfdae_illegal_argument
    call check_arrays(wanted, n, count, complaint)
    if (len(complaint) > 0) return
    allocate (addresses(1))
    addresses = c_null_ptr
    if (count > 0) then
      call names_in_c(wanted%parameter_names, names, addresses)
      do k = 1, count
        if (len_trim(wanted%parameter_names(k)) == 0) addresses(k) = c_null_ptr
      end do
    end if
    directions = c_null_ptr
    if (count > 0 .and. allocated(wanted%directions)) directions = c_loc(wanted%directions)
    status = c_sensitivity_options_init(options, c_sizeof(options))
    if (status /= sfdae_ok) return
    options%error_test = flag(wanted%error_test)
    options%adjoint = flag(wanted%adjoint)
    options%max_kept_steps = wanted%max_kept_steps
    if (count > 0 .and. allocated(wanted%scales)) options%scales = c_loc(wanted%scales)
    if (is_hybrid) then
      status = c_set_hybrid_sensitivities(handle, count, addresses, directions, options)
    else
      status = c_set_sensitivities(handle, count, addresses, directions, options)
    end if
    if (status >= 0) number = count
  end subroutine set_sensitivities_in_c

  subroutine check_arrays(wanted, n, count, complaint)
    type(dae_sensitivities), intent(in) :: wanted
    integer(c_int), intent(in) :: n
    integer(c_int), intent(in) :: count
    character(len=:), allocatable, intent(inout) :: complaint

    complaint = ""
    if (allocated(wanted%directions)) then
      call compare_size("a column of directions", size(wanted%directions, 1, c_int), n, complaint)
      call compare_size("a row of directions", size(wanted%directions, 2, c_int), count, &
        complaint, "number of names")
    end if
    if (allocated(wanted%scales)) call compare_size("scales", size(wanted%scales, kind=c_int), &
      count, complaint, "number of names")
  end subroutine check_arrays

end module sfdae_sensitivities
