# SPDX-License-Identifier: BSD-3-Clause
"""Callbacks of the library, which call the user's functions. Their exceptions are stored until the
library has returned.
"""

from __future__ import annotations

import weakref
from typing import Any, Callable, Mapping

import numpy as np

from ._arguments import PointFunction
from ._arrays import vector
from ._binding import ffi, lib
from ._conditions import BRANCHES
from ._expression import Expression, Recording
from ._formula import Formula, flatten, write_formulas
from ._multibody import FORMULA_PLACES
from ._status import CannotEvaluate


class CountMismatch(ValueError):
    """The number of equations is `count` instead of `expected`."""

    def __init__(self, count: int, expected: int) -> None:
        super().__init__(f"equations returned {count} formulas, not {expected}")
        self.count = count


class CallbackState:
    """The `user` argument of the callbacks of a solver. It has no reference to the solver, so that
    both are freed at once.

    Attributes
    ----------
    problem : Problem
    monitor : callable or None
        Called with sfdae_progress after every accepted step; a true value stops.
    events : PointFunction or None
        Returns num_events values.
    exception : BaseException or None
        The first one raised since the call began.
    """

    __slots__ = ("problem", "values", "monitor", "events", "num_events", "exception", "functions")
    __slots__ += ("__weakref__",)

    def __init__(self, problem: Any) -> None:
        self.problem = problem
        self.values = dict(problem.parameters)
        self.monitor: Callable[[Any], Any] | None = None
        self.events: PointFunction | None = None
        self.num_events = 0
        self.exception: BaseException | None = None
        self.functions: dict[Any, Any] = {}  # handles of functions that formulas call

    def take_exception(self) -> BaseException | None:
        exception, self.exception = self.exception, None
        return exception


def callback(name: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Makes a function of (state, arguments without user) callable from C under this name."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        from_handle = ffi.from_handle

        def call(*arguments: Any) -> int:
            state = from_handle(arguments[-1])
            try:
                return function(state, *arguments[:-1]) or 0
            except CannotEvaluate:
                return 1
            except BaseException as exception:  # no exception may cross the frames of the library
                if state.exception is None:
                    state.exception = exception
                return -1

        ffi.def_extern(name=name, error=-1, onerror=_keep_interrupt)(call)
        return function

    return decorate


def _keep_interrupt(kind: type[BaseException], exception: BaseException, traceback: Any) -> None:
    """Stores Ctrl-C raised at the very beginning of a callback, before its own handler."""
    state = ffi.from_handle(traceback.tb_frame.f_locals["arguments"][-1])
    if state.exception is None:
        state.exception = exception


def _numbers(pointer: Any, shape: tuple[int, ...]) -> np.ndarray:
    """A read-only copy of column-major C numbers, which the user may keep."""
    size = int(np.prod(shape))
    return np.frombuffer(ffi.buffer(pointer, 8 * size)[:]).reshape(shape, order="F")


def _write(pointer: Any, value: Any, shape: tuple[int, ...], name: str) -> None:
    """Writes numbers returned by a callback, column-major."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"{name} returned {value!r}, which is no array of numbers") from None
    if len(shape) == 2 and array.ndim == 1 and shape[0] == shape[1] == array.size:
        array = np.diag(array)
    if array.shape != shape:
        raise ValueError(f"{name} returned an array of shape {array.shape}, not {shape}")
    if array.size:
        np.frombuffer(ffi.buffer(pointer, 8 * array.size)).reshape(shape, order="F")[...] = array


# ---- Functions in formulas -----------------------------------------------------------------------


class _ExternalFunction:
    """A function of k numbers that a recorded formula calls. Its exceptions are stored with those
    of the solver.
    """

    def __init__(self, state: CallbackState, name: str, function: Any, count: int) -> None:
        self.state = weakref.proxy(state)
        self.name, self.function, self.count = name, function, count

    @property
    def exception(self) -> BaseException | None:
        return self.state.exception

    @exception.setter
    def exception(self, exception: BaseException) -> None:
        self.state.exception = exception


@callback("python_external_function")
def _external(external: _ExternalFunction, order: int, arguments: Any, result: Any) -> int | None:
    value = external.function(order, _numbers(arguments, (external.count,)))
    if value is None:
        return lib.SFDAE_ORDER_NOT_AVAILABLE
    shape = (external.count,) * order
    values = np.reshape(value, ()) if order == 0 else value
    if external.count == 1 and np.ndim(values) == 0:
        values = np.reshape(values, shape)
    _write(result, values, shape, f"{external.name} of order {order}")
    return None


def external_value(name: str, function: Any, arguments: list[Expression]) -> Expression:
    """The result of sfdae.external."""
    recordings = [a._recording for a in arguments if a._recording is not None]
    if not recordings:  # plain numbers
        value = function(0, np.array([a._c.value for a in arguments]))
        return Expression(lib.sfdae_number(float(value)), None)
    for recording in recordings:
        recording.require_open()
    state = recordings[0].state
    key = (name, function, len(arguments))
    if key not in state.functions:
        state.functions[key] = ffi.new_handle(_ExternalFunction(state, *key))
    c_arguments = ffi.new("sfdae_expression[]", [a._c for a in arguments])
    c = lib.sfdae_external(
        name.encode(),
        lib.python_external_function,
        len(arguments),
        c_arguments,
        state.functions[key],
    )
    if recordings[0].tape is not None:
        operands = tuple(a._c for a in arguments)
        recordings[0].tape.add("sfdae_external", operands, c, (name, function))
    return Expression(c, recordings[0])


# ---- Linear problems -----------------------------------------------------------------------------


def _define_coefficient(name: str) -> None:
    @callback(f"python_linear_problem_{name}")
    def coefficient(state: CallbackState, t: float, order: int, result: Any) -> int | None:
        problem = state.problem
        shape = (problem.num_equations,) if name == "f" else problem.matrix_shape(name)
        part = problem.coefficients[name]
        if isinstance(part, np.ndarray):
            if order == 0:
                _write(result, part, shape, name)
            return 0
        value = part(t, order)
        if value is None:
            if order == 0:
                raise TypeError(f"{name} returned None for order 0")
            return lib.SFDAE_ORDER_NOT_AVAILABLE
        _write(result, value, shape, f"{name} of order {order}")
        return 0


for _name in ("E", "A", "f"):
    _define_coefficient(_name)


def _prescribed(state: CallbackState, t: float, order: int, result: Any) -> None:
    values = [function(t) for function in state.problem.prescribed.values()]
    _write(result, values, (len(values),), "prescribed values")


callback("python_linear_problem_prescribed_values")(_prescribed)
callback("python_nonlinear_problem_prescribed_values")(_prescribed)


# ---- Nonlinear problems --------------------------------------------------------------------------


@callback("python_nonlinear_problem_equations")
def _equations(state: CallbackState, record: Any, t: Any, x: Any, xdot: Any, residual: Any) -> None:
    problem = state.problem
    with Recording(record, state) as recording:
        n = problem.num_unknowns
        arguments = (Expression(t, recording), vector(x, n, recording), vector(xdot, n, recording))
        entries = flatten(problem._written(arguments, state.values), "equations")
        if len(entries) != problem.num_equations:
            raise CountMismatch(len(entries), problem.num_equations)
        write_formulas(
            residual, np.array([*entries, None], dtype=object)[:-1], (len(entries),), "equations"
        )


@callback("python_nonlinear_problem_linear_equations")
def _linear_equations(state: CallbackState, record: Any, t: Any, E: Any, A: Any, f: Any) -> None:
    problem = state.problem
    with Recording(record, state) as recording:
        time = Expression(t, recording)
        shape = (problem.num_equations, problem.num_unknowns)
        for name, places in (("E", E), ("A", A), ("f", f)):
            part = problem.coefficients.get(name)
            if isinstance(part, Formula):
                part = part(time, values=state.values)
            elif part is None:
                continue
            write_formulas(places, part, shape[:1] if name == "f" else shape, name)


def _derivative_of_numbers(
    problem: Any, t: float, order: int, jet: np.ndarray, values: Mapping[str, Any]
) -> np.ndarray | None:
    """The total derivative of equations that are not recorded: only order 0."""
    if order > 0:
        return None
    if problem._takes_branches:
        values = {**values, BRANCHES: problem.branches.astype(bool)}
    try:
        result = problem._evaluated(t, jet[:, 0].copy(), jet[:, 1].copy(), values)
    except (ArithmeticError, ValueError) as exception:
        # OverflowError, ZeroDivisionError, and ValueError of the functions of math
        if isinstance(exception, ValueError) and str(exception) != "math domain error":
            raise
        raise CannotEvaluate(str(exception)) from exception
    if len(result) != problem.num_equations:
        raise ValueError(f"{len(result)} residuals, not {problem.num_equations}: num_equations?")
    return result


@callback("python_nonlinear_problem_total_derivative")
def _total_derivative(
    state: CallbackState, t: float, order: int, derivatives: Any, F: Any, F_x: Any, F_xdot: Any
) -> int | None:
    problem = state.problem
    m, n = problem.num_equations, problem.num_unknowns
    asks_for_jacobians = F_x != ffi.NULL
    jet = _numbers(derivatives, (n, order + 2))
    if problem.records:
        result = problem.total_derivative(t, order, jet, asks_for_jacobians)
    else:
        result = _derivative_of_numbers(problem, t, order, jet, state.values)
    if result is None:
        return lib.SFDAE_ORDER_NOT_AVAILABLE
    if isinstance(result, tuple):
        parts = result
    elif asks_for_jacobians:
        raise TypeError("total_derivative has to return (F, F_x, F_xdot) where jacobians is true")
    else:
        parts = (result,)
    _write(F, parts[0], (m,), "F of total_derivative")
    if asks_for_jacobians:
        _write(F_x, parts[1], problem.matrix_shape("F_x"), "F_x of total_derivative")
        _write(F_xdot, parts[2], problem.matrix_shape("F_xdot"), "F_xdot of total_derivative")
    return 0


def _define_conditions(kind: str) -> None:
    @callback(f"python_{kind}_problem_conditions")
    def _conditions(state: CallbackState, t: float, x: Any, xdot: Any, g: Any) -> None:
        problem = state.problem
        shape = (problem.num_unknowns,)
        point = _numbers(x, shape), _numbers(xdot, shape)
        values = [condition(t, *point, state.values) for condition in problem.conditions]
        _write(g, np.array(values, dtype=float).ravel(), (len(values),), "conditions")


for _kind in ("linear", "nonlinear"):
    _define_conditions(_kind)


# ---- Mechanical systems --------------------------------------------------------------------------


@callback("python_multibody_problem_equations")
def _multibody_equations(
    state: CallbackState, record: Any, t: Any, q: Any, v: Any, formulas: Any
) -> None:
    problem = state.problem
    with Recording(record, state) as recording:
        time = Expression(t, recording)
        positions = vector(q, problem.num_positions, recording)
        velocities = vector(v, problem.num_velocities, recording)
        for name, place in FORMULA_PLACES.items():
            part = problem.functions.get(name)
            if isinstance(part, Formula):
                parts = [positions, velocities] if name == "forces" else [positions]
                part = problem._written(name, time, parts, state.values)
                if name != "mass" and name != "kinematics" and name != "nonholonomic_matrix":
                    part = np.array([*flatten(part, name), None], dtype=object)[:-1]
            elif part is None and name == "mass":
                part = np.ones(problem.num_velocities)
            elif part is None:
                continue
            write_formulas(getattr(formulas, place), part, problem.shape(name), name)


def _define_multibody(name: str, has_velocities: bool) -> None:
    def evaluate(state: CallbackState, t: float, q: Any, v: Any, result: Any) -> None:
        problem = state.problem
        part = problem.functions[name]
        if not isinstance(part, np.ndarray):
            parts = [_numbers(q, (problem.num_positions,))]
            if has_velocities:
                parts.append(_numbers(v, (problem.num_velocities,)))
            part = problem._written(name, t, parts, state.values)
        _write(result, part, problem.shape(name), name)

    def evaluate_at_positions(state: CallbackState, t: float, q: Any, result: Any) -> None:
        evaluate(state, t, q, None, result)

    callback(f"python_multibody_problem_{name}")(
        evaluate if has_velocities else evaluate_at_positions
    )


for _name, _field in ffi.typeof("sfdae_multibody_problem").fields:
    if _field.type.kind == "function" and _name != "equations":
        _define_multibody(_name, has_velocities=len(_field.type.args) == 5)


# ---- Monitor and events --------------------------------------------------------------------------


@callback("python_options_monitor")
def _monitor(state: CallbackState, progress: Any) -> int:
    return 1 if state.monitor is not None and state.monitor(progress) else 0


@callback("python_event_function")
def _events(state: CallbackState, t: float, x: Any, xdot: Any, g: Any) -> None:
    n = state.problem.num_unknowns
    values = state.events(t, _numbers(x, (n,)), _numbers(xdot, (n,)), state.values)
    if state.num_events == 1 and np.size(values) == 1:
        values = np.reshape(values, (1,))
    _write(g, values, (state.num_events,), "event functions")
