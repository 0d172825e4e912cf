# Installs the Python package with pip, on the installed library and without a package index, and uses it.

include("${SETTINGS}")
set(target "${work_dir}/python")
file(REMOVE_RECURSE "${target}" "${work_dir}/python_source")
file(COPY "${source_dir}/python" "${source_dir}/cmake" DESTINATION "${work_dir}/python_source"
  PATTERN build EXCLUDE PATTERN "*.egg-info" EXCLUDE PATTERN __pycache__ EXCLUDE)
run("${CMAKE_COMMAND}" -E env "SFDAE_PREFIX=${prefix}" "PIP_DISABLE_PIP_VERSION_CHECK=1" "PYTHONPATH="
  "${PYTHON}" -m pip install --no-build-isolation --no-index --no-deps --quiet --root-user-action=ignore
  --target "${target}" "${work_dir}/python_source/python")
file(WRITE "${work_dir}/python_program.py" "
import pathlib, sfdae
assert pathlib.Path(sfdae.__file__).is_relative_to(pathlib.Path('${target}')), sfdae.__file__
sol = sfdae.solve(lambda t, x, xdot, k=1.0: [xdot[0] - x[1], xdot[1] + k * x[0]], (0, 1), [1, 0])
assert sol.success and abs(sol.x[0, -1] - 0.5403023) < 1e-4, sol
")
run("${CMAKE_COMMAND}" -E env "PYTHONPATH=${target}" "${PYTHON}" "${work_dir}/python_program.py")
