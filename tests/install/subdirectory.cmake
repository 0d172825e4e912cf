# Builds sfdae as a part of another project, installs it from there and asks pkg-config where it is.

include("${SETTINGS}")
set(build "${work_dir}/${NAME}")
set(deep_libdir lib/deep/er)
set(with_fortran OFF)
if("Fortran" IN_LIST languages)
  set(with_fortran ON)
endif()
configure("${test_dir}/subdirectory" "${build}" "-DSFDAE_SOURCE_DIR=${source_dir}" -DWITH_FORTRAN=${with_fortran}
  -DCMAKE_INSTALL_LIBDIR=${deep_libdir}
  -DCMAKE_CXX_FLAGS_DEBUG=)  # no symbols for a debugger: they take time
run("${CMAKE_COMMAND}" --build "${build}" --config Debug)
run("${CMAKE_COMMAND}" --build "${build}" --config Debug --target run)
run("${CMAKE_COMMAND}" --install "${build}" --config Debug --prefix "${build}/prefix")

if(pkg_config)
  set(ENV{PKG_CONFIG_PATH} "${build}/prefix/${deep_libdir}/pkgconfig")
  execute_process(COMMAND "${pkg_config}" --variable=includedir sfdae
    OUTPUT_VARIABLE includedir OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  if(NOT EXISTS "${includedir}/sfdae/sfdae.h")
    message(FATAL_ERROR "pkg-config says that headers are in ${includedir}")
  endif()
endif()
