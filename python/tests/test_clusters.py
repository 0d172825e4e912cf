# SPDX-License-Identifier: BSD-3-Clause
"""Ensembles on Dask and MPI: the same bits as in threads, also if a worker is killed."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time

import pytest

from ensembles import pendula, require_equal

MPI_PROGRAM = """
import sys
import numpy as np
import sfdae
from mpi4py.futures import MPIPoolExecutor

scale = 2.0
if __name__ == "__main__":
    with MPIPoolExecutor() as executor:
        rates = np.linspace(0.5, 2, 50)
        problem = lambda t, x, xdot, k=1.0: [xdot[0] - x[1], xdot[1] + k * scale * x[0]]
        given = dict(parameters={"k": rates}, t_eval=[0.5, 1.0], xdot=True)
        results = [
            sfdae.solve_ensemble(problem, (0, 1), [1, 0], **given, **more)
            for more in ({}, {"executor": executor}, {"executor": executor, "chunk": 7})
        ]
        same = [np.array_equal(results[0].x, other.x) for other in results]
        same += [np.array_equal(results[0].xdot, other.xdot) for other in results]
        print(executor._max_workers, "workers, equal:", all(same))
"""


@pytest.mark.filterwarnings("default")
def test_dask_with_a_worker_that_is_killed():
    distributed = pytest.importorskip("distributed")
    layout = dict(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=60)
    expected = pendula(threads=1)
    with distributed.LocalCluster(**layout) as cluster, distributed.Client(cluster) as client:
        executor = client.get_executor()
        with pytest.raises(TypeError, match=r"give client.get_executor\(\)"):
            pendula(executor=client)
        require_equal(expected, pendula(executor=executor))
        process = next(iter(client.run(os.getpid).values()))

        def kill_when_working():
            while not any(client.processing().values()):
                time.sleep(0.005)
            os.kill(process, signal.SIGKILL)

        killer = threading.Thread(target=kill_when_working)
        killer.start()
        result = pendula(executor=executor, chunk=1)
        killer.join()
        require_equal(expected, result)
        assert process not in client.run(os.getpid).values()  # another one has replaced it


def test_mpi(tmp_path):
    pytest.importorskip("mpi4py")
    mpiexec = shutil.which("mpiexec")
    if mpiexec is None:
        pytest.skip("no mpiexec")
    version = subprocess.run([mpiexec, "--version"], capture_output=True, text=True).stdout
    if "OpenRTE" not in version and "Open MPI" not in version:
        pytest.skip("no mpiexec of Open MPI")
    program = tmp_path / "program.py"
    program.write_text(MPI_PROGRAM)
    command = [mpiexec, "--oversubscribe", "--allow-run-as-root", "-n", "3"]
    command += [sys.executable, "-m", "mpi4py.futures", str(program)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert result.stdout.strip() == "2 workers, equal: True", result.stderr
