# As a part of a project that chooses no build type the library is optimized all the same; with one, it is as chosen.

include("${SETTINGS}")
set(build "${work_dir}/${NAME}")
# Nothing is linked: whether programs can be linked statically takes seconds to find out, and need not be known.
foreach(type IN ITEMS "" Debug)
  configure("${test_dir}/subdirectory" "${build}" "-DSFDAE_SOURCE_DIR=${source_dir}" -DWITH_FORTRAN=OFF
    "-DCMAKE_BUILD_TYPE=${type}" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DSFDAE_UNITY_BUILD=OFF
    -DSFDAE_STATIC_LAPACK_1=ON)
  if(NOT EXISTS "${build}/compile_commands.json")
    message(STATUS "${generator} writes no compile_commands.json")
    return()
  endif()
  file(STRINGS "${build}/compile_commands.json" commands REGEX "linalg/qr\\.cpp")
  list(GET commands 0 command)
  string(FIND "${command}" "-O2 " position)
  if(type STREQUAL "" AND position EQUAL -1)
    message(FATAL_ERROR "not optimized: ${command}")
  elseif(NOT type STREQUAL "" AND NOT position EQUAL -1)
    message(FATAL_ERROR "optimized although the build type is ${type}: ${command}")
  endif()
endforeach()
