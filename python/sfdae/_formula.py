# SPDX-License-Identifier: BSD-3-Clause
"""User-supplied functions that write formulas: their parameters and results."""

from __future__ import annotations

from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ._arguments import Arguments, is_same
from ._binding import ffi, lib
from ._expression import Expression, Recording, as_expression, parameter


class Formula:
    """A function whose first arguments are passed by the library and whose others are named
    parameters.

    Attributes
    ----------
    positional : tuple of str
        The arguments that the library passes.
    defaults : dict
        Default values of the named parameters, None without a default.
    """

    def __init__(self, function: Callable[..., Any], positional: Sequence[str], name: str) -> None:
        self.positional = tuple(positional)
        self.arguments = Arguments(function, positional, name)
        self.function = function
        self.name = name
        self.defaults = self.arguments.defaults

    def __call__(self, *arguments: Any, values: Mapping[str, Any]) -> Any:
        """The formulas; each parameter is recorded in the recording of `arguments`."""
        return self.function(*arguments, **self.recorded(arguments[0], values))

    def recorded(self, inside: Any, values: Mapping[str, Any]) -> dict[str, Any]:
        """The named parameters, recorded in the recording of `inside`."""
        return {name: recorded_parameter(inside, name, values[name]) for name in self.defaults}


def recorded_parameter(inside: Any, name: str, value: Any) -> Any:
    """A parameter, or an array of parameters ``name[0]``, ``name[1]``, ..."""
    if not isinstance(inside, Expression):
        return value
    if np.ndim(value) == 0:
        return parameter(inside, name, value)
    result = np.empty(np.shape(value), dtype=object)
    for i, entry in enumerate(np.ravel(value)):
        result.flat[i] = parameter(inside, f"{name}[{i}]", entry)
    return result


def parameter_values(
    formulas: Sequence[Formula], given: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Values of all named parameters: those given, else the defaults of the functions.

    Raises
    ------
    TypeError
        For a name that no function has, for a parameter without a value, and for a parameter with
        several defaults and no given value.
    ValueError
        For a value that is not finite.
    """
    values: dict[str, Any] = {}
    source: dict[str, str] = {}  # the function that a default belongs to
    for formula in formulas:
        for name, default in formula.defaults.items():
            if values.get(name) is None:
                values[name], source[name] = default, formula.name
            elif not (default is None or name in (given or {}) or is_same(default, values[name])):
                raise TypeError(
                    f"parameter {name!r} has two defaults, {values[name]!r} of {source[name]} and "
                    f"{default!r} of {formula.name}: functions of a problem share their "
                    f"parameters. Give parameters={{{name!r}: ...}}, or choose another name"
                )
    for name, value in (given or {}).items():
        if name not in values:
            known = ", ".join(values) or "none"
            raise TypeError(f"there is no parameter {name!r}; parameters of the equations: {known}")
        values[name] = value
    for name, value in values.items():
        if value is None:
            raise TypeError(
                f"parameter {name!r} has no value: give it a default, or "
                f"parameters={{{name!r}: ...}}; an array that takes the residuals is called res"
            )
        values[name] = checked_value(name, value)
    return values


def checked_value(name: str, value: Any) -> Any:
    """A finite number, or an array of finite numbers."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(
            f"parameter {name!r} has to be a number or an array of numbers, not {value!r}"
        ) from None
    if not np.all(np.isfinite(array)):
        raise ValueError(f"parameter {name!r} is not finite: {value!r}")
    return float(array) if array.ndim == 0 else array


def flatten(value: Any, name: str) -> list[Any]:
    """The entries of nested sequences and arrays, in order."""
    if isinstance(value, (Expression, float, int)):
        return [value]
    if value is None:
        raise TypeError(f"{name} returned nothing: it has to return its formulas")
    if isinstance(value, np.ndarray):
        return list(value.ravel())
    if isinstance(value, (str, bytes, dict)):
        raise TypeError(f"{name} returned {type(value).__name__}, not formulas")
    try:
        parts = list(value)
    except TypeError:
        return [value]
    return [entry for part in parts for entry in flatten(part, name)]


def write_formulas(places: Any, value: Any, shape: tuple[int, ...], name: str) -> None:
    """Writes a vector or a matrix of formulas to places of C, column-major."""
    array = value if isinstance(value, np.ndarray) else _object_array(value, name)
    if len(shape) == 2 and array.ndim == 1 and shape[0] == shape[1] == array.size:  # a diagonal
        diagonal, array = array, np.zeros(shape, dtype=object)
        np.fill_diagonal(array, diagonal)
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, not {shape}")
    for i, entry in enumerate(array.ravel(order="F")):
        if type(entry) is not float or entry != 0.0:
            places[i] = as_expression(entry)._c
        else:
            places[i] = lib.sfdae_number(0.0)


def _object_array(value: Any, name: str) -> np.ndarray:
    if value is None:
        raise TypeError(f"{name} returned nothing: it has to return its formulas")
    try:
        return np.array(value, dtype=object)
    except ValueError:  # rows of different lengths
        raise ValueError(f"{name} is no vector or matrix: {value!r}") from None


def probe(count: int) -> np.ndarray:
    """Plain numbers in place of unknowns, to determine the shape of formulas."""
    return np.array([Expression(lib.sfdae_number(1.0), None) for _ in range(count)], dtype=object)


def open_recording(record: Any) -> Recording:
    """The recording that the library has begun."""
    return Recording(ffi.cast("sfdae_record*", record))
