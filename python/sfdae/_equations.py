# SPDX-License-Identifier: BSD-3-Clause
"""Equations F(t, x, x') = 0 as functions: residuals are returned or written to an array, or M x' =
f(t, x).
"""

from __future__ import annotations

import inspect
from typing import Any, Callable, Mapping

import numpy as np

from ._arrays import ExpressionArray
from ._expression import Expression
from ._formula import Formula, flatten
from ._numpy import matmul
from ._status import CannotEvaluate

# The argument after xdot that takes the residuals has one of these names and no default.
RESIDUALS = ("res", "resid", "residual", "residuals", "result", "out")


class Equations(Formula):
    """A function of (t, x, xdot), or with a mass matrix of (t, x), and named parameters.

    Attributes
    ----------
    mass : array, matrix of scipy.sparse or Formula, optional
        M of M x' = f(t, x), or a function ``M(t)`` or ``M(t, x)`` and named parameters.
    residuals : str or None
        The argument to which the function writes its residuals.
    """

    def __init__(self, function: Callable[..., Any], mass: Any = None) -> None:
        positional = ("t", "x", "xdot") if mass is None else ("t", "x")
        try:
            super().__init__(function, positional, "equations")
        except TypeError as error:
            if mass is None and _count_arguments(function) == 2:
                raise TypeError(
                    f"{error}. For x' = f(t, x) add mass=1, for M x' = f(t, x) add mass=M"
                ) from None
            raise
        self.mass = _mass_formula(mass, self.defaults) if callable(mass) else mass
        first = next(iter(self.defaults), None)
        is_written = mass is None and first in self.arguments.required and first in RESIDUALS
        self.residuals = first if is_written else None
        if is_written:
            del self.defaults[first]

    @property
    def formulas(self) -> list[Formula]:
        """All functions with named parameters."""
        return [self, self.mass] if isinstance(self.mass, Formula) else [self]

    def __call__(self, *arguments: Any, values: Mapping[str, Any], count: int = 0) -> Any:
        """The formulas, nested as the function returns them. count: m, for an array to fill."""
        if self.residuals is not None:
            return self._filled(arguments, values, count)
        if self.mass is None:
            return super().__call__(*arguments, values=values)
        t, x, xdot = arguments
        right = super().__call__(t, x, values=values)
        return self._times_mass(t, x, xdot, values) - _vector(right, self.name)

    def _filled(self, arguments: tuple[Any, ...], values: Mapping[str, Any], count: int) -> Any:
        is_recorded = isinstance(arguments[0], Expression)
        array = np.full(count, None if is_recorded else np.nan)
        array = array.view(ExpressionArray) if is_recorded else array
        named = {**self.recorded(arguments[0], values), str(self.residuals): array}
        result = self.function(*arguments, **named)
        if not (result is None or isinstance(result, (int, np.integer))):
            return result  # the array itself, or formulas
        if result is not None and result > 0:
            raise CannotEvaluate(f"{self.name} returned {result}")
        if result is not None and result < 0:
            raise RuntimeError(f"{self.name} returned {result}")
        for i, entry in enumerate(np.asarray(array)):
            if entry is None:
                raise TypeError(f"{self.name} did not write entry {i} of {self.residuals}")
        return array

    def _times_mass(self, t: Any, x: Any, xdot: Any, values: Mapping[str, Any]) -> Any:
        M = self.mass
        if isinstance(M, Formula):
            M = M(*(t, x)[: len(M.positional)], values=values)
        if not hasattr(M, "tocsr"):  # scipy.sparse
            M = np.asarray(M)
        if M.ndim < 2:
            return M * xdot  # a number, or a diagonal
        if M.shape[1] != len(xdot):
            raise ValueError(f"mass has shape {M.shape}, not (m, {len(xdot)})")
        return matmul(M, xdot) if isinstance(t, Expression) else M @ xdot


def _mass_formula(function: Callable[..., Any], parameters: Mapping[str, Any]) -> Formula:
    """M(t) or M(t, x). A second argument is x if it has this name, or has no default and is not a
    parameter of f.
    """
    try:
        places = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):  # functions of C have no signature
        return Formula(function, ("t", "x"), "mass")
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    second = [p for p in places if p.kind in kinds][1:2]
    takes_x = any(p.name == "x" or p.kind == p.VAR_POSITIONAL for p in places) or any(
        p.default is p.empty and p.name not in parameters for p in second
    )
    return Formula(function, ("t", "x") if takes_x else ("t",), "mass")


def _count_arguments(function: Callable[..., Any]) -> int:
    """The number of positional arguments without a default; 0 if it is unknown."""
    try:
        places = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return 0
    if any(p.kind == p.VAR_POSITIONAL for p in places):
        return 0
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(p.kind in kinds and p.default is p.empty for p in places)


def _vector(value: Any, name: str) -> Any:
    entries = flatten(value, name)
    return np.array([*entries, None], dtype=object)[:-1]
