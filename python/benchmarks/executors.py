# SPDX-License-Identifier: BSD-3-Clause
"""Speed of an ensemble of pendula by executors, compared with one thread of one process.

    python executors.py processes 2
    python executors.py dask 2
    mpiexec -n 3 python -m mpi4py.futures executors.py mpi

Prints elapsed seconds, seconds of the processor in all processes, and the load of the machine. Set
OPENBLAS_NUM_THREADS=1."""

from __future__ import annotations

import concurrent.futures
import contextlib
import os
import sys
import time
from typing import Any, Iterator

import numpy as np

import sfdae

COUNT = int(os.environ.get("COUNT", "10000"))
ANGLES = np.linspace(-1.2, 1.2, COUNT)
STARTS = np.stack([np.sin(ANGLES), -np.cos(ANGLES), *np.zeros((3, COUNT))], axis=1)


def pendulum(t: Any, x: Any, xdot: Any, g: float = 9.81) -> list[Any]:
    p, q, u, v, s = x
    balance = [xdot[2] + 2 * p * s, xdot[3] + 2 * q * s + g]
    return [xdot[0] - u, xdot[1] - v, *balance, p**2 + q**2 - 1]


def cpu_seconds() -> float:
    return time.process_time()


@contextlib.contextmanager
def executor_of(kind: str, workers: int) -> Iterator[tuple[Any, Any]]:
    """An executor, and a function that returns the seconds of the processor in its workers."""
    if kind == "dask":
        from distributed import Client, LocalCluster

        layout = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
        with LocalCluster(**layout) as cluster, Client(cluster) as client:
            yield client.get_executor(), lambda: sum(client.run(cpu_seconds).values())
    elif kind == "mpi":
        from mpi4py.futures import MPIPoolExecutor

        with MPIPoolExecutor() as mpi:
            yield mpi, lambda: float("nan")
    else:
        with concurrent.futures.ProcessPoolExecutor(workers) as pool:
            yield pool, lambda: float("nan")


def measured(**more: Any) -> tuple[Any, float, float]:
    begin, cpu = time.perf_counter(), time.process_time()
    result = sfdae.solve_ensemble(pendulum, (0, 1), STARTS, **more)
    return result, time.perf_counter() - begin, time.process_time() - cpu


def main() -> None:
    kind, workers = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 2
    one, alone, cpu = measured(threads=1)
    print(f"one thread: {alone:.2f} s, processor {cpu:.2f} s, load {os.getloadavg()[0]:.1f}")
    with executor_of(kind, workers) as (executor, seconds):
        sfdae.solve_ensemble(pendulum, (0, 1), STARTS[:100], executor=executor)  # starts them
        for _ in range(int(os.environ.get("REPEAT", "2"))):
            before = seconds()
            result, elapsed, own = measured(executor=executor)
            cpu_workers = seconds() - before
            print(
                f"{kind}: {elapsed:.2f} s, speedup {alone / elapsed:.2f}, processor of this process "
                f"{own:.2f} s, of workers {cpu_workers:.2f} s, load {os.getloadavg()[0]:.1f}, "
                f"same bits: {np.array_equal(one.x, result.x)}"
            )


if __name__ == "__main__":
    main()
