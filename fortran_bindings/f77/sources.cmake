# The Fortran 77 layer: entries of the shared library, written in C++.
#
# Every routine R is exported as r_ (INTEGER of 32 bits) and as r_64_ (64 bits); r_64__ is the latter as compilers name it
# that append a second underscore to names with one (gfortran -fsecond-underscore).

set(sfdae_f77_routines dgelda sfndae sfndaf sfmdae dgeerm dgenrm dnfpen dnfval dnfind dnfotr dnfred dnfix1 dnfini dgeini)

set(sfdae_f77_sources
  call_options.cpp
  call_outputs.cpp
  call_state.cpp
  derivative_arrays.cpp
  derivative_stages.cpp
  dgelda.cpp
  dgelda_call.cpp
  dgelda_problem.cpp
  initial_values.cpp
  integration_call.cpp
  messages.cpp
  norm.cpp
  orthogonal_factors.cpp
  reduced_system.cpp
  reduced_systems.cpp
  sfmdae.cpp
  sfmdae_call.cpp
  sfmdae_problem.cpp
  sfndae.cpp
  sfndae_call.cpp
  sfndae_problem.cpp
  sfndaf.cpp
  sfndaf_problem.cpp)
list(TRANSFORM sfdae_f77_sources PREPEND "${PROJECT_SOURCE_DIR}/fortran_bindings/f77/")
