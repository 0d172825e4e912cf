# sfdae_warnings: compile options of everything that is built here.

add_library(sfdae_warnings INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  set(warnings -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
  target_compile_options(sfdae_warnings INTERFACE
    "$<$<COMPILE_LANGUAGE:C,CXX>:${warnings}>"
    "$<$<COMPILE_LANG_AND_ID:Fortran,GNU>:-Wall;-Wextra;-fimplicit-none>"
    "$<$<BOOL:${SFDAE_WERROR}>:-Werror>")
endif()
