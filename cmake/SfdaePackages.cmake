# Debian packages by CPack, one for each of these, in a build for the prefix /usr:
#
#   libsfdae<version of the ABI>   component runtime       the shared library
#   libsfdae-dev                   components development, docs
#   sfdae                          component program       where the program is built
#   python3-sfdae                  component python        where the Python package is built

get_target_property(soversion sfdae SOVERSION)
set(library_package "libsfdae${soversion}")
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_PACKAGING_INSTALL_PREFIX "${CMAKE_INSTALL_PREFIX}")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "sfdae developers <sfdae@localhost>" CACHE STRING "Maintainer of Debian packages")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENTS_ALL runtime development docs)

# What Debian expects of documents: a changelog in its own format, compressed as manual pages are.
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/cmake/compress_documents.cmake")
string(TIMESTAMP built "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE "${PROJECT_BINARY_DIR}/packages/changelog.Debian"
  "sfdae (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
  "  * Version ${PROJECT_VERSION}: see CHANGELOG.md in libsfdae-dev.\n\n"
  " -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${built}\n")

# sfdae_package(<component> <package> <section> <description> <dependencies> <recommended packages>)
macro(sfdae_package component package section description depends recommends)
  string(TOUPPER "${component}" upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME "${package}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION "${section}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${description}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS "${recommends}")
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "share/doc/${package}" RENAME copyright
    COMPONENT ${component})
  install(FILES "${PROJECT_BINARY_DIR}/packages/changelog.Debian" DESTINATION "share/doc/${package}" COMPONENT ${component})
endmacro()
set(same_library "${library_package} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")

# Libraries that are linked become dependencies by themselves.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}/src")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_PROVIDES libsfdae)
# CPack would write shlibs for the Python module, too, which has no version.
file(WRITE "${PROJECT_BINARY_DIR}/packages/shlibs" "libsfdae ${soversion} ${same_library}\n")
file(WRITE "${PROJECT_BINARY_DIR}/packages/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA
  "${PROJECT_BINARY_DIR}/packages/shlibs;${PROJECT_BINARY_DIR}/packages/triggers")

sfdae_package(runtime "${library_package}" libs "This package contains the shared library." "" "")
set(CPACK_COMPONENT_DEVELOPMENT_GROUP development)
set(CPACK_COMPONENT_DOCS_GROUP development)
# The group is called as its first component, so that settings of both agree.
sfdae_package(development libsfdae-dev libdevel
  "Headers for C and C++, modules for Fortran, the static library,\ndocuments and examples." "${same_library}"
  "liblapack-dev, pkgconf | pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake, g++, gfortran")

if(TARGET sfdae_program)
  list(APPEND CPACK_COMPONENTS_ALL program)
  sfdae_package(program sfdae math "This package contains the program sfdae, which solves model files." "${same_library}"
    "gnuplot-nox, xdg-utils")
endif()

if(SFDAE_PYTHON_INSTALL_DIR AND TARGET sfdae_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  sfdae_package(python python3-sfdae python "This package contains the Python module sfdae."
    "${same_library}, python3 (>= 3.9), python3-cffi-backend, python3-numpy" python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-tqdm")
endif()

include(CPack)
cpack_add_component_group(development)
