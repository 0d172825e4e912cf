# The shared library exports the functions that sfdae.h declares and the routines of the Fortran 77 layer, all of them
# and nothing else.

file(READ "${HEADER}" text)
string(REPLACE ";" "|" text "${text}")
string(REGEX MATCHALL "SFDAE_API [^(|]*sfdae_[a-z0-9_A-Z]+\\(" declarations "${text}")
list(TRANSFORM declarations REPLACE ".*(sfdae_[a-z0-9_A-Z]+)\\($" "\\1" OUTPUT_VARIABLE declared)
include("${F77_SOURCES}")
foreach(routine IN LISTS sfdae_f77_routines)
  list(APPEND declared ${routine}_ ${routine}_64_ ${routine}_64__)
endforeach()
list(SORT declared)

execute_process(COMMAND "${NM}" -D --defined-only "${LIBRARY}" OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" lines "${text}")
list(TRANSFORM lines REPLACE "^.* " "" OUTPUT_VARIABLE exported)
list(SORT exported)

list(LENGTH declared count)
if(count EQUAL 0)
  message(FATAL_ERROR "no declaration found in ${HEADER}")
endif()
if(NOT declared STREQUAL exported)
  set(missing ${declared})
  list(REMOVE_ITEM missing ${exported})
  list(REMOVE_ITEM exported ${declared})
  message(FATAL_ERROR "declared, not exported: ${missing}\nexported, not declared: ${exported}")
endif()
message(STATUS "${count} functions declared and exported")
