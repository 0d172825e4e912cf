# SPDX-License-Identifier: BSD-3-Clause
"""The solution over a whole run as the C library records it."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np

from ._binding import ffi, lib
from ._status import Error, Status


def _checked(status: int, what: str) -> None:
    if status < 0:
        raise Error(Status(status), what)


class RecordedSolution:
    """The solution over a whole run, at any time: evaluated by ``sol(t)`` of sfdae.solve, or
    recorded by Solver.record. Polynomials for all steps, which can be saved and loaded.

    They agree to a third of the tolerances with the integrator's interpolation, whose own error is
    up to half a tolerance, if the solution has no jumps and kinks within steps.
    """

    def __init__(self) -> None:
        box = ffi.new("sfdae_solution**")
        _checked(lib.sfdae_create_solution(box), "out of memory")
        self._box = ffi.gc(box, lib.sfdae_destroy_solution)

    def __reduce__(self) -> tuple[Callable[..., RecordedSolution], tuple[np.ndarray]]:
        return RecordedSolution.load, (self.save(),)

    def _range(self) -> tuple[int, float, float]:
        n, ends = ffi.new("int*"), ffi.new("double[2]")
        status = lib.sfdae_get_solution_range(self._box[0], n, ends, ends + 1)
        _checked(status, "nothing was recorded")
        return n[0], ends[0], ends[1]

    def _accuracy(self) -> tuple[float, float]:
        values = ffi.new("double[2]")
        status = lib.sfdae_get_solution_accuracy(self._box[0], values, values + 1)
        _checked(status, "nothing was recorded")
        return values[0], values[1]

    @property
    def is_empty(self) -> bool:
        """True if nothing was recorded."""
        null = ffi.NULL
        return lib.sfdae_get_solution_range(self._box[0], null, null, null) < 0

    @property
    def start(self) -> float:
        """The start of the recording."""
        return self._range()[1]

    @property
    def end(self) -> float:
        """The end of the last step, or of the part that was not cut."""
        return self._range()[2]

    @property
    def t_min(self) -> float:
        """The earliest time."""
        return min(self._range()[1:])

    @property
    def t_max(self) -> float:
        """The latest time."""
        return max(self._range()[1:])

    @property
    def accuracy(self) -> float:
        """The largest expected difference to the integrator's own values, in units of rtol |x| +
        atol. Large if the solution has jumps or kinks within a step.
        """
        return self._accuracy()[0]

    @property
    def worst_t(self) -> float:
        """The beginning of the part of a step with the largest difference."""
        return self._accuracy()[1]

    def cut(self, t: float) -> None:
        """Discards the recording after t.

        Raises
        ------
        ValueError
            For a time outside the recording.
        """
        n, start, end = self._range()
        if lib.sfdae_cut_solution(self._box[0], t) < 0:
            raise ValueError(f"t = {t} is outside of what was recorded, {start} to {end}")

    def _evaluate(self, t: Any, part: int) -> np.ndarray:
        n, start, end = self._range()
        times = np.array(t, dtype=float)
        if times.ndim > 1:
            raise ValueError(f"t has shape {times.shape}: it has to be a number or a vector")
        first, last = min(start, end), max(start, end)
        flat = np.clip(times.reshape(-1), first, last)  # NaN stays
        slack = 4 * np.finfo(float).eps * max(abs(first), abs(last))
        outside = ~(np.abs(flat - times.reshape(-1)) <= slack)
        if outside.any():
            raise ValueError(
                f"t = {times.reshape(-1)[outside][0]} is outside of [{first}, {last}], where the "
                "solution is known"
            )
        values = np.empty((2, flat.size, n))
        c_times, x, xdot = (ffi.cast("double*", array.ctypes.data) for array in (flat, *values))
        status = lib.python_evaluate_solution(
            self._box[0], c_times, flat.size, x, xdot if part == 1 else ffi.NULL, n
        )
        _checked(status, "the solution cannot be evaluated")
        return values[part, 0].copy() if times.ndim == 0 else values[part].T.copy()

    def __call__(self, t: Any) -> np.ndarray:
        """x at a time, shape (n,), or at N times in any order, shape (n, N). At a restart, for
        example by the action of an event, these are the values after it.

        Raises
        ------
        ValueError
            For times that were not reached.
        Error
            If nothing was recorded.
        """
        return self._evaluate(t, 0)

    def derivative(self, t: Any) -> np.ndarray:
        """x' at a time, shape (n,), or at N times, shape (n, N): the slope of the polynomials; its
        error is about that of x over the step size.
        """
        return self._evaluate(t, 1)

    def save(self) -> np.ndarray:
        """The solution as an array of numbers, for ``np.save`` and similar functions."""
        length = ffi.new("size_t*")
        _checked(lib.sfdae_get_solution_length(self._box[0], length), "out of memory")
        values = np.empty(length[0])
        pointer = ffi.cast("double*", values.ctypes.data)
        _checked(lib.sfdae_save_solution(self._box[0], pointer, length[0]), "out of memory")
        return values

    @classmethod
    def load(cls, values: Any) -> RecordedSolution:
        """Restores a saved solution.

        Raises
        ------
        Error
            If the numbers are damaged or not a solution.
        """
        array = np.ascontiguousarray(values, dtype=float).ravel()
        solution = cls()
        pointer = ffi.cast("double*", array.ctypes.data)
        status = lib.sfdae_load_solution(solution._box[0], pointer, array.size)
        _checked(status, "this is not a solution, or it is damaged")
        return solution
