# SPDX-License-Identifier: BSD-3-Clause
"""Names of unknowns in a user-supplied function: ``p, q, u = x``.

They are read from the bytecode, which every Python function has, even without source text. They
count only if they are confirmed when the function runs, with expressions or first with numbers: a
Watch records which unknowns are unpacked under which names, so that wrappers that rearrange x and
branches that are not taken are not misleading.
"""

from __future__ import annotations

import dis
import functools
import re
import sys
import types
from typing import Any, Callable, Iterator, Mapping, NamedTuple, Sequence

import numpy as np

_X = 1  # the place of x among the arguments (t, x, ...)


# ---- Bytecode ------------------------------------------------------------------------------------


class _Operation(NamedTuple):
    """kind: LOAD or STORE of a name, UNPACK_SEQUENCE, UNPACK_EX, or another operation."""

    offset: int
    kind: str
    argument: Any


@functools.lru_cache(maxsize=256)
def _operations(code: types.CodeType) -> list[_Operation]:
    """The operations of a function. Later versions of Python combine two loads or stores."""
    result = []
    prefix = None  # offset of the first EXTENDED_ARG, where the operation after it begins
    for instruction in dis.get_instructions(code):
        if instruction.opname == "EXTENDED_ARG":
            prefix = instruction.offset if prefix is None else prefix
        if instruction.opname in ("EXTENDED_ARG", "NOP", "CACHE"):
            continue
        offset, prefix = instruction.offset if prefix is None else prefix, None
        moves = re.findall(r"(LOAD|STORE)_(?:FAST|DEREF|NAME|GLOBAL)", instruction.opname)
        if not moves:
            result.append(_Operation(offset, instruction.opname, instruction.arg))
            continue
        is_global = instruction.opname == "LOAD_GLOBAL"
        names = instruction.argval
        for move, name in zip(moves, names if isinstance(names, tuple) else [names]):
            result.append(_Operation(offset, "LOAD_GLOBAL" if is_global else move, name))
    return result


def _stored(operations: Sequence[_Operation], k: int) -> list[tuple[int, str]]:
    """The names to which an unpacking, operation k, assigns its values: (place, name) up to the
    first target that is not a name. Places after ``*rest`` count from the end, -1 for the last.
    """
    count, after = int(operations[k].argument), 0
    is_whole = operations[k].kind == "UNPACK_SEQUENCE"
    if not is_whole:  # a, b, *rest, z
        count, after = count & 255, count >> 8
    places = [*range(count), *([] if is_whole else [None]), *range(-after, 0)]
    result = []
    for place, operation in zip(places, operations[k + 1 :]):
        if operation.kind != "STORE":  # what follows is not the value of a place any more
            break
        if place is not None:
            result.append((place, str(operation.argument)))
    return result


def _code_of(function: Any) -> tuple[types.CodeType, int] | None:
    """The code that a callable finally runs, and the place of x among its arguments; None if it is
    not written in Python.
    """
    place = _X
    for _ in range(100):  # wrappers of wrappers
        if isinstance(function, functools.partial):
            place += len(function.args)
            function = function.func
        elif isinstance(function, types.MethodType):
            place += 1
            function = function.__func__
        elif getattr(function, "__wrapped__", None) is not None:
            function = function.__wrapped__
        elif isinstance(function, types.FunctionType):
            return function.__code__, place
        elif isinstance(getattr(type(function), "__call__", None), types.FunctionType):
            place += 1
            function = type(function).__call__
        else:
            return None
    return None


def read_names(function: Callable[..., Any]) -> tuple[str, ...] | None:
    """The names under which a function of (t, x, ...) unpacks the whole of x; None if it does not
    do so, or several times under different names. A Watch has to confirm them.
    """
    found = _code_of(function)
    if found is None:
        return None
    code, place = found
    if place >= code.co_argcount:
        return None
    x = code.co_varnames[place]
    operations = _operations(code)
    readings = set()
    for k, operation in enumerate(operations[:-1]):
        if (operation.kind, operation.argument) != ("LOAD", x):
            continue
        if operations[k + 1].kind == "UNPACK_SEQUENCE":
            count = operations[k + 1].argument
            names = tuple(name for _, name in _stored(operations, k + 1))
            readings.add(names if len(set(names)) == count else None)
    return readings.pop() if len(readings) == 1 else None


# ---- What a function does with x -----------------------------------------------------------------


class WatchedNumbers(np.ndarray):
    """Values of unknowns, as an array that tells a Watch when a function begins to iterate over it
    or over a part of it. Results that numpy computes from it are plain arrays or numbers.
    """

    _watch: Watch | None = None

    def __array_finalize__(self, source: Any) -> None:
        self._watch = getattr(source, "_watch", None)

    def __array_wrap__(self, result: np.ndarray, *context: Any) -> Any:
        return result.view(np.ndarray)[()]

    def __iter__(self) -> Iterator[Any]:
        if self._watch is not None:
            self._watch.note(self, sys._getframe(1))
        return super().__iter__()


def _keys(vector: np.ndarray) -> list[Any]:
    """Keys that distinguish the entries of a vector while they are alive: for expressions their
    ids, for numbers their memory places and values, which a function might change.
    """
    if vector.dtype == object:
        return [id(unknown) for unknown in vector.view(np.ndarray)]
    first, stride = vector.__array_interface__["data"][0], vector.strides[0]
    return [(first + i * stride, value) for i, value in enumerate(vector.tolist())]


class Watch:
    """Records which unknowns a function unpacks under which names while it runs.

    Parameters
    ----------
    function : callable
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        found = _code_of(function)
        self._code = None if found is None else found[0]
        self._parts: list[np.ndarray] = []  # alive as long as their keys are used
        self._index: dict[Any, int] = {}
        self._seen: dict[str, set[int | None]] = {}

    def over(self, part: np.ndarray, first: int = 0) -> Any:
        """A part of the unknowns, an ExpressionArray or numbers, to be passed to the function.
        first: the index of its first unknown.
        """
        self._parts.append(part)
        self._index.update((key, first + i) for i, key in enumerate(_keys(part)))
        result: Any = part.view() if part.dtype == object else part.view(WatchedNumbers)
        result._watch = self
        return result

    def note(self, vector: np.ndarray, frame: types.FrameType) -> None:
        """Called when a function begins to iterate over an array that was made of unknowns."""
        if frame.f_code is not self._code or vector.ndim != 1:
            return
        operations = _operations(frame.f_code)
        k = sum(operation.offset <= frame.f_lasti for operation in operations) - 1
        if operations[k].kind not in ("UNPACK_SEQUENCE", "UNPACK_EX"):  # a loop, say
            return
        keys = _keys(vector)
        for place, name in _stored(operations, k):
            if -len(keys) <= place < len(keys):  # else Python reports an error
                index = self._index.get(keys[place])
                self._seen.setdefault(name, set()).add(index)

    def names(self) -> dict[str, int]:
        """Names that stood for exactly one unknown, with its index."""
        single = {name: next(iter(seen)) for name, seen in self._seen.items() if len(seen) == 1}
        return {name: index for name, index in single.items() if index is not None}


# ---- Agreement of names --------------------------------------------------------------------------


def by_name(given: Any) -> Any:
    """A mapping, or a pandas Series indexed by names, as a dict; other values unchanged.

    Raises
    ------
    ValueError
        For a name with two values.
    """
    if not (hasattr(given, "keys") and hasattr(given, "items")):
        return given
    pairs = list(given.items())
    result = dict(pairs)
    if len(result) < len(pairs):
        twice = next(name for i, (name, _) in enumerate(pairs) if name in dict(pairs[:i]))
        raise ValueError(f"the name {twice!r} has two values")
    return result


def called(function: Callable[..., Any]) -> str:
    return getattr(function, "__qualname__", None) or type(function).__name__


def names_for(function: Callable[..., Any], x0: Mapping[Any, Any]) -> tuple[str, ...] | int:
    """The names of the unknowns of a function for which values are given by name, or the number of
    unknowns if the values are given by index.

    Raises
    ------
    TypeError
        If the names cannot be read from the function.
    KeyError
        For a key that is no name of an unknown.
    """
    names = read_names(function)
    keys = list(x0)
    if names is None:
        if keys and all(isinstance(key, (int, np.integer)) for key in keys):
            if sorted(keys) == list(range(len(keys))):
                return len(keys)
        raise TypeError(
            f"values are given by name ({_listed(keys)}), but the names of the unknowns cannot be "
            f"read from {called(function)}, and the order of the keys does not tell. Add "
            "names=[...], the names of x[0], x[1], ... in this order, or unpack all unknowns at "
            "once in the function, as in p, q, u = x, or give the values as a list"
        )
    for key in keys:
        if isinstance(key, str) and key not in names:
            raise KeyError(
                f"there is no unknown {key!r}: {called(function)} unpacks x as {', '.join(names)}. "
                "Use these names, or add names=[...], the names of x[0], x[1], ... in this order"
            )
    return names


def _listed(keys: Sequence[Any]) -> str:
    return ", ".join(str(key) for key in keys[:8]) + (", ..." if len(keys) > 8 else "")


def require_same_names(
    function: Callable[..., Any], names: Sequence[str], unpacked: Mapping[str, int]
) -> None:
    """ValueError if a function unpacks unknowns under the names of others. unpacked: the index of
    the unknown that each name stands for.
    """
    for name, index in unpacked.items():
        if name in names and names.index(name) != index:
            raise ValueError(
                f"names contradict {called(function)}: {name!r} is the name of "
                f"x[{names.index(name)}], but the function unpacks x[{index}] as {name}. Put names "
                "in the order of x, and unpack x in the order of names"
            )


def require_confirmed(
    function: Callable[..., Any], names: Sequence[str], unpacked: Mapping[str, int]
) -> None:
    """TypeError unless a function that has run unpacked the unknowns under the names that were read
    from it.
    """
    if any(unpacked.get(name) != index for index, name in enumerate(names)):
        raise TypeError(
            f"the names of the unknowns, {_listed(names)}, were read from {called(function)} but "
            "not confirmed: it did not unpack x itself in this order when it was called. Add "
            "names=[...], the names of x[0], x[1], ... in this order"
        )
