# Compiles the Fortran modules from their sources: .mod files are specific to a compiler, so every build tree makes its
# own. Included by the project itself and, installed, by the package config.

# Adds the static library sfdae_fortran (alias sfdae::fortran), which brings the module `sfdae` and `library`.
# directory: holds the sources and their list, sources.txt.
function(sfdae_add_fortran_module directory library)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${directory}/sources.txt")
  file(STRINGS "${directory}/sources.txt" sources)
  list(TRANSFORM sources PREPEND "${directory}/")
  set(module_directory "${CMAKE_CURRENT_BINARY_DIR}/sfdae_fortran_modules")
  add_library(sfdae_fortran STATIC EXCLUDE_FROM_ALL ${sources})
  add_library(sfdae::fortran ALIAS sfdae_fortran)
  set_target_properties(sfdae_fortran PROPERTIES
    Fortran_MODULE_DIRECTORY "${module_directory}"
    POSITION_INDEPENDENT_CODE ON)
  target_include_directories(sfdae_fortran INTERFACE "${module_directory}")
  target_link_libraries(sfdae_fortran PUBLIC ${library})
endfunction()
