# sfdae_docs: the site in <build>/docs/html, from docs/, the headers, the Fortran modules and the Python package. Programs:
# doxygen, and Sphinx with MyST, Breathe and Furo. SFDAE_DOCS_FOUND says whether all are there. Installed if it was built.

include(SfdaePython)
find_program(SFDAE_DOXYGEN NAMES doxygen)
mark_as_advanced(SFDAE_DOXYGEN)
set(SFDAE_DOCS_FOUND FALSE)
foreach(candidate IN LISTS SFDAE_PYTHON_USED ITEMS python3 /usr/bin/python3)
  sfdae_python_has(has_sphinx "${candidate}" sphinx myst_parser breathe furo)
  if(has_sphinx AND SFDAE_DOXYGEN)
    set(SFDAE_DOCS_FOUND TRUE)
    set(docs_python "${candidate}")
    break()
  endif()
endforeach()
if(NOT SFDAE_DOCS_FOUND)
  message(STATUS "No doxygen, or no Sphinx with MyST, Breathe and Furo found: the documentation is not built (Debian, "
    "Ubuntu: apt install doxygen python3-sphinx python3-myst-parser python3-breathe furo)")
  return()
endif()

set(SFDAE_DOCS_COMMAND "${docs_python}" -B "${PROJECT_SOURCE_DIR}/docs/site/build.py" --output "${PROJECT_BINARY_DIR}/docs")
add_custom_target(sfdae_docs VERBATIM COMMENT "Building the site")
if(TARGET sfdae_python_package AND SFDAE_PYTHON_USED STREQUAL docs_python)
  list(APPEND SFDAE_DOCS_COMMAND --python-package "${PROJECT_BINARY_DIR}/python")
  add_dependencies(sfdae_docs sfdae_python_package)
endif()
add_custom_command(TARGET sfdae_docs POST_BUILD COMMAND ${SFDAE_DOCS_COMMAND} VERBATIM)

if(SFDAE_INSTALL)
  install(DIRECTORY "${PROJECT_BINARY_DIR}/docs/html" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT docs OPTIONAL)
endif()
