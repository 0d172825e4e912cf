# sfdae_warnings: compile options of everything that is built here.

add_library(sfdae_warnings INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  set(warnings -Wall -Wextra -Wpedantic -Wconversion)
  # Sources that are compiled at once have constants of the same name.
  if(NOT SFDAE_UNITY_BUILD AND NOT SFDAE_UNITY_TESTS)
    list(APPEND warnings -Wshadow)
  endif()
  # Fortran: overriding procedures have to accept arguments that they do not need.
  set(fortran_warnings -Wall -Wextra -Wno-unused-dummy-argument -fimplicit-none)
  target_compile_options(sfdae_warnings INTERFACE
    "$<$<COMPILE_LANGUAGE:C,CXX>:${warnings}>"
    "$<$<COMPILE_LANG_AND_ID:Fortran,GNU>:${fortran_warnings}>"
    "$<$<BOOL:${SFDAE_WERROR}>:-Werror>")
endif()
