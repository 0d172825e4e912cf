# pkgconfig_libs_private: what a program needs besides libsfdae.a, in the order of the linker. Libraries in standard places
# are named by -l, so that the linker may take shared libraries or, with -static, archives alone: therefore also what the
# archives of KLU and LAPACK need, which shared libraries would find by themselves.
#
# sfdae_archives_link: whether programs can be linked with archives alone here.

include(CheckCSourceCompiles)

# KLU, and what its archive needs. (FindKLU.cmake has the latter if KLU was found as an archive.)
set(klu_libraries "")
if(sfdae_uses_klu)
  set(klu_libraries "${KLU_LIBRARY}" ${KLU_DEPENDENCIES})
  if(NOT KLU_DEPENDENCIES)
    get_filename_component(klu_dir "${KLU_LIBRARY}" DIRECTORY)
    foreach(name IN ITEMS btf colamd amd suitesparseconfig)
      find_library(SFDAE_${name}_LIBRARY NAMES ${name} HINTS "${klu_dir}")
      mark_as_advanced(SFDAE_${name}_LIBRARY)
      if(SFDAE_${name}_LIBRARY)
        list(APPEND klu_libraries "${SFDAE_${name}_LIBRARY}")
      endif()
    endforeach()
  endif()
endif()

# as_linked(<result> <library>...)
function(as_linked result)
  set(names "")
  foreach(library IN LISTS ARGN)
    get_filename_component(dir "${library}" DIRECTORY)
    get_filename_component(name "${library}" NAME_WE)
    if(dir IN_LIST CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES AND name MATCHES "^lib")
      string(REGEX REPLACE "^lib" "-l" library "${name}")
    elseif(library MATCHES "^[^-/]")
      string(PREPEND library "-l")
    endif()
    list(APPEND names "${library}")
  endforeach()
  set(${result} ${names} PARENT_SCOPE)
endfunction()

as_linked(klu_names ${klu_libraries})
as_linked(lapack_names ${LAPACK_LIBRARIES})

set(cxx_runtime ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
list(REMOVE_DUPLICATES cxx_runtime)
list(REMOVE_ITEM cxx_runtime ${CMAKE_C_IMPLICIT_LINK_LIBRARIES})
list(TRANSFORM cxx_runtime PREPEND "-l" REGEX "^[^-/]")

# Archives of LAPACK may need the Fortran runtime: the first of these with which a program links statically, if any does.
set(fortran_runtime "")
set(sfdae_archives_link OFF)
if(UNIX AND NOT APPLE AND CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
  set(number 0)
  foreach(runtime IN ITEMS "" "-lgfortran" "-lgfortran -lquadmath")
    math(EXPR number "${number} + 1")
    separate_arguments(runtime UNIX_COMMAND "${runtime}")
    set(CMAKE_REQUIRED_LIBRARIES -static ${lapack_names} ${runtime} -lm ${CMAKE_THREAD_LIBS_INIT})
    set(CMAKE_REQUIRED_QUIET ON)
    check_c_source_compiles("void dgesvd_(void); void dgeqp3_(void); void dgbsv_(void);
      int main(void) { dgesvd_(); dgeqp3_(); dgbsv_(); return 0; }" SFDAE_STATIC_LAPACK_${number})
    unset(CMAKE_REQUIRED_LIBRARIES)
    unset(CMAKE_REQUIRED_QUIET)
    if(SFDAE_STATIC_LAPACK_${number})
      set(fortran_runtime ${runtime})
      set(sfdae_archives_link ON)
      break()
    endif()
  endforeach()
endif()

set(pkgconfig_libs_private ${klu_names} ${lapack_names} ${fortran_runtime} ${cxx_runtime} ${CMAKE_THREAD_LIBS_INIT})
list(JOIN pkgconfig_libs_private " " pkgconfig_libs_private)

# Archives of KLU may be absent where the shared libraries are present.
if(sfdae_archives_link AND klu_names)
  set(CMAKE_REQUIRED_LIBRARIES -static ${klu_names} -lm)
  set(CMAKE_REQUIRED_QUIET ON)
  check_c_source_compiles("void klu_analyze(void); int main(void) { klu_analyze(); return 0; }" SFDAE_STATIC_KLU)
  unset(CMAKE_REQUIRED_LIBRARIES)
  unset(CMAKE_REQUIRED_QUIET)
  set(sfdae_archives_link ${SFDAE_STATIC_KLU})
endif()
