# SPDX-License-Identifier: BSD-3-Clause
"""Descriptor systems: of problems at a point, and of matrices."""

import pickle

import numpy as np
import pytest

import sfdae
from models import PENDULUM_START, pendulum_problem

Status = sfdae.Status


def pushed(t, x, xdot):
    """A pendulum of length and mass 1 with a horizontal force."""
    px, py, u, v, force = x
    push = sfdae.parameter(t, "push", 0.0)
    return [
        xdot[0] - u,
        xdot[1] - v,
        xdot[2] + 2 * px * force - push,
        xdot[3] + 2 * py * force + 9.81,
        px**2 + py**2 - 1,
    ]


AT_REST = {"px": 0, "py": -1, "lambda": 9.81 / 2}
NAMES = ["px", "py", "u", "v", "lambda"]


def test_a_pendulum_at_rest():
    solver = sfdae.Solver(sfdae.NonlinearProblem(pushed, names=NAMES))
    system = solver.linearize(
        x=AT_REST,
        xdot=np.zeros(5),
        input_parameters=["push"],
        output_unknowns=["px"],
        output_rows=[[0, 0, 1, 0, 0]],
    )
    assert system.shape == (5, 5, 1, 2)
    poles = system.poles()
    assert poles.values == pytest.approx([1j * 9.81**0.5, -1j * 9.81**0.5], abs=1e-13)
    assert (poles.errors < 1e-13).all() and poles.summary.num_infinite == 3
    s = np.array([[1j, 2.0], [0.5 + 1j, 0]])
    H = system.transfer(s)
    assert H.shape == (2, 2, 2, 1)
    np.testing.assert_allclose(H[..., 0, 0], 1 / (s**2 + 9.81), rtol=1e-13)
    np.testing.assert_allclose(H[..., 1, 0], s / (s**2 + 9.81), rtol=1e-13)
    assert system.transfer(1j).shape == (2, 1) and system.zeros().values.size == 0
    with pytest.raises(sfdae.Error, match="a pole") as caught:
        system.transfer(1j * 9.81**0.5)
    assert caught.value.status == Status.SINGULAR


def test_along_a_solution():
    solver = sfdae.Solver(pendulum_problem())
    with pytest.raises(sfdae.Error) as caught:
        solver.linearize()
    assert caught.value.status == Status.NOT_STARTED
    solver.start(0.0, PENDULUM_START, 1.0)
    point = solver.advance(0.5)
    system = solver.linearize(0.5)
    px, py, force = point.x[0], point.x[1], point.x[4]
    assert system.A[2] == pytest.approx([-2 * force, 0, 0, 0, -2 * px], abs=1e-5)
    assert system.A[4] == pytest.approx([-2 * px, -2 * py, 0, 0, 0], abs=1e-5)
    assert system.poles().summary.differential == 2


def test_matrices():
    system = sfdae.Descriptor([[1, 0], [0, 0]], [[-2, 1], [0, 1]], [[0], [1]], [[1, 0]])
    assert system.poles().values == pytest.approx([-2]) and system.zeros().values.size == 0
    assert system.transfer(1.0) == pytest.approx(np.array([[-1 / 3]]))
    copy = pickle.loads(pickle.dumps(system))
    assert (copy.E == system.E).all() and (copy.D == system.D).all() and copy.D.shape == (1, 1)
    with pytest.raises(ValueError, match="B has shape"):
        sfdae.Descriptor(np.eye(2), np.eye(2), np.ones((3, 1)))
    with pytest.raises(sfdae.Error) as caught:
        sfdae.Descriptor([[np.nan]], [[1.0]])
    assert caught.value.status == Status.ILLEGAL_ARGUMENT
    with pytest.raises(sfdae.Error) as caught:
        sfdae.Descriptor(np.zeros((1, 1)), np.zeros((1, 1))).poles()
    assert caught.value.status == Status.SINGULAR


def test_mistakes_in_a_choice():
    solver = sfdae.Solver(pendulum_problem())
    here = {"x": AT_REST, "xdot": np.zeros(5)}
    with pytest.raises(KeyError):
        solver.linearize(**here, output_unknowns=["pz"])
    with pytest.raises(ValueError, match="input_columns"):
        solver.linearize(**here, input_columns=[[1.0]])
    with pytest.raises(sfdae.Error, match="no parameter"):
        solver.linearize(**here, input_parameters=["push"])
