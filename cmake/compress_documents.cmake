# Run by cpack on what is about to be packed.
file(GLOB_RECURSE documents "${CPACK_TEMPORARY_DIRECTORY}/*/man/man*/*.[1-9]"
  "${CPACK_TEMPORARY_DIRECTORY}/*/share/doc/*/changelog.Debian")
foreach(document IN LISTS documents)
  execute_process(COMMAND gzip --best --no-name "${document}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
