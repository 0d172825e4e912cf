# Reads HEADER (sfdae.h), MODULE (sfdae.f90) and EXPRESSIONS_MODULE (sfdae_expressions.f90). Fails if a function of the
# header is not bound in the modules, and writes the Fortran subroutine check_constants, which compares every constant of the header, to OUTPUT.

file(READ "${HEADER}" header)
file(READ "${MODULE}" module)
file(READ "${EXPRESSIONS_MODULE}" expressions_module)
string(APPEND module "${expressions_module}")

string(REGEX MATCHALL "SFDAE_API [^(;]*sfdae_[a-z0-9_]+\\(" functions "${header}")
list(LENGTH functions count)
if(count LESS 30)
  message(FATAL_ERROR "only ${count} functions found in ${HEADER}")
endif()
foreach(function IN LISTS functions)
  string(REGEX REPLACE ".*(sfdae_[a-z0-9_]+)\\($" "\\1" function "${function}")
  string(FIND "${module}" "name=\"${function}\"" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "${function} of ${HEADER} is not bound in ${MODULE}")
  endif()
endforeach()

string(REGEX MATCHALL "#define SFDAE_[A-Z0-9a-z_]+ +\\(?-?[0-9]+" constants "${header}")
list(LENGTH constants count)
if(count LESS 40)
  message(FATAL_ERROR "only ${count} constants found in ${HEADER}")
endif()
set(text "! Written by check_mirror.cmake.
subroutine check_constants()
  use sfdae
  use test_support, only: check
  implicit none

")
foreach(constant IN LISTS constants)
  string(REGEX REPLACE "#define (SFDAE_[A-Z0-9a-z_]+) +\\(?(-?[0-9]+)" "\\1;\\2" pair "${constant}")
  list(GET pair 0 name)
  list(GET pair 1 value)
  string(TOLOWER "${name}" name)
  string(APPEND text "  call check(${name} == (${value}), \"${name}\")\n")
endforeach()
string(APPEND text "end subroutine check_constants\n")
file(WRITE "${OUTPUT}" "${text}")
