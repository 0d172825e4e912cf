! SPDX-License-Identifier: BSD-3-Clause
!
! Recorded solutions over a whole run, which can be evaluated anywhere, saved and loaded.
module sfdae_solutions
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_loc, c_null_ptr, c_ptr, &
    c_size_t
  use sfdae_c, only: c_create_solution, c_cut_solution, c_destroy_solution, c_evaluate_solution, &
    c_get_solution_accuracy, c_get_solution_length, c_get_solution_range, c_load_solution, &
    c_save_solution
  use sfdae_types, only: sfdae_illegal_argument, sfdae_ok, sfdae_out_of_memory
  implicit none
  private

  public :: dae_solution

  !> A solution, recorded by `record` of a dae_solver, or loaded. Never copy one, and destroy it
  !> before it goes out of scope.
  type :: dae_solution
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure :: create => solution_create
    procedure :: destroy => solution_destroy
    procedure :: get_range => solution_get_range
    procedure :: evaluate => solution_evaluate
    procedure :: get_accuracy => solution_get_accuracy
    procedure :: cut => solution_cut
    procedure :: save => solution_save
    procedure :: load => solution_load
    !> For internal use by the modules of sfdae: the address of the C solution.
    procedure :: address => solution_address
  end type dae_solution

contains

  !> Creates an empty solution; an existing one is destroyed.
  subroutine solution_create(self, status)
    class(dae_solution), intent(inout) :: self
    integer(c_int), intent(out) :: status
    integer(c_int) :: ignored

    call self%destroy(ignored)
    status = c_create_solution(self%handle)
  end subroutine solution_create

  !> Destroys it. A solver that records it stops doing so.
  subroutine solution_destroy(self, status)
    class(dae_solution), intent(inout) :: self
    integer(c_int), intent(out) :: status

    status = c_destroy_solution(self%handle)
  end subroutine solution_destroy

  !> Range of the recording; sfdae_not_started if nothing was recorded.
  subroutine solution_get_range(self, num_unknowns, start, end, status)
    class(dae_solution), intent(in) :: self
    integer(c_int), intent(inout) :: num_unknowns
    real(c_double), intent(inout) :: start
    !> The end of the last step.
    real(c_double), intent(inout) :: end
    integer(c_int), intent(out) :: status

    status = c_get_solution_range(self%handle, num_unknowns, start, end)
  end subroutine solution_get_range

  !> x and x' at any t of the range; sfdae_illegal_argument for other t.
  subroutine solution_evaluate(self, t, x, status, xdot)
    class(dae_solution), intent(in) :: self
    real(c_double), intent(in) :: t
    !> n values.
    real(c_double), intent(inout), contiguous :: x(:)
    integer(c_int), intent(out) :: status
    !> n values.
    real(c_double), intent(inout), contiguous, target, optional :: xdot(:)
    integer(c_int) :: n
    real(c_double) :: start, end
    type(c_ptr) :: slopes

    status = c_get_solution_range(self%handle, n, start, end)
    if (status < 0) return
    status = sfdae_illegal_argument
    slopes = c_null_ptr
    if (size(x) /= n) return
    if (present(xdot)) then
      if (size(xdot) /= n) return
      slopes = c_loc(xdot)
    end if
    status = c_evaluate_solution(self%handle, t, x, slopes)
  end subroutine solution_evaluate

  !> Accuracy relative to the integrator's own values; sfdae_not_started if nothing was recorded.
  subroutine solution_get_accuracy(self, accuracy, t, status)
    class(dae_solution), intent(in) :: self
    !> The largest expected difference, in tolerances.
    real(c_double), intent(inout) :: accuracy
    !> Time of that difference.
    real(c_double), intent(inout) :: t
    integer(c_int), intent(out) :: status

    status = c_get_solution_accuracy(self%handle, accuracy, t)
  end subroutine solution_get_accuracy

  !> Discards the recording after t; sfdae_illegal_argument for t outside the range.
  subroutine solution_cut(self, t, status)
    class(dae_solution), intent(inout) :: self
    real(c_double), intent(in) :: t
    integer(c_int), intent(out) :: status

    status = c_cut_solution(self%handle, t)
  end subroutine solution_cut

  !> The solution as an array of numbers, to be stored or written to a file.
  subroutine solution_save(self, values, status)
    class(dae_solution), intent(in) :: self
    real(c_double), allocatable, intent(out) :: values(:)
    integer(c_int), intent(out) :: status
    integer(c_size_t) :: length
    integer :: outcome

    status = c_get_solution_length(self%handle, length)
    if (status < 0) return
    allocate (values(length), stat=outcome)
    if (outcome /= 0) then
      status = sfdae_out_of_memory
      return
    end if
    status = c_save_solution(self%handle, values, length)
  end subroutine solution_save

  !> Restores a saved solution; sfdae_illegal_argument if the numbers are damaged or unsuitable.
  subroutine solution_load(self, values, status)
    class(dae_solution), intent(inout) :: self
    real(c_double), intent(in), contiguous :: values(:)
    integer(c_int), intent(out) :: status

    status = sfdae_ok
    if (.not. c_associated(self%handle)) status = c_create_solution(self%handle)
    if (status < 0) return
    status = c_load_solution(self%handle, values, int(size(values), c_size_t))
  end subroutine solution_load

  function solution_address(self) result(address)
    class(dae_solution), intent(in) :: self
    type(c_ptr) :: address

    address = self%handle
  end function solution_address

end module sfdae_solutions
