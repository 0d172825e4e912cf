# SPDX-License-Identifier: BSD-3-Clause
"""Derivative arrays that a function of the user returns as a whole."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._binding import ffi, lib
from ._callbacks import CallbackState, _numbers, _write, callback
from ._status import Error


@callback("python_nonlinear_problem_derivative_array")
def _derivative_array(
    state: CallbackState, t: float, order: int, derivatives: Any, F: Any, jacobian: Any
) -> int | None:
    problem = state.problem
    m, n = problem.num_equations, problem.num_unknowns
    asks_for_jacobian = jacobian != ffi.NULL
    jet = _numbers(derivatives, (n, order + 2))
    result = problem.derivative_array(t, order, jet, asks_for_jacobian)
    if result is None:
        return lib.SFDAE_ORDER_NOT_AVAILABLE
    parts = result if isinstance(result, tuple) else (result,)
    if asks_for_jacobian and len(parts) != 2:
        raise TypeError("derivative_array has to return (F, J) where jacobian is true")
    values = parts[0]
    if np.shape(values) == (order + 1, m):
        values = np.ravel(values)
    _write(F, values, ((order + 1) * m,), "F of derivative_array")
    if asks_for_jacobian:
        _write(jacobian, parts[1], ((order + 1) * m, (order + 2) * n), "J of derivative_array")
    return 0


def split_derivative_array(jacobian: Any, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Splits the Jacobian of a derivative array into total derivatives of F_x and F_xdot, and
    checks all its blocks.

    Parameters
    ----------
    jacobian : array_like
        (order + 1) m x (order + 2) n, as ``derivative_array`` of NonlinearProblem returns it.
    order : int
        0 to 13.

    Returns
    -------
    F_x, F_xdot : numpy.ndarray
        (order + 1) x m x n, the derivatives of order 0, 1, ..., without factorials.

    Raises
    ------
    Error
        ``Status.WRONG_DERIVATIVES`` if an entry contradicts others.
    """
    array = np.asarray(jacobian, dtype=float)
    levels = int(order) + 1
    if array.ndim != 2 or levels < 1 or array.shape[0] % levels or array.shape[1] % (levels + 1):
        raise ValueError(f"a derivative array of order {order} has no Jacobian {array.shape}")
    m, n = array.shape[0] // levels, array.shape[1] // (levels + 1)
    entries = np.asfortranarray(array)
    F_x, F_xdot = (np.zeros((m, n, levels), order="F") for _ in range(2))
    text = ffi.new("char[]", 1536)
    places = (ffi.cast("double*", part.ctypes.data) for part in (entries, F_x, F_xdot))
    status = lib.sfdae_split_derivative_array(m, n, levels - 1, *places, text, len(text))
    if status < 0:
        raise Error(status, ffi.string(text).decode())
    return np.moveaxis(F_x, 2, 0), np.moveaxis(F_xdot, 2, 0)
