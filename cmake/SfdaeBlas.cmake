# Finds BLAS and LAPACK (target LAPACK::LAPACK) and makes sure that their integers have 32 bits.

# "Generic" finds libblas and liblapack, which a distribution's alternatives switch at run time. Whoever sets
# BLA_VENDOR gets what they ask for; where there is nothing generic, anything else is welcome.
# sfdae_bla_vendor is what the package config searches for users of the static library.
if(DEFINED BLA_VENDOR OR DEFINED ENV{BLA_VENDOR})
  find_package(LAPACK REQUIRED)
  if(DEFINED BLA_VENDOR)
    set(sfdae_bla_vendor "${BLA_VENDOR}")
  else()
    set(sfdae_bla_vendor "$ENV{BLA_VENDOR}")
  endif()
else()
  set(BLA_VENDOR Generic)
  find_package(LAPACK QUIET)
  unset(BLA_VENDOR)
  set(sfdae_bla_vendor Generic)
  if(NOT LAPACK_FOUND)
    find_package(LAPACK REQUIRED)
    set(sfdae_bla_vendor All)
  endif()
endif()
message(STATUS "BLAS and LAPACK: ${LAPACK_LIBRARIES}")

# FindBLAS can return a library with 64-bit integers (ILP64), which would be called with the wrong arguments.
if(NOT CMAKE_CROSSCOMPILING AND NOT "${SFDAE_BLAS_PROBED}" STREQUAL "${LAPACK_LIBRARIES}")
  try_run(probe_status probe_compiled
    "${PROJECT_BINARY_DIR}/blas_integer_probe" "${PROJECT_SOURCE_DIR}/cmake/blas_integer_probe.cpp"
    LINK_LIBRARIES LAPACK::LAPACK
    COMPILE_OUTPUT_VARIABLE probe_output)
  if(NOT probe_compiled)
    message(FATAL_ERROR "A program that calls isamax_ and dgetrf_ cannot be linked with ${LAPACK_LIBRARIES}. "
      "sfdae needs BLAS and LAPACK with 32-bit integers and names like dgetrf_. Choose another one with "
      "-DBLA_VENDOR=... (Debian, Ubuntu: apt install liblapack-dev).\n${probe_output}")
  endif()
  if(NOT probe_status EQUAL 0)
    message(FATAL_ERROR "The integers of ${LAPACK_LIBRARIES} seem to have 64 bits (ILP64). sfdae needs BLAS and "
      "LAPACK with 32-bit integers (LP64). Choose another one with -DBLA_VENDOR=... "
      "(Debian, Ubuntu: apt install liblapack-dev). The probe returned ${probe_status}.")
  endif()
  set(SFDAE_BLAS_PROBED "${LAPACK_LIBRARIES}" CACHE INTERNAL "Libraries known to have 32-bit integers")
endif()
