# SPDX-License-Identifier: BSD-3-Clause
"""sfdae.solve, sfdae.analyze and sfdae.make_consistent: everything in one call."""

from __future__ import annotations

from collections import ChainMap
from typing import Any, Callable, Mapping, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from ._equations import Equations
from ._events import Event, as_events
from ._formula import checked_value
from ._options import check_names
from ._problem import NonlinearProblem, Problem
from ._progress import ProgressBar
from ._recorded_solution import RecordedSolution
from ._report import Report
from ._run import Run
from ._solution import Solution
from ._points import Point, Progress
from ._solver import Solver
from ._types import Breakpoints, Tolerance, Units, Unknowns, Values
from ._unknowns import by_name, names_for

ProblemOrFunction = Union[Problem, Callable[..., Any]]
EventOrFunction = Union[Event, Callable[..., Any]]


def solve(
    problem: ProblemOrFunction,
    t_span: Sequence[float],
    x0: Values,
    *,
    method: str = "bdf",
    rtol: Tolerance | None = None,
    atol: Tolerance | None = None,
    t_eval: ArrayLike | None = None,
    dense_output: bool | None = None,
    events: EventOrFunction | Sequence[EventOrFunction] | None = None,
    breakpoints: Breakpoints | None = None,
    fixed: Unknowns | None = None,
    parameters: Mapping[str, Any] | None = None,
    max_steps: int | None = None,
    sensitivities: Sequence[str] | None = None,
    xdot0: Values | None = None,
    names: Sequence[str] | None = None,
    units: Units | None = None,
    mass: Any = None,
    record: bool = True,
    progress: bool = False,
    monitor: Callable[[Progress], Any] | None = None,
    **options: Any,
) -> Solution:
    """Solves an initial value problem F(t, x, x') = 0 of arbitrary index, similar to scipy's
    solve_ivp.

    Parameters
    ----------
    problem : Problem or callable
        A NonlinearProblem, LinearProblem or MultibodyProblem, or a function ``F(t, x, xdot)`` that
        returns the list of equations; it is called once, with expressions, and recorded. Further
        arguments of it are named parameters.
    t_span : (float, float)
        Start and end, not equal; the end may come first. Nothing is evaluated beyond the end.
    x0 : array_like or dict
        n values, or values by name, also as a pandas Series: the names are those of the problem,
        those in ``names``, or those under which the function unpacks x, as in ``p, q, u = x``. Use
        0 as the initial guess of anything unknown at the start (forces, currents); it is the
        default for unknowns without a value. The library finds consistent values and keeps the
        differential variables if possible.
    method : str
        ``"bdf"``, ``"radau"`` (fewer and longer steps for smooth problems and tight tolerances) or
        ``"automatic"``.
    rtol, atol : float or array_like or dict, optional
        The error of unknown i is kept near rtol |x_i| + atol; default 1e-6 each.
    t_eval : array_like, optional
        Times of the outputs, in the order of integration, within t_span. By default the ends of all
        steps.
    dense_output : bool, optional
        True: ``sol(t)`` can be evaluated at any t. By default true if t_eval is not given; it costs
        a few interpolations a step. ``sol.dense`` is a RecordedSolution, which can be saved.
    events : callable, Event, or sequence of these, optional
        Functions ``g(t, x)`` or ``g(t, x, xdot)`` whose zeros are located; further arguments are
        named parameters; see Event. The attributes ``terminal`` and ``direction`` of functions are
        used as in solve_ivp.
    breakpoints : sequence of float or dict, optional
        Times of kinks in the data, at which steps end; or a dict of times and ``"kink"`` or
        ``"jump"``, the latter if x may jump. See Solver.set_breakpoints.
    fixed : sequence of str or int or bool, or dict, optional
        Unknowns whose initial values must not change; a dict has flags by name.
    parameters : dict, optional
        Values of named parameters, of the equations and of events.
    max_steps : int, optional
        Maximum number of attempted steps in the whole run, including restarts after events. By
        default 100,000 in the whole run, or with t_eval 100,000 between two outputs and 10,000,000
        in the run.
    max_seconds : float, optional
        Wall-clock time of the whole run in seconds; by default there is no limit. A run that takes
        longer ends with ``Status.STOPPED`` and the part reached.
    sensitivities : sequence of str, optional
        Names of parameters, or of unknowns (for their start values), with respect to which the
        solution is differentiated: ``sol.S``. For recorded problems; see Solver.set_sensitivities.
        Actions of events must not change x then (ValueError): Hybrid supports sensitivities over
        jumps.
    xdot0 : array_like or dict, optional
        An initial guess of x', for problems that allow several.
    names, units : sequence of str, optional
        Names and units of the unknowns, in the order of x, if the problem is a function. Required
        if x0 is a dict and the function does not unpack x as a whole; the order of the keys does
        not matter.
    mass : float, array_like, matrix of scipy.sparse, or callable, optional
        M of M x' = f(t, x), if the problem is a function ``f(t, x)``; see NonlinearProblem.
    record : bool
        False, if the problem is a function: it is called with numbers at every point, and Jacobians
        are central differences. For code that cannot be recorded; see NonlinearProblem.
    progress : bool
        Shows a bar with time, step size and order.
    monitor : callable, optional
        Called after every step with a Progress; a true result stops.
    **options
        Further members of sfdae_options by name, such as max_step, max_index, initial_step:
        ``sfdae.OPTION_NAMES``. Large problems use sparse matrices automatically if the structural
        analysis is confirmed numerically; ``structure="required"`` uses sparse matrices or fails
        with the reason, ``"off"`` uses the full derivative array, ``"automatic"`` is the default.

    Returns
    -------
    Solution
        ``sol.t, sol.x`` (n x N), ``sol.xdot, sol(t), sol["name"], sol.events, sol.report,
        sol.status, sol.message``. If the integration fails or is stopped (including Ctrl-C), the
        part reached, with a warning.

    Raises
    ------
    Error
        If the problem cannot be started: invalid arguments, an index that is too high or unclear,
        values for which there is no solution.
    Exception
        An exception of a callback stops the solver and is raised with its traceback.

    Warns
    -----
    InitialValuesWarning
        If initial values of differential variables had to change, or the solution is not unique.
    IntegrationWarning
        If the end was not reached, for example with ``Status.MAX_STEPS`` because of max_steps.

    Examples
    --------
    >>> import numpy as np, sfdae
    >>> def pendulum(t, x, xdot, g=9.81):
    ...     p, q, u, v, force = x
    ...     motion = [xdot[0] - u, xdot[1] - v]
    ...     balance = [xdot[2] + 2 * p * force, xdot[3] + 2 * q * force + g]
    ...     return [*motion, *balance, p**2 + q**2 - 1]
    >>> sol = sfdae.solve(pendulum, (0, 10), [0.6, -0.8, 0, 0, 0], rtol=1e-8)
    >>> sol.report.characteristics.strangeness_index
    2
    >>> bool(abs(sol(5.0)[0] ** 2 + sol(5.0)[1] ** 2 - 1) < 1e-6)
    True
    """
    problem = as_problem(
        problem, x0, names, units=units, mass=mass, record=record, parameters=parameters
    )
    t0, t1 = span(t_span)
    times = None if t_eval is None else output_times(t_eval, t0, t1)
    dense_output = times is None if dense_output is None else bool(dense_output)
    options = with_stop_time(
        {
            **options,
            "method": method,
            "rtol": rtol,
            "atol": atol,
            "fixed": fixed,
            "max_steps": max_steps,
        },
        t1,
    )
    events = as_events(events)
    given, of_events = _split_parameters(parameters or {}, problem, events)
    solver = Solver(problem, parameters=given, monitor=monitor, **options)
    known = ChainMap(solver._state.values, of_events)
    for event in events:
        for function in event.functions:
            function.check(problem, known)
    dense = RecordedSolution() if dense_output else None
    bar = ProgressBar(t0, t1) if progress else None
    if isinstance(breakpoints, Mapping):
        solver.set_breakpoints(sorted(breakpoints), [breakpoints[t] for t in sorted(breakpoints)])
    elif breakpoints is not None:
        solver.set_breakpoints(breakpoints)
    solver._recorder.records = 1
    if bar is not None:
        solver._set_monitor(bar.watch(monitor))
    if sensitivities is not None:
        solver.set_sensitivities(sensitivities)
    run = Run(solver, t1, events, dense, known)
    try:
        run.start(t0, problem.values(x0), None if xdot0 is None else problem.values(xdot0, "xdot0"))
        run.integrate(times, max_steps)
        return run.solution()
    finally:
        if bar is not None:
            bar.close(t0 if run.last is None else run.last.t, solver._recorder.count)
        run.warn(stacklevel=2)


def analyze(
    problem: ProblemOrFunction,
    t: float = 0.0,
    x: Values | None = None,
    *,
    toward: float | None = None,
    names: Sequence[str] | None = None,
    mass: Any = None,
    record: bool = True,
    parameters: Mapping[str, Any] | None = None,
    **options: Any,
) -> Report:
    """Detects the strangeness index and the characteristic values, with every rank decision.

    Parameters
    ----------
    problem : Problem or callable
        As for solve.
    t, toward : float
        The index is detected at t and at a nearby point in the direction of `toward`, by default t
        + 1.
    x : array_like or dict, optional
        Values near the solution; linear problems need none.
    names, mass, record, parameters, **options
        As for solve; names are required for a dict x if they cannot be read from the function.

    Returns
    -------
    Report
        ``report.characteristics, report.decisions``, ``print(report)``, ``report.plot()``.

    Raises
    ------
    Error
        If the index cannot be determined; ``error.report`` has the rank decisions.
    """
    if x is None and not isinstance(problem, Problem):
        raise TypeError("x is needed: the index of a nonlinear problem depends on the solution")
    problem = as_problem(problem, x, names, mass=mass, record=record, parameters=parameters)
    solver = Solver(problem, parameters=parameters, **options)
    try:
        solver.analyze(t, t + 1.0 if toward is None else toward, x)
    except Exception as error:
        error.report = Report(solver)
        raise
    return Report(solver)


def make_consistent(
    problem: ProblemOrFunction,
    t: float,
    x: Values,
    *,
    xdot: Values | None = None,
    fixed: Unknowns | None = None,
    names: Sequence[str] | None = None,
    mass: Any = None,
    record: bool = True,
    parameters: Mapping[str, Any] | None = None,
    **options: Any,
) -> Point:
    """Consistent values near x, and the derivative of the solution through them.

    Parameters
    ----------
    problem, fixed, names, mass, record, parameters, **options
        As for solve; initial_values is ``"nearest"``, ``"fixed"`` or ``"accept"``.
    t : float
    x : array_like or dict
        n values, or values by name; the initial guess of others is 0.
    xdot : array_like or dict, optional
        An initial guess of x', for problems that allow several.

    Returns
    -------
    Point
        ``t, x, xdot, status, message``; status is ``VALUES_CHANGED`` if values of differential
        variables changed.

    Raises
    ------
    Error
        If there are no consistent values.
    """
    problem = as_problem(problem, x, names, mass=mass, record=record, parameters=parameters)
    solver = Solver(problem, parameters=parameters, fixed=fixed, **options)
    return solver.make_consistent(t, x, xdot)


def as_problem(
    problem: ProblemOrFunction, x0: Any, names: Sequence[str] | None, **more: Any
) -> Problem:
    """A problem unchanged; a function as a nonlinear one, with as many unknowns as x0 has. more:
    further arguments of NonlinearProblem; parameters may include names unknown to the function.
    """
    if isinstance(problem, Problem):
        if names is not None or more.get("units") is not None:
            raise TypeError("names and units belong to the problem: give them there")
        if more.get("mass") is not None or not more.get("record", True):
            raise TypeError("mass and record belong to the problem: give them there")
        return problem
    if not callable(problem):
        raise TypeError(f"a problem or a function F(t, x, xdot) is needed, not {problem!r}")
    x0 = by_name(x0)
    count = np.size(x0)
    is_read = names is None and isinstance(x0, Mapping)
    if is_read:
        found = names_for(problem, x0)
        names, count = (None, found) if isinstance(found, int) else (found, len(found))
    elif names is not None:
        count = len(names)
    equations = Equations(problem, more.pop("mass", None))
    given = more.pop("parameters", None) or {}
    required = [name for formula in equations.formulas for name in formula.arguments.required]
    needed = {name: given[name] for name in required if name in given}
    result = NonlinearProblem(equations, count, names=names, parameters=needed, **more)
    result._must_confirm_names = is_read and names is not None
    return result


def _split_parameters(
    given: Mapping[str, Any], problem: Problem, events: Sequence[Event]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Values of parameters of the equations, and of those that only events have."""
    of_events = {
        name: checked_value(name, value)
        for name, value in given.items()
        if name not in problem.parameters
        and any(name in f.arguments.defaults for event in events for f in event.functions)
    }
    return {name: given[name] for name in given if name not in of_events}, of_events


def span(t_span: Sequence[float]) -> tuple[float, float]:
    try:
        t0, t1 = (float(t) for t in t_span)
    except (TypeError, ValueError):
        raise ValueError(f"t_span has to be (start, end), not {t_span!r}") from None
    if not (np.isfinite(t0) and np.isfinite(t1)) or t0 == t1:
        raise ValueError(f"t_span has to be two different finite times, not ({t0}, {t1})")
    return t0, t1


def output_times(t_eval: Any, t0: float, t1: float) -> np.ndarray:
    times = np.array(t_eval, dtype=float)
    if times.ndim != 1:
        raise ValueError(f"t_eval has shape {times.shape}: it has to be a vector of times")
    if not np.all((times >= min(t0, t1)) & (times <= max(t0, t1))):  # also NaN
        raise ValueError(f"t_eval has times outside of t_span = ({t0}, {t1})")
    if np.any(np.diff(times) * (t1 - t0) <= 0):
        raise ValueError("t_eval has to be in the order of integration, without repetitions")
    return times


def with_stop_time(options: dict[str, Any], t1: float) -> dict[str, Any]:
    """The options, with the end as stop time, beyond which nothing is evaluated, unless another is
    given.
    """
    check_names(options)
    if "stop_time" not in options and "use_stop_time" not in options:
        options["stop_time"] = t1
    return options
