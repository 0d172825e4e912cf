# SPDX-License-Identifier: BSD-3-Clause
"""Ensembles in other processes and on other machines, by executors of concurrent.futures."""

from __future__ import annotations

import collections
import concurrent.futures
import math
import os
import time
from typing import Any, Callable, cast

import numpy as np

from ._instances import Outcome
from ._jobs import Answer, Job, RemoteTraceback, solve_chunk
from ._status import Status, status_name

_CHUNKS_PER_WORKER = 16  # at least, so that workers of different speed end at the same time
_SHORTEST_CHUNK = 0.02  # seconds of work; sending a chunk takes about a tenth of it
_SENT_PER_WORKER = 3  # chunks that are running or on their way
# Exceptions of other packages, by name, that mean that a worker was lost.
_LOST = ("KilledWorker", "CommClosedError", "FutureCancelledError", "TerminatedWorkerError")


class _Chunk:
    """Consecutive instances that are sent together."""

    def __init__(self, first: int, count: int) -> None:
        self.first, self.count = first, count
        self.attempts = 0  # that were lost

    @property
    def place(self) -> slice:
        return slice(self.first, self.first + self.count)


class Distribution:
    """An ensemble that is being solved by an executor.

    Parameters
    ----------
    executor : concurrent.futures.Executor
    job : Job
    start, columns : numpy.ndarray
        Start values (N x n) and parameters (N x P) of all instances.
    outcome : Outcome
        Receives the results.
    chunk : int or None
        Instances of a chunk; None: chosen by the time that chunks take.
    retries : int
        How often a chunk is sent again if its worker was lost.
    on_ended : callable or None
        Called with the number of instances that have ended.
    """

    def __init__(
        self,
        executor: concurrent.futures.Executor,
        job: Job,
        start: np.ndarray,
        columns: np.ndarray,
        outcome: Outcome,
        chunk: int | None,
        retries: int,
        on_ended: Callable[[int], Any] | None,
    ) -> None:
        self._executor = executor
        self._replacement: concurrent.futures.Executor | None = None
        self._job = job
        self._data = start, columns
        self._outcome = outcome
        self._chunk = chunk
        self._retries = retries
        self._on_ended = on_ended
        self._workers = 0
        self._next_count = 0.0  # when workers are counted again
        self._next = 0  # the first instance that has not been sent
        self._lost: collections.deque[_Chunk] = collections.deque()  # to be sent again
        self._sent: dict[concurrent.futures.Future[Answer], _Chunk] = {}
        self._num_solved = self._num_ended = self._num_analyses = 0
        self._seconds = 0.0  # of work for the instances that were solved

    def run(self) -> Outcome:
        """Sends all chunks and collects their results. Ctrl-C, and any exception, cancels what has
        not begun; Ctrl-C returns what was solved.
        """
        is_interrupted = False
        try:
            while self._send():
                done, _ = concurrent.futures.wait(
                    self._sent, return_when=concurrent.futures.FIRST_COMPLETED
                )
                for future in done:
                    self._receive(future)
        except KeyboardInterrupt:
            is_interrupted = True
            self._receive_finished()
            self._mark_unsolved("the user interrupted the ensemble before this instance was solved")
        finally:
            self._cancel()
        summary = self._summary(is_interrupted)
        return self._outcome._replace(num_analyses=self._num_analyses, summary=summary)

    # ---- Sending ---------------------------------------------------------------------------------

    def _send(self) -> bool:
        """Sends chunks as long as workers need some; returns whether any is on its way. Chunks that
        were lost go one at a time, so that the one which ends its worker takes no other along.
        """
        self._count_workers()
        limit = _SENT_PER_WORKER * self._workers
        while self._lost and not self._sent:
            self._submit(self._lost.popleft())
        while not self._has_suspects() and len(self._sent) < limit:
            rest = len(self._data[0]) - self._next
            if rest == 0:
                break
            chunk = _Chunk(self._next, min(self._size(), rest))
            self._next += chunk.count
            self._submit(chunk)
        return bool(self._sent)

    def _count_workers(self) -> None:
        """Counts the workers once a second, since clusters may grow."""
        now = time.monotonic()
        if now >= self._next_count:
            self._workers, self._next_count = num_workers(self._executor), now + 1.0

    def _has_suspects(self) -> bool:
        return bool(self._lost) or any(chunk.attempts for chunk in self._sent.values())

    def _size(self) -> int:
        """Instances of the next chunk."""
        if self._chunk is not None:
            return self._chunk
        size = math.ceil(len(self._data[0]) / (_CHUNKS_PER_WORKER * self._workers))
        if self._seconds > 0.0:
            size = max(size, math.ceil(_SHORTEST_CHUNK * self._num_solved / self._seconds))
        return max(size, 1)

    def _submit(self, chunk: _Chunk) -> None:
        start, columns = (part[chunk.place] for part in self._data)
        arguments = (self._job, start, columns, (chunk.first, chunk.attempts))
        try:
            future = self._current().submit(solve_chunk, *arguments)
        except concurrent.futures.BrokenExecutor as error:
            self._replacement = _replacement(self._current())
            if self._replacement is None:
                self._give_up(chunk, error)
                return
            future = self._replacement.submit(solve_chunk, *arguments)
        self._sent[future] = chunk

    def _current(self) -> concurrent.futures.Executor:
        return self._executor if self._replacement is None else self._replacement

    # ---- Receiving -------------------------------------------------------------------------------

    def _receive(self, future: concurrent.futures.Future[Answer]) -> None:
        chunk = self._sent.pop(future)
        try:
            answer = future.result()
        except (Exception, concurrent.futures.CancelledError) as error:
            if not _is_loss(error):
                raise
            chunk.attempts += 1
            if chunk.attempts > self._retries:
                self._give_up(chunk, error)
            else:
                self._lost.append(chunk)
            return
        if answer.outcome is None:
            self._raise(answer)
        self._store(chunk, answer)

    def _receive_finished(self) -> None:
        """Collects the chunks that were solved before an interrupt."""
        for future in [future for future in self._sent if future.done()]:
            if not future.cancelled() and future.exception() is None:
                if future.result().outcome is not None:
                    self._receive(future)

    def _raise(self, answer: Answer) -> None:
        exception = cast(Exception, answer.exception)
        if exception.__traceback__ is not None:  # of a thread
            raise exception
        raise exception from RemoteTraceback(answer.text)

    def _store(self, chunk: _Chunk, answer: Answer) -> None:
        result, total = cast(Outcome, answer.outcome), self._outcome
        total.x[chunk.place] = result.x
        if total.xdot is not None:
            total.xdot[chunk.place] = result.xdot
        total.statuses[chunk.place] = result.statuses
        total.messages[chunk.place] = result.messages
        self._num_analyses += result.num_analyses
        self._num_solved += chunk.count
        self._seconds += answer.seconds
        self._count_ended(chunk)

    def _count_ended(self, chunk: _Chunk) -> None:
        self._num_ended += chunk.count
        if self._on_ended is not None:
            self._on_ended(self._num_ended)

    # ---- Losses ----------------------------------------------------------------------------------

    def _give_up(self, chunk: _Chunk, error: BaseException) -> None:
        """Ends a chunk without results, and all others if no chunk has ever been solved."""
        times = f"{chunk.attempts} times" if chunk.attempts > 1 else "once"
        reason = (
            f"the worker of this instance was lost {times} ({type(error).__name__}: {error}). "
            "Look for the reason in the messages of the worker, for example a lack of memory or a "
            "crash of a function that the equations call; then repeat the call with this instance"
        )
        self._outcome.messages[chunk.place] = [reason] * chunk.count
        self._count_ended(chunk)
        if self._num_solved == 0:
            self._next = len(self._data[0])
            self._lost.clear()
            self._mark_unsolved(reason)

    def _mark_unsolved(self, reason: str) -> None:
        """Gives all instances that have not ended, and have no message, this one."""
        messages, statuses = self._outcome.messages, self._outcome.statuses
        for i, status in enumerate(statuses):
            if status == Status.STOPPED and not messages[i]:
                messages[i] = reason

    def _cancel(self) -> None:
        self._job.is_stopped = True
        for future in self._sent:
            future.cancel()
        if self._replacement is not None:
            self._replacement.shutdown(wait=False)

    # ---- Summary ---------------------------------------------------------------------------------

    def _summary(self, is_interrupted: bool) -> str:
        """The message about all instances, as that of the library."""
        statuses, messages = self._outcome.statuses, self._outcome.messages
        count = len(statuses)
        stopped = np.flatnonzero(statuses == Status.STOPPED)
        failed = np.flatnonzero(statuses < 0)
        if stopped.size and is_interrupted:
            return (
                f"stopped on request: {stopped.size} of {count} instances have not come to their "
                "end; the call can be repeated."
            )
        if stopped.size:
            first = stopped[0]
            return (
                f"{stopped.size} of {count} instances have not come to their end, first of all "
                f"instance {first}: {messages[first]}"
            )
        if failed.size:
            first = failed[0]
            return (
                f"{failed.size} of {count} instances failed, first of all instance {first} with "
                f"{status_name(statuses[first])}: {messages[first]}"
            )
        return ""


def num_workers(executor: Any) -> int:
    """The number of workers of an executor; that of processors if it does not tell."""
    client = getattr(executor, "_client", None)  # of dask.distributed
    if hasattr(client, "nthreads"):
        return max(sum(client.nthreads().values()), 1)
    for name in ("num_workers", "_max_workers"):  # of MPI, and of concurrent.futures
        count = getattr(executor, name, None)
        if isinstance(count, int) and count > 0:
            return count
    return os.cpu_count() or 1


def _is_loss(error: BaseException) -> bool:
    kinds = (concurrent.futures.BrokenExecutor, concurrent.futures.CancelledError)
    return isinstance(error, kinds) or type(error).__name__ in _LOST


def _replacement(executor: Any) -> concurrent.futures.Executor | None:
    """A new pool of processes in place of a broken one, which accepts no more work."""
    if not isinstance(executor, concurrent.futures.ProcessPoolExecutor):
        return None
    pool: Any = executor
    return concurrent.futures.ProcessPoolExecutor(
        pool._max_workers,
        getattr(pool, "_mp_context", None),
        getattr(pool, "_initializer", None),
        getattr(pool, "_initargs", ()),
    )


def distributed(
    executor: concurrent.futures.Executor,
    job: Job,
    start: np.ndarray,
    columns: np.ndarray,
    outcome: Outcome,
    **more: Any,
) -> Outcome:
    """Solves all instances by an executor. more: chunk, retries, on_ended; see Distribution."""
    if not isinstance(executor, concurrent.futures.ThreadPoolExecutor):
        job.to_bytes()  # before anything is sent: an error that tells what cannot be pickled
    return Distribution(executor, job, start, columns, outcome, **more).run()
