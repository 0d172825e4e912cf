# Compiles and runs a program of consumer/ by hand, with what pkg-config says about the installed tree.

include("${SETTINGS}")
set(root "${prefix}")
# VARIANT archives: programs that need no shared library at all.
set(static "")
set(flags "")
if(VARIANT STREQUAL "archives")
  set(flags -static)
endif()
if(VARIANT MATCHES "static|archives")
  # Where there is no shared library the linker takes the static one.
  set(root "${work_dir}/${NAME}_prefix")
  set(static --static)
  file(REMOVE_RECURSE "${root}")
  file(COPY "${prefix}/" DESTINATION "${root}")
  file(GLOB shared_libraries "${root}/${libdir}/*.so*")
  file(REMOVE ${shared_libraries})
endif()

set(ENV{PKG_CONFIG_PATH} "${root}/${libdir}/pkgconfig")
function(ask result)
  execute_process(COMMAND "${pkg_config}" ${ARGN} sfdae
    OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(answer UNIX_COMMAND "${answer}")
  set(${result} ${answer} PARENT_SCOPE)
endfunction()

ask(cflags --cflags)
ask(libs --libs ${static})
ask(fortrandir --variable=fortrandir)

set(build "${work_dir}/${NAME}")
file(REMOVE_RECURSE "${build}")
file(MAKE_DIRECTORY "${build}")
if(LANGUAGE STREQUAL "Fortran")
  # The modules first, in the order of the list, as the README of the Fortran bindings says.
  execute_process(
    COMMAND sh -c "dir=$1; \"$0\" -c $(sed \"s|^|$dir/|\" \"$dir/sources.txt\")" "${Fortran_compiler}" "${fortrandir}"
    WORKING_DIRECTORY "${build}" COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB modules "${build}/*.o")
  set(sources "${test_dir}/consumer/main.f90" ${modules})
elseif(LANGUAGE STREQUAL "Fortran77")
  # A program written for GELDA needs the library alone.
  set(Fortran77_compiler "${Fortran_compiler}")
  set(sources "${test_dir}/../../examples/dgelda.f")
elseif(LANGUAGE STREQUAL "CXX")
  set(sources -std=c++17 "${test_dir}/consumer/main.cpp")
else()
  set(sources "${test_dir}/consumer/main.c")
endif()
execute_process(COMMAND "${${LANGUAGE}_compiler}" ${flags} ${cflags} ${sources} ${libs} -lm -o consumer
  WORKING_DIRECTORY "${build}" COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
set(ENV{LD_LIBRARY_PATH} "${root}/${libdir}:$ENV{LD_LIBRARY_PATH}")
run("${build}/consumer")
if(VARIANT STREQUAL "archives")
  # NEEDED names a shared library.
  file(READ "${build}/consumer" magic LIMIT 4 HEX)
  find_program(readelf readelf)
  if(readelf AND magic STREQUAL "7f454c46")
    execute_process(COMMAND "${readelf}" -d "${build}/consumer" OUTPUT_VARIABLE dynamic ERROR_QUIET)
    if(dynamic MATCHES "NEEDED")
      message(FATAL_ERROR "the program needs shared libraries:\n${dynamic}")
    endif()
  endif()
endif()
