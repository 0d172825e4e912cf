# Sanitizers with Clang: their run-time library is a part of programs, not of shared libraries.

if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
  set(sfdae_clang_sanitizers ON)
else()
  set(sfdae_clang_sanitizers OFF)
endif()

# Programs in C and Fortran are linked like those in C++, which know the whole of that library. What GCC puts into Fortran
# calls the same functions.
macro(sfdae_link_with_sanitizers)
  if(sfdae_clang_sanitizers)
    set(link "<FLAGS> <LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES>")
    set(CMAKE_C_LINK_EXECUTABLE "\"${CMAKE_CXX_COMPILER}\" ${link}")
    set(CMAKE_Fortran_LINK_EXECUTABLE "\"${CMAKE_CXX_COMPILER}\" ${CMAKE_CXX_FLAGS} <LINK_FLAGS> <OBJECTS> -o <TARGET> \
<LINK_LIBRARIES> -lgfortran -lm")
  endif()
endmacro()
