# SPDX-License-Identifier: BSD-3-Clause
"""Ensembles: many instances of one problem, which differ in parameters and start values."""

from __future__ import annotations

import concurrent.futures
import warnings
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ._executors import Job, distributed
from ._formula import checked_value
from ._instances import Task, empty_outcome, solve_instances
from ._problem import Problem
from ._progress import InstancesBar
from ._solve import ProblemOrFunction, as_problem, output_times, span, with_stop_time
from ._solver import Solver
from ._status import IntegrationWarning, Status
from ._types import Values
from ._unknowns import by_name


class EnsembleSolution:
    """The result of an ensemble of N instances.

    Attributes
    ----------
    t : numpy.ndarray
        K times.
    x : numpy.ndarray
        N x n x K; NaN for times that an instance did not reach.
    xdot : numpy.ndarray or None
        N x n x K, if requested.
    parameters : dict
        Values of the parameters that differ, N each.
    status : list of Status
        N, as for solve; ``STOPPED`` for instances that were not started or finished.
    messages : list of str
        N; "" for ``OK``.
    num_analyses : int
        Number of complete index analyses; the others followed a precedent. With an executor at
        least one for each chunk.
    names : tuple of str
        Names of the unknowns.
    """

    t: np.ndarray
    x: np.ndarray
    xdot: np.ndarray | None
    parameters: dict[str, np.ndarray]
    status: list[Status]
    messages: list[str]
    num_analyses: int
    names: tuple[str, ...]

    def __init__(self, **members: Any) -> None:
        vars(self).update(members)

    @property
    def success(self) -> bool:
        """True if all instances reached the end."""
        return all(status >= 0 and status != Status.STOPPED for status in self.status)

    def __len__(self) -> int:
        return len(self.status)

    def __getitem__(self, name: str) -> np.ndarray:
        """One unknown of all instances by its name, N x K."""
        if name not in self.names:
            raise KeyError(f"there is no unknown {name!r}; there are {', '.join(self.names)}")
        return self.x[:, self.names.index(name)]

    def __repr__(self) -> str:
        failed = sum(status < 0 for status in self.status)
        return f"EnsembleSolution({len(self)} instances, {failed} failed, {self.t.size} times)"


def solve_ensemble(
    problem: ProblemOrFunction,
    t_span: Sequence[float],
    x0: Values,
    *,
    parameters: Mapping[str, Any] | None = None,
    t_eval: ArrayLike | None = None,
    threads: int = 0,
    xdot: bool = False,
    names: Sequence[str] | None = None,
    progress: bool = False,
    executor: concurrent.futures.Executor | None = None,
    chunk: int | None = None,
    retries: int = 2,
    **options: Any,
) -> EnsembleSolution:
    """Solves many instances of a recorded problem: in threads, without Python's lock, or by an
    executor in other processes and on other machines.

    Each instance gives the same result, to the last bit, as alone; they share the recording, and
    index analyses if the ranks are the same.

    Parameters
    ----------
    problem : Problem or callable
        As for solve, recorded: no callbacks.
    t_span : (float, float)
        Start and end, not equal.
    x0 : array_like or dict
        Start values of all instances, n, or of each, N x n.
    parameters : dict, optional
        Values of named parameters: a number for all instances, or N for each; of arrays of
        parameters, N x their shape.
    t_eval : array_like, optional
        Times of the outputs; by default only the end.
    threads : int
        Number of threads; 0: as many as there are processors. With an executor, the number of
        threads of each worker; 0: one.
    xdot : bool
        True: derivatives are returned, too.
    names : sequence of str, optional
        Names of the unknowns, in the order of x, if the problem is a function, as for solve.
    progress : bool
        Shows a bar.
    executor : concurrent.futures.Executor, optional
        Workers that solve the instances: a ProcessPoolExecutor or ThreadPoolExecutor,
        ``client.get_executor()`` of dask.distributed, or an MPIPoolExecutor of mpi4py.futures. They
        need sfdae, and receive the recorded equations, not the function. Results are the same in
        every bit.
    chunk : int, optional
        Number of instances that are sent together; by default at least 16 chunks for each worker,
        unless these would take less than 20 milliseconds.
    retries : int
        How often a chunk is sent again if its worker was lost. After that its instances have the
        status ``STOPPED`` and a message with the reason.
    **options
        As for solve: method, rtol, atol, fixed, max_step, ... max_steps limits the steps that an
        instance attempts between two outputs, by default 100,000.

    Returns
    -------
    EnsembleSolution
        ``t, x`` (N x n x K), ``status, messages``; incomplete, with a warning, if instances fail or
        Ctrl-C stops all.

    Raises
    ------
    Error
        For invalid arguments, and problems that are not recorded.
    TypeError
        If a function that equations call with numbers cannot be pickled for the executor.
    Exception
        An exception in a worker cancels all chunks and is raised with its traceback.
    """
    parameters = parameters or {}
    x0 = by_name(x0)
    first = x0 if isinstance(x0, Mapping) else np.atleast_2d(np.array(x0, dtype=float))[0]
    given = {name: value if np.ndim(value) == 0 else value[0] for name, value in parameters.items()}
    problem = as_problem(problem, first, names, parameters=given)
    t0, t1 = span(t_span)
    times = np.array([t1]) if t_eval is None else output_times(t_eval, t0, t1)
    common, different, count = _parameters(problem, parameters, x0)
    options = with_stop_time(options, t1)
    solver = Solver(problem, parameters=common, **options)
    start = _start_values(problem, x0, count)
    labels, columns = _columns(different)

    task = Task(t0, times, labels, bool(xdot))
    _check_sending(executor, chunk, retries)
    bar = InstancesBar(count) if progress else None
    try:
        if executor is None:
            monitor = None if bar is None else bar.update
            outcome = solve_instances(solver, task, start, columns, threads, monitor)
        else:
            outcome = solve_instances(solver, task, start[:0], columns[:0], threads)  # checks all
            outcome = empty_outcome(task, count, problem.num_unknowns)
            job = Job(problem, common, options, task, threads or 1)
            on_ended = None if bar is None else bar.update
            sending = {"chunk": chunk, "retries": retries, "on_ended": on_ended}
            outcome = distributed(executor, job, start, columns, outcome, **sending)
    finally:
        if bar is not None:
            bar.close()
    if outcome.summary:
        warnings.warn(problem.with_names(outcome.summary), IntegrationWarning, stacklevel=2)
    return EnsembleSolution(
        t=times,
        x=outcome.x.transpose(0, 2, 1),
        xdot=None if outcome.xdot is None else outcome.xdot.transpose(0, 2, 1),
        parameters=different,
        status=[Status(code) for code in outcome.statuses],
        messages=outcome.messages,
        num_analyses=outcome.num_analyses,
        names=problem.names,
    )


def _check_sending(executor: Any, chunk: int | None, retries: int) -> None:
    """TypeError or ValueError for wrong arguments about executors."""
    if executor is None:
        if chunk is not None:
            raise TypeError("chunk, the number of instances sent together, needs an executor")
        return
    if not isinstance(executor, concurrent.futures.Executor):
        hint = "; give client.get_executor()" if hasattr(executor, "get_executor") else ""
        raise TypeError(f"executor has to be one of concurrent.futures, not {executor!r}{hint}")
    if chunk is not None and (int(chunk) != chunk or chunk < 1):
        raise ValueError(f"chunk has to be an integer of at least 1, not {chunk!r}")
    if int(retries) != retries or retries < 0:
        raise ValueError(f"retries has to be an integer of at least 0, not {retries!r}")


def _parameters(
    problem: Problem, given: Mapping[str, Any], x0: Any
) -> tuple[dict[str, Any], dict[str, np.ndarray], int]:
    """Parameters that all instances share, those that differ, and the number of instances."""
    common, different = {}, {}
    count = None if isinstance(x0, Mapping) or np.ndim(x0) < 2 else np.shape(x0)[0]
    for name, value in given.items():
        if name not in problem.parameters:
            known = ", ".join(problem.parameters) or "none"
            raise TypeError(f"there is no parameter {name!r}; there are {known}")
        value = checked_value(name, value)
        shape = np.shape(problem.parameters[name])
        if np.shape(value) == shape:
            common[name] = value
            continue
        if np.shape(value)[1:] != shape:
            raise ValueError(f"parameter {name!r} has shape {np.shape(value)}, not (N, *{shape})")
        if count is not None and np.shape(value)[0] != count:
            raise ValueError(f"parameter {name!r} has {np.shape(value)[0]} values, not {count}")
        count = np.shape(value)[0]
        different[name] = value
    return common, different, 1 if count is None else count


def _start_values(problem: Problem, x0: Any, count: int) -> np.ndarray:
    """N x n."""
    if isinstance(x0, Mapping) or np.ndim(x0) < 2:
        return np.tile(problem.values(x0), (count, 1))
    values = np.array(x0, dtype=float)
    if values.shape != (count, problem.num_unknowns):
        raise ValueError(f"x0 has shape {values.shape}, not ({count}, {problem.num_unknowns})")
    return values


def _columns(different: Mapping[str, np.ndarray]) -> tuple[list[str], np.ndarray]:
    """Names of single parameters and their values, N x P."""
    labels, columns = [], []
    for name, values in different.items():
        flat = values.reshape(values.shape[0], -1)
        labels += [name] if values.ndim == 1 else [f"{name}[{i}]" for i in range(flat.shape[1])]
        columns.append(flat)
    return labels, np.concatenate(columns, axis=1) if columns else np.empty((0, 0))
