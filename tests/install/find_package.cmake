# Configures, builds and runs consumer/ with the installed CMake package.

include("${SETTINGS}")
configure("${test_dir}/consumer" "${work_dir}/${NAME}" "-DCMAKE_PREFIX_PATH=${prefix}"
  -DCONSUMER_LANGUAGE=${LANGUAGE} -DCONSUMER_VARIANT=${VARIANT} "-DCONSUMER_ONLY_LANGUAGE=${ONLY_LANGUAGE}")
run("${CMAKE_COMMAND}" --build "${work_dir}/${NAME}" --config Debug)
run("${CMAKE_COMMAND}" --build "${work_dir}/${NAME}" --config Debug --target run)
