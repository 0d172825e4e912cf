# SPDX-License-Identifier: BSD-3-Clause
"""Functions of expressions, numbers and arrays of them; numpy's functions on expressions."""

from __future__ import annotations

import math
from typing import Any, Callable

import numpy as np

from ._binding import ffi, lib
from ._expression import Condition, Expression, _condition, as_expression


def _functions_of_c() -> dict[str, Callable[..., Expression]]:
    """All functions sfdae_<name> of the library from expressions to an expression, by name."""
    number = ffi.typeof("sfdae_expression")
    result = {}
    for name in dir(lib):
        if not name.startswith("sfdae_"):
            continue
        ctype = ffi.typeof(getattr(lib, name))
        if (
            ctype.kind == "function"
            and ctype.result is number
            and all(a is number for a in ctype.args)
        ):
            result[name.removeprefix("sfdae_")] = _of_expressions(
                getattr(lib, name), len(ctype.args)
            )
    return result


def _of_expressions(function: Callable[..., Any], count: int) -> Callable[..., Expression]:
    def call(*arguments: Any) -> Expression:
        if len(arguments) != count:
            raise TypeError(f"{count} arguments are needed, not {len(arguments)}")
        operands = [as_expression(argument) for argument in arguments]
        recording = None
        for operand in operands:
            if operand._recording is not None:
                operand._recording.require_open()
                recording = operand._recording
        return Expression(function(*(operand._c for operand in operands)), recording)

    return call


OF_C = _functions_of_c()


def _scalar_choose(condition: Any, a: Any, b: Any) -> Any:
    if isinstance(condition, (bool, np.bool_)):
        return a if condition else b
    if not isinstance(condition, Expression):
        return a if condition > 0 else b
    return OF_C["choose"](condition, a, b)


def _log_of_base(base: float) -> Callable[[Any], Expression]:
    return lambda a: OF_C["log"](a) / math.log(base)


# Those that numpy calls otherwise, and some that are made of others.
UFUNCS: dict[str, Callable[..., Any]] = {
    "add": OF_C["add"],
    "subtract": OF_C["subtract"],
    "multiply": OF_C["multiply"],
    "divide": OF_C["divide"],
    "true_divide": OF_C["divide"],
    "negative": OF_C["negate"],
    "positive": as_expression,
    "power": OF_C["power"],
    "float_power": OF_C["power"],
    "absolute": OF_C["abs"],
    "fabs": OF_C["abs"],
    "arcsin": OF_C["asin"],
    "arccos": OF_C["acos"],
    "arctan": OF_C["atan"],
    "arctan2": OF_C["atan2"],
    "minimum": OF_C["min"],
    "maximum": OF_C["max"],
    "fmin": OF_C["min"],
    "fmax": OF_C["max"],
    "square": lambda a: as_expression(a) * a,
    "reciprocal": lambda a: 1 / as_expression(a),
    "hypot": lambda a, b: OF_C["sqrt"](as_expression(a) * a + as_expression(b) * b),
    "exp2": lambda a: OF_C["exp"](as_expression(a) * math.log(2.0)),
    "expm1": lambda a: 2 * OF_C["exp"](as_expression(a) / 2) * OF_C["sinh"](as_expression(a) / 2),
    "log2": _log_of_base(2.0),
    "remainder": OF_C["modulo"],
    "floor_divide": lambda a, b: as_expression(a) // b,
    "logical_and": lambda a, b: _condition(lib.sfdae_and, a, b),
    "logical_or": lambda a, b: _condition(lib.sfdae_or, a, b),
    "logical_not": lambda a: ~_condition(lib.sfdae_greater, a, 0.0),
    "degrees": lambda a: as_expression(a) * (180.0 / math.pi),
    "radians": lambda a: as_expression(a) * (math.pi / 180.0),
    "greater": lambda a, b: as_expression(a) > b,
    "greater_equal": lambda a, b: as_expression(a) >= b,
    "less": lambda a, b: as_expression(a) < b,
    "less_equal": lambda a, b: as_expression(a) <= b,
}
UFUNCS["rad2deg"], UFUNCS["deg2rad"] = UFUNCS["degrees"], UFUNCS["radians"]
for _name, _function in OF_C.items():  # sin, exp, ...: the same name
    if isinstance(getattr(np, _name, None), np.ufunc):
        UFUNCS[_name] = _function

# numpy's loops over objects call methods of these names: np.sin(np.array([x[0], x[1]])).
_OPERATORS = {
    "add",
    "subtract",
    "multiply",
    "divide",
    "true_divide",
    "negative",
    "positive",
    "absolute",
}
_OPERATORS |= {"remainder", "floor_divide"}
_OPERATORS |= {"power", "greater", "greater_equal", "less", "less_equal"}
for _name in sorted(UFUNCS.keys() - _OPERATORS):
    setattr(Expression, _name, UFUNCS[_name])
Expression.conjugate = as_expression  # np.vdot, np.linalg.norm


def _elementwise(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """A scalar function of the elements of arrays, broadcast; a scalar if all arguments are."""
    if not any(isinstance(argument, (np.ndarray, list, tuple)) for argument in arguments):
        return function(*arguments)
    arrays = [_as_array(argument) for argument in arguments]
    shape = np.broadcast_shapes(*(array.shape for array in arrays))
    flat = [np.broadcast_to(array, shape).ravel() for array in arrays]
    result = np.empty(flat[0].size, dtype=object)
    for i, elements in enumerate(zip(*flat)):
        result[i] = function(*elements)
    return result.reshape(shape)


def _as_array(value: Any) -> np.ndarray:
    if isinstance(value, np.ndarray):
        return value
    if isinstance(value, (Expression, Condition)):
        result = np.empty((), dtype=object)
        result[()] = value
        return result
    return np.array(value, dtype=object)


def apply_ufunc(
    ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], kwargs: dict[str, Any]
) -> Any:
    """A function of numpy where one of the operands is an expression."""
    if method == "__call__" and not kwargs and ufunc.__name__ in UFUNCS:
        return _elementwise(UFUNCS[ufunc.__name__], inputs)
    if ufunc.__name__ == "matmul" and method == "__call__":
        raise TypeError("matmul: @ needs vectors or matrices, use * for a single expression")
    out = kwargs.get("out")
    if (
        method in ("__call__", "at")
        and ufunc.__name__ in UFUNCS
        and out is not None
        and len(out) == 1
    ):
        if (
            not isinstance(out[0], np.ndarray) or out[0].dtype != object
        ):  # x += expression, x an array of floats
            raise TypeError(
                "an expression cannot be stored in an array of numbers: use dtype=object for it"
            )
        out[0][...] = _elementwise(UFUNCS[ufunc.__name__], inputs)
        return out[0]
    known = ", ".join(sorted(UFUNCS))
    raise TypeError(f"np.{ufunc.__name__} cannot be recorded; these can: {known}")


def apply_array_function(function: Callable, args: Any, kwargs: Any) -> Any:
    """np.where with a comparison of expressions; everything else as numpy does it for objects."""
    if function is np.where and len(args) == 3 and not kwargs:
        return choose(*args)
    wrapped = [
        _as_array(argument) if isinstance(argument, Expression) else argument for argument in args
    ]
    if any(
        isinstance(argument, (Expression, Condition)) for argument in [*wrapped, *kwargs.values()]
    ):
        return NotImplemented
    return function(*wrapped, **kwargs)


def _is_recorded(value: Any) -> bool:
    if isinstance(value, (Expression, Condition)):
        return True
    if isinstance(value, (list, tuple)):
        return any(_is_recorded(element) for element in value)
    return isinstance(value, np.ndarray) and value.dtype == object


def _public(name: str, ufunc: np.ufunc) -> Callable[..., Any]:
    """A function that serves expressions, numbers and arrays of both."""

    def function(*arguments: Any) -> Any:
        if any(_is_recorded(argument) for argument in arguments):
            return _elementwise(UFUNCS[ufunc.__name__], arguments)
        return ufunc(*arguments)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = f"np.{ufunc.__name__} of expressions, numbers, or arrays that contain both."
    return function


def choose(condition: Any, a: Any, b: Any) -> Any:
    """a where the condition holds, else b; the other one need not be defined. Arrays are broadcast.

    Parameters
    ----------
    condition : Condition, Expression, bool or array of these
        A comparison such as ``x[0] > 1``, or an expression, which means that it is > 0.
    a, b : Expression, float or arrays of these
    """
    return _elementwise(_scalar_choose, (condition, a, b))


def derivative(a: Any, variable: Any) -> Any:
    """The derivative of a formula by a variable, all others held; arrays are broadcast.

    ``derivative(lam * g, q)`` is the force of a constraint g(q) = 0 on the positions q.

    Parameters
    ----------
    a : Expression, float or array of these
    variable : Expression or array of these
        t, unknowns or their derivatives as they were handed to the function that writes the
        equations, or parameters.
    """
    return _elementwise(OF_C["derivative"], (a, variable))


def time_derivative(a: Any) -> Any:
    """The total derivative along time of formulas in t and x, in which x' appears.

    Parameters
    ----------
    a : Expression, float or array of these
        Without x' in it, whose derivative is no variable, and not of a MultibodyProblem.
    """
    return _elementwise(OF_C["time_derivative"], (a,))


def table(a: Any, x: Any, y: Any, degree: int = 3) -> Any:
    """The value at a of the spline through points (x, y); see sfdae_table of the C library.

    Outside of the data there is no value: hold the ends with ``np.clip``, or rather
    ``np.minimum`` and ``np.maximum``, or use ``a % period``.

    Parameters
    ----------
    a : Expression, float or array of these
    x, y : array_like
        At least degree + 1 points, x increasing.
    degree : int
        1, 3, 5 or 7.
    """
    points, values = (np.ascontiguousarray(data, dtype=float) for data in (x, y))
    if points.ndim != 1 or points.shape != values.shape:
        raise ValueError(f"x and y have the shapes {points.shape} and {values.shape}")
    c_points, c_values = (ffi.cast("double*", data.ctypes.data) for data in (points, values))

    def at(argument: Any) -> Expression:
        expression = as_expression(argument)
        if expression._recording is not None:
            expression._recording.require_open()
        c = lib.sfdae_table(expression._c, int(degree), points.size, c_points, c_values)
        return Expression(c, expression._recording)

    return _elementwise(at, (a,))


def external(name: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """The value of a function that formulas cannot express; see sfdae_external of the C library.

    Parameters
    ----------
    name : str
        For messages.
    function : callable
        ``function(order, arguments)`` returns all partial derivatives of an order at k numbers, an
        array of shape (k,) * order, a number for order 0; None if they are not available.
    *arguments : Expression or float
        k of them, at least one of them an expression.
    """
    from ._callbacks import external_value

    return external_value(name, function, [as_expression(argument) for argument in arguments])


PUBLIC = {
    name: _public(name, ufunc)
    for name, ufunc in {
        "sqrt": np.sqrt, "exp": np.exp, "log": np.log, "sin": np.sin, "cos": np.cos, "tan": np.tan,
        "arcsin": np.arcsin, "arccos": np.arccos, "arctan": np.arctan, "arctan2": np.arctan2,
        "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh, "absolute": np.absolute,
        "minimum": np.minimum, "maximum": np.maximum, "log10": np.log10, "sign": np.sign,
        "floor": np.floor, "mod": np.mod,
    }.items()
}  # fmt: skip
