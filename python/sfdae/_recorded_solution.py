# SPDX-License-Identifier: BSD-3-Clause
"""The solution over a whole run as the C library records it."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._binding import ffi, lib
from ._status import Error, Status


def _checked(status: int, what: str) -> None:
    if status < 0:
        raise Error(Status(status), what)


class RecordedSolution:
    """The solution over a whole run of a Solver, see Solver.record: polynomials for all steps, to
    be evaluated anywhere, saved and loaded. (The solution that sfdae.solve returns has a dense
    output of its own, ``sol(t)``, which is more accurate than the tolerances ask for.)
    """

    def __init__(self) -> None:
        box = ffi.new("sfdae_solution**")
        _checked(lib.sfdae_create_solution(box), "out of memory")
        self._box = ffi.gc(box, lib.sfdae_destroy_solution)

    def _range(self) -> tuple[int, float, float]:
        n, ends = ffi.new("int*"), ffi.new("double[2]")
        status = lib.sfdae_get_solution_range(self._box[0], n, ends, ends + 1)
        _checked(status, "nothing was recorded")
        return n[0], ends[0], ends[1]

    @property
    def start(self) -> float:
        """Where the recording began."""
        return self._range()[1]

    @property
    def end(self) -> float:
        """The end of the last step."""
        return self._range()[2]

    def _evaluate(self, t: Any, part: int) -> np.ndarray:
        n, start, end = self._range()
        times = np.array(t, dtype=float)
        if times.ndim > 1:
            raise ValueError(f"t has shape {times.shape}: it has to be a number or a vector")
        values = np.empty((times.size, 2, n))
        for at, both in zip(np.atleast_1d(times), values):
            x, xdot = (ffi.cast("double*", row.ctypes.data) for row in both)
            if lib.sfdae_evaluate_solution(self._box[0], at, x, xdot) < 0:
                raise ValueError(f"t = {at} is outside of what was recorded, {start} to {end}")
        return values[0, part] if times.ndim == 0 else values[:, part].T

    def __call__(self, t: Any) -> np.ndarray:
        """x at a time, shape (n,), or at N times, shape (n, N)."""
        return self._evaluate(t, 0)

    def derivative(self, t: Any) -> np.ndarray:
        """x' at a time, shape (n,), or at N times, shape (n, N)."""
        return self._evaluate(t, 1)

    def save(self) -> np.ndarray:
        """All of it as numbers, for ``np.save`` and the like."""
        length = ffi.new("size_t*")
        _checked(lib.sfdae_get_solution_length(self._box[0], length), "out of memory")
        values = np.empty(length[0])
        pointer = ffi.cast("double*", values.ctypes.data)
        _checked(lib.sfdae_save_solution(self._box[0], pointer, length[0]), "out of memory")
        return values

    @classmethod
    def load(cls, values: Any) -> RecordedSolution:
        """What was saved.

        Raises
        ------
        Error
            If the numbers are damaged or something else.
        """
        array = np.ascontiguousarray(values, dtype=float).ravel()
        solution = cls()
        pointer = ffi.cast("double*", array.ctypes.data)
        status = lib.sfdae_load_solution(solution._box[0], pointer, array.size)
        _checked(status, "this is not a solution, or it is damaged")
        return solution
