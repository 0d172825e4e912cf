# SPDX-License-Identifier: BSD-3-Clause
"""The work for an ensemble as workers receive it, and their answers."""

from __future__ import annotations

import pickle
import threading
import time
import traceback
import uuid
from typing import Any, Mapping, NamedTuple, cast

import numpy as np

from ._instances import Outcome, Task, solve_instances
from ._pickling import dumps
from ._problem import Problem
from ._solver import Solver
from ._status import version

# The job and the solver that a thread of a worker used last.
_kept = threading.local()


class Job:
    """The data that all chunks of an ensemble share. The first chunk pickles them; threads of this
    process use the same object.

    Parameters
    ----------
    problem : Problem
    parameters : mapping
        Values that are the same for all instances.
    options : mapping
        Options of the solver.
    task : Task
    threads : int
        For each chunk.
    """

    def __init__(
        self,
        problem: Problem,
        parameters: Mapping[str, Any],
        options: Mapping[str, Any],
        task: Task,
        threads: int,
    ) -> None:
        self._parts: Any = problem, dict(parameters), dict(options), task, threads
        self._bytes: bytes | None = None
        self._version = version()
        self.key = uuid.uuid4().hex
        self.is_stopped = False  # seen by the threads of this process

    def to_bytes(self) -> bytes:
        """The pickled job, made at the first call. TypeError if it cannot be pickled."""
        if self._bytes is None:
            self._bytes = dumps(self._parts)
        return self._bytes

    def __getstate__(self) -> tuple[str, str, bytes]:
        return self.key, self._version, self.to_bytes()

    def __setstate__(self, state: tuple[str, str, bytes]) -> None:
        self.key, self._version, self._bytes = state
        self._parts = None
        self.is_stopped = False

    def parts(self) -> tuple[Solver, Task, int]:
        """The solver of this thread, the task and the number of threads. RuntimeError if the job
        was made by another version of the library, which might give other results.
        """
        if self._version != version():
            raise RuntimeError(
                f"a worker has sfdae {version()}, but the program that sends the ensemble has "
                f"{self._version}: install the same version on all machines"
            )
        if getattr(_kept, "key", None) != self.key:
            parts = self._parts
            if parts is None:
                parts = pickle.loads(cast(bytes, self._bytes))
            problem, parameters, options, task, threads = parts
            solver = Solver(problem, parameters=parameters, **options)
            _kept.key, _kept.parts = self.key, (solver, task, threads)
        return cast("tuple[Solver, Task, int]", _kept.parts)


class Answer(NamedTuple):
    """The answer of a worker to a chunk: an outcome and the seconds that it took, or an exception
    and its traceback as text, which pickling would drop.
    """

    outcome: Outcome | None
    seconds: float
    exception: Exception | None = None
    text: str = ""


class RemoteTraceback(Exception):
    """The traceback of an exception in another process; the cause of that exception."""

    def __str__(self) -> str:
        return f'\n"""\n{self.args[0]}"""'


def solve_chunk(
    job: Job, start: np.ndarray, columns: np.ndarray, attempt: tuple[int, int]
) -> Answer:
    """Solves a chunk in a worker. attempt: the first instance and the number of earlier attempts,
    which make all calls different for executors that keep results.
    """
    begin = time.perf_counter()
    try:
        solver, task, threads = job.parts()
        outcome = solve_instances(
            solver, task, start, columns, threads, lambda num_ended: job.is_stopped
        )
        return Answer(outcome, time.perf_counter() - begin)
    except Exception as exception:
        frames = exception.__traceback__
        text = "".join(traceback.format_exception(type(exception), exception, frames))
        return Answer(None, 0.0, _portable(exception, text), text)


def _portable(exception: Exception, text: str) -> Exception:
    """The exception if it can be pickled, else another one with its text."""
    try:
        pickle.loads(pickle.dumps(exception))
    except Exception:
        return RuntimeError(f"{type(exception).__name__} in a worker: {exception}")
    return exception
