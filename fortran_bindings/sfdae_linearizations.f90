! SPDX-License-Identifier: BSD-3-Clause
!
! Descriptor systems E x' = A x + B u, y = C x + D u: poles, zeros, transfer functions.
module sfdae_linearizations
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_loc, c_null_ptr, c_ptr, c_sizeof
  use sfdae_c, only: c_create_descriptor, c_descriptor_matrices_init, c_descriptor_message, &
    c_destroy_descriptor, c_get_descriptor_matrices, c_get_descriptor_sizes, c_get_poles, &
    c_get_transfer, c_get_zeros, c_linearization_init, c_linearize, c_spectrum_init
  use sfdae_control, only: compare_size
  use sfdae_conversions, only: names_in_c, text_at
  use sfdae_types, only: sfdae_descriptor_matrices, sfdae_illegal_argument, sfdae_linearization, &
    sfdae_ok, sfdae_spectrum
  implicit none
  private

  public :: dae_descriptor, dae_linearization
  public :: linearize_in_c

  !> Characters of a name of a parameter.
  integer, parameter :: name_length = 128

  !> The point at which a problem with n unknowns is linearized, with the inputs and outputs; see
  !> sfdae_linearization in C. Components that are not allocated are absent.
  type :: dae_linearization
    !> Time of the point.
    real(c_double) :: t = 0
    !> n values; else those of the solution at t.
    real(c_double), allocatable :: x(:)
    !> n values; else those of the solution through x.
    real(c_double), allocatable :: xdot(:)
    !> Inputs: first parameters of recorded equations,
    character(len=name_length), allocatable :: input_parameters(:)
    !> then unknowns, from 1,
    integer(c_int), allocatable :: input_unknowns(:)
    !> then right-hand sides, one in each column.
    real(c_double), allocatable :: input_columns(:, :)
    !> Outputs: first unknowns, from 1,
    integer(c_int), allocatable :: output_unknowns(:)
    !> then combinations of unknowns, one in each row.
    real(c_double), allocatable :: output_rows(:, :)
  end type dae_linearization

  !> A descriptor system, created by `linearize` of a dae_solver or from matrices. Never copy one,
  !> and destroy it before it goes out of scope.
  type :: dae_descriptor
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure :: create => descriptor_create
    procedure :: destroy => descriptor_destroy
    procedure :: message => descriptor_message
    procedure :: get_sizes => descriptor_get_sizes
    procedure :: get_matrices => descriptor_get_matrices
    procedure :: get_poles => descriptor_get_poles
    procedure :: get_zeros => descriptor_get_zeros
    procedure :: get_transfer => descriptor_get_transfer
  end type dae_descriptor

contains

  !> Creates a descriptor system from matrices; an existing one is destroyed. sfdae_illegal_argument
  !> if sizes do not match or numbers are not finite.
  subroutine descriptor_create(self, E, A, status, B, C, D, rank_tol)
    class(dae_descriptor), intent(inout) :: self
    !> m x n.
    real(c_double), intent(in), contiguous, target :: E(:, :)
    !> m x n.
    real(c_double), intent(in), contiguous, target :: A(:, :)
    integer(c_int), intent(out) :: status
    !> m x q; absent: no inputs.
    real(c_double), intent(in), contiguous, target, optional :: B(:, :)
    !> p x n; absent: no outputs.
    real(c_double), intent(in), contiguous, target, optional :: C(:, :)
    !> p x q; absent: 0.
    real(c_double), intent(in), contiguous, target, optional :: D(:, :)
    !> As in dae_options; absent: 0.
    real(c_double), intent(in), optional :: rank_tol
    type(sfdae_descriptor_matrices) :: matrices
    integer(c_int) :: ignored

    call self%destroy(ignored)
    status = c_descriptor_matrices_init(matrices, c_sizeof(matrices))
    matrices%num_equations = size(E, 1, c_int)
    matrices%num_unknowns = size(E, 2, c_int)
    if (any(shape(A) /= shape(E))) status = sfdae_illegal_argument
    if (size(E) > 0) matrices%e = c_loc(E)
    if (size(A) > 0) matrices%a = c_loc(A)
    if (present(B)) then
      matrices%num_inputs = size(B, 2, c_int)
      if (size(B, 1) /= size(E, 1)) status = sfdae_illegal_argument
      if (size(B) > 0) matrices%b = c_loc(B)
    end if
    if (present(C)) then
      matrices%num_outputs = size(C, 1, c_int)
      if (size(C, 2) /= size(E, 2)) status = sfdae_illegal_argument
      if (size(C) > 0) matrices%c = c_loc(C)
    end if
    if (present(D)) then
      if (size(D, 1) /= matrices%num_outputs .or. size(D, 2) /= matrices%num_inputs) &
        status = sfdae_illegal_argument
      if (size(D) > 0) matrices%d = c_loc(D)
    end if
    if (present(rank_tol)) matrices%rank_tol = rank_tol
    if (status == sfdae_ok) status = c_create_descriptor(matrices, self%handle)
  end subroutine descriptor_create

  !> Frees its memory.
  subroutine descriptor_destroy(self, status)
    class(dae_descriptor), intent(inout) :: self
    integer(c_int), intent(out) :: status

    status = c_destroy_descriptor(self%handle)
  end subroutine descriptor_destroy

  !> Message of the last call, empty if there is none.
  function descriptor_message(self) result(message)
    class(dae_descriptor), intent(in) :: self
    character(len=:), allocatable :: message

    message = text_at(c_descriptor_message(self%handle))
  end function descriptor_message

  !> m, n, q, p: equations, unknowns, inputs, outputs.
  subroutine descriptor_get_sizes(self, num_equations, num_unknowns, num_inputs, &
    num_outputs, status)
    class(dae_descriptor), intent(in) :: self
    integer(c_int), intent(inout) :: num_equations
    integer(c_int), intent(inout) :: num_unknowns
    integer(c_int), intent(inout) :: num_inputs
    integer(c_int), intent(inout) :: num_outputs
    integer(c_int), intent(out) :: status

    status = c_get_descriptor_sizes(self%handle, num_equations, num_unknowns, num_inputs, &
      num_outputs)
  end subroutine descriptor_get_sizes

  !> The matrices, which are allocated here.
  subroutine descriptor_get_matrices(self, E, A, B, C, D, status)
    class(dae_descriptor), intent(in) :: self
    !> m x n.
    real(c_double), allocatable, intent(inout) :: E(:, :)
    !> m x n.
    real(c_double), allocatable, intent(inout) :: A(:, :)
    !> m x q.
    real(c_double), allocatable, intent(inout) :: B(:, :)
    !> p x n.
    real(c_double), allocatable, intent(inout) :: C(:, :)
    !> p x q.
    real(c_double), allocatable, intent(inout) :: D(:, :)
    integer(c_int), intent(out) :: status
    integer(c_int) :: m, n, q, p

    status = c_get_descriptor_sizes(self%handle, m, n, q, p)
    if (status < 0) return
    call resize(E, m, n)
    call resize(A, m, n)
    call resize(B, m, q)
    call resize(C, p, n)
    call resize(D, p, q)
    status = c_get_descriptor_matrices(self%handle, E, A, B, C, D)
  end subroutine descriptor_get_matrices

  subroutine resize(a, rows, columns)
    real(c_double), allocatable, intent(inout) :: a(:, :)
    integer(c_int), intent(in) :: rows, columns

    if (allocated(a)) deallocate (a)
    allocate (a(rows, columns))
  end subroutine resize

  !> Poles: the finite eigenvalues of lambda E - A; their number is spectrum%num_finite.
  subroutine descriptor_get_poles(self, spectrum, values, status, errors)
    class(dae_descriptor), intent(inout) :: self
    type(sfdae_spectrum), intent(inout) :: spectrum
    complex(c_double), allocatable, intent(inout) :: values(:)
    integer(c_int), intent(out) :: status
    !> Estimates of absolute errors.
    real(c_double), allocatable, intent(inout), optional :: errors(:)

    call get_spectrum(self, .true., spectrum, values, status, errors)
  end subroutine descriptor_get_poles

  !> Invariant zeros.
  subroutine descriptor_get_zeros(self, spectrum, values, status, errors)
    class(dae_descriptor), intent(inout) :: self
    !> Spectrum of the system pencil.
    type(sfdae_spectrum), intent(inout) :: spectrum
    complex(c_double), allocatable, intent(inout) :: values(:)
    integer(c_int), intent(out) :: status
    !> Estimates of absolute errors.
    real(c_double), allocatable, intent(inout), optional :: errors(:)

    call get_spectrum(self, .false., spectrum, values, status, errors)
  end subroutine descriptor_get_zeros

  subroutine get_spectrum(self, of_poles, spectrum, values, status, errors)
    class(dae_descriptor), intent(inout) :: self
    logical, intent(in) :: of_poles
    type(sfdae_spectrum), intent(inout) :: spectrum
    complex(c_double), allocatable, intent(inout) :: values(:)
    integer(c_int), intent(out) :: status
    real(c_double), allocatable, intent(inout), optional :: errors(:)
    type(sfdae_spectrum) :: found
    real(c_double), allocatable :: parts(:, :)
    integer(c_int) :: m, n, q, p

    status = c_get_descriptor_sizes(self%handle, m, n, q, p)
    if (status < 0) return
    allocate (parts(n, 3))
    status = c_spectrum_init(found, c_sizeof(found))
    if (of_poles) then
      status = c_get_poles(self%handle, found, parts(:, 1), parts(:, 2), parts(:, 3))
    else
      status = c_get_zeros(self%handle, found, parts(:, 1), parts(:, 2), parts(:, 3))
    end if
    if (status < 0) return
    spectrum = found
    n = found%num_finite
    values = cmplx(parts(:n, 1), parts(:n, 2), c_double)
    if (present(errors)) errors = parts(:n, 3)
  end subroutine get_spectrum

  !> H(s) = C (s E - A)^-1 B + D at numbers s; sfdae_singular if one of them is a pole.
  subroutine descriptor_get_transfer(self, s, H, status)
    class(dae_descriptor), intent(inout) :: self
    complex(c_double), intent(in) :: s(:)
    !> p x q x size(s), allocated here.
    complex(c_double), allocatable, intent(inout) :: H(:, :, :)
    integer(c_int), intent(out) :: status
    real(c_double), allocatable :: parts(:, :)
    integer(c_int) :: m, n, q, p

    status = c_get_descriptor_sizes(self%handle, m, n, q, p)
    if (status < 0) return
    allocate (parts(p * q * size(s), 2))
    status = c_get_transfer(self%handle, size(s, kind=c_int), real(s), aimag(s), parts(:, 1), &
      parts(:, 2))
    if (status < 0) return
    H = reshape(cmplx(parts(:, 1), parts(:, 2), c_double), [int(p), int(q), size(s)])
  end subroutine descriptor_get_transfer

  !> The descriptor system of a problem with n unknowns and m equations in the C solver at `handle`.
  recursive subroutine linearize_in_c(handle, m, n, choice, descriptor, status, complaint)
    type(c_ptr), intent(in) :: handle
    integer(c_int), intent(in) :: m, n
    type(dae_linearization), target, intent(in) :: choice
    class(dae_descriptor), intent(inout) :: descriptor
    integer(c_int), intent(out) :: status
    !> Error in the arrays; empty if there is none.
    character(len=:), allocatable, intent(inout) :: complaint
    type(sfdae_linearization) :: c_choice
    character(kind=c_char), allocatable, target :: names(:, :)
    type(c_ptr), allocatable, target :: addresses(:)
    integer(c_int), allocatable, target :: inputs(:), outputs(:)
    type(c_ptr) :: found

    status = sfdae_illegal_argument
    call check_sizes(choice, m, n, complaint)
    if (len(complaint) > 0) return
    status = c_linearization_init(c_choice, c_sizeof(c_choice))
    call fill_point(choice, c_choice)
    if (allocated(choice%input_parameters)) then
      call names_in_c(choice%input_parameters, names, addresses)
      c_choice%num_input_parameters = size(choice%input_parameters, kind=c_int)
      c_choice%input_parameters = c_loc(addresses)
    end if
    if (allocated(choice%input_unknowns)) then
      inputs = [choice%input_unknowns - 1_c_int, 0_c_int]  ! never empty
      c_choice%num_input_unknowns = size(choice%input_unknowns, kind=c_int)
      c_choice%input_unknowns = c_loc(inputs)
    end if
    if (allocated(choice%output_unknowns)) then
      outputs = [choice%output_unknowns - 1_c_int, 0_c_int]
      c_choice%num_output_unknowns = size(choice%output_unknowns, kind=c_int)
      c_choice%output_unknowns = c_loc(outputs)
    end if
    found = c_null_ptr
    status = c_linearize(handle, c_choice, found)
    if (status < 0) return
    call replace(descriptor, found)
  end subroutine linearize_in_c

  subroutine replace(descriptor, found)
    class(dae_descriptor), intent(inout) :: descriptor
    type(c_ptr), intent(in) :: found
    integer(c_int) :: ignored

    call descriptor%destroy(ignored)
    descriptor%handle = found
  end subroutine replace

  !> Complains about arrays of wrong sizes.
  subroutine check_sizes(choice, m, n, complaint)
    type(dae_linearization), intent(in) :: choice
    integer(c_int), intent(in) :: m, n
    character(len=:), allocatable, intent(inout) :: complaint

    if (allocated(choice%x)) call compare_size("x", size(choice%x, kind=c_int), n, complaint)
    if (allocated(choice%xdot)) &
      call compare_size("xdot", size(choice%xdot, kind=c_int), n, complaint)
    if (allocated(choice%input_columns)) call compare_size("a column of input_columns", &
      size(choice%input_columns, 1, c_int), m, complaint, "the number of equations")
    if (allocated(choice%output_rows)) &
      call compare_size("a row of output_rows", size(choice%output_rows, 2, c_int), n, complaint)
  end subroutine check_sizes

  !> Addresses of the point and the matrices.
  subroutine fill_point(choice, c)
    type(dae_linearization), target, intent(in) :: choice
    type(sfdae_linearization), intent(inout) :: c

    c%t = choice%t
    if (allocated(choice%x)) c%x = c_loc(choice%x)
    if (allocated(choice%xdot)) c%xdot = c_loc(choice%xdot)
    if (allocated(choice%input_columns)) then
      c%num_input_columns = size(choice%input_columns, 2, c_int)
      if (c%num_input_columns > 0) c%input_columns = c_loc(choice%input_columns)
    end if
    if (allocated(choice%output_rows)) then
      c%num_output_rows = size(choice%output_rows, 1, c_int)
      if (c%num_output_rows > 0) c%output_rows = c_loc(choice%output_rows)
    end if
  end subroutine fill_point

end module sfdae_linearizations
