# SPDX-License-Identifier: BSD-3-Clause
"""Ensembles by executors: the same bits as in threads, lost workers, exceptions, interrupts."""

import concurrent.futures
import multiprocessing
import os
import pathlib
import signal
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest

import sfdae
from sfdae import _executors
from sfdae._instances import Task, empty_outcome
from sfdae._jobs import Job, solve_chunk
from ensembles import COUNT, pendula, require_equal
from models import oscillator


@pytest.fixture(scope="module")
def expected():
    return pendula(threads=1)


def pool(kind, workers=2):
    if kind == "threads":
        return concurrent.futures.ThreadPoolExecutor(workers)
    context = multiprocessing.get_context(kind)
    return concurrent.futures.ProcessPoolExecutor(workers, mp_context=context)


@pytest.mark.parametrize("kind", ["threads", "fork", "spawn"])
def test_the_same_bits_for_all_executors_and_chunks(kind, expected):
    with pool(kind) as executor:
        for more in ({}, {"chunk": 1}, {"chunk": 17, "threads": 2}, {"chunk": 1000}):
            require_equal(expected, pendula(executor=executor, **more))


def test_values_by_name():
    def equations(t, x, xdot, k=1.0):
        height, speed = x
        return [xdot[0] - speed, xdot[1] + k * height]

    given = dict(parameters={"k": np.linspace(1, 2, 9)}, xdot=True)
    with pool("fork") as executor:
        found = sfdae.solve_ensemble(equations, (0, 1), {"height": 1}, executor=executor, **given)
    require_equal(sfdae.solve_ensemble(equations, (0, 1), {"height": 1}, **given), found)
    assert found.names == ("height", "speed")


def test_workers_of_another_version_are_refused():
    task = Task(0.0, np.array([1.0]), [], False)
    job = Job(sfdae.NonlinearProblem(oscillator, 2), {}, {}, task, 1)
    key, _, data = job.__getstate__()
    job.__setstate__((key, "0.0.1", data))
    answer = solve_chunk(job, np.ones((1, 2)), np.empty((1, 0)), (0, 0))
    assert "but the program that sends the ensemble has 0.0.1" in str(answer.exception)


class Waiting(concurrent.futures.Executor):
    """Keeps all chunks waiting."""

    num_workers = 1

    def submit(self, *arguments):
        return concurrent.futures.Future()


def test_clusters_that_grow_get_more_chunks(monkeypatch):
    """Three chunks for each worker, which are counted once a second."""
    seconds = iter([0.0, 0.5, 1.5])
    monkeypatch.setattr(_executors, "time", SimpleNamespace(monotonic=lambda: next(seconds)))
    task = Task(0.0, np.array([1.0]), [], False)
    job = Job(sfdae.NonlinearProblem(oscillator, 2), {}, {}, task, 1)
    outcome, data = empty_outcome(task, 100, 2), (np.ones((100, 2)), np.empty((100, 0)))
    executor = Waiting()
    run = _executors.Distribution(executor, job, *data, outcome, 1, 2, None)
    numbers = []
    for executor.num_workers in (1, 4, 4):
        assert run._send()
        numbers.append(len(run._sent))
    assert numbers == [3, 3, 12]


def test_progress_moves_with_the_chunks(capsys, expected):
    with pool("threads") as executor:
        require_equal(expected, pendula(executor=executor, chunk=10, progress=True))
    assert f"{COUNT} of {COUNT} instances" in capsys.readouterr().err


class Counted(concurrent.futures.ThreadPoolExecutor):
    """Keeps the numbers of instances that are sent."""

    def submit(self, function, *arguments):
        self.sizes = [*getattr(self, "sizes", []), len(arguments[1])]
        return super().submit(function, *arguments)


def test_chunks_are_long_enough_and_numerous():
    """16 chunks for each worker at the beginning, then at least 20 milliseconds of work."""
    count = 3200
    with Counted(2) as executor:
        sfdae.solve_ensemble(oscillator, (0, 0.1), np.ones((count, 2)), executor=executor)
    assert executor.sizes[0] == count // 32 and sum(executor.sizes) == count
    assert min(executor.sizes[:-1]) == count // 32  # the last one is the rest


def test_instances_that_fail_are_named():
    """h' = k h^2, h(0) = 1: h = 1 / (1 - k t)."""
    problem = sfdae.NonlinearProblem(
        lambda t, x, xdot, k=1.0: [xdot[0] - k * x[0] ** 2], names=["height"]
    )
    rates = {"k": np.where(np.arange(20) % 7 == 3, 1.0, 0.1)}
    results, warned = [], []
    with pool("fork") as executor:
        for more in ({}, {"executor": executor, "chunk": 6}):
            given = dict(parameters=rates, xdot=True, **more)
            with pytest.warns(sfdae.IntegrationWarning) as caught:
                results.append(sfdae.solve_ensemble(problem, (0, 2), [1.0], **given))
            warned.append(str(caught[0].message))
    require_equal(*results)
    assert [i for i, status in enumerate(results[1].status) if status < 0] == [3, 10, 17]
    assert warned[0] == warned[1] and "3 of 20 instances failed" in warned[1]
    assert results[1].messages[10] and not results[1].messages[11]


def dies_once(order, arguments):
    """Ends its process unless another one has ended before."""
    if order == 0 and arguments[0] > 0 and not os.path.exists(os.environ["SFDAE_TEST_FLAG"]):
        pathlib.Path(os.environ["SFDAE_TEST_FLAG"]).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return 0.0


def dies_above_one(order, arguments):
    if arguments[0] > 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return 0.0


def growth(function):
    return lambda t, x, xdot, k=1.0: [xdot[0] - k - sfdae.external("end", function, t + k)]


def test_the_chunk_of_a_lost_worker_is_sent_again(tmp_path, monkeypatch):
    monkeypatch.setenv("SFDAE_TEST_FLAG", str(tmp_path / "ended"))
    rates = np.linspace(0.1, 0.9, 12)
    with pool("fork") as executor:
        solution = sfdae.solve_ensemble(
            growth(dies_once), (0, 0.1), [0.0], parameters={"k": rates}, executor=executor, chunk=2
        )
    assert os.path.exists(tmp_path / "ended") and solution.success
    assert solution.x[:, 0, 0] == pytest.approx(0.1 * rates, abs=1e-9)


def test_instances_that_end_their_worker_are_stopped_with_the_reason():
    rates = np.array([0.1, 0.2, 0.3, 5.0, 0.4, 0.5, 0.6, 0.7])
    with pool("fork") as executor:
        with pytest.warns(sfdae.IntegrationWarning, match="1 of 8 instances have not come"):
            solution = sfdae.solve_ensemble(
                growth(dies_above_one), (0, 0.1), [0.0], parameters={"k": rates},
                executor=executor, chunk=1, retries=1,
            )  # fmt: skip
    stopped = [status == sfdae.Status.STOPPED for status in solution.status]
    assert stopped == [k > 1 for k in rates] and not solution.success
    assert "lost 2 times (BrokenProcessPool" in solution.messages[3]
    assert np.isnan(solution.x[3]).all()
    assert solution.x[rates < 1, 0, 0] == pytest.approx(0.1 * rates[rates < 1], abs=1e-9)


def fails_to_begin():
    raise RuntimeError("no license")


def test_workers_that_never_begin_stop_all():
    executor = concurrent.futures.ThreadPoolExecutor(1, initializer=fails_to_begin)
    with pytest.warns(sfdae.IntegrationWarning, match="9 of 9 instances"):
        solution = sfdae.solve_ensemble(oscillator, (0, 1), np.ones((9, 2)), executor=executor)
    assert all(status == sfdae.Status.STOPPED for status in solution.status)
    assert all("BrokenThreadPool" in message for message in solution.messages)


def divides_by_zero(order, arguments):
    return 1.0 / 0.0


@pytest.mark.parametrize("kind", ["threads", "fork"])
def test_an_exception_in_a_worker_keeps_its_traceback(kind):
    with pool(kind) as executor:
        with pytest.raises(ZeroDivisionError) as caught:
            sfdae.solve_ensemble(
                growth(divides_by_zero), (0, 1), np.ones((40, 1)), executor=executor, chunk=1
            )
        names = [frame.name for frame in caught.traceback]
        assert "divides_by_zero" in (names if kind == "threads" else str(caught.value.__cause__))
        result = sfdae.solve_ensemble(oscillator, (0, 1), np.ones((4, 2)), executor=executor)
        assert result.success  # the executor is still usable


class Unpicklable(Exception):
    def __init__(self, first, second):
        super().__init__(f"{first} and {second}")


def raises_unpicklable(order, arguments):
    raise Unpicklable("this", "that")


def test_exceptions_that_cannot_be_pickled():
    with pool("fork", 1) as executor:
        with pytest.raises(RuntimeError, match="Unpicklable in a worker: this and that"):
            sfdae.solve_ensemble(
                growth(raises_unpicklable), (0, 1), np.ones((2, 1)), executor=executor
            )


def test_functions_that_cannot_be_pickled():
    lock = threading.Lock()

    def locked(order, arguments):
        with lock:
            return 0.0

    given = growth(locked), (0, 1), np.zeros((4, 1))
    with pool("fork", 1) as executor:
        with pytest.raises(TypeError, match="external function 'end' of equations"):
            sfdae.solve_ensemble(*given, executor=executor)
    with pool("threads") as executor:  # nothing is pickled
        assert sfdae.solve_ensemble(*given, executor=executor).success


class Interrupted(concurrent.futures.ThreadPoolExecutor):
    """Ctrl-C is pressed while the tenth chunk is sent."""

    def submit(self, *arguments):
        self.count = getattr(self, "count", 0) + 1
        if self.count == 10:
            time.sleep(0.05)
            signal.raise_signal(signal.SIGINT)
        return super().submit(*arguments)


def test_interrupts_return_what_was_solved(expected):
    with Interrupted(1) as executor:
        with pytest.warns(sfdae.IntegrationWarning, match="stopped on request"):
            solution = pendula(executor=executor, chunk=1)
    stopped = np.array([status == sfdae.Status.STOPPED for status in solution.status])
    assert 50 <= stopped.sum() < COUNT and executor.count == 10
    assert np.array_equal(solution.x[~stopped], expected.x[~stopped])
    assert np.isnan(solution.x[stopped]).all()
    assert "the user interrupted" in solution.messages[-1]


@pytest.mark.parametrize(
    "more, error, text",
    [
        (dict(executor=3), TypeError, "executor has to be one of concurrent.futures, not 3"),
        (dict(chunk=3), TypeError, "sent together, needs an executor"),
        (dict(executor="threads", chunk=0), ValueError, "at least 1, not 0"),
        (dict(executor="threads", retries=-1), ValueError, "at least 0, not -1"),
        (dict(executor="threads", threads=-1), sfdae.Error, "ILLEGAL_ARGUMENT"),
    ],
)
def test_mistakes(more, error, text):
    with pool("threads", 1) as executor:
        if more.get("executor") == "threads":
            more = {**more, "executor": executor}
        with pytest.raises(error, match=text):
            sfdae.solve_ensemble(oscillator, (0, 1), [1, 0], **more)


def test_callbacks_are_refused():
    problem = sfdae.LinearProblem([[1.0]], [[-1.0]], lambda t, order: [0.0])
    with pool("threads", 1) as executor, pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT"):
        sfdae.solve_ensemble(problem, (0, 1), [[1.0], [2.0]], executor=executor)
