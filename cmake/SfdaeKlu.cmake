# Finds KLU of SuiteSparse (target KLU::KLU) as SFDAE_WITH_KLU says: AUTO, ON or OFF.

if(SFDAE_WITH_KLU STREQUAL "AUTO")
  find_package(KLU QUIET)
  if(KLU_FOUND)
    message(STATUS "KLU: ${KLU_LIBRARY}")
  else()
    message(STATUS "KLU was not found: sparse matrices by LAPACK alone (Debian, Ubuntu: apt install libsuitesparse-dev)")
  endif()
elseif(SFDAE_WITH_KLU)
  find_package(KLU REQUIRED)
endif()

# What the package config asks.
if(TARGET KLU::KLU)
  set(sfdae_uses_klu ON)
else()
  set(sfdae_uses_klu OFF)
endif()
