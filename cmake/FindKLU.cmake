# KLU of SuiteSparse (LGPL): target KLU::KLU, and KLU_LIBRARY, KLU_INCLUDE_DIR. A shared library brings along what it needs,
# a static one is followed by that. Installed with sfdae, whose static library is linked with it.

find_path(KLU_INCLUDE_DIR klu.h PATH_SUFFIXES suitesparse)
find_library(KLU_LIBRARY klu)
mark_as_advanced(KLU_INCLUDE_DIR KLU_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(KLU REQUIRED_VARS KLU_LIBRARY KLU_INCLUDE_DIR)

if(KLU_FOUND AND NOT TARGET KLU::KLU)
  add_library(KLU::KLU UNKNOWN IMPORTED)
  set_target_properties(KLU::KLU PROPERTIES IMPORTED_LOCATION "${KLU_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${KLU_INCLUDE_DIR}")
  set(KLU_DEPENDENCIES "")
  if(KLU_LIBRARY MATCHES "\\.a$")
    get_filename_component(_klu_dir "${KLU_LIBRARY}" DIRECTORY)
    foreach(_klu_name IN ITEMS amd colamd btf suitesparseconfig)
      find_library(KLU_${_klu_name}_LIBRARY NAMES "lib${_klu_name}.a" ${_klu_name} HINTS "${_klu_dir}")
      mark_as_advanced(KLU_${_klu_name}_LIBRARY)
      list(APPEND KLU_DEPENDENCIES "${KLU_${_klu_name}_LIBRARY}")
    endforeach()
    unset(_klu_dir)
    list(APPEND KLU_DEPENDENCIES m)
    set_target_properties(KLU::KLU PROPERTIES INTERFACE_LINK_LIBRARIES "${KLU_DEPENDENCIES}")
  endif()
endif()
