# HEADER defines no macros but SFDAE_..., beyond those of stddef.h.

function(macros_of header result)
  file(WRITE "${WORK_FILE}" "#include <${header}>\n")
  execute_process(COMMAND "${COMPILER}" -E -dM "-I${INCLUDE_DIR}" "${WORK_FILE}"
    OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "#define [A-Za-z_0-9]+" names "${text}")
  list(TRANSFORM names REPLACE "^#define " "")
  set(${result} "${names}" PARENT_SCOPE)
endfunction()

macros_of(stddef.h stddef)
macros_of("${HEADER}" sfdae)
list(LENGTH sfdae all)
list(REMOVE_ITEM sfdae ${stddef})
list(LENGTH sfdae own)
list(FILTER sfdae EXCLUDE REGEX "^SFDAE_")
if(sfdae)
  message(FATAL_ERROR "macros without the prefix SFDAE_: ${sfdae}")
endif()
if(own EQUAL 0)
  message(FATAL_ERROR "no macro found among ${all}")
endif()
