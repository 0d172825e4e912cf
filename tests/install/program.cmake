# The installed program finds the library beside it, and its models are there.

include("${SETTINGS}")
set(ENV{LD_LIBRARY_PATH} "")
set(page "${work_dir}/${NAME}.html")
file(REMOVE "${page}")
run("${prefix}/${BINDIR}/sfdae" solve "${prefix}/${DATADIR}/sfdae/models/crane.mo" --html "${page}")
foreach(file IN ITEMS "${page}" "${prefix}/${MANDIR}/man1/sfdae.1")
  if(NOT EXISTS "${file}")
    message(SEND_ERROR "${file} is missing")
  endif()
endforeach()
