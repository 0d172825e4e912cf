# SPDX-License-Identifier: BSD-3-Clause
"""Functions of expressions, numbers and arrays of them; numpy's functions on expressions."""

from __future__ import annotations

import math
from typing import Any, Callable

import numpy as np

from ._arrays import elementwise
from ._binding import ffi, lib
from ._expression import Condition, Expression, _condition, applied, as_expression


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
        return applied(function, recording, *(operand._c for operand in operands))

    return call


OF_C = _functions_of_c()


def truth(a: Any) -> Any:
    """The truth value as in numpy: a comparison that holds, and every number but 0."""
    if isinstance(a, Condition) or not isinstance(a, Expression):
        return a if isinstance(a, Condition) else bool(a)
    return (a < 0.0) | (a > 0.0)


def _scalar_choose(condition: Any, a: Any, b: Any) -> Any:
    if isinstance(condition, (bool, np.bool_)):
        return a if condition else b
    if not isinstance(condition, Expression):
        return a if condition > 0 else b
    return OF_C["choose"](condition, a, b)


def _log_of_base(base: float) -> Callable[[Any], Expression]:
    return lambda a: OF_C["log"](a) / math.log(base)


def _xor(a: Any, b: Any) -> Any:
    both, either = _condition(lib.sfdae_and, a, b), _condition(lib.sfdae_or, a, b)
    return either & ~both


def _logical(name: str, function: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """A function of two truth values for the operators &, | and ^."""

    def call(a: Any, b: Any) -> Any:
        for operand in (a, b):
            if not isinstance(operand, (Condition, bool, np.bool_)):
                raise TypeError(f"{name} combines comparisons, not {type(operand).__name__}")
        return function(a, b)

    return call


def _not(a: Any) -> Any:
    return _condition(lib.sfdae_less_equal, a, 0.0)


def _invert(a: Any) -> Any:
    if not isinstance(a, (Condition, bool, np.bool_)):
        raise TypeError(f"~ inverts comparisons, not {type(a).__name__}")
    return _not(a)


def _rint(a: Any) -> Any:
    """The nearest integer, the even one of two."""
    up = OF_C["floor"](as_expression(a) + 0.5)
    return up - (up % 2) * _condition(lib.sfdae_less_equal, as_expression(a) + 0.5, up)


def rounded(a: Any, decimals: int | None = None) -> Any:
    """np.round of a number or an expression."""
    unit = 10.0 ** (decimals or 0)
    return _rint(as_expression(a) * unit) / unit


def _ceil(a: Any) -> Any:
    return -OF_C["floor"](-as_expression(a))


def _trunc(a: Any) -> Any:
    return OF_C["choose"](a, OF_C["floor"](a), _ceil(a))


def _heaviside(a: Any, at_zero: Any) -> Any:
    below = _condition(lib.sfdae_less, a, 0.0)
    return OF_C["choose"](a, 1.0, OF_C["choose"](below, 0.0, at_zero))


def _cbrt(a: Any) -> Any:
    a = as_expression(a)
    return OF_C["sign"](a) * OF_C["power"](OF_C["abs"](a), 1.0 / 3.0)


def _arcsinh(a: Any) -> Any:
    a = as_expression(a)
    root = OF_C["sqrt"](a * a + 1)
    return OF_C["choose"](a, OF_C["log"](root + a), -OF_C["log"](root - a))


def _arccosh(a: Any) -> Any:
    a = as_expression(a)
    return OF_C["log"](a + OF_C["sqrt"](a * a - 1))


def _arctanh(a: Any) -> Any:
    a = as_expression(a)
    return OF_C["log"]((1 + a) / (1 - a)) / 2


def _logaddexp(a: Any, b: Any) -> Any:
    larger = OF_C["max"](a, b)
    return larger + OF_C["log"](OF_C["exp"](a - larger) + OF_C["exp"](b - larger))


def _divmod(a: Any, b: Any) -> Any:
    return as_expression(a) // b, as_expression(a) % b


def _erf(order: int, arguments: Any) -> float:
    """erf and its derivatives: Hermite polynomials times exp(-a^2)."""
    a = float(arguments[0])
    if order == 0:
        return math.erf(a)
    before, now = 0.0, 1.0  # H_0 = 1, H_(k+1) = 2 a H_k - 2 k H_(k-1)
    for k in range(order - 1):
        before, now = now, 2 * a * now - 2 * k * before
    return (-1) ** (order - 1) * 2 / math.sqrt(math.pi) * now * math.exp(-a * a)


def _erfc(order: int, arguments: Any) -> float:
    """erfc and its derivatives."""
    return math.erfc(float(arguments[0])) if order == 0 else -_erf(order, arguments)


# Functions with other names in numpy, and some composed of others.
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
    "rint": _rint,
    "ceil": _ceil,
    "trunc": _trunc,
    "heaviside": _heaviside,
    "cbrt": _cbrt,
    "arcsinh": _arcsinh,
    "arccosh": _arccosh,
    "arctanh": _arctanh,
    "log1p": lambda a: OF_C["log"](1 + as_expression(a)),
    "logaddexp": _logaddexp,
    "copysign": lambda a, b: OF_C["choose"](_condition(lib.sfdae_less, b, 0.0), -abs(a), abs(a)),
    "fmod": lambda a, b: as_expression(a) - b * _trunc(as_expression(a) / b),
    "divmod": _divmod,
    "clip": lambda a, low, high: OF_C["min"](OF_C["max"](a, low), high),
    "conjugate": as_expression,
    "square": lambda a: as_expression(a) * a,
    "reciprocal": lambda a: 1 / as_expression(a),
    "hypot": lambda a, b: OF_C["sqrt"](as_expression(a) * a + as_expression(b) * b),
    "exp2": lambda a: OF_C["exp"](as_expression(a) * math.log(2.0)),
    "expm1": lambda a: 2 * OF_C["exp"](as_expression(a) / 2) * OF_C["sinh"](as_expression(a) / 2),
    "log2": _log_of_base(2.0),
    "remainder": OF_C["modulo"],
    "floor_divide": lambda a, b: as_expression(a) // b,
    "logical_and": lambda a, b: _condition(lib.sfdae_and, truth(a), truth(b)),
    "logical_or": lambda a, b: _condition(lib.sfdae_or, truth(a), truth(b)),
    "logical_not": lambda a: _not(truth(a)),
    "logical_xor": lambda a, b: _xor(truth(a), truth(b)),
    "bitwise_and": _logical("&", lambda a, b: _condition(lib.sfdae_and, a, b)),
    "bitwise_or": _logical("|", lambda a, b: _condition(lib.sfdae_or, a, b)),
    "bitwise_xor": _logical("^", _xor),
    "invert": _invert,
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
        UFUNCS.setdefault(_name, _function)
# Those of scipy.special.
OF_SCIPY: dict[str, Callable[..., Any]] = {
    "erf": lambda a: external("erf", _erf, a),
    "erfc": lambda a: external("erfc", _erfc, a),
    "expit": lambda a: (1 + OF_C["tanh"](as_expression(a) / 2)) / 2,
    "xlogy": lambda a, b: as_expression(a) * OF_C["log"](b),
}

# Operators of expressions: numpy's loops over objects call them.
OPERATORS = {
    "add",
    "subtract",
    "multiply",
    "divide",
    "true_divide",
    "negative",
    "positive",
    "absolute",
    "power",
}
OPERATORS |= {"remainder", "floor_divide"}
_COMPARISONS = {"greater", "greater_equal", "less", "less_equal"}
# The loops over plain arrays, np.sin(np.array([x[0], x[1]])), call methods of these names.
for _name in sorted(UFUNCS.keys() - OPERATORS - _COMPARISONS):
    setattr(Expression, _name, UFUNCS[_name])
for _name in ("floor", "ceil", "trunc"):  # math.floor(a)
    setattr(Expression, f"__{_name}__", UFUNCS[_name])
setattr(Expression, "__round__", rounded)
UFUNCS.update(OF_SCIPY)


def _is_recorded(value: Any) -> bool:
    if isinstance(value, Expression):
        return True
    if isinstance(value, (list, tuple)):
        return any(_is_recorded(element) for element in value)
    return isinstance(value, np.ndarray) and value.dtype == object


def _public(name: str, ufunc: np.ufunc) -> Callable[..., Any]:
    """A function for expressions, numbers and arrays of both."""

    def function(*arguments: Any) -> Any:
        if any(_is_recorded(argument) for argument in arguments):
            return elementwise(UFUNCS[ufunc.__name__], arguments)
        return ufunc(*arguments)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = f"np.{ufunc.__name__} of expressions, numbers, or arrays that contain both."
    return function


def choose(condition: Any, a: Any, b: Any) -> Any:
    """a if the condition holds, else b; the other one may be undefined. Arrays are broadcast.

    Parameters
    ----------
    condition : Condition, Expression, bool or array of these
        A comparison such as ``x[0] > 1``, or an expression, which means that it is > 0.
    a, b : Expression, float or arrays of these
    """
    return elementwise(_scalar_choose, (condition, a, b))


def where(condition: Any, a: Any, b: Any) -> Any:
    """np.where: as choose, but numbers and expressions are true unless they are 0."""
    return elementwise(lambda c, u, v: _scalar_choose(truth(c), u, v), (condition, a, b))


def derivative(a: Any, variable: Any) -> Any:
    """The derivative of a formula with respect to a variable; arrays are broadcast.

    ``derivative(lam * g, q)`` is the force of a constraint g(q) = 0 on the positions q.

    Parameters
    ----------
    a : Expression, float or array of these
    variable : Expression or array of these
        t, unknowns or their derivatives as passed to the function that writes the equations, or
        parameters.
    """
    return elementwise(OF_C["derivative"], (a, variable))


def time_derivative(a: Any) -> Any:
    """The total derivative along time of formulas in t and x, in which x' appears.

    Parameters
    ----------
    a : Expression, float or array of these
        Without x', whose derivative is not a variable, and not in a MultibodyProblem.
    """
    return elementwise(OF_C["time_derivative"], (a,))


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
