# SPDX-License-Identifier: BSD-3-Clause
"""Splines and tables in formulas."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._arrays import ExpressionArray, elementwise
from ._binding import ffi, lib
from ._expression import Expression, as_expression
from ._functions import external


def table(a: Any, x: Any, y: Any = None, degree: int = 3) -> Any:
    """The value at a of the spline through points (x, y); see sfdae_table of the C library.

    The value is undefined outside the data: clip a with ``np.clip``, or use ``a % period``.

    Parameters
    ----------
    a : Expression, float or array of these
    x : array_like, or a spline of scipy.interpolate
        At least degree + 1 points, increasing. A spline replaces all other arguments: ``table(t,
        CubicSpline(...))``. Linear and cubic interp1d and a CubicSpline with its default boundary
        conditions become tables; other splines are called at every point, with their derivatives.
    y : array_like
        Values at the points, or rows of k values for a result with k values.
    degree : int
        1, 3, 5 or 7.
    """
    if y is None:
        return _of_scipy(a, x)
    points, values = (np.array(data, dtype=float, order="C") for data in (x, y))
    if points.ndim != 1 or values.ndim < 1 or len(values) != len(points):
        raise ValueError(f"x and y have the shapes {points.shape} and {values.shape}")
    if values.ndim > 1:
        columns = [table(a, points, column, degree) for column in np.moveaxis(values, 0, -1)]
        return np.stack([np.asarray(column) for column in columns], axis=-1).view(ExpressionArray)
    c_points, c_values = (ffi.cast("double*", data.ctypes.data) for data in (points, values))

    def at(argument: Any) -> Expression:
        expression = as_expression(argument)
        if expression._recording is not None:
            expression._recording.require_open()
        c = lib.sfdae_table(expression._c, int(degree), points.size, c_points, c_values)
        if expression._recording is not None and expression._recording.tape is not None:
            data = (int(degree), points, values)
            expression._recording.tape.add("sfdae_table", (expression._c,), c, data)
        return Expression(c, expression._recording)

    return elementwise(at, (a,))


def _of_scipy(a: Any, spline: Any) -> Any:
    kind = getattr(spline, "_kind", None)
    if kind is not None:  # interp1d
        degree = 1 if kind == "linear" else getattr(getattr(spline, "_spline", None), "k", 0)
        if degree not in (1, 3, 5, 7):
            raise TypeError(f"an interp1d of kind {kind!r} cannot be recorded: use 'cubic'")
        return table(a, spline.x, np.moveaxis(spline.y, spline.axis, 0), degree)
    if not callable(spline):
        raise TypeError(f"table needs points x and y, or a spline, not {spline!r}")
    if _is_table(spline):
        return table(a, spline.x, spline(spline.x))
    _require_one_value(spline)
    derivatives = _SplineDerivatives(spline)
    return elementwise(lambda argument: external("spline", derivatives, argument), (a,))


class _SplineDerivatives:
    """The derivatives of a spline of scipy, as sfdae.external needs them."""

    def __init__(self, spline: Any) -> None:
        self.spline = spline

    def __call__(self, order: int, arguments: Any) -> float:
        try:
            return float(self.spline(arguments[0], nu=order))
        except ValueError:  # UnivariateSpline, above its degree
            if order == 0:
                raise
            return 0.0


def _is_table(spline: Any) -> bool:
    """True for a cubic spline whose third derivative is continuous at the first and the last inner
    point: that is the table through these points.
    """
    c = getattr(spline, "c", None)
    if type(spline).__name__ != "CubicSpline" or len(c) != 4 or c.shape[1] < 3:
        return False
    if spline.axis != 0 or spline.extrapolate == "periodic":
        return False
    tolerance = 1e-9 * np.abs(c[0]).max() if c[0].size else 0.0
    return bool(np.all(np.abs(c[0][[0, -1]] - c[0][[1, -2]]) <= tolerance))


def _require_one_value(spline: Any) -> None:
    """TypeError unless the spline has one argument, a derivative, and one value."""
    try:
        points = next(getattr(spline, name) for name in ("x", "t") if hasattr(spline, name))
    except StopIteration:
        points = spline.get_knots() if hasattr(spline, "get_knots") else None
    try:
        value = spline(float(points[0]), nu=1)
    except (TypeError, ValueError):
        raise TypeError(
            f"{type(spline).__name__} is no spline of one argument with derivatives: use "
            "sfdae.external, or solve with record=False"
        ) from None
    if np.ndim(value) > 0:
        raise TypeError("a spline with several values at a point has to be recorded one by one")
