#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What Python costs: the pendulum by recorded equations with 500 outputs, in Python and in C.

    PYTHONPATH=<build>/python python3 python/benchmarks/overhead.py --library <build>/src

Compiles the program in C beside it, runs both in turn, and prints the ratio of the fastest runs:
creation, start, integration and outputs in processor time, without starting the interpreter."""

import argparse
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np

import sfdae

HERE = pathlib.Path(__file__).resolve().parent
OUTPUTS, END = 500, 10.0


def pendulum(t, x, xdot, g=9.81):
    px, py, u, v, force = x
    return [
        xdot[0] - u,
        xdot[1] - v,
        xdot[2] + 2 * px * force,
        xdot[3] + 2 * py * force + g,
        px**2 + py**2 - 1,
    ]


def in_python(method: str, tolerance: float, dense_output: bool) -> tuple[float, np.ndarray]:
    """Processor seconds of a whole solve, and x at the end."""
    times = np.linspace(0, END, OUTPUTS + 1)[1:]
    start = time.process_time()
    sol = sfdae.solve(
        pendulum,
        (0, END),
        [0.6, -0.8, 0, 0, 0],
        t_eval=times,
        method=method,
        rtol=tolerance,
        atol=tolerance,
        dense_output=dense_output,
    )
    return time.process_time() - start, sol.x[:, -1]


def in_c(program: pathlib.Path, method: str, tolerance: float) -> tuple[float, np.ndarray]:
    """Processor seconds of a whole solve as the program measures them, and x at the end."""
    number = sfdae.choices("method")[method]
    arguments = [str(program), str(number), repr(tolerance), str(OUTPUTS), repr(END)]
    words = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout.split()
    return float(words[0]), np.array(words[1:], dtype=float)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--library", required=True, help="directory of libsfdae.so")
    parser.add_argument("--runs", type=int, default=30)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        program = pathlib.Path(directory) / "pendulum"
        library = pathlib.Path(arguments.library).resolve()
        include = HERE.parent.parent / "include"
        command = ["cc", "-O2", f"-I{include}", HERE / "pendulum.c", "-o", program, f"-L{library}"]
        subprocess.run([*command, "-lsfdae", f"-Wl,-rpath,{library}"], check=True)
        print(f"{'method':10} {'tol':>6} {'C ms':>8} {'Python':>8} {'ratio':>6} {'dense':>6}")
        for method in ("bdf", "radau"):
            for tolerance in (1e-6, 1e-9):
                runs = []
                for _ in range(arguments.runs):  # in turn: the machine is the same for all
                    c, x = in_c(program, method, tolerance)
                    python, y = in_python(method, tolerance, False)
                    dense, _ = in_python(method, tolerance, True)
                    runs.append((c, python, dense))
                    assert np.abs(x - y).max() < 1e3 * tolerance
                c, python, dense = (min(column) for column in zip(*runs))
                median = statistics.median(run[1] / run[0] for run in runs)
                print(
                    f"{method:10} {tolerance:6.0e} {1e3 * c:8.2f} {1e3 * python:8.2f} "
                    f"{python / c:6.2f} {dense / c:6.2f}   (median {median:.2f})"
                )


if __name__ == "__main__":
    main()
