# SPDX-License-Identifier: BSD-3-Clause
"""Hybrid systems: modes, transitions between them, and an integration across all of them."""

from __future__ import annotations

import threading
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ._binding import ffi, lib
from ._checkpoint import with_numbers, without_numbers
from ._modes import Jump
from ._points import Point
from ._problem import Problem
from ._recorded_solution import RecordedSolution
from ._sensitivities import _gradient, _Request
from ._solver import Solver
from ._status import Error, Status
from ._structs import Struct, filled
from ._switch import SurfaceState, Switch
from ._transition import Passage, Transition, _State


class Hybrid:
    """A system with several modes, each a problem of its own with the same unknowns, and
    transitions between them. A mode is analyzed when it is first entered.

    Parameters
    ----------
    modes : mapping
        Problems, or solvers, by the names of their modes.
    transitions : sequence of Transition
    switches : sequence of Switch
        Each adds a mode, to which transitions may refer. Transitions are counted from 0 on, the
        four of each switch first.
    **options
        Options of the solvers of modes that are given as problems. max_steps limits the attempted
        steps of a call between two transitions.

    Raises
    ------
    Error
        ``ILLEGAL_ARGUMENT`` with the reason in the message.
    """

    def __init__(
        self,
        modes: Mapping[str, Problem | Solver],
        transitions: Sequence[Transition] = (),
        switches: Sequence[Switch] = (),
        **options: Any,
    ) -> None:
        self.solvers = {
            name: mode if isinstance(mode, Solver) else Solver(mode, **options)
            for name, mode in modes.items()
        }
        if not self.solvers:
            raise ValueError("a hybrid system needs modes")
        self._require_same_unknowns()
        self._names = list(self.solvers)
        self._equations: dict[str, str] = {}  # of sliding modes: the mode that has their parameters
        self._num_sensitivities = 0
        self._states: list[_State | SurfaceState] = []
        self._handles: list[Any] = []
        self._lock = threading.RLock()
        self._box = ffi.new("sfdae_hybrid**")
        if lib.sfdae_create_hybrid(self._box) < 0:
            raise Error(Status.OUT_OF_MEMORY, "out of memory")
        for name, solver in self.solvers.items():
            self._call(lib.sfdae_add_mode, solver._box[0], name.encode(), ffi.NULL)
        for switch in switches:
            self._add_switch(switch)
        for transition in transitions:
            self._add(transition)

    def _require_same_unknowns(self) -> None:
        """ValueError for modes that have the same names in other orders."""
        first, *others = self.solvers
        names = self.solvers[first].problem.names
        for mode in others:
            for i, name in enumerate(self.solvers[mode].problem.names):
                if name in names and names.index(name) != i:
                    raise ValueError(
                        f"{name!r} is the name of x[{names.index(name)}] in mode {first!r} and of "
                        f"x[{i}] in mode {mode!r}: modes have the same unknowns in the same order"
                    )

    def __del__(self, destroy: Callable[[Any], int] = lib.sfdae_destroy_hybrid) -> None:
        box = getattr(self, "_box", None)
        if box is not None:
            destroy(box)

    def __reduce__(self) -> Any:
        raise TypeError("hybrid systems cannot be pickled or copied; see save_checkpoint")

    @property
    def _problem(self) -> Any:
        return self.solvers[self._names[0]].problem

    def _number(self, name: str) -> int:
        if name not in self._names:
            raise ValueError(f"there is no mode {name!r}; there are {', '.join(self._names)}")
        return self._names.index(name)

    def _add_switch(self, switch: Switch) -> None:
        below, above = self._number(switch.below), self._number(switch.above)
        self._equations[switch.name] = self._equations.get(switch.below, switch.below)
        problem = self.solvers[self._equations[switch.name]].problem
        state = SurfaceState(switch, problem)
        handle = ffi.new_handle(state)
        self._states.append(state)
        self._handles.append(handle)
        name = switch.name.encode()
        surface = lib.python_equations_function
        self._call(lib.sfdae_add_switch, below, above, surface, handle, name, ffi.NULL)
        self._names.append(switch.name)

    def _add(self, transition: Transition) -> None:
        number = self._number(transition.source)
        solver = self.solvers[self._equations.get(transition.source, transition.source)]
        state = _State(transition, solver.problem, solver._state.values)
        handle = ffi.new_handle(state)
        c = ffi.new("sfdae_transition*")
        lib.sfdae_transition_init(c, ffi.sizeof(c[0]))
        setattr(c, "from", number)
        c.to = self._number(transition.target)
        c.kind = transition.kind
        c.direction = transition.direction
        c.user = handle
        if transition.time is not None:
            c.time = transition.time
        if transition.function is not None:
            c.function = lib.python_transition_function
        if transition.guard is not None:
            c.guard = lib.python_transition_guard
        if transition.jump is not None:
            c.jump = lib.python_transition_jump
        self._call(lib.sfdae_add_transition, c, ffi.NULL)
        self._states.append(state)
        self._handles.append(handle)

    def _call(self, function: Callable[..., int], *arguments: Any) -> int:
        if not self._lock.acquire(blocking=False):
            raise Error(Status.BUSY, "the hybrid system is in use by another thread")
        try:
            status = function(self._box[0], *arguments)
        finally:
            self._lock.release()
        raised = [state.exception for state in self._states if state.exception is not None]
        for state in self._states:
            state.exception = None
        raised += [e for s in self.solvers.values() if (e := s._state.take_exception()) is not None]
        if raised:
            raise raised[0]
        if status < 0:
            raise Error(status, self.message)
        return status

    def _point(self, function: Callable[..., int], *arguments: Any) -> Point:
        t = ffi.new("double*", np.nan)
        x, xdot = np.full((2, self._problem.num_unknowns), np.nan)
        try:
            status = self._call(function, *arguments, t, _address(x), _address(xdot))
        except Error as error:
            if not np.isnan(t[0]):
                error.point = Point(t[0], x, xdot, error.status, error.message)
            raise
        return Point(t[0], x, xdot, Status(status), self.message)

    @property
    def message(self) -> str:
        """Message of the last call; a message of a solver begins with its mode."""
        text = ffi.string(lib.sfdae_get_hybrid_message(self._box[0]))
        return self._problem.with_names(text.decode(errors="replace"))

    def request_stop(self) -> None:
        """Stops the current call, or else the next one; any thread may call it."""
        lib.sfdae_request_stop_hybrid(self._box[0])

    # ---- Integration -----------------------------------------------------------------------------

    def start(self, mode: str, t: float, x: Any, toward: float) -> Point:
        """Starts at (t, x) in a mode and returns the consistent values, in the mode reached if a
        condition of that mode holds there.
        """
        values = self._problem.values(x, "x")
        xdot = np.zeros_like(values)
        number = self._number(mode)
        status = self._call(
            lib.sfdae_start_hybrid, number, t, toward, _address(values), _address(xdot)
        )
        return Point(float(t), values, xdot, Status(status), self.message)

    def advance(self, tout: float) -> Point:
        """Integrates to tout across all transitions on the way.

        Raises
        ------
        Error
            ``ZENO`` if transitions accumulate, see accumulation; error.point is the one reached.
        """
        return self._point(lib.sfdae_advance_hybrid, tout)

    def advance_to_transition(self, tout: float) -> Point:
        """Integrates to the next transition, with the status ``EVENT`` and the values after it, or
        to tout.
        """
        return self._point(lib.sfdae_advance_to_transition, tout)

    def record(self, solution: RecordedSolution | None) -> None:
        """Records all following accepted steps in all modes in the solution; None: stops recording.
        """
        self._call(lib.sfdae_record_hybrid, ffi.NULL if solution is None else solution._box[0])

    # ---- Sensitivities ---------------------------------------------------------------------------

    def set_sensitivities(
        self,
        names: Sequence[str],
        directions: Any = None,
        error_test: bool = False,
        scales: Any = None,
        adjoint: bool = False,
        max_kept_steps: int = 0,
    ) -> None:
        """Requests derivatives of the solution from the next start() on, over all modes and
        transitions: see Solver.set_sensitivities. The names are those of parameters of some mode,
        or of unknowns, for their start values. None: no sensitivities.

        Raises
        ------
        ValueError
            For a parameter of conditions, guards or jumps, which may depend on parameters only
            through x.
        """
        for state in self._states:
            if isinstance(state, _State):
                state.require_independence(names)
        request = _Request(
            self._problem, names, directions, error_test, scales, adjoint, max_kept_steps
        )
        self._call(lib.sfdae_set_hybrid_sensitivities, *request.arguments)
        self._num_sensitivities = request.count

    def sensitivities(self, t: float, slopes: bool = True) -> tuple[np.ndarray, np.ndarray | None]:
        """S = dx/dp and S' at t, n x p each, at the time returned by the last call or within the
        last step; after a transition at t, those after it. slopes: False: None instead of S'.
        """
        shape = (max(self._num_sensitivities, 1), self._problem.num_unknowns)
        S, Sdot = np.empty(shape), np.empty(shape) if slopes else None
        self._call(
            lib.sfdae_get_hybrid_sensitivities,
            t,
            _address(S),
            _address(Sdot) if slopes else ffi.NULL,
        )
        return S.T, Sdot.T if slopes else None

    @property
    def passage_sensitivities(self) -> np.ndarray:
        """dt/dp of the last transition, one for each parameter."""
        dt = np.empty(max(self._num_sensitivities, 1))
        self._call(lib.sfdae_get_passage_sensitivities, _address(dt))
        return dt

    def gradient(self, t: Any, weights: Any) -> np.ndarray:
        """Gradients of functionals by the adjoint, back over all transitions and along surfaces,
        for set_sensitivities(..., adjoint=True): see Solver.gradient. At the time of a transition,
        weights refer to x after it.
        """
        return _gradient(
            lambda *arguments: self._call(lib.sfdae_get_hybrid_gradient, *arguments),
            (self._problem.num_unknowns, self._num_sensitivities),
            t,
            weights,
        )

    # ---- Inspection ------------------------------------------------------------------------------

    @property
    def mode(self) -> str:
        """The current mode."""
        number = ffi.new("int*")
        self._call(lib.sfdae_get_current_mode, number)
        return self._names[number[0]]

    @property
    def modes(self) -> dict[str, Struct]:
        """Statistics of each mode since the start: visits, duration, steps, num_analyses,
        strangeness_index (-1: not analyzed yet), differential, algebraic.
        """
        return {
            name: filled("mode", lambda mode, k=k: self._call(lib.sfdae_get_mode, k, mode))
            for k, name in enumerate(self._names)
        }

    @property
    def num_passages(self) -> int:
        """Number of transitions since the start, including those before a checkpoint."""
        count = ffi.new("long*")
        self._call(lib.sfdae_get_num_passages, count)
        return count[0]

    def passage(self, index: int) -> Passage:
        """The transition with number `index`, from 0 on."""
        found = filled("passage", lambda p: self._call(lib.sfdae_get_passage, index, p))._asdict()
        source, target = self._names[found.pop("from")], self._names[found.pop("to")]
        return Passage(source=source, target=target, **found)

    @property
    def last_jump(self) -> Jump:
        """Values before and after the last transition, with only the impulse of order 0."""
        n = self._problem.num_unknowns
        before, after = np.empty((2, n))
        impulses = np.empty((n, 1))
        self._call(
            lib.sfdae_get_passage_values, _address(before), _address(after), _address(impulses)
        )
        return Jump(self.passage(self.num_passages - 1).t, before, after, impulses)

    @property
    def accumulation(self) -> float:
        """The time at which transitions accumulate, after ``ZENO``."""
        t = ffi.new("double*")
        self._call(lib.sfdae_get_accumulation, t)
        return t[0]

    @property
    def statistics(self) -> Struct:
        """Counts over all modes."""
        return filled("statistics", lambda s: self._call(lib.sfdae_get_hybrid_statistics, s))

    def report(self) -> str:
        """Modes with their index, visits, times and steps, and the last transitions."""
        needed = ffi.new("size_t*")
        self._call(lib.sfdae_report_hybrid, ffi.NULL, 0, needed)
        text = ffi.new("char[]", needed[0])
        self._call(lib.sfdae_report_hybrid, text, needed[0], needed)
        return ffi.string(text).decode(errors="replace")

    # ---- Checkpoints -----------------------------------------------------------------------------

    def _numbers(self) -> dict[str, Any]:
        return {
            f"{name} of mode {mode!r}": value
            for mode, solver in self.solvers.items()
            for name, value in solver._numbers().items()
        }

    def save_checkpoint(self) -> np.ndarray:
        """The state of the run as an array of numbers."""
        length = ffi.new("size_t*")
        self._call(lib.sfdae_get_hybrid_checkpoint_length, length)
        checkpoint = np.empty(length[0])
        self._call(lib.sfdae_save_hybrid_checkpoint, _address(checkpoint), length[0])
        return with_numbers(checkpoint, self._numbers())

    def restore_checkpoint(self, checkpoint: Any) -> None:
        """Continues from a checkpoint instead of start(), with the same modes and transitions.

        Formulas, arrays and parameters of all modes are compared; functions that are called with
        numbers, such as conditions, cannot be compared: pass the same ones.
        """
        values = without_numbers(checkpoint, self._numbers())
        self._call(lib.sfdae_restore_hybrid_checkpoint, _address(values), values.size)


def _address(array: np.ndarray) -> Any:
    return ffi.cast("double*", array.ctypes.data)
