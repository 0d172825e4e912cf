# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of expressions: behavior of numpy's functions and operators on them.

numpy passes every call with such an array to __array_ufunc__ or __array_function__. An elementwise
function becomes a loop of numpy over objects that calls the function of expressions. All other
functions run numpy's own code on top of the elementwise ones, except those in _numpy.OWN.
"""

from __future__ import annotations

import sys
from typing import Any, Callable, Iterator, Mapping

import numpy as np

from ._expression import Condition, Expression, Recording, no_value

_LIKE = (
    "an array of numbers cannot hold expressions: make it with like=x, as in np.zeros(n, like=x) or "
    "np.array([...], like=x)"
)


class ExpressionArray(np.ndarray):
    """An array of expressions and numbers.

    It is an ndarray of objects, whose elementwise functions and comparisons are recorded. Arrays
    computed from it are of this class, and so are those created with ``like=x``.
    """

    _watch: Any = None  # records the names under which the unknowns are unpacked

    def __array_finalize__(self, source: Any) -> None:
        self._watch = getattr(source, "_watch", None)

    def __iter__(self) -> Iterator[Any]:
        if self._watch is not None:
            self._watch.note(self, sys._getframe(1))
        return super().__iter__()

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, (Expression, ExpressionArray)):
            raise no_value("it selects no elements", sys._getframe(1))
        return super().__getitem__(index)

    def __setitem__(self, index: Any, value: Any) -> None:
        if isinstance(index, (Condition, ExpressionArray)):  # out[x < 0] = 0
            if np.ndim(value) > 0 and np.shape(value) != self.shape:
                raise no_value("it selects no elements", sys._getframe(1))
            index, value = ..., np.where(index, value, self)
        super().__setitem__(index, value)

    def __eq__(self, other: Any) -> Any:
        raise no_value("== cannot be decided", sys._getframe(1))

    def __ne__(self, other: Any) -> Any:
        raise no_value("!= cannot be decided", sys._getframe(1))

    __hash__ = None  # type: ignore[assignment]

    def __matmul__(self, other: Any) -> Any:
        return np.matmul(self, other)  # also if other is a matrix of scipy.sparse

    def round(self, decimals: int = 0, out: Any = None) -> Any:
        """np.round of the elements."""
        return np.round(self, decimals, out)

    def clip(self, min: Any = None, max: Any = None, out: Any = None, **kwargs: Any) -> Any:
        """np.clip of the elements."""
        return np.clip(self, min, max, out, **kwargs)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        return apply_ufunc(ufunc, method, inputs, kwargs)

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return apply_array_function(function, args, kwargs)


_ANY = np.empty(0, dtype=object).view(ExpressionArray)


def vector(c_array: Any, count: int, recording: Recording | None) -> ExpressionArray:
    """The expressions of a C array."""
    result = np.empty(count, dtype=object)
    for i in range(count):
        result[i] = Expression(c_array[i], recording)
    return result.view(ExpressionArray)


def plain(value: Any) -> Any:
    """An expression or an array of them as an ndarray of objects; other values unchanged."""
    if isinstance(value, ExpressionArray):
        return value.view(np.ndarray)
    if isinstance(value, Expression):
        result = np.empty((), dtype=object)
        result[()] = value
        return result
    if isinstance(value, (list, tuple)):
        return np.array(value, dtype=object)
    return value


def wrapped(value: Any) -> Any:
    """A result of numpy: arrays of objects as ExpressionArray, those without axes as scalars."""
    if isinstance(value, np.ndarray):
        if value.dtype != object:
            return value
        is_one = value.ndim == 0 and isinstance(value[()], Expression)
        return value[()] if is_one else value.view(ExpressionArray)
    if isinstance(value, (list, tuple)):
        parts = [wrapped(part) for part in value]
        return parts if isinstance(value, list) else tuple(parts)
    return value


# ---- Elementwise functions -----------------------------------------------------------------------


def elementwise(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """A scalar function of the elements of arrays, broadcast; a scalar if all arguments are."""
    if not any(isinstance(argument, (np.ndarray, list, tuple)) for argument in arguments):
        return function(*arguments)
    return wrapped(np.frompyfunc(function, len(arguments), 1)(*map(plain, arguments)))


def apply_ufunc(
    ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], kwargs: Mapping[str, Any]
) -> Any:
    """A numpy function with an expression or an array of them among the operands."""
    from ._functions import OPERATORS, UFUNCS
    from ._numpy import matmul

    name = ufunc.__name__
    if name == "matmul" and method == "__call__":
        return _stored(matmul(*inputs), kwargs.get("out"))
    function = UFUNCS.get(name)
    if function is not None and method == "__call__" and not kwargs:
        if all(isinstance(operand, (Expression, float, int)) for operand in inputs):
            return function(*inputs)
    if function is None or name in OPERATORS:  # numpy's own loop over objects
        if "O" * ufunc.nin + "->" + "O" * ufunc.nout not in ufunc.types:
            known = ", ".join(sorted(UFUNCS))
            raise TypeError(
                f"np.{name} cannot be recorded; these can: {known}. record=False calls the function "
                "with numbers instead of recording it"
            )
        loop = ufunc
    else:
        loop = np.frompyfunc(function, ufunc.nin, ufunc.nout)
    if method == "at":
        if inputs[0].dtype != object:
            raise TypeError(_LIKE)
        return loop.at(plain(inputs[0]), inputs[1], *map(plain, inputs[2:]))
    options = {
        key: plain(value)
        for key, value in kwargs.items()
        if key not in ("out", "dtype", "casting", "order", "subok")
    }
    needs_identity = loop is not ufunc or "where" in options
    if method == "reduce" and needs_identity and ufunc.identity is not None:
        options.setdefault("initial", ufunc.identity)
    result = getattr(loop, method)(*map(plain, inputs), **options)
    return _stored(wrapped(result), kwargs.get("out"))


def _stored(result: Any, out: Any) -> Any:
    """The result, or the arrays `out` with the result in them."""
    if out is None:
        return result
    outputs = out if isinstance(out, tuple) else (out,)
    results = result if len(outputs) > 1 else (result,)
    for place, value in zip(outputs, results):
        if place is not None:
            if place.dtype != object:
                raise TypeError(_LIKE)
            place[...] = value
    return outputs[0] if len(outputs) == 1 else outputs


# ---- All other functions of numpy ----------------------------------------------------------------


def _with_arrays(value: Any) -> Any:
    """Expressions, also in lists, as arrays without axes: numpy's own code can use them."""
    if isinstance(value, Expression):
        return plain(value).view(ExpressionArray)
    if isinstance(value, (list, tuple)) and not hasattr(value, "_fields"):
        return type(value)(_with_arrays(part) for part in value)
    if type(value) is np.ndarray and value.dtype == object:
        return value.view(ExpressionArray)
    return value


def apply_array_function(
    function: Callable[..., Any], args: tuple[Any, ...], kwargs: Mapping[str, Any]
) -> Any:
    """A function of numpy, not elementwise, with expressions or arrays of them."""
    from ._numpy import OWN

    own = OWN.get(function)
    if own is not None:
        return wrapped(own(*args, **kwargs))
    args, kwargs = _with_arrays(args), {key: _with_arrays(value) for key, value in kwargs.items()}
    run = np.ndarray.__array_function__  # numpy's code without an override
    return wrapped(run(_ANY, function, (ExpressionArray,), args, kwargs))
