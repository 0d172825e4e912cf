# Install rules: headers, libraries, CMake package, pkg-config file, sources of the Fortran modules, documents, examples.

include(CMakePackageConfigHelpers)
# Components: runtime, development (whatever names no other), program, python, docs.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/sfdae")
set(fortran_dir "${CMAKE_INSTALL_DATADIR}/sfdae/fortran")

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/sfdae" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
  DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
  FILES_MATCHING PATTERN site EXCLUDE PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
  FILES_MATCHING PATTERN models EXCLUDE REGEX "\\.(c|cpp|h|f|f90|gp)$")

# Two export sets, because only the static library needs LAPACK where it is used.
install(TARGETS sfdae EXPORT sfdae_shared
  LIBRARY COMPONENT runtime NAMELINK_COMPONENT development)
install(TARGETS sfdae_static EXPORT sfdae_static)
install(EXPORT sfdae_shared NAMESPACE sfdae:: FILE sfdaeSharedTargets.cmake DESTINATION "${package_dir}")
install(EXPORT sfdae_static NAMESPACE sfdae:: FILE sfdaeStaticTargets.cmake DESTINATION "${package_dir}")

if(EXISTS "${PROJECT_SOURCE_DIR}/fortran_bindings/sources.txt")
  # The list, in the order of compilation, is for those who compile by hand.
  set(fortran_sources_list "${PROJECT_SOURCE_DIR}/fortran_bindings/sources.txt")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${fortran_sources_list}")
  file(STRINGS "${fortran_sources_list}" fortran_sources)
  list(TRANSFORM fortran_sources PREPEND "${PROJECT_SOURCE_DIR}/fortran_bindings/")
  install(FILES ${fortran_sources} "${fortran_sources_list}" DESTINATION "${fortran_dir}")
  install(FILES "${PROJECT_SOURCE_DIR}/cmake/SfdaeFortran.cmake" DESTINATION "${package_dir}")
endif()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/sfdaeConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/sfdaeConfig.cmake"
  INSTALL_DESTINATION "${package_dir}" PATH_VARS fortran_dir NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/sfdaeConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/sfdaeConfig.cmake" "${PROJECT_BINARY_DIR}/sfdaeConfigVersion.cmake"
  DESTINATION "${package_dir}")
if(sfdae_uses_klu)
  install(FILES "${PROJECT_SOURCE_DIR}/cmake/FindKLU.cmake" DESTINATION "${package_dir}")
endif()

# pkg-config. The prefix is found from where the file lies, so an installed tree can be moved.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  set(pkgconfig_prefix "${CMAKE_INSTALL_PREFIX}")
else()
  file(RELATIVE_PATH to_prefix "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
  string(REGEX REPLACE "/$" "" to_prefix "${to_prefix}")
  set(pkgconfig_prefix "\${pcfiledir}/${to_prefix}")
endif()
foreach(dir IN ITEMS LIBDIR INCLUDEDIR)
  if(IS_ABSOLUTE "${CMAKE_INSTALL_${dir}}")
    set(pkgconfig_${dir} "${CMAKE_INSTALL_${dir}}")
  else()
    set(pkgconfig_${dir} "\${prefix}/${CMAKE_INSTALL_${dir}}")
  endif()
endforeach()
if(IS_ABSOLUTE "${fortran_dir}")
  set(pkgconfig_fortrandir "${fortran_dir}")
else()
  set(pkgconfig_fortrandir "\${prefix}/${fortran_dir}")
endif()

include(SfdaeStaticLibraries)
configure_file("${PROJECT_SOURCE_DIR}/cmake/sfdae.pc.in" "${PROJECT_BINARY_DIR}/sfdae.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/sfdae.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
