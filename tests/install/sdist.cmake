# Makes the source distribution of the Python package, unpacks it, and has CMake find all that the library is built from.
# scripts/test-packages.sh installs it.

include("${SETTINGS}")
set(work "${work_dir}/${NAME}")
file(REMOVE_RECURSE "${work}")
file(COPY "${source_dir}/python" "${source_dir}/cmake" "${source_dir}/include" "${source_dir}/src"
  "${source_dir}/fortran_bindings" "${source_dir}/CMakeLists.txt" "${source_dir}/LICENSE" DESTINATION "${work}/checkout"
  PATTERN build EXCLUDE PATTERN "*.egg-info" EXCLUDE PATTERN __pycache__ EXCLUDE)
execute_process(COMMAND "${PYTHON}" -W ignore setup.py -q sdist -d "${work}" WORKING_DIRECTORY "${work}/checkout/python"
  COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
file(GLOB archive "${work}/sfdae-*.tar.gz")
file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${work}")
file(REMOVE_RECURSE "${work}/checkout")
file(GLOB unpacked LIST_DIRECTORIES true "${work}/sfdae-*")
list(FILTER unpacked EXCLUDE REGEX "\\.tar\\.gz$")

# Headers are found by the compiler only: as many as there are in the checkout.
foreach(folder IN ITEMS include src fortran_bindings/f77)
  file(GLOB_RECURSE expected RELATIVE "${source_dir}/${folder}" "${source_dir}/${folder}/*.h*" "${source_dir}/${folder}/*.cpp")
  file(GLOB_RECURSE found RELATIVE "${unpacked}/library/${folder}" "${unpacked}/library/${folder}/*.h*"
    "${unpacked}/library/${folder}/*.cpp")
  if(NOT found STREQUAL expected)
    message(FATAL_ERROR "${folder}: ${found} instead of ${expected}")
  endif()
endforeach()
# pip builds where there is nothing but what pyproject.toml requires for that: no numpy.
file(WRITE "${work}/hidden/numpy.py" "raise ModuleNotFoundError('no numpy')\n")
set(ENV{PYTHONPATH} "${work}/hidden")
configure("${unpacked}/library" "${work}/build" "-DSFDAE_PYTHON_EXECUTABLE=${PYTHON}" -DSFDAE_PYTHON_LINK=static
  -DSFDAE_BUILD_FORTRAN=OFF -DSFDAE_BUILD_PROGRAM=OFF -DSFDAE_INSTALL=OFF -DSFDAE_BUILD_PYTHON=ON)
execute_process(COMMAND "${CMAKE_COMMAND}" --build "${work}/build" --target help
  OUTPUT_VARIABLE targets COMMAND_ERROR_IS_FATAL ANY)
if(NOT targets MATCHES "sfdae_python")
  message(FATAL_ERROR "the Python module is not built: ${targets}")
endif()
