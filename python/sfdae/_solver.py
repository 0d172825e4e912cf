# SPDX-License-Identifier: BSD-3-Clause
"""The solver, step by step."""

from __future__ import annotations

import threading
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ._arguments import PointFunction
from ._binding import ffi, lib
from ._callbacks import CallbackState, CountMismatch
from ._checkpoint import Checkpoints
from ._formula import checked_value
from ._linearization import Linearizing
from ._branches import Branches
from ._modes import Modes
from ._options import c_options, check_names
from ._points import Point, Progress, wrapped
from ._linear_problem import LinearProblem
from ._problem import Problem
from ._recorded_solution import RecordedSolution
from ._sensitivities import Sensitivities
from ._status import Error, Status
from ._structs import Struct
from ._types import Values


class Solver(Sensitivities, Linearizing, Modes, Branches, Checkpoints):
    """Analysis and integration of a problem, step by step; ``sfdae.solve`` does all of it in one
    call.

    Failures are raised as sfdae.Error; a point that was reached is ``error.point``. Exceptions of
    callbacks stop the call and are raised with their traceback. A solver belongs to one thread at a
    time: calls from a second one fail with ``Status.BUSY``. The library releases Python's lock, so
    that different solvers run in parallel. Solvers cannot be copied or pickled; see
    save_checkpoint.

    Parameters
    ----------
    problem : Problem
    parameters : dict, optional
        Values of named parameters that replace those of the problem.
    monitor : callable, optional
        Called after every accepted step with a Progress (t, step, order, steps, x); a true result
        stops the call with ``Status.STOPPED``.
    **options
        Members of sfdae_options by name (``sfdae.OPTION_NAMES``): rtol, atol (numbers or n values),
        method (``"bdf"``, ``"radau"``, ``"automatic"``), fixed (names, indices or n booleans),
        max_step, ...

    Raises
    ------
    Error
        ``ILLEGAL_ARGUMENT`` with the reason in the message.
    """

    def __init__(
        self,
        problem: Problem,
        *,
        parameters: Mapping[str, Any] | None = None,
        monitor: Callable[[Progress], Any] | None = None,
        **options: Any,
    ) -> None:
        if not isinstance(problem, Problem):
            raise TypeError(
                f"a problem is needed, for example NonlinearProblem(F, n), not {problem!r}"
            )
        check_names(options)
        self.problem = problem
        self._options = {**problem.default_options, **options}
        self._lock = threading.RLock()
        self._box = ffi.new("sfdae_solver**")
        self._recorder = ffi.gc(ffi.new("python_recorder*"), lib.python_free_steps)
        try:
            self._create(parameters)
        except CountMismatch as mismatch:
            if not problem._counts:
                raise
            problem.num_equations = mismatch.count
            self._create(parameters)
        self._set_monitor(monitor)

    def _create(self, parameters: Mapping[str, Any] | None) -> None:
        problem = self.problem
        state = self._state = CallbackState(problem)
        self._set_values(parameters or {})
        self._user = self._recorder.user = ffi.new_handle(state)
        keep: list[Any] = []
        c_problem = problem._c_problem(keep)
        c_problem.user = self._user
        c, alive = self._c_options(self._options)
        status = getattr(lib, f"sfdae_create_{problem.kind}")(self._box, c_problem, c)
        if status >= 0:
            return
        exception = state.take_exception()
        if exception is not None:
            raise exception
        raise Error(status, problem.with_names(ffi.string(lib.sfdae_message(ffi.NULL)).decode(errors="replace")))

    def _set_monitor(self, monitor: Callable[[Any], Any] | None) -> None:
        """Sets the monitor called after every step; without one Python only checks for Ctrl-C."""
        self._state.monitor = None if monitor is None else wrapped(monitor)
        self._recorder.calls_python = monitor is not None

    def _steps(self) -> np.ndarray:
        """t, signed size and order of the recorded steps, N x 3."""
        count = self._recorder.count
        if count == 0:
            return np.empty((0, 3))
        return np.frombuffer(ffi.buffer(self._recorder.steps, 24 * count)[:]).reshape(-1, 3)

    def __del__(self, destroy: Callable[[Any], int] = lib.sfdae_destroy) -> None:
        box = getattr(self, "_box", None)
        if box is not None:
            destroy(box)

    def __reduce__(self) -> Any:
        raise TypeError(
            "solvers cannot be pickled or copied: create another one, and see save_checkpoint"
        )

    def __repr__(self) -> str:
        return f"Solver({self.problem!r})"

    # ---- Calls -----------------------------------------------------------------------------------

    def _call(self, function: Callable[..., int], *arguments: Any) -> int:
        """Calls a C function with this solver and returns its status unless it is a failure."""
        if not self._lock.acquire(blocking=False):
            raise Error(Status.BUSY, "the solver is in use by another thread")
        try:
            return self._checked(function(self._box[0], *arguments))
        finally:
            self._lock.release()

    def _checked(self, status: int) -> int:
        exception = self._state.take_exception()
        if exception is not None:
            raise exception
        if status < 0:
            raise Error(status, self.message)
        return status

    @property
    def message(self) -> str:
        """Message of the last call: the event, its place, the numbers and a remedy; "" after
        ``OK``.
        """
        return self.problem.with_names(
            ffi.string(lib.sfdae_message(self._box[0])).decode(errors="replace")
        )

    def request_stop(self) -> None:
        """Stops the current call, or else the next one; any thread may call it."""
        lib.sfdae_request_stop(self._box[0])

    def _pointer(self, array: np.ndarray) -> Any:
        return ffi.cast("double*", array.ctypes.data)

    def _point(self, function: Callable[..., int], *arguments: Any) -> Point:
        """Calls a C function that returns a point."""
        t = ffi.new("double*", np.nan)
        x, xdot = np.full((2, self.problem.num_unknowns), np.nan)
        try:
            status = self._call(function, *arguments, t, self._pointer(x), self._pointer(xdot))
        except Error as error:
            if not np.isnan(t[0]):
                error.point = Point(t[0], x, xdot, error.status, error.message)
            raise
        return Point(t[0], x, xdot, Status(status), self.message)

    # ---- Options and parameters ------------------------------------------------------------------

    def set_options(self, **options: Any) -> None:
        """Replaces some options; others are unchanged. See sfdae_set_options for those that require
        a new start.
        """
        merged = {**self._options, **options}
        c, alive = self._c_options(merged)
        self._call(lib.sfdae_set_options, c)
        self._options = merged

    def _c_options(self, options: Mapping[str, Any]) -> tuple[Any, list[Any]]:
        """A struct sfdae_options with the monitor of this solver, and its memory."""
        keep: list[Any] = []
        c = c_options(self.problem, options, keep)
        c.monitor = ffi.addressof(lib, "python_record_step")
        c.monitor_user = self._recorder
        return c, keep

    @property
    def parameters(self) -> dict[str, Any]:
        """Values of the named parameters."""
        return dict(self._state.values)

    def set_parameters(self, **parameters: Any) -> None:
        """Changes named parameters without a new recording.

        The next advance() continues the integration from the point returned last, as at a jump of
        data: x changes by impulses if necessary. With sensitivities, and if the problem has
        record=False, start() must be called first.

        Raises
        ------
        TypeError
            For an unknown name, and a value that is not a number or has another shape.
        ValueError
            For a value that is not finite.
        """
        for name, value in self._set_values(parameters).items():
            if not self.problem.records:  # the function receives the values in every call
                continue
            if np.ndim(value) == 0:
                self._call(lib.sfdae_set_parameter, name.encode(), value)
                continue
            for i, entry in enumerate(np.ravel(value)):
                self._call(lib.sfdae_set_parameter, f"{name}[{i}]".encode(), entry)

    def _set_values(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        values = self._state.values
        checked = {}
        for name, value in parameters.items():
            if name not in values:
                raise TypeError(
                    f"there is no parameter {name!r}; there are {', '.join(values) or 'none'}"
                )
            checked[name] = checked_value(name, value)
            if np.shape(checked[name]) != np.shape(values[name]):
                raise TypeError(
                    f"parameter {name!r} has shape {np.shape(values[name])}, not {np.shape(value)}"
                )
        values.update(checked)
        return checked

    def get_parameter(self, name: str) -> float:
        """The value of a parameter in the library, also of ``sfdae.parameter`` and of ``"k[1]"``.
        """
        if not self.problem.records and np.ndim(self._state.values.get(name, [])) == 0:
            return float(self._state.values[name])
        value = ffi.new("double*")
        self._call(lib.sfdae_get_parameter, name.encode(), value)
        return value[0]

    # ---- Integration -----------------------------------------------------------------------------

    def analyze(self, t: float, toward: float, x: Values | None = None) -> Struct:
        """Detects the strangeness index at t and at a nearby point in the direction of `toward`.

        Parameters
        ----------
        t, toward : float
            Not equal. The point reached is discarded: start() must follow.
        x : array_like or mapping, optional
            Values near the solution; linear problems need none.

        Returns
        -------
        Struct
            characteristics: strangeness_index, differential, algebraic, undetermined, redundant,
            ...
        """
        if x is None and not isinstance(self.problem, LinearProblem):
            raise TypeError("x is needed: the index of a nonlinear problem depends on the solution")
        if self.problem.kind == "linear":
            self._call(lib.sfdae_analyze, t, toward, ffi.NULL)
        else:
            values = self.problem.values(
                np.zeros(self.problem.num_unknowns) if x is None else x, "x"
            )
            self._call(lib.sfdae_analyze_at, t, toward, self._pointer(values), ffi.NULL)
        return self.characteristics

    def make_consistent(self, t: float, x: Values, xdot: Values | None = None) -> Point:
        """Makes x consistent at t according to the options and computes the derivative of the
        solution through it.

        Parameters
        ----------
        t : float
        x : array_like or mapping
            n values, or values by name; the initial guess of others is 0.
        xdot : array_like or mapping, optional
            An initial guess of x', if F(t, x, x') = 0 allows several.
        """
        return self._values(lib.sfdae_make_consistent, (t,), x, xdot)

    def start(self, t: float, x: Values, toward: float, xdot: Values | None = None) -> Point:
        """Starts or restarts the integration at (t, x) in the direction of `toward`.

        Parameters
        ----------
        t, toward : float
            Not equal; the distance sets the scale of the first step.
        x, xdot
            As for make_consistent.

        Returns
        -------
        Point
            The consistent values.
        """
        return self._values(lib.sfdae_start, (t, toward), x, xdot)

    def _values(
        self, function: Callable[..., int], times: tuple[float, ...], x: Any, xdot: Any
    ) -> Point:
        x = self.problem.values(x, "x")
        if xdot is not None and not self._options.get("xdot_is_guess"):
            self.set_options(xdot_is_guess=1)
        derivatives = np.zeros_like(x) if xdot is None else self.problem.values(xdot, "xdot")
        status = self._call(function, *times, self._pointer(x), self._pointer(derivatives))
        return Point(float(times[0]), x, derivatives, Status(status), self.message)

    def advance(self, tout: float) -> Point:
        """Integrates to tout and returns the point there, that of an event, or the one reached when
        stopped.
        """
        return self._point(lib.sfdae_advance, tout)

    def step(self, tout: float) -> Point:
        """Takes one step toward tout: ``STEP_TAKEN``, or ``OK`` at tout."""
        return self._point(lib.sfdae_step, tout)

    def interpolate(self, t: float) -> Point:
        """The solution at any t within the last step; the point reached is unaffected."""
        x, xdot = np.empty((2, self.problem.num_unknowns))
        status = self._call(lib.sfdae_interpolate, t, self._pointer(x), self._pointer(xdot))
        return Point(float(t), x, xdot, Status(status), self.message)

    def record(self, solution: RecordedSolution | None) -> None:
        """Records all following accepted steps in the solution; None: stops recording."""
        self._call(lib.sfdae_record_solution, ffi.NULL if solution is None else solution._box[0])

    # ---- Events ----------------------------------------------------------------------------------

    def set_events(
        self,
        function: Callable[..., Any] | None,
        num_events: int = 1,
        directions: Sequence[int] | None = None,
    ) -> None:
        """Sets event functions: advance() and step() return with ``EVENT`` at their zeros.

        Parameters
        ----------
        function : callable or None
            ``function(t, x)`` or ``function(t, x, xdot)`` returns num_events numbers; arguments are
            those of Event. None: no events.
        num_events : int
        directions : sequence of int, optional
            +1: only rising zeros count, -1: only falling ones, 0: both.
        """
        if function is None:
            self._call(lib.sfdae_set_events, 0, ffi.NULL, ffi.NULL, ffi.NULL)
            self._state.num_events, self._state.events = 0, None
            return
        if directions is not None and len(directions) != num_events:
            raise ValueError(f"there are {len(directions)} directions for {num_events} events")
        events = PointFunction(function, "the event function")
        events.check(self.problem, self._state.values)
        c_directions = (
            ffi.NULL if directions is None else ffi.new("int[]", [int(d) for d in directions])
        )
        self._call(
            lib.sfdae_set_events, num_events, lib.python_event_function, c_directions, self._user
        )
        self._state.num_events = num_events
        self._state.events = events

    @property
    def events(self) -> np.ndarray:
        """The events at the point that was returned with ``EVENT``: +1 rising, -1 falling, else 0.
        """
        which = np.zeros(max(self._state.num_events, 1), dtype=np.intc)
        self._call(lib.sfdae_get_events, ffi.cast("int*", which.ctypes.data))
        return which[: self._state.num_events]
