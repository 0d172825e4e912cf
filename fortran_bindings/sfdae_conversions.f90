! SPDX-License-Identifier: BSD-3-Clause
!
! Conversions between C addresses and Fortran arrays and strings.
module sfdae_conversions
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, &
    c_loc, c_null_char, c_null_ptr, c_ptr, c_size_t
  implicit none
  private

  public :: flag, text_at, text_in, text_in_c, names_in_c, vector_at, matrix_at

  interface
    !> strlen of the C library: number of characters before the final zero.
    function c_strlen(text) bind(c, name="strlen") result(length)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: text
      integer(c_size_t) :: length
    end function c_strlen
  end interface

contains

  !> A logical as a C truth value.
  elemental function flag(condition) result(number)
    !> .true.: 1, .false.: 0.
    logical, intent(in) :: condition
    integer(c_int) :: number

    number = merge(1_c_int, 0_c_int, condition)
  end function flag

  !> The C string at an address.
  function text_at(address) result(text)
    !> Null: no characters.
    type(c_ptr), intent(in) :: address
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: characters(:)

    text = ""
    if (.not. c_associated(address)) return
    call c_f_pointer(address, characters, [c_strlen(address) + 1])
    text = text_in(characters)
  end function text_at

  !> The C string in an array of characters.
  function text_in(characters) result(text)
    !> Up to the first zero, or all of them.
    character(kind=c_char), intent(in) :: characters(:)
    character(len=:), allocatable :: text
    integer :: i, length

    length = 0
    do while (length < size(characters))
      if (characters(length + 1) == c_null_char) exit
      length = length + 1
    end do
    allocate (character(len=length) :: text)
    do i = 1, length
      text(i:i) = characters(i)
    end do
  end function text_in

  !> A text as a C string: with a final zero, without trailing blanks.
  pure function text_in_c(text) result(c_text)
    !> Without zeros.
    character(len=*), intent(in) :: text
    character(kind=c_char) :: c_text(len_trim(text) + 1)
    integer :: i

    do i = 1, len_trim(text)
      c_text(i) = text(i:i)
    end do
    c_text(len_trim(text) + 1) = c_null_char
  end function text_in_c

  !> Names as C strings: addresses of texts as made by text_in_c.
  subroutine names_in_c(names, texts, addresses)
    character(len=*), intent(in) :: names(:)
    !> The C strings; the actual argument must have the target attribute.
    character(kind=c_char), allocatable, target, intent(inout) :: texts(:, :)
    !> At least one, null if there are no names.
    type(c_ptr), allocatable, intent(inout) :: addresses(:)
    integer :: k

    if (allocated(texts)) deallocate (texts)
    if (allocated(addresses)) deallocate (addresses)
    allocate (texts(len(names) + 1, max(size(names), 1)), addresses(max(size(names), 1)))
    texts = c_null_char
    addresses = c_null_ptr
    do k = 1, size(names)
      texts(:len_trim(names(k)) + 1, k) = text_in_c(names(k))
      addresses(k) = c_loc(texts(1, k))
    end do
  end subroutine names_in_c

  !> The numbers at an address.
  function vector_at(address, length) result(vector)
    !> Address of the first number.
    type(c_ptr), intent(in) :: address
    !> Number of numbers.
    integer(c_int), intent(in) :: length
    real(c_double), pointer :: vector(:)

    call c_f_pointer(address, vector, [length])
  end function vector_at

  !> The matrix at an address, column by column without padding.
  function matrix_at(address, rows, columns) result(matrix)
    !> Address of the first entry.
    type(c_ptr), intent(in) :: address
    !> Number of rows.
    integer(c_int), intent(in) :: rows
    !> Number of columns.
    integer(c_int), intent(in) :: columns
    real(c_double), pointer :: matrix(:, :)

    call c_f_pointer(address, matrix, [rows, columns])
  end function matrix_at

end module sfdae_conversions
