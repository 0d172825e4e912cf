# SPDX-License-Identifier: BSD-3-Clause
"""Derivatives of the solution with respect to parameters and start values, for Solver."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from ._binding import ffi, lib
from ._inspection import Inspection
from ._structs import filled, prepared


class _Request:
    """The arguments of sfdae_set_sensitivities after the solver, and their memory."""

    def __init__(
        self,
        problem: Any,
        names: Sequence[str | None],
        directions: Any,
        error_test: bool,
        scales: Any,
        adjoint: bool = False,
        max_kept_steps: int = 0,
    ) -> None:
        names = list(names)
        n, count = problem.num_unknowns, len(names)
        columns = np.zeros((count, n))
        if directions is not None:
            columns += np.reshape(np.array(directions, dtype=float), (n, count)).T
        c_names = [ffi.NULL] * count
        for j, name in enumerate(names):
            if name in problem.names and name not in problem.parameters:
                columns[j, problem.names.index(name)] += 1.0
            elif name is not None:
                c_names[j] = ffi.new("char[]", str(name).encode())
        options = prepared("sensitivity_options")
        options.error_test = int(bool(error_test))
        options.adjoint = int(bool(adjoint))
        options.max_kept_steps = int(max_kept_steps)
        sizes = None
        if scales is not None:
            sizes = np.ascontiguousarray(np.reshape(np.array(scales, dtype=float), count))
            options.scales = ffi.cast("double*", sizes.ctypes.data)
        self.count = count
        self.arguments = (
            count,
            ffi.new("char*[]", c_names) if count else ffi.NULL,
            ffi.cast("double*", columns.ctypes.data) if count else ffi.NULL,
            options,
        )
        self._alive = (c_names, columns, sizes)


def _gradient(call: Any, shape: tuple[int, int], t: Any, weights: Any) -> np.ndarray:
    """Calls sfdae_get_gradient or sfdae_get_hybrid_gradient. shape: n and the number of parameters;
    t, weights: see Sensitivities.gradient.
    """
    n, count = shape
    times = np.ascontiguousarray(np.atleast_1d(np.array(t, dtype=float)))
    given = np.array(weights, dtype=float)
    if given.ndim == 1 and len(times) == 1:
        given = given[:, np.newaxis]
    one = given.ndim == 2
    if one:
        given = given[np.newaxis]
    if given.ndim != 3 or given.shape[1:] != (n, len(times)):
        raise ValueError(
            f"weights has the shape {np.shape(weights)}; it must be ({n}, {len(times)}), or a number "
            "of functionals before that"
        )
    columns = np.ascontiguousarray(np.swapaxes(given, 1, 2))
    result = np.zeros((len(columns), max(count, 1)))
    times_, columns_, result_ = (
        ffi.cast("double*", array.ctypes.data) for array in (times, columns, result)
    )
    call(len(times), times_, len(columns), columns_, result_)
    return result[0, :count] if one else result[:, :count]


class Sensitivities(Inspection):
    """The sensitivity methods of a Solver."""

    _num_sensitivities = 0

    def set_sensitivities(
        self,
        names: Sequence[str | None],
        directions: Any = None,
        error_test: bool = False,
        scales: Any = None,
        adjoint: bool = False,
        max_kept_steps: int = 0,
    ) -> None:
        """Requests derivatives of the solution from the next start() on.

        Parameters
        ----------
        names : sequence of str
            Names of parameters of recorded equations, or of unknowns, for their start values; None
            for one that occurs in `directions` only. An empty sequence: no sensitivities.
        directions : array_like, optional
            n x p: derivatives of the initial guess of x with respect to these, added to the unit
            vectors of start values.
        error_test : bool
            True: steps are controlled for the sensitivities, too.
        scales : array_like, optional
            p typical sizes of the parameters, for the error test; by default 1.
        adjoint : bool
            Steps are stored for gradient() instead: for many parameters and few functionals.
        max_kept_steps : int
            With the adjoint: maximum number stored at a time, to save memory; earlier ones are
            recomputed for each gradient. 0: all are stored.
        """
        request = _Request(
            self.problem, names, directions, error_test, scales, adjoint, max_kept_steps
        )
        self._call(lib.sfdae_set_sensitivities, *request.arguments)
        self._num_sensitivities = request.count

    def sensitivities(self, t: float, slopes: bool = True) -> tuple[np.ndarray, np.ndarray | None]:
        """S = dx/dp and S' at t, n x p each, at the time returned by the last call or within the
        last step. slopes: False: None instead of S', which costs more than S.
        """
        shape = (max(self._num_sensitivities, 1), self.problem.num_unknowns)
        S, Sdot = np.zeros(shape), np.zeros(shape) if slopes else None
        self._call(
            lib.sfdae_get_sensitivities,
            t,
            self._pointer(S),
            ffi.NULL if Sdot is None else self._pointer(Sdot),
        )
        return S.T, None if Sdot is None else Sdot.T

    def gradient(self, t: Any, weights: Any) -> np.ndarray:
        """Gradients of functionals by the adjoint: sum_k S(t_k)^T w_k, for set_sensitivities(...,
        adjoint=True).

        Parameters
        ----------
        t : array_like
            K times, in any order, from the start to the time reached.
        weights : array_like
            n x K derivatives of a functional with respect to x(t_k); or f x n x K for f
            functionals.

        Returns
        -------
        ndarray
            p numbers, or f x p.
        """
        return _gradient(
            lambda *arguments: self._call(lib.sfdae_get_gradient, *arguments),
            (self.problem.num_unknowns, self._num_sensitivities),
            t,
            weights,
        )

    def event_sensitivities(self, t: float, g_t: float, g_x: Any, g_p: Any = None) -> np.ndarray:
        """dt_e/dp of an event g(t, x, p) = 0 at t, from the partial derivatives of g."""
        n, count = self.problem.num_unknowns, self._num_sensitivities
        by_x = np.ascontiguousarray(np.reshape(np.array(g_x, dtype=float), n))
        by_p = None
        if g_p is not None:
            by_p = np.ascontiguousarray(np.reshape(np.array(g_p, dtype=float), count))
        dt = np.zeros(max(count, 1))
        self._call(
            lib.sfdae_get_event_sensitivities,
            t,
            g_t,
            self._pointer(by_x),
            ffi.NULL if by_p is None else self._pointer(by_p),
            self._pointer(dt),
        )
        return dt[:count]

    @property
    def sensitivity_statistics(self) -> Any:
        """Work for the sensitivities since the start: count, linearizations, ..."""
        return filled(
            "sensitivity_statistics",
            lambda statistics: self._call(lib.sfdae_get_sensitivity_statistics, statistics),
        )
