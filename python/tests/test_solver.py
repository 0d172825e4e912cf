# SPDX-License-Identifier: BSD-3-Clause
"""The solver step by step: what it returns, the theory's objects, threads, memory."""

import concurrent.futures
import copy
import gc
import pickle
import resource
import threading
import weakref

import numpy as np
import pytest

import sfdae
from models import PENDULUM_START, energy, forced_mass, oscillator, pendulum_problem

Status = sfdae.Status


def started(problem=None, x0=PENDULUM_START, **options):
    solver = sfdae.Solver(problem or pendulum_problem(), **options)
    solver.start(0.0, x0, 10.0)
    return solver


# ---- Steps ---------------------------------------------------------------------------------------


def test_points_of_every_kind():
    solver = sfdae.Solver(pendulum_problem(), rtol=1e-8, atol=1e-8)
    start = solver.start(0.0, PENDULUM_START, 10.0)
    assert (start.t, start.status, start.message) == (0.0, Status.OK, "")
    step = solver.step(10.0)
    assert step.status == Status.STEP_TAKEN and 0 < step.t < 10
    within = solver.interpolate(step.t / 2)
    assert abs(energy(within.x)) < 1e-6
    end = solver.advance(1.0)
    assert (end.t, end.status) == (1.0, Status.OK)
    assert solver.statistics.steps > 1 and solver.statistics.t_internal >= 1.0
    assert solver.initial_report.largest_change == pytest.approx(9.81 * 0.8 / 2)
    assert "Index analysis" in solver.report() and "largest change" in solver.report()


def test_a_failure_has_its_point_and_the_names_of_unknowns():
    problem = sfdae.NonlinearProblem(lambda t, x, xdot: [xdot[0] - x[0] ** 2], names=["size"])
    solver = started(problem, [1.0])
    with pytest.raises(sfdae.Error) as caught:
        solver.advance(2.0)
    assert caught.value.point.t == pytest.approx(1.0, abs=0.01) and caught.value.point.x[0] > 100
    with pytest.raises(sfdae.Error) as caught:
        solver.interpolate(0.0)
    assert caught.value.status == Status.ILLEGAL_ARGUMENT


def test_calls_before_a_start():
    solver = sfdae.Solver(pendulum_problem())
    for call in (
        lambda: solver.advance(1.0),
        lambda: solver.characteristics,
        lambda: solver.decisions,
    ):
        with pytest.raises(sfdae.Error) as caught:
            call()
        assert caught.value.status == Status.NOT_STARTED
    assert sfdae.Report(solver).characteristics is None


def test_options_can_be_changed():
    solver = started()
    solver.set_options(max_step=0.01)
    assert solver.advance(0.5).t == 0.5 and solver.statistics.last_step <= 0.01 * (1 + 1e-12)
    with pytest.raises(sfdae.Error):
        solver.set_options(max_step=-1.0)
    assert solver.advance(0.6).t == 0.6


def test_checkpoints_continue_in_every_bit():
    solver, other = started(), sfdae.Solver(pendulum_problem())
    solver.advance(1.0)
    other.restore_checkpoint(solver.save_checkpoint())
    assert np.array_equal(solver.advance(2.0).x, other.advance(2.0).x)
    with pytest.raises(sfdae.Error):
        other.restore_checkpoint([1.0, 2.0])


def test_a_stop_can_be_requested():
    solver = started()
    solver.request_stop()
    assert solver.advance(1.0).status == Status.STOPPED
    assert solver.advance(1.0).status == Status.OK


def test_events_of_the_solver():
    solver = started(sfdae.NonlinearProblem(oscillator, 2), [1.0, 0.0])
    solver.set_events(lambda t, x, xdot: [x[0], x[1]], 2, directions=[0, 1])
    point = solver.advance(10.0)
    assert point.status == Status.EVENT and solver.events.tolist() == [-1, 0]
    assert solver.advance(10.0).t == pytest.approx(np.pi, abs=1e-4)
    solver.set_events(None)
    assert solver.advance(10.0).t == 10.0
    with pytest.raises(ValueError, match="1 directions for 2"):
        solver.set_events(lambda t, x, xdot: x, 2, directions=[1])


def test_a_callback_that_cannot_evaluate_makes_steps_smaller():
    refused = []

    def f(t, order):
        if t > 0.5 and not refused:
            refused.append(t)
            raise sfdae.CannotEvaluate
        return [np.cos(t + order * np.pi / 2)]

    solver = started(sfdae.LinearProblem([[1.0]], [[0.0]], f), [0.0])
    assert solver.advance(1.0).x[0] == pytest.approx(np.sin(1), abs=1e-4)
    assert refused and solver.statistics.other_failures == 1


def test_a_callback_may_read_but_not_integrate():
    seen = []

    def event(t, x, xdot):
        seen.append(solver.statistics.steps)
        with pytest.raises(sfdae.Error) as caught:
            solver.advance(1.0)
        assert caught.value.status == Status.BUSY
        return 1.0

    solver = started()
    solver.set_events(event)
    solver.advance(0.1)
    assert seen


# ---- The theory's objects ------------------------------------------------------------------------


def test_projectors_have_their_defining_properties():
    solver = started()
    solver.advance(1.0)
    jet = solver.jet(1.0, 2)
    assert jet.shape == (5, 4)
    M, N, g = solver.derivative_array(1.0, 2, jet)
    Z1, Z2, Z3, T2 = solver.projectors(1.0, jet)
    assert (M.shape, N.shape, g.shape) == ((15, 15), (15, 5), (15,))
    assert np.abs(g).max() < 1e-9
    assert np.abs(Z2.T @ M).max() < 1e-10 * np.abs(M).max()
    assert np.abs(Z2.T @ N @ T2).max() < 1e-10 * np.abs(N).max()
    for Z in (Z1, Z2, T2):
        assert Z.T @ Z == pytest.approx(np.eye(Z.shape[1]), abs=1e-12)
    E1, A1, f1, A2, f2, residual = solver.strangeness_free_system(1.0, jet)
    assert (E1.shape, A2.shape, f2.shape) == ((2, 5), (3, 5), (3,))
    assert np.linalg.matrix_rank(np.vstack([E1, A2])) == 5
    along = solver.projectors(1.0)
    assert np.abs(along.T2 @ along.T2.T - T2 @ T2.T).max() < 1e-8
    assert solver.strangeness_free_system(1.0).E1.shape == (2, 5)
    assert solver.derivative_array(1.0, 1).M.shape == (10, 10)
    with pytest.raises(ValueError, match=r"jet has shape \(5, 1\), not \(5, 4\)"):
        solver.projectors(1.0, np.zeros((5, 1)))


def test_certificates():
    solver = sfdae.Solver(sfdae.NonlinearProblem(forced_mass, 3))
    solver.analyze(0.0, 1.0, [0, 1, 0])
    assert 1e-6 < solver.certify() <= 1


def test_linear_problems_are_analyzed_without_values():
    solver = sfdae.Solver(sfdae.LinearProblem([[0.0, 1.0], [0.0, 0.0]], np.eye(2)))
    assert solver.analyze(0.0, 1.0).strangeness_index == 1
    decision = solver.decisions[0]
    assert (decision.rows, decision.columns, decision.rank) == (2, 2, 1)
    assert sfdae.analyze(solver.problem).characteristics.algebraic == 2


def test_values_are_needed_to_analyze_nonlinear_problems():
    with pytest.raises(TypeError, match="x is needed"):
        sfdae.Solver(pendulum_problem()).analyze(0.0, 1.0)
    with pytest.raises(TypeError, match="x is needed"):
        sfdae.analyze(forced_mass, 0.0)
    assert sfdae.analyze(forced_mass, 0.0, [0, 1, 0]).characteristics.strangeness_index == 2


def test_changes_of_the_characteristic_values():
    """E x' = -x with E = 1 before t = 0.5 and 0 after it."""
    problem = sfdae.LinearProblem(
        lambda t: [[np.where(t < 0.5, 1.0, 0.0)]], [[-1.0]], num_unknowns=1
    )
    solver = sfdae.Solver(problem)
    solver.start(0.0, [1.0], 1.0)
    with pytest.raises(sfdae.Error) as caught:
        solver.advance(1.0)
    assert caught.value.status == Status.CHARACTERISTICS_CHANGED
    change = solver.change
    assert change.t == pytest.approx(0.5, abs=1e-6)
    assert (change.old_differential, change.new_differential) == (1, 0)


# ---- Threads -------------------------------------------------------------------------------------


def test_solvers_run_in_threads():
    """Parameter sweep: x'' = -k x."""

    def final(k):
        sol = sfdae.solve(
            oscillator, (0, 5), [1, 0], parameters={"k": k}, rtol=1e-8, atol=1e-8, t_eval=[5.0]
        )
        return sol.x[0, 0]

    values = np.linspace(0.5, 4, 16)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        results = list(pool.map(final, values))
    assert results == pytest.approx(np.cos(5 * np.sqrt(values)), abs=1e-4)


def test_a_second_thread_is_refused():
    is_within, may_go_on = threading.Event(), threading.Event()

    def monitor(progress):
        is_within.set()
        may_go_on.wait(30)

    solver = sfdae.Solver(pendulum_problem(), monitor=monitor)
    solver.start(0.0, PENDULUM_START, 1.0)
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        running = pool.submit(solver.advance, 0.1)
        is_within.wait(30)
        with pytest.raises(sfdae.Error) as caught:
            solver.statistics
        assert caught.value.status == Status.BUSY
        solver.request_stop()  # from any thread
        may_go_on.set()
        assert running.result().status == Status.STOPPED


# ---- Memory --------------------------------------------------------------------------------------


def test_solvers_cannot_be_copied():
    solver = started()
    for make in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match="cannot be pickled or copied"):
            make(solver)


def test_a_solver_is_freed_with_its_last_reference():
    solver = started()
    state = weakref.ref(solver._state)
    del solver
    assert state() is None


def test_a_solver_that_its_own_callbacks_know_is_freed():
    solver = sfdae.Solver(pendulum_problem(), monitor=lambda progress: solver is None)
    solver.set_events(lambda t, x, xdot: float(solver is not None))
    solver.start(0.0, PENDULUM_START, 1.0)
    solver.advance(0.1)
    reference = weakref.ref(solver)
    del solver
    gc.collect()
    assert reference() is None


def test_what_a_function_holds_is_freed_with_the_problem():
    class Data:
        rate = 2.0

    data = Data()
    reference = weakref.ref(data)
    problem = sfdae.NonlinearProblem(
        (lambda held: lambda t, x, xdot: [xdot[0] + held.rate * x[0]])(data), 1
    )
    sol = sfdae.solve(problem, (0, 1), [1.0])
    del data, problem
    gc.collect()
    assert reference() is None and sol.success


def test_many_solves_need_no_more_memory():
    def run(count):
        for _ in range(count):
            sfdae.solve(pendulum_problem(), (0, 0.2), PENDULUM_START)

    run(40)
    gc.collect()
    before, objects = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, len(gc.get_objects())
    run(200)
    gc.collect()
    # A solver of the pendulum has more than 50 kB: 200 of them would be 10 MB.
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 5000
    assert len(gc.get_objects()) - objects < 200


def test_failed_creations_leave_nothing():
    def equations(t, x, xdot):
        raise LookupError

    for _ in range(20):
        with pytest.raises(LookupError):
            sfdae.Solver(sfdae.NonlinearProblem(equations, 2))
    gc.collect()
    assert not [
        thing for thing in gc.get_objects() if isinstance(thing, sfdae._callbacks.CallbackState)
    ]


def test_the_structure_is_certified_at_the_start():
    solver = sfdae.Solver(pendulum_problem())
    assert solver.structure().summary.verdict == 0  # no point is known
    solver.start(0.0, PENDULUM_START, 10.0)
    structure = solver.structure()
    assert list(structure.differentiations) == [1, 1, 0, 0, 2]
    assert list(structure.orders) == [2, 2, 1, 1, 0]
    assert sorted(structure.assigned) == [0, 1, 2, 3, 4] and set(structure.block) == {0}
    assert structure.summary.verdict == 1 and structure.summary.freedom == 2
    assert structure.words == ""
    with pytest.raises(sfdae.Error):
        started(structure=7)


def test_source_of_the_equations():
    solver = sfdae.Solver(pendulum_problem())
    with pytest.raises(sfdae.Error):
        solver.export_source("pendulum")
    solver.start(0.0, PENDULUM_START, 10.0)
    assert "void pendulum_residual(double t, const double *z" in solver.export_source("pendulum")
    assert "pure subroutine pendulum_residual(" in solver.export_source("pendulum", "fortran")
    with pytest.raises(ValueError):
        solver.export_source("pendulum", "basic")
    with pytest.raises(sfdae.Error):
        solver.export_source("not a name")


def test_structure_is_required_by_name():
    solver = started(structure="required")
    assert solver.structure().summary.is_followed == 1
    with pytest.raises((ValueError, TypeError, sfdae.Error)):
        started(structure="certified")


def test_the_structure_names_equations_that_are_too_many():
    problem = sfdae.NonlinearProblem(
        lambda t, x, xdot: [xdot[0] ** 2 - t, x[0] ** 2 - 1, xdot[1] - x[0]],
        names=["left", "right", "none"],
    )
    structure = sfdae.Solver(problem).structure()
    assert structure.summary.has_assignment == 0 and list(structure.block) == [0, 0, -1]
    assert "equation 0" in structure.words and "left only" in structure.words


def linear(A=-1.0, E=1.0, f=0.0):
    return sfdae.LinearProblem([[E]], [[A]], [f])


def of_numbers(k=1.0, mass=1.0):
    return sfdae.NonlinearProblem(lambda t, x, k=k: [-k * x[0]], 1, mass=mass, record=False)


def spring(stiffness=1.0, mass=1.0):
    def forces(t, q, v, stiffness=stiffness):
        return [-stiffness * q[0]]

    return sfdae.MultibodyProblem(1, mass=[mass], forces=forces, record=False)


@pytest.mark.parametrize(
    "problem, name, value",
    [
        (linear, "A", -2.0),
        (linear, "E", 2.0),
        (linear, "f", 1.0),
        (of_numbers, "k", 2.0),
        (of_numbers, "mass", 2.0),
        (of_numbers, "mass", np.array([2.0])),
        (spring, "stiffness", 2.0),
        (spring, "mass", 2.0),
    ],
)
def test_checkpoints_compare_arrays_and_parameters(problem, name, value):
    solver = sfdae.Solver(problem())
    start = np.ones(problem().num_unknowns)
    solver.start(0, start, 2)
    solver.advance(1)
    checkpoint = solver.save_checkpoint()
    other, same = sfdae.Solver(problem(**{name: value})), sfdae.Solver(problem())
    with pytest.raises(sfdae.Error, match=f"was made with other values of {name} than"):
        other.restore_checkpoint(checkpoint)
    with pytest.raises(sfdae.Error, match="not a checkpoint of this version"):
        same.restore_checkpoint(checkpoint[:-1])
    same.restore_checkpoint(checkpoint)
    assert np.array_equal(same.advance(2).x, solver.advance(2).x)

    def two_modes(second):
        transition = sfdae.Transition("a", "b", time=1.0)
        return sfdae.Hybrid({"a": problem(), "b": second}, [transition])

    system = two_modes(problem())
    system.start("a", 0, start, 2)
    system.advance(0.5)
    checkpoint = system.save_checkpoint()
    with pytest.raises(sfdae.Error, match=f"other values of {name} of mode 'b' than"):
        two_modes(problem(**{name: value})).restore_checkpoint(checkpoint)
    same = two_modes(problem())
    same.restore_checkpoint(checkpoint)
    assert np.array_equal(same.advance(2).x, system.advance(2).x)
