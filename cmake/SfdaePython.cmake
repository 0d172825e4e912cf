# sfdae_find_python(<variable>): an interpreter with the modules that the Python package needs, or an empty string. The
# first python3 of the path need not have them: those of the system are tried, too. SFDAE_PYTHON_EXECUTABLE decides, and
# need not have numpy: pip builds where there is nothing but what python/pyproject.toml requires for that.

function(sfdae_find_python variable)
  set(${variable} "" PARENT_SCOPE)
  set(modules "cffi, numpy")
  if(SFDAE_PYTHON_EXECUTABLE)
    set(candidates "${SFDAE_PYTHON_EXECUTABLE}")
    set(modules "cffi")
  else()
    find_program(sfdae_python_in_path NAMES python3 python)
    mark_as_advanced(sfdae_python_in_path)
    set(candidates ${sfdae_python_in_path} /usr/bin/python3 /usr/local/bin/python3)
  endif()
  set(test "import ${modules}, sys, sysconfig, os
assert sys.version_info >= (3, 9)
print(sysconfig.get_path('include'), end='')
assert os.path.exists(os.path.join(sysconfig.get_path('include'), 'Python.h'))")
  foreach(candidate IN LISTS candidates)
    execute_process(COMMAND "${candidate}" -c "${test}"
      RESULT_VARIABLE result OUTPUT_VARIABLE include_dir ERROR_VARIABLE complaint)
    if(result EQUAL 0)
      set(${variable} "${candidate}" PARENT_SCOPE)
      set(${variable}_INCLUDE_DIR "${include_dir}" PARENT_SCOPE)
      return()
    endif()
    string(REGEX REPLACE ".*\n([^\n]+)\n?$" "\\1" complaint "${complaint}")
    message(STATUS "Python package: ${candidate} cannot be used (${complaint})")
  endforeach()
endfunction()

# sfdae_python_has(<variable> <interpreter> <module>...): whether it has these modules.
function(sfdae_python_has variable interpreter)
  list(JOIN ARGN ", " modules)
  execute_process(COMMAND "${interpreter}" -c "import ${modules}"
    RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
  if(result EQUAL 0)
    set(${variable} TRUE PARENT_SCOPE)
  else()
    set(${variable} FALSE PARENT_SCOPE)
  endif()
endfunction()
