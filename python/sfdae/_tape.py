# SPDX-License-Identifier: BSD-3-Clause
"""Recorded formulas as data: a tape of their operations, which can be pickled and repeated."""

from __future__ import annotations

from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ._arrays import plain
from ._binding import ffi, lib
from ._expression import Expression, Recording, as_expression
from ._formula import Formula, _object_array, flatten

# Formulas that have rows and columns; all others are vectors, nested as the user likes.
_MATRICES = ("E", "A", "mass", "kinematics", "nonholonomic_matrix")


def _inputs(arguments: Sequence[Any]) -> list[Any]:
    """The entries of t and of vectors of unknowns, in order."""
    return [entry for part in arguments for entry in np.ravel(np.asarray(plain(part), object))]


class Tape:
    """The operations that a function applied to its arguments, in their order.

    An operand is a plain number (float), or the node of the recording (int) that an argument or an
    earlier operation has given.

    Attributes
    ----------
    inputs : list of int
        The nodes of the arguments.
    operations : list of tuple
        (name of the C function, operands, node of the result or None for a plain number, further
        arguments of the function).
    results : list of int or float
        The formulas, in row-major order.
    shape : tuple of int
        The shape of the formulas.
    """

    def __init__(self, arguments: Sequence[Any]) -> None:
        self.inputs: list[int] = [entry._c.node for entry in _inputs(arguments)]
        self.operations: list[tuple[str, tuple[Any, ...], int | None, tuple[Any, ...]]] = []
        self.results: list[Any] = []
        self.shape: tuple[int, ...] = ()

    def add(self, name: str, operands: Sequence[Any], c: Any, more: tuple[Any, ...] = ()) -> None:
        """Adds an operation. operands, c: expressions of C; more: further arguments."""
        node = _reference(c)
        references = tuple(_reference(operand) for operand in operands)
        self.operations.append((name, references, node if type(node) is int else None, more))

    def finish(self, formulas: np.ndarray) -> None:
        """Sets the results: an array of expressions and numbers."""
        self.shape = formulas.shape
        self.results = [_reference(as_expression(entry)._c) for entry in formulas.flat]

    def repeated(
        self, arguments: Sequence[Any], recording: Recording | None, values: Mapping[str, float]
    ) -> np.ndarray:
        """The formulas of other arguments, made by the same operations in the same order.

        Parameters
        ----------
        arguments : sequence
            t and vectors of unknowns: expressions of `recording`, or numbers if it is None.
        values : mapping
            Values of parameters by their names in the recording; others keep their values.
        """
        nodes = {
            node: as_expression(entry)._c for node, entry in zip(self.inputs, _inputs(arguments))
        }

        def operand(reference: Any) -> Any:
            is_node = type(reference) is int
            return nodes[reference] if is_node else lib.sfdae_number(reference)

        for name, references, node, more in self.operations:
            operands = [operand(reference) for reference in references]
            special = _SPECIAL.get(name)
            if special is None:
                c = getattr(lib, name)(*operands)
            else:
                c = special(recording, operands, more, values)
            if node is not None:
                nodes[node] = c
        result = np.empty(len(self.results), dtype=object)
        for i, reference in enumerate(self.results):
            result[i] = Expression(operand(reference), recording)
        return result.reshape(self.shape)


def _reference(c: Any) -> Any:
    return float(c.value) if c.record == ffi.NULL else int(c.node)


def _parameter(
    recording: Recording | None,
    operands: Sequence[Any],
    more: tuple[Any, ...],
    values: Mapping[str, float],
) -> Any:
    name, value = more
    value = values.get(name, value)
    if recording is None:
        return lib.sfdae_number(value)
    return lib.sfdae_parameter(recording.c, name.encode(), value)


def _table(
    recording: Recording | None, operands: Sequence[Any], more: tuple[Any, ...], values: Any
) -> Any:
    degree, points, entries = more
    addresses = [ffi.cast("double*", data.ctypes.data) for data in (points, entries)]
    return lib.sfdae_table(operands[0], degree, points.size, *addresses)


def _external(
    recording: Recording | None, operands: Sequence[Any], more: tuple[Any, ...], values: Any
) -> Any:
    from ._callbacks import external_value

    name, function = more
    return external_value(name, function, [Expression(c, recording) for c in operands])._c


_SPECIAL: dict[str, Callable[..., Any]] = {
    "sfdae_parameter": _parameter,
    "sfdae_table": _table,
    "sfdae_external": _external,
}


class TapedFormula(Formula):
    """A formula that keeps the tape of its last recording."""

    def __init__(self, formula: Formula) -> None:
        vars(self).update(vars(formula))
        self.formula = formula
        self.tape: Tape | None = None

    @property
    def formulas(self) -> list[Formula]:
        """All functions with named parameters."""
        return getattr(self.formula, "formulas", [self.formula])

    def __call__(self, *arguments: Any, values: Mapping[str, Any], **more: Any) -> Any:
        recording = arguments[0]._recording
        tape = recording.tape = Tape(arguments)
        try:
            result = self.formula(*arguments, values=values, **more)
        finally:
            recording.tape = None
        if self.name in _MATRICES or self.name == "f":
            is_array = isinstance(result, np.ndarray)
            formulas = result if is_array else _object_array(result, self.name)
        else:
            formulas = np.array([*flatten(result, self.name), None], dtype=object)[:-1]
        tape.finish(np.asarray(plain(formulas)))
        self.tape = tape
        return result


class RepeatedFormula(Formula):
    """A formula that repeats the operations of a tape instead of calling a function."""

    mass = None  # is part of the tape
    residuals = None

    def __init__(self, taped: TapedFormula) -> None:
        self.positional, self.name = taped.positional, taped.name
        self.arguments = taped.arguments
        self.defaults = {
            name: value for formula in taped.formulas for name, value in formula.defaults.items()
        }
        self.tape = taped.tape

    @property
    def formulas(self) -> list[Formula]:
        """All functions with named parameters."""
        return [self]

    @property
    def function(self) -> Any:
        """The formula itself: it unpacks the unknowns under no names."""
        return self

    def __call__(self, *arguments: Any, values: Mapping[str, Any], count: int = 0) -> Any:
        time = arguments[0]
        recording = time._recording if isinstance(time, Expression) else None
        formulas = self.tape.repeated(arguments, recording, _by_label(values))
        if isinstance(time, Expression):
            return formulas
        numbers = [entry._c.value for entry in formulas.flat]
        return np.array(numbers, dtype=float).reshape(formulas.shape)


def _by_label(values: Mapping[str, Any]) -> dict[str, float]:
    """Values of parameters by their names in the recording, where arrays are ``k[0]``, ..."""
    result: dict[str, float] = {}
    for name, value in values.items():
        if np.ndim(value) == 0:
            result[name] = float(value)
            continue
        result.update({f"{name}[{i}]": float(entry) for i, entry in enumerate(np.ravel(value))})
    return result
