# SPDX-License-Identifier: BSD-3-Clause
"""Instances of an ensemble, solved by one call of the library."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from ._binding import ffi, lib
from ._callbacks import callback
from ._solver import Solver
from ._status import Status
from ._structs import prepared

_MESSAGE_LENGTH = 1536  # always sufficient according to ensemble.h


class Task(NamedTuple):
    """The part of an ensemble that all of its instances share.

    Attributes
    ----------
    t0 : float
    times : numpy.ndarray
        K output times.
    labels : list of str
        P names of single parameters that differ.
    xdot : bool
        True: derivatives are returned, too.
    """

    t0: float
    times: np.ndarray
    labels: Sequence[str]
    xdot: bool


class Outcome(NamedTuple):
    """Results of N instances.

    Attributes
    ----------
    x : numpy.ndarray
        N x K x n.
    xdot : numpy.ndarray or None
        The same, if wanted.
    statuses : numpy.ndarray
        N.
    messages : list of str
        N.
    num_analyses : int
        Complete index analyses.
    summary : str
        The message about all instances; "" if all of them have ended without a failure.
    """

    x: np.ndarray
    xdot: np.ndarray | None
    statuses: np.ndarray
    messages: list[str]
    num_analyses: int
    summary: str


def empty_outcome(task: Task, count: int, num_unknowns: int) -> Outcome:
    """An outcome without any result: no instance has been started."""
    shape = (count, task.times.size, num_unknowns)
    return Outcome(
        np.full(shape, np.nan),
        np.full(shape, np.nan) if task.xdot else None,
        np.full(count, Status.STOPPED, dtype=np.intc),
        [""] * count,
        0,
        "",
    )


class _MonitorState:
    """The `user` argument of the monitor of an ensemble."""

    def __init__(self, monitor: Callable[[int], Any] | None) -> None:
        self.monitor = monitor
        self.exception: BaseException | None = None


@callback("python_ensemble_monitor")
def _instance_ended(state: _MonitorState, progress: Any) -> int:
    return 1 if state.monitor is not None and state.monitor(progress.num_ended) else 0


def solve_instances(
    solver: Solver,
    task: Task,
    start: np.ndarray,
    columns: np.ndarray,
    threads: int,
    monitor: Callable[[int], Any] | None = None,
) -> Outcome:
    """Solves instances of the problem of a solver in threads.

    Parameters
    ----------
    start : numpy.ndarray
        N x n start values.
    columns : numpy.ndarray
        N x P parameters.
    monitor : callable, optional
        Called with the number of instances that have ended; a true result stops.
    """
    problem = solver.problem
    count = len(start)
    empty = empty_outcome(task, count, problem.num_unknowns)
    texts = ffi.new("char[]", max(count, 1) * _MESSAGE_LENGTH)
    state = _MonitorState(monitor)
    labels = [ffi.new("char[]", label.encode()) for label in task.labels]
    keep = [ffi.new_handle(state), ffi.new("char*[]", labels)]
    c, results = prepared("ensemble"), prepared("ensemble_results")
    c.num_instances, c.num_times, c.num_threads, c.t0 = count, task.times.size, threads, task.t0
    start, columns = np.ascontiguousarray(start), np.ascontiguousarray(columns)
    c.x0, c.times = solver._pointer(start), solver._pointer(task.times)
    c.monitor, c.monitor_user = lib.python_ensemble_monitor, keep[0]
    if labels:
        c.num_parameters, c.parameter_names = len(labels), keep[1]
        c.parameters = solver._pointer(columns)
    results.x = solver._pointer(empty.x)
    results.statuses = ffi.cast("int*", empty.statuses.ctypes.data)
    results.messages, results.message_length = texts, _MESSAGE_LENGTH
    if empty.xdot is not None:
        results.xdot = solver._pointer(empty.xdot)
    status = solver._call(lib.sfdae_solve_ensemble, c, results)
    summary = ""
    if status != Status.OK:
        summary = solver.message or "the ensemble was stopped"
    if state.exception is not None and not isinstance(state.exception, KeyboardInterrupt):
        raise state.exception
    messages = [
        problem.with_names(ffi.string(texts + i * _MESSAGE_LENGTH).decode(errors="replace"))
        for i in range(count)
    ]
    return empty._replace(messages=messages, num_analyses=results.num_analyses, summary=summary)
