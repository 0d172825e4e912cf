# Installs to one place, moves the tree to another, and looks for traces of the first.

include("${SETTINGS}")
file(REMOVE_RECURSE "${work_dir}/original" "${prefix}")
run("${CMAKE_COMMAND}" --install "${build_dir}" --prefix "${work_dir}/original" --config "${CONFIG}")
file(RENAME "${work_dir}/original" "${prefix}")

file(GLOB_RECURSE text_files "${prefix}/*.cmake" "${prefix}/*.pc" "${prefix}/*.h" "${prefix}/*.hpp"
  "${prefix}/*.f90" "${prefix}/*.txt")
if(NOT text_files)
  message(FATAL_ERROR "nothing installed in ${prefix}")
endif()
foreach(file IN LISTS text_files)
  file(READ "${file}" text)
  foreach(path IN ITEMS "${source_dir}" "${build_dir}" "${work_dir}/original")
    string(FIND "${text}" "${path}" position)
    if(NOT position EQUAL -1)
      message(SEND_ERROR "${file} mentions ${path}")
    endif()
  endforeach()
endforeach()
