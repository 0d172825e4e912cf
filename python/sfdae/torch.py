# SPDX-License-Identifier: BSD-3-Clause
"""Solutions as tensors of PyTorch, with gradients by the discrete adjoint method.

    import sfdae.torch

    x = sfdae.torch.solve(problem, (0, 1), x0, parameters={"k": k}, t_eval=[0.5, 1.0])
    loss = ((x - measured) ** 2).sum()
    loss.backward()

PyTorch has to be installed; ``import sfdae`` does not load it.
"""

from __future__ import annotations

import concurrent.futures
import os
import warnings
from typing import Any, Callable, Mapping, NamedTuple, Sequence, Union

import numpy as np
import torch
from torch.autograd.function import once_differentiable

from ._ensemble import solve_ensemble
from ._problem import Problem
from ._solve import ProblemOrFunction, as_problem, output_times, span, with_stop_time
from ._solver import Solver
from ._status import Error, InitialValuesWarning, IntegrationWarning, Status
from ._unknowns import by_name

__all__ = ["solve"]

Parameters = Union[torch.Tensor, Mapping[str, Any]]


def solve(
    problem: ProblemOrFunction,
    t_span: Sequence[float],
    x0: Any,
    *,
    parameters: Parameters | None = None,
    t_eval: Any = None,
    names: Sequence[str] | None = None,
    threads: int = 0,
    max_kept_steps: int = 0,
    **options: Any,
) -> torch.Tensor:
    """Solves a recorded problem and returns x at the output times as a tensor.

    ``backward()`` computes gradients for those parameters and start values that are tensors with
    ``requires_grad``: the exact ones of the numerical solution for its steps. Second derivatives
    are not available.

    Parameters
    ----------
    problem : Problem or callable
        As for sfdae.solve, recorded: no callbacks.
    t_span : (float, float)
        Start and end, not equal.
    x0 : Tensor, array_like or dict
        Start values, n, or N x n for a batch of N; or values by name. Gradients are those with
        respect to the guess, which is made consistent.
    parameters : Tensor or dict, optional
        Values by name, tensors or numbers; of a batch also with N in front of their shape, which is
        that of their defaults. A tensor alone has all entries of all parameters, in the order of
        ``problem.parameters``.
    t_eval : array_like, optional
        Times of the outputs, in the order of integration; by default only the end.
    names : sequence of str, optional
        Names of the unknowns, if the problem is a function, as for sfdae.solve.
    threads : int
        Number of threads for a batch; 0: as many as there are processors.
    max_kept_steps : int
        Maximum number of steps stored for the gradient; 0: all. See Solver.set_sensitivities.
    **options
        As for sfdae.solve: method, rtol, atol, fixed, max_step, ...

    Returns
    -------
    Tensor
        float64, n x K, or N x n x K for a batch. It is on the device of the first tensor given.

    Raises
    ------
    Error
        If the problem cannot be started, or an integration does not reach its end.
    TypeError
        For tensors that are not float64.
    """
    start = by_name(x0)
    first = start if isinstance(start, Mapping) else np.atleast_2d(_numbers("x0", start))[0]
    given = parameters if isinstance(parameters, Mapping) else {}
    plain = {name: _plain_value(name, value) for name, value in given.items()}
    problem = as_problem(problem, first, names, parameters=plain)
    t0, t1 = span(t_span)
    times = np.array([t1]) if t_eval is None else output_times(t_eval, t0, t1)
    if times.size == 0:
        raise ValueError("t_eval has no times: at least one output is needed")
    values = _by_parameter(problem, parameters)
    tensors = [_start_tensor(problem, start)]
    tensors += [_tensor(f"parameter {name!r}", value) for name, value in values.items()]
    plan = _Plan(
        problem, t0, t1, times, tuple(values), threads, max_kept_steps, with_stop_time(options, t1)
    )
    devices = [value.device for value in _given_tensors(x0, parameters)]
    result: torch.Tensor = _Solve.apply(plan, *tensors)
    return result.to(devices[0]) if devices else result


# ---- Arguments -----------------------------------------------------------------------------------


def _numbers(what: str, value: Any) -> np.ndarray:
    return np.array(_tensor(what, value).detach().numpy())


def _tensor(what: str, value: Any) -> torch.Tensor:
    """A value as a tensor of numbers of double precision in the memory of the processor."""
    if isinstance(value, torch.Tensor):
        if value.dtype != torch.float64:
            raise TypeError(
                f"{what} is a tensor of {value.dtype}, but sfdae needs double precision: give "
                "value.double(), or make it with dtype=torch.float64"
            )
        return value.cpu()
    if isinstance(value, (list, tuple)) and any(isinstance(v, torch.Tensor) for v in value):
        return torch.stack([_tensor(what, entry) for entry in value])
    return torch.as_tensor(np.array(value, dtype=float))


def _given_tensors(x0: Any, parameters: Any) -> list[torch.Tensor]:
    parts: list[Any] = []
    for given in (x0, parameters):
        parts += list(given.values()) if isinstance(given, Mapping) else [given]
    return [part for part in parts if isinstance(part, torch.Tensor)]


def _plain_value(name: str, value: Any) -> Any:
    """The value of a parameter without a default, as a number or an array of numbers."""
    numbers = _numbers(f"parameter {name!r}", value)
    return float(numbers) if numbers.ndim == 0 else numbers


def _by_parameter(problem: Problem, given: Parameters | None) -> dict[str, Any]:
    """Values by name. A tensor alone is divided among all parameters."""
    if given is None or isinstance(given, Mapping):
        for name in given or {}:
            if name not in problem.parameters:
                known = ", ".join(problem.parameters) or "none"
                raise TypeError(f"there is no parameter {name!r}; there are {known}")
        return dict(given or {})
    shapes = {name: np.shape(value) for name, value in problem.parameters.items()}
    sizes = [int(np.prod(shape)) for shape in shapes.values()]
    values = _tensor("parameters", given)
    if values.ndim == 0:
        values = values.reshape(1)
    if values.shape[-1] != sum(sizes) or values.ndim > 2:
        raise ValueError(
            f"parameters has shape {tuple(values.shape)}; the problem has {sum(sizes)} entries of "
            f"parameters ({', '.join(shapes) or 'none'}): give as many, or a dict"
        )
    parts = torch.split(values, sizes, dim=-1)
    batch = tuple(values.shape[:-1])
    return {name: part.reshape(batch + shapes[name]) for name, part in zip(shapes, parts)}


def _start_tensor(problem: Problem, start: Any) -> torch.Tensor:
    if not isinstance(start, Mapping):
        return _tensor("x0", start)
    entries = [torch.zeros((), dtype=torch.float64)] * problem.num_unknowns
    for unknown, value in start.items():
        entries[problem.index(unknown)] = _tensor(f"x0 of {unknown!r}", value).reshape(())
    return torch.stack(entries)


# ---- Integration ---------------------------------------------------------------------------------


class _Plan(NamedTuple):
    """Everything but the values. names: of the parameters that are given."""

    problem: Problem
    t0: float
    t1: float
    times: np.ndarray
    names: tuple[str, ...]
    threads: int
    max_kept_steps: int
    options: dict[str, Any]

    def dimensions(self) -> list[int]:
        """The dimensions of x0 and of the parameters without a batch."""
        return [len(shape) for shape in self.shapes()]

    def shapes(self) -> list[tuple[int, ...]]:
        """The shapes of x0 and of the parameters without a batch."""
        values = (np.shape(self.problem.parameters[name]) for name in self.names)
        return [(self.problem.num_unknowns,), *values]

    def batch_size(self, values: Sequence[np.ndarray]) -> int | None:
        """N, or None without a batch. ValueError for wrong shapes."""
        count = None
        for name, value, shape in zip(("x0", *self.names), values, self.shapes()):
            if value.shape == shape:
                continue
            if value.shape[1:] != shape or value.ndim == 0 or count not in (None, len(value)):
                expected = "N" if count is None else str(count)
                raise ValueError(
                    f"{name} has shape {value.shape}: it has to be {shape}, or for a batch "
                    f"{expected} x {shape}"
                )
            count = len(value)
        return count


class _Run:
    """One integration with its stored steps. is_wanted: True for x0 and for each parameter whose
    gradient will be needed.
    """

    def __init__(
        self, plan: _Plan, values: Sequence[np.ndarray], is_wanted: Sequence[bool]
    ) -> None:
        named = dict(zip(plan.names, values[1:]))
        self.times = plan.times
        self.x = np.empty((plan.problem.num_unknowns, plan.times.size))
        self._shapes = plan.shapes()
        self._is_wanted = is_wanted
        self._solver = Solver(plan.problem, parameters=named, **plan.options)
        if any(is_wanted):
            self._request(plan)
        point = self._solver.start(plan.t0, values[0], plan.t1)
        self.notes = [(point.message, InitialValuesWarning)] if point.status > 0 else []
        for k, t in enumerate(plan.times):
            if t != plan.t0:
                point = self._solver.advance(t)
                if point.status > 0:
                    self.notes.append((point.message, IntegrationWarning))
            if point.t != t:
                raise Error(point.status, point.message)
            self.x[:, k] = point.x

    def _request(self, plan: _Plan) -> None:
        """Asks for the gradient with respect to the entries of the values wanted, in order."""
        n = plan.problem.num_unknowns
        labels: list[str | None] = [None] * n if self._is_wanted[0] else []
        for name, shape, wanted in zip(plan.names, self._shapes[1:], self._is_wanted[1:]):
            if wanted:
                size = int(np.prod(shape))
                labels += [name] if shape == () else [f"{name}[{i}]" for i in range(size)]
        directions = np.eye(n, len(labels)) if self._is_wanted[0] else None
        self._solver.set_sensitivities(
            labels, directions, adjoint=True, max_kept_steps=plan.max_kept_steps
        )

    def gradients(self, weights: np.ndarray) -> list[np.ndarray | None]:
        """Derivatives of the sum of weights (n x K) times x by x0 and each parameter; None for
        those not wanted.
        """
        entries = self._solver.gradient(self.times, weights)
        result: list[np.ndarray | None] = []
        for shape, wanted in zip(self._shapes, self._is_wanted):
            size = int(np.prod(shape))
            result.append(entries[:size].reshape(shape) if wanted else None)
            entries = entries[size:] if wanted else entries
        return result


def _in_threads(function: Callable[[int], Any], count: int, threads: int) -> list[Any]:
    """Results of a function of 0, ..., count - 1; the first exception is raised."""
    workers = min(count, threads or os.cpu_count() or 1)
    if workers <= 1:
        return [function(i) for i in range(count)]
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(function, i) for i in range(count)]
        try:
            return [future.result() for future in futures]
        finally:
            for future in futures:
                future.cancel()


def _instance(values: Sequence[np.ndarray], dimensions: Sequence[int], i: int) -> list[np.ndarray]:
    return [v if v.ndim == dimension else v[i] for v, dimension in zip(values, dimensions)]


def _solved_by_ensemble(plan: _Plan, values: Sequence[np.ndarray]) -> np.ndarray:
    """A batch without gradients: the instances share one recording."""
    named = dict(zip(plan.names, values[1:]))
    common = {"t_eval": plan.times, "threads": plan.threads, **plan.options}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", IntegrationWarning)  # failures are raised
        solution = solve_ensemble(
            plan.problem, (plan.t0, plan.t1), values[0], parameters=named, **common
        )
    for i, status in enumerate(solution.status):
        if status == Status.STOPPED:
            raise KeyboardInterrupt
        if status < 0:
            raise Error(status, f"instance {i} of the batch: {solution.messages[i]}")
    return solution.x


class _Solve(torch.autograd.Function):
    """x at the output times as a function of x0 and of parameters."""

    @staticmethod
    def forward(ctx: Any, plan: _Plan, *tensors: torch.Tensor) -> torch.Tensor:
        values = [np.array(tensor.detach().numpy()) for tensor in tensors]
        count = plan.batch_size(values)
        is_wanted = ctx.needs_input_grad[1:]
        ctx.plan, ctx.count = plan, count
        if count is not None and not any(is_wanted):
            return torch.from_numpy(np.ascontiguousarray(_solved_by_ensemble(plan, values)))

        def run(i: int) -> _Run:
            return _Run(plan, _instance(values, plan.dimensions(), i), is_wanted)

        ctx.runs = _in_threads(run, 1 if count is None else count, plan.threads)
        ctx.shapes = [value.shape for value in values]
        for message, category in dict.fromkeys(note for run in ctx.runs for note in run.notes):
            warnings.warn(message, category, stacklevel=3)
        x = np.stack([run.x for run in ctx.runs])
        return torch.from_numpy(x if count is not None else x[0])

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, weights: torch.Tensor) -> tuple[Any, ...]:
        plan, count = ctx.plan, ctx.count
        given = np.array(weights.detach().cpu().numpy(), dtype=float)
        given = given if count is not None else given[np.newaxis]

        def gradients(i: int) -> list[np.ndarray | None]:
            return ctx.runs[i].gradients(given[i])

        found = _in_threads(gradients, len(given), plan.threads)
        results: list[torch.Tensor | None] = []
        for k, dimension in enumerate(plan.dimensions()):
            if not ctx.needs_input_grad[k + 1]:
                results.append(None)
                continue
            parts = np.stack([gradient[k] for gradient in found])
            is_shared = len(ctx.shapes[k]) == dimension
            results.append(torch.from_numpy(np.array(parts.sum(axis=0) if is_shared else parts)))
        return (None, *results)
