# Compiles the Fortran module from its source: .mod files are specific to a compiler, so every build tree makes its
# own. Included by the project itself and, installed, by the package config.

# Adds the static library sfdae_fortran (alias sfdae::fortran), which brings the module `sfdae` and `library`. source:
# sfdae.f90; the modules that it uses lie beside it.
function(sfdae_add_fortran_module source library)
  get_filename_component(directory "${source}" DIRECTORY)
  set(module_directory "${CMAKE_CURRENT_BINARY_DIR}/sfdae_fortran_modules")
  add_library(sfdae_fortran STATIC EXCLUDE_FROM_ALL "${directory}/sfdae_expressions.f90" "${source}")
  add_library(sfdae::fortran ALIAS sfdae_fortran)
  set_target_properties(sfdae_fortran PROPERTIES
    Fortran_MODULE_DIRECTORY "${module_directory}"
    POSITION_INDEPENDENT_CODE ON)
  target_include_directories(sfdae_fortran INTERFACE "${module_directory}")
  target_link_libraries(sfdae_fortran PUBLIC ${library})
endfunction()
