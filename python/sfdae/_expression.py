# SPDX-License-Identifier: BSD-3-Clause
"""Numbers and parts of formulas that are being recorded."""

from __future__ import annotations

import dis
import numbers
import sys
from typing import Any, Callable

import numpy as np

from ._binding import ffi, lib

_NO_VALUE = "an expression has no value while equations are recorded, so that {}. {}"
_AS_NUMBERS = "record=False calls the function with numbers instead of recording it"
_BRANCHES = "Use np.where(a > b, ...), np.maximum(a, b), np.minimum(a, b) or sfdae.choose. "
_EQUALITY = "Use np.where(abs(a - b) < c, ...). "
_ARRAYS = "Arrays of expressions need like=x: np.array([...], like=x), np.zeros(n, like=x). "
_NUMBERS = "Use np.sin, np.exp, ... (not those of math), and np.zeros(n, like=x) for arrays. "


# Replacements for code of other packages that needs numbers, by the name of the module.
_INSTEAD = {
    "scipy.sparse": "write x @ A.T instead of A @ x. ",
    "scipy.interpolate": "write sfdae.table(t, spline) instead of spline(t). ",
    "scipy": "",
    "numba": "",
}


def _hint(modules: list[str]) -> str | None:
    """Advice if code of these modules, one per frame, needs numbers; None for other modules."""
    for start, instead in _INSTEAD.items():
        for module in modules:
            if module.startswith(start):
                return f"{start} needs numbers: {instead}"
    return None


def no_value(what: str, frame: Any) -> TypeError:
    """The error of code that needs a value, with the change required in the code of this frame."""
    modules = [frame.f_globals.get("__name__", "")]
    while frame.f_back is not None and modules[-1].split(".")[0] in ("numpy", "sfdae"):
        frame = frame.f_back
        modules.append(frame.f_globals.get("__name__", ""))
    code = frame.f_code.co_code
    operation = dis.opname[code[frame.f_lasti]] if 0 <= frame.f_lasti < len(code) else ""
    hint = _hint(modules)
    if hint is None and what.startswith(("==", "!=")):
        hint = _EQUALITY
    elif hint is None and operation.startswith(("STORE_S", "COMPARE_OP")):  # STORE_SUBSCR, _SLICE
        hint = _ARRAYS
    elif hint is None and what == "it is no float":
        hint = _NUMBERS
    elif hint is None:  # max(a, b), or np.maximum of an array made by np.array
        hint = _BRANCHES + (_ARRAYS if "CALL" in operation else "")
    return TypeError(_NO_VALUE.format(what, hint) + _AS_NUMBERS)


def explain(exception: BaseException, traceback: Any) -> None:
    """Adds advice to an exception of another package raised while equations are recorded."""
    modules = []
    while traceback is not None:
        modules.append(traceback.tb_frame.f_globals.get("__name__", ""))
        traceback = traceback.tb_next
    hint, text = _hint(modules), str(exception)
    if hint is None and "dtype('O')" in text:  # numpy, of an array made without like=x
        hint = _ARRAYS
    elif hint is None and "Expression" in text:  # as Python calls what it cannot use
        hint = ""
    is_explained = hint is None or "record=False" in text or not exception.args
    if is_explained or not isinstance(exception, Exception):
        return
    if not isinstance(exception.args[0], str):  # UFuncTypeError makes its text of other arguments
        raise TypeError(f"{text} ({hint}{_AS_NUMBERS})") from exception
    exception.args = (f"{text} ({hint}{_AS_NUMBERS})", *exception.args[1:])


class Recording:
    """An open recording; its expressions are unusable after it has ended."""

    __slots__ = ("c", "is_open", "state", "refused", "tape")

    def __init__(self, record: Any, state: Any = None) -> None:
        self.c = record
        self.is_open = True
        self.state = state  # of the callbacks of the solver, which stores objects needed later
        self.refused: TypeError | None = None  # == was used; numpy < 1.25 ignores the exception
        self.tape: Any = None  # a Tape, to which all operations are added

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, kind: Any, exception: BaseException | None, traceback: Any) -> None:
        self.is_open = False
        refused, self.refused = (
            self.refused,
            None,
        )  # no cycle through arrays, which are not collected
        if exception is not None:
            explain(exception, traceback)
        elif refused is not None:
            raise refused

    def require_open(self) -> None:
        if not self.is_open:
            raise RuntimeError(
                "this expression belongs to a recording that has ended: t, x, xdot and what is "
                "made of them can only be used within the function that writes the equations"
            )


def _as_c(value: Any) -> Any:
    """A number as a C expression, or None for other values."""
    if isinstance(value, (float, int, np.floating, np.integer, np.bool_)):
        return lib.sfdae_number(float(value))
    if isinstance(value, numbers.Real):
        return lib.sfdae_number(float(value))
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return _as_c(value.item())
    return None


def _describe(value: Any) -> str:
    return f"{type(value).__name__} {value!r}"[:80]


def as_expression(value: Any) -> Expression:
    """An expression or a real number as an expression.

    Raises
    ------
    TypeError
        For anything else.
    """
    if isinstance(value, Expression):
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
        if isinstance(value, Expression):
            return value
    c = _as_c(value)
    if c is None:
        raise TypeError(f"an expression or a real number is needed, not {_describe(value)}")
    return Expression(c, None)


def applied(
    function: Callable[..., Any], recording: Recording | None, *operands: Any
) -> Expression:
    """The result of a function of C from expressions of C to one of them."""
    c = function(*operands)
    if recording is not None and recording.tape is not None:
        recording.tape.add(function.__name__, operands, c)
    return Expression(c, recording)


_Operator = Callable[["Expression", Any], "Expression"]


def _operator(function: Callable[[Any, Any], Any]) -> tuple[_Operator, _Operator]:
    """The methods a (op) b and b (op) a for a function of C with two operands."""

    def forward(self: Expression, other: Any) -> Expression:
        recording = self._recording
        if recording is not None and not recording.is_open:
            recording.require_open()
        if isinstance(other, Expression):
            if other._recording is not recording and other._recording is not None:
                other._recording.require_open()
                recording = other._recording
            operand = other._c
        else:
            operand = _as_c(other)
            if operand is None:
                return NotImplemented
        if recording is not None and recording.tape is not None:
            return applied(function, recording, self._c, operand)
        return Expression(function(self._c, operand), recording)

    def reflected(self: Expression, other: Any) -> Expression:
        c = _as_c(other)
        if c is None:
            return NotImplemented
        if self._recording is not None:
            self._recording.require_open()
        return applied(function, self._recording, c, self._c)

    return forward, reflected


class Expression:
    """A number, or a part of a formula that is being recorded.

    Operators, numpy's functions (``np.sin(x[0])``, also of arrays of expressions) and the functions
    of this package (``sfdae.sin``, ``sfdae.choose``) combine expressions. They have no values to
    branch on: ``if x > 0`` is an error, ``np.where(x > 0, a, b)`` is recorded.
    """

    __slots__ = ("_c", "_recording")

    def __init__(self, c: Any, recording: Recording | None) -> None:
        self._c = c
        self._recording = recording

    __add__, __radd__ = _operator(lib.sfdae_add)
    __sub__, __rsub__ = _operator(lib.sfdae_subtract)
    __mul__, __rmul__ = _operator(lib.sfdae_multiply)
    __truediv__, __rtruediv__ = _operator(lib.sfdae_divide)
    __pow__, __rpow__ = _operator(lib.sfdae_power)
    __mod__, __rmod__ = _operator(lib.sfdae_modulo)

    def __floordiv__(self, other: Any) -> Expression:
        quotient = self.__truediv__(other)
        return quotient if quotient is NotImplemented else quotient._apply(lib.sfdae_floor)

    def __rfloordiv__(self, other: Any) -> Expression:
        quotient = self.__rtruediv__(other)
        return quotient if quotient is NotImplemented else quotient._apply(lib.sfdae_floor)

    def __divmod__(self, other: Any) -> Any:
        return self // other, self % other

    def __rdivmod__(self, other: Any) -> Any:
        return other // self, other % self

    def __neg__(self) -> Expression:
        return self._apply(lib.sfdae_negate)

    def __pos__(self) -> Expression:
        return self

    def __abs__(self) -> Expression:
        return self._apply(lib.sfdae_abs)

    def _apply(self, function: Callable[[Any], Any]) -> Expression:
        if self._recording is not None:
            self._recording.require_open()
        return applied(function, self._recording, self._c)

    def _compare(self, function: Callable[[Any, Any], Any], other: Any) -> Any:
        if isinstance(other, np.ndarray) and other.ndim > 0:
            return NotImplemented  # numpy compares the elements
        return _condition(function, self, other)

    def __gt__(self, other: Any) -> Condition:
        return self._compare(lib.sfdae_greater, other)

    def __lt__(self, other: Any) -> Condition:
        return self._compare(lib.sfdae_less, other)

    def __ge__(self, other: Any) -> Condition:
        return self._compare(lib.sfdae_greater_equal, other)

    def __le__(self, other: Any) -> Condition:
        return self._compare(lib.sfdae_less_equal, other)

    def __eq__(self, other: object) -> bool:
        raise self._refuse("==", sys._getframe(1))

    def __ne__(self, other: object) -> bool:
        raise self._refuse("!=", sys._getframe(1))

    def _refuse(self, operator: str, frame: Any) -> TypeError:
        error = no_value(f"{operator} cannot be decided", frame)
        if self._recording is not None:
            self._recording.refused = error
        return error

    __hash__ = object.__hash__

    def __bool__(self) -> bool:
        raise no_value("it is neither true nor false", sys._getframe(1))

    def __float__(self) -> float:
        raise no_value("it is no float", sys._getframe(1))

    __int__ = __index__ = __complex__ = __float__

    def __reduce__(self) -> Any:
        raise TypeError("expressions cannot be pickled or copied: they belong to a recording")

    def __repr__(self) -> str:
        if self._c.record == ffi.NULL:
            return f"Expression({self._c.value!r})"
        return "Expression(recorded)"

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        from ._arrays import apply_ufunc

        return apply_ufunc(ufunc, method, inputs, kwargs)

    def __array_function__(self, function: Callable, types: Any, args: Any, kwargs: Any) -> Any:
        from ._arrays import apply_array_function

        return apply_array_function(function, args, kwargs)


class Condition(Expression):
    """A comparison of expressions, for ``np.where(a > b, x, y)`` and sfdae.choose: the expression 1
    if it holds, else 0. Conditions are combined by ``&``, ``|`` and ``~``.
    """

    __slots__ = ()

    def __bool__(self) -> bool:
        raise no_value("a comparison is neither true nor false", sys._getframe(1))

    def __and__(self, other: Any) -> Condition:
        return self._compare(lib.sfdae_and, other)

    def __or__(self, other: Any) -> Condition:
        return self._compare(lib.sfdae_or, other)

    def __invert__(self) -> Condition:
        return Condition(self._apply(lib.sfdae_not)._c, self._recording)

    def __xor__(self, other: Any) -> Any:
        either = self | other
        return NotImplemented if either is NotImplemented else either & ~(self & other)

    __rand__, __ror__, __rxor__ = __and__, __or__, __xor__


def _condition(function: Callable[[Any, Any], Any], a: Any, b: Any) -> Any:
    """A function of C with two operands whose result is 1 or 0."""
    left, right = as_expression(a), as_expression(b)
    recording = left._recording or right._recording
    for operand in (left, right):
        if operand._recording is not None:
            operand._recording.require_open()
    return Condition(applied(function, recording, left._c, right._c)._c, recording)


def parameter(inside: Any, name: str, value: float) -> Expression:
    """A named constant, whose value can be changed later without a new recording.

    Parameters
    ----------
    inside : Expression
        Any expression of the recording, for example ``t``.
    name : str
        Not empty. The same name denotes the same parameter, and the first value is used.
    value : float
        Finite.
    """
    expression = as_expression(inside)
    if expression._recording is None:  # plain numbers: the formula is evaluated, not recorded
        return as_expression(value)
    expression._recording.require_open()
    c = lib.sfdae_parameter(expression._recording.c, name.encode(), float(value))
    if expression._recording.tape is not None:
        expression._recording.tape.add("sfdae_parameter", (), c, (name, float(value)))
    return Expression(c, expression._recording)
