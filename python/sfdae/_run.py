# SPDX-License-Identifier: BSD-3-Clause
"""One integration from start to end, with the collection of its results."""

from __future__ import annotations

import logging
import warnings
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ._binding import ffi, lib
from ._events import Event, EventRecord, joined
from ._report import Report
from ._solution import Solution, Steps
from ._inspection import ConditionSwitch
from ._points import Point
from ._recorded_solution import RecordedSolution
from ._solver import Solver
from ._status import Error, InitialValuesWarning, IntegrationWarning, Status

_log = logging.getLogger("sfdae")  # level INFO: messages as they occur, events, the end

_GOES_ON = (lib.SFDAE_OK, lib.SFDAE_STEP_TAKEN, lib.SFDAE_INCONSISTENCY_IGNORED)
# Ratio of attempts in a run to those between two outputs, unless a limit is given.
_SPANS_OF_RUN = 100
_UNKNOWN_ACCURACY = 1e300  # sfdae_get_solution_accuracy
_ACCURACY_TO_WARN = 10.0  # warning threshold for the error of dense output, in tolerances


class Run:
    """A running integration: calls the solver, records points, events and steps.

    The points reached are kept after any end: normal, an event, a failure, Ctrl-C.
    """

    def __init__(
        self,
        solver: Solver,
        t1: float,
        events: Sequence[Event],
        dense: RecordedSolution | None,
        parameters: Mapping[str, Any],
    ) -> None:
        self.solver = solver
        self.t1 = t1
        self.events = events
        self.dense = dense
        self.parameters = parameters  # values, of events as well
        self.points: list[tuple[float, np.ndarray, np.ndarray]] = []
        self.happened: list[EventRecord] = []
        self.status = Status.OK
        self.message = ""
        self.notes: list[str] = []
        self._switches: list[ConditionSwitch] = []  # before the last start
        self._warnings: list[tuple[str, type[Warning]]] = []
        self.last: Point | None = None
        self._counts = [0] * len(events)
        self._S: list[np.ndarray] | None = [] if solver._num_sensitivities > 0 else None
        self._limit = ffi.new("python_limit*")
        self._max_steps = 0  # in the whole run
        self._begun = lib.python_seconds()

    # ---- Integration -----------------------------------------------------------------------------

    def start(self, t0: float, x0: np.ndarray, xdot0: Any) -> None:
        """The consistent values at the start; a warning if they differ from the given ones."""
        if self.events:
            directions = [event.direction for event in self.events]
            function = joined(self.events, self.parameters)
            self.solver.set_events(function, len(self.events), directions)
        if self.dense is not None:
            self.solver.record(self.dense)
        point = self.solver.start(t0, x0, self.t1, xdot0)
        if point.status == Status.STOPPED:
            raise Error(point.status, point.message)
        if point.status > 0:
            self._note(point.message, InitialValuesWarning)
        self._add(point)

    def integrate(self, t_eval: np.ndarray | None, max_steps: int | None) -> None:
        """Integrates to the end, or as far as possible. max_steps: attempts in the whole run; None:
        the default of the library, or with output times, this default between two of them and a
        hundred times as many in the whole run.
        """
        self._limit_steps(max_steps, t_eval is None)
        try:
            if t_eval is not None:
                self._through(t_eval)
            else:
                self._step_by_step()
        except KeyboardInterrupt:
            self.solver._state.take_exception()
            if t_eval is None:
                self._add_reached(self.last)
            self._end(Status.STOPPED, "interrupted by the user")
        except Error as error:
            self._end(error.status, error.message)

    def _limit_steps(self, max_steps: int | None, has_one_call: bool) -> None:
        c, arrays = self.solver._c_options(self.solver._options)
        self._alive = c, arrays
        limit = self._limit
        limit.options, limit.each = c, c.max_steps  # given, or the default
        is_total = max_steps is not None or has_one_call
        self._max_steps = limit.attempts = c.max_steps * (1 if is_total else _SPANS_OF_RUN)
        limit.direction = 1.0 if self.t1 > self.last.t else -1.0
        if c.max_seconds > 0:
            limit.end = self._begun + c.max_seconds

    def _attempts(self) -> int:
        """Number of attempts since the last start."""
        statistics = self.solver.statistics
        return statistics.steps + statistics.error_failures + statistics.other_failures

    def _time_is_up(self) -> bool:
        return 0 < self._limit.end <= lib.python_seconds()

    def _through(self, t_eval: np.ndarray) -> None:
        """Integrates to given output times, as many as possible in one call."""
        n = self.solver.problem.num_unknowns
        count = t_eval.size
        t = np.full(count + 1, np.nan)
        x, xdot = np.empty((count + 1, n)), np.empty((count + 1, n))
        times = np.ascontiguousarray(t_eval)
        done = ffi.new("long*", 0)
        if count and times[0] == self.last.t:
            t[0], x[0], xdot[0] = self.last.t, self.last.x, self.last.xdot
            done[0] = 1
        pointers = [self.solver._pointer(array) for array in (t, x, xdot)]
        c_times = self.solver._pointer(times)
        if not done[0] and self._S is not None:
            self._S.clear()  # the start is not an output
        try:
            is_on = True
            while is_on and done[0] < count:
                # Sensitivities are available within the last step only.
                limit = count if self._S is None else done[0] + 1
                status = lib.python_advance_through(
                    self.solver._box[0], self._limit, c_times, limit, done, *pointers, n
                )
                k = min(done[0], limit - 1)
                point = Point(t[k], x[k].copy(), xdot[k].copy(), Status(status), "")
                if self._S is not None and point.t == times[k]:
                    self._S.append(self.solver.sensitivities(point.t, False)[0])
                is_on = self._next(status, point)
                done[0] += done[0] < limit and point.t == times[k]  # an event at an output
            if is_on and self.last.t != self.t1:
                self._to_end()
        finally:
            self.points = [(t[i], x[i], xdot[i]) for i in range(done[0])]

    def _to_end(self) -> None:
        """Integrates from the last output to the end, which may include events or failures."""
        while self._next(*self._call(0)) and self.last.t != self.t1:
            pass

    def _step_by_step(self) -> None:
        """Integrates step by step: the outputs are the ends of the steps."""
        while self.last.t != self.t1:
            status, point = self._call(1)
            goes_on = self._next(status, point)
            self._add_reached(point)
            if not goes_on:
                return

    def _call(self, one_step: int) -> tuple[int, Point]:
        """Integrates to the end, or one step toward it."""
        solver = self.solver
        t = ffi.new("double*", np.nan)
        x, xdot = np.empty((2, solver.problem.num_unknowns))
        pointers = t, solver._pointer(x), solver._pointer(xdot)
        status = lib.python_advance(solver._box[0], self._limit, one_step, self.t1, *pointers)
        return status, Point(t[0], x, xdot, Status(status), "")

    def _add_reached(self, point: Point) -> None:
        """Adds the point returned by a call if it is new, and the one after an action, at the same
        time.
        """
        reached = self.last
        if not np.isnan(point.t) and point.t != self.points[-1][0]:
            self._add(point)
        if reached is not point and reached.x is not self.points[-1][1]:
            self._add(reached)

    def _add(self, point: Point) -> None:
        self.last = point
        self.points.append((point.t, point.x, point.xdot))
        if self._S is not None:
            self._S.append(self.solver.sensitivities(point.t, False)[0])

    def _next(self, status: int, point: Point) -> bool:
        """Handles the result of a call; returns whether the integration continues."""
        exception = self.solver._state.take_exception()
        is_ahead = (point.t - self.last.t) * (
            self.t1 - self.last.t
        ) > 0  # False for NaN, if nothing was returned
        if is_ahead or status == lib.SFDAE_EVENT:
            self.last = point
        if exception is not None:
            raise exception
        message = self.solver.message if status != lib.SFDAE_OK else ""
        if status == lib.SFDAE_MAX_STEPS and self._attempts() >= self._limit.attempts:
            message = (
                f"{self._max_steps} steps attempted in the whole run, the limit max_steps, without "
                f"reaching the end t = {self.t1:.9g}. Raise max_steps, or loosen the tolerances. "
                "If the steps are very small, look for their reason first, such as an equation "
                "that jumps."
            )
        if status == lib.SFDAE_STOPPED and self._time_is_up():
            message = (
                f"{self.solver._options['max_seconds']:.9g} seconds passed in the whole run, the "
                f"limit max_seconds, without reaching the end t = {self.t1:.9g}."
            )
        if status == lib.SFDAE_INCONSISTENCY_IGNORED and message not in self.notes:
            self._note(message, IntegrationWarning)
        if status == lib.SFDAE_EVENT:
            return self._handle_event(point)
        if status not in _GOES_ON:
            self._end(Status(status), message)
        return status in _GOES_ON

    # ---- Events ----------------------------------------------------------------------------------

    def _handle_event(self, point: Point) -> bool:
        """Records the events at a point and calls their actions; returns whether it continues."""
        which = self.solver.events
        x, xdot = point.x, point.xdot
        is_restarted = ends = False
        for i in np.flatnonzero(which):
            event = self.events[i]
            self._counts[i] += 1
            _log.info("event %r at t = %.9g", event.name, point.t)
            self.happened.append(
                EventRecord(point.t, point.x, point.xdot, int(i), event.name, int(which[i]))
            )
            if self._counts[i] >= event.limit:
                self._end(
                    Status.EVENT, f"event {event.name!r} ended the integration at t = {point.t:.9g}"
                )
                ends = True
            if event.action is not None:
                changed = event.action(point.t, x.copy(), xdot.copy(), self.parameters)
                if changed is not None:
                    if self._S is not None:
                        raise ValueError(
                            f"the action of event {event.name!r} changes x at t = {point.t:.9g}, and its "
                            "derivatives, which the sensitivities need there, are not known: use "
                            "sfdae.Hybrid, which carries sensitivities over jumps"
                        )
                    name = f"x of the action of event {event.name!r}"
                    x = self.solver.problem.values(changed, name, missing=x)
                    is_restarted = True
        if ends or not is_restarted or point.t == self.t1:
            return not ends
        self._limit.attempts -= self._attempts()
        self._switches += self.solver.switches
        restart = self.solver.start(point.t, x, self.t1)
        if restart.status > 0:
            self._note(
                f"after an event at t = {point.t:.9g}: {restart.message}", InitialValuesWarning
            )
        self.last = restart
        return True

    # ---- Result ----------------------------------------------------------------------------------

    def warn(self, stacklevel: int) -> None:
        """Issues the collected warnings."""
        for message, category in self._warnings:
            warnings.warn(message, category, stacklevel=stacklevel + 1)

    def _note(self, message: str, category: type[Warning]) -> None:
        _log.info("%s", message)
        self.notes.append(message)
        self._warnings.append((message, category))

    def _end(self, status: Status, message: str) -> None:
        self.status, self.message = status, message

    def solution(self) -> Solution:
        """The collected results; warns if the run ended early."""
        solver, problem = self.solver, self.solver.problem
        if self.status < 0:
            text = self.message or self.status.name
            self.message = f"the integration ended at t = {self.last.t:.9g}: {text}"
            self._warnings.append((self.message, IntegrationWarning))
        elif self.status == Status.STOPPED:
            self.message = f"stopped at t = {self.last.t:.9g}" + (
                f": {self.message}" if self.message else ""
            )
            if self._time_is_up():
                self._warnings.append((self.message, IntegrationWarning))
        elif self.status == Status.OK:
            self.message = "the end of the interval was reached"
        _log.info("%s", self.message)
        if self.dense is not None:
            self._finish_dense()
        times = np.array([point[0] for point in self.points])
        x = np.array([point[1] for point in self.points]).reshape(-1, problem.num_unknowns)
        xdot = np.array([point[2] for point in self.points]).reshape(-1, problem.num_unknowns)
        S = None
        if self._S is not None:
            shape = (-1, problem.num_unknowns, solver._num_sensitivities)
            S = np.array(self._S[: times.size]).reshape(shape).transpose(1, 2, 0)
        steps = solver._steps()
        by_function = [[e for e in self.happened if e.index == i] for i in range(len(self.events))]
        return Solution(
            t=times,
            x=x.T,
            xdot=xdot.T,
            S=S,
            status=self.status,
            message="; ".join([self.message, *self.notes]),
            last=self.last._replace(status=self.status, message=self.message),
            events=self.happened,
            t_events=[np.array([e.t for e in events]) for events in by_function],
            x_events=[
                np.array([e.x for e in events]).reshape(-1, problem.num_unknowns)
                for events in by_function
            ],
            switches=self._switches + solver.switches,
            report=Report(solver),
            steps=Steps(steps[:, 0], steps[:, 1], steps[:, 2].astype(int)),
            dense=self.dense,
            names=problem.names,
            units=dict(problem.units),
        )

    def _finish_dense(self) -> None:
        """Cuts the dense output at the end of the run, for example within the last step."""
        dense = self.dense
        self.solver.record(None)
        if dense.is_empty:
            return
        if dense.t_min <= self.last.t <= dense.t_max:
            dense.cut(self.last.t)
        if not dense.is_empty and dense.accuracy > _ACCURACY_TO_WARN:
            is_known = dense.accuracy < _UNKNOWN_ACCURACY
            difference = f"up to {dense.accuracy:.0f} tolerances" if is_known else "an unknown amount"
            self._note(
                f"dense output differs from the solution by {difference} near t = {dense.worst_t:.6g}, "
                "where it has a jump or a kink: sol.t and sol.x are accurate there",
                IntegrationWarning,
            )
