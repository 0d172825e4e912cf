# Sanitizers with Clang: their run-time library is a part of programs, not of shared libraries.

# Fortran programs are linked by Clang then, which knows that library; GCC's instructions call the same functions.
macro(sfdae_link_fortran_with_sanitizers)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    set(CMAKE_Fortran_LINK_EXECUTABLE
      "<CMAKE_CXX_COMPILER> ${CMAKE_CXX_FLAGS} <LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES> -lgfortran -lm")
  endif()
endmacro()

# sfdae_undefined_symbols(<variable>): the option by which a shared library has to define all that it uses.
function(sfdae_undefined_symbols variable)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    set(${variable} "" PARENT_SCOPE)
  else()
    set(${variable} "LINKER:-z,defs" PARENT_SCOPE)
  endif()
endfunction()
