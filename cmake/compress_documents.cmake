# Run by cpack on what is about to be packed.
file(GLOB_RECURSE documents "${CPACK_TEMPORARY_DIRECTORY}/*")
list(FILTER documents INCLUDE REGEX "/man/man[1-9]/[^/]*[1-9]$|/changelog\\.Debian$")
foreach(document IN LISTS documents)
  execute_process(COMMAND gzip --best --no-name "${document}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
