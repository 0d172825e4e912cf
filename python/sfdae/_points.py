# SPDX-License-Identifier: BSD-3-Clause
"""Points of a solution, and arguments of monitors."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple

import numpy as np

from ._binding import ffi
from ._status import Status


class Point(NamedTuple):
    """A point of the solution.

    Attributes
    ----------
    t : float
    x, xdot : numpy.ndarray
        n values and their derivatives.
    status : Status
        ``OK``, or a warning of the call that returned the point.
    message : str
        Message of the call.
    """

    t: float
    x: np.ndarray
    xdot: np.ndarray
    status: Status
    message: str


class Progress(NamedTuple):
    """The argument of a monitor, after every accepted step: t, signed step size, order, number of
    steps, x (n values).
    """

    t: float
    step: float
    order: int
    steps: int
    x: np.ndarray


def wrapped(monitor: Callable[[Progress], Any]) -> Callable[[Any], Any]:
    """A function of sfdae_progress that calls the user's monitor."""

    def call(progress: Any) -> Any:
        x = np.frombuffer(ffi.buffer(progress.x, 8 * progress.num_unknowns)[:])
        return monitor(Progress(progress.t, progress.step, progress.order, progress.steps, x))

    return call
