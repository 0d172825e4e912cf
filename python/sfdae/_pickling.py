# SPDX-License-Identifier: BSD-3-Clause
"""Problems as bytes, for other processes: recorded formulas become tapes."""

from __future__ import annotations

import copy
import pickle
from typing import Any, Callable, Mapping

from ._arguments import PointFunction
from ._formula import Formula
from ._tape import RepeatedFormula, TapedFormula

_REMEDY = (
    "Define it by def at the top level of a module that the other processes can import, or install "
    "cloudpickle"
)


class Picklable:
    """A problem that can be pickled, although its functions may not be. Copies share them."""

    def __reduce__(self) -> Any:
        return problem_from, (type(self), problem_to_bytes(self))

    def __copy__(self) -> Any:
        return _with_members(type(self), vars(self))

    def __deepcopy__(self, memo: Any) -> Any:
        return _with_members(type(self), copy.deepcopy(vars(self), memo))


def _with_members(kind: type, members: Mapping[str, Any]) -> Any:
    """An object of a class, made of its members."""
    result = object.__new__(kind)
    vars(result).update(members)
    return result


def dumps(value: Any) -> bytes:
    """Pickles a value; by cloudpickle if it is installed, which also stores functions without a
    module.
    """
    try:
        import cloudpickle
    except ImportError:
        return pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    return bytes(cloudpickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL))


def problem_from(kind: type, state: bytes) -> Any:
    """A problem from its class and the bytes that problem_to_bytes has returned."""
    return _with_members(kind, pickle.loads(state))


def problem_to_bytes(problem: Any) -> bytes:
    """The state of a problem. Recorded equations are recorded once more, and stored as they are.

    Raises
    ------
    TypeError
        If a function that is called at every point cannot be pickled.
    """
    state = problem
    if problem.records and not all(isinstance(f, RepeatedFormula) for f in _formulas(problem)):
        from ._solver import Solver

        state = _with_formulas(problem, TapedFormula)
        Solver(state)
        state = _with_formulas(state, RepeatedFormula)
        state._must_confirm_names = False  # they were confirmed in this recording
    try:
        return dumps(vars(state))
    except Exception as error:
        raise TypeError(_explained(state, error)) from error


def _with_formulas(problem: Any, change: Callable[[Any], Any]) -> Any:
    """A shallow copy of a problem with other formulas, if these are not repeated already."""

    def changed(value: Any) -> Any:
        is_ready = not isinstance(value, Formula) or isinstance(value, RepeatedFormula)
        return value if is_ready else change(value)

    members = {}
    for name, value in vars(problem).items():
        if type(value) is dict:
            value = {key: changed(entry) for key, entry in value.items()}
        members[name] = changed(value)
    return _with_members(type(problem), members)


def _formulas(problem: Any) -> list[Any]:
    parts = list(vars(problem).values())
    parts += [entry for part in parts if type(part) is dict for entry in part.values()]
    return [part for part in parts if isinstance(part, Formula)]


def _explained(problem: Any, error: Exception) -> str:
    """A message that names the function that cannot be pickled, the reason and the remedy."""
    for what, function in _functions(problem):
        try:
            dumps(function)
        except Exception as reason:
            return (
                f"the problem cannot be pickled for other processes, because {what}, {function!r}, "
                f"cannot: {reason}. {_REMEDY}"
            )
    return f"the problem cannot be pickled for other processes: {error}"


def _functions(problem: Any) -> list[tuple[str, Any]]:
    """All functions of a problem that are called with numbers, with descriptions for messages."""
    result: list[tuple[str, Any]] = []
    for formula in _formulas(problem):
        if not isinstance(formula, RepeatedFormula):
            hint = "which record=False calls with numbers"
            result.append((f"the function {formula.name}, {hint}", formula.function))
            continue
        for name, _, _, more in formula.tape.operations:
            if name == "sfdae_external":
                result.append((f"the external function {more[0]!r} of {formula.name}", more[1]))
    if getattr(problem, "total_derivative", None) is not None:
        result.append(("the function total_derivative", problem.total_derivative))
    for index, function in getattr(problem, "prescribed", {}).items():
        result.append((f"the prescribed value of {problem.names[index]}", function))
    for name, part in getattr(problem, "coefficients", {}).items():
        if callable(part) and not isinstance(part, Formula):
            result.append((f"the function {name}", part.function))
    for condition in getattr(problem, "conditions", []):
        if isinstance(condition, PointFunction):
            result.append((f"the function {condition.name}", condition.function))
    return result
