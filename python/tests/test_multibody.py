# SPDX-License-Identifier: BSD-3-Clause
"""Mechanical systems, recorded and by callbacks."""

import numpy as np
import pytest

import sfdae

G = 9.81


def recorded(**more):
    return sfdae.MultibodyProblem(
        2,
        forces=lambda t, q, v, g=G: [0, -g],
        constraints=lambda t, q: [q @ q - 1],
        **{"mass": [1.0, 1.0], **more},
    )


def callbacks(**more):
    return sfdae.MultibodyProblem(
        2,
        mass=lambda t, q: np.eye(2),
        forces=lambda t, q, v: [0, -G],
        constraints=lambda t, q: [q @ q - 1],
        constraint_jacobian=lambda t, q: [2 * q],
        record=False,
        **more,
    )


def energy(x):
    return (x[2] ** 2 + x[3] ** 2) / 2 + G * (x[1] + 0.8)


@pytest.mark.parametrize("make", [recorded, callbacks])
@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_the_pendulum(make, method):
    problem = make()
    assert problem.names == ("q[0]", "q[1]", "v[0]", "v[1]", "lambda[0]")
    sol = sfdae.solve(
        problem, (0, 3), {"q[0]": 0.6, "q[1]": -0.8}, method=method, rtol=1e-9, atol=1e-9
    )
    assert np.abs(energy(sol.x)).max() < 1e-6
    c = sol.report.characteristics
    assert (c.strangeness_index, c.differential, c.algebraic) == (2, 2, 3)
    assert (sol.report.multibody.degrees_of_freedom, sol.report.multibody.redundant) == (1, 0)
    # v' = -2 q lambda - (0, g) and q v = 0, q v' + v v = 0: 2 lambda = v v - g q2
    assert 2 * sol.x[4] == pytest.approx(sol.x[2] ** 2 + sol.x[3] ** 2 - G * sol.x[1], abs=1e-9)


@pytest.mark.parametrize(
    "mass", [None, np.eye(2), [1, 1], lambda t, q: [[1, 0], [0, 1]], lambda t, q, m=1.0: [m, m]]
)
def test_every_form_of_a_mass(mass):
    sol = sfdae.solve(
        recorded(mass=mass), (0, 1), [0.6, -0.8, 0, 0, 0], t_eval=[1.0], rtol=1e-9, atol=1e-9
    )
    assert abs(energy(sol.x[:, 0])) < 1e-6


def test_parameters():
    sol = sfdae.solve(recorded(), (0, 1), [0.6, -0.8, 0, 0, 0], parameters={"g": 0.0})
    assert sol.x[:2, -1] == pytest.approx([0.6, -0.8], abs=1e-12)


def test_redundant_constraints_are_reported():
    problem = sfdae.MultibodyProblem(
        2, forces=[0, -G], constraints=lambda t, q: [q @ q - 1, 3 * (q @ q) - 3], num_constraints=2
    )
    report = sfdae.solve(problem, (0, 0.5), [0.6, -0.8, 0, 0, 0, 0]).report
    assert report.multibody.redundant == 1 and report.multibody.degrees_of_freedom == 1


def test_a_skate():
    """Nonholonomic: a skate at angle q3 moves along its blade only; pushed and turning it runs in a
    circle.
    """
    problem = sfdae.MultibodyProblem(
        3,
        nonholonomic_matrix=lambda t, q: [[np.sin(q[2]), -np.cos(q[2]), 0]],
        names=["x", "y", "angle", "u", "v", "omega", "kappa"],
    )
    sol = sfdae.solve(problem, (0, 2), {"u": 1.0, "omega": 1.0}, rtol=1e-9, atol=1e-9)
    assert sol["x"] == pytest.approx(np.sin(sol.t), abs=1e-6)
    assert sol["y"] == pytest.approx(1 - np.cos(sol.t), abs=1e-6)


def test_kinematics():
    """q' = 2 v."""
    problem = sfdae.MultibodyProblem(1, kinematics=[[2.0]], forces=lambda t, q, v: -2 * q)
    sol = sfdae.solve(problem, (0, 1), [1.0, 0.0], rtol=1e-9, atol=1e-9)
    assert sol.x[0] == pytest.approx(np.cos(2 * sol.t), abs=1e-6)


def test_the_extended_system():
    solver = sfdae.Solver(recorded())
    solver.start(0, [0.6, -0.8, 0, 0, 0], 1)
    extended = solver.extended_system(0)
    assert extended.E.shape == extended.A.shape == (7, 7) and extended.w.shape == (2,)
    assert extended.Qq.T @ extended.Qq == pytest.approx(np.eye(2), abs=1e-14)


@pytest.mark.parametrize(
    "arguments, error, text",
    [
        (dict(constraint_jacobian=[[1, 0]]), TypeError, "record=False only"),
        (dict(mass=np.eye(3)), ValueError, r"mass has shape \(3, 3\), not \(2, 2\)"),
        (dict(forces=lambda t, q, v: [0]), ValueError, r"forces has shape \(1,\), not \(2,\)"),
        (dict(num_constraints=2), ValueError, r"constraints has shape \(1,\), not \(2,\)"),
        (dict(coordinates="polar"), ValueError, "coordinates has to be one of"),
        (dict(names=["a"]), ValueError, "1 names for 5"),
        (dict(forces=lambda t, q: [0, 0]), TypeError, r"accept \(t, q, v\)"),
    ],
)
def test_mistakes(arguments, error, text):
    given = {"forces": [0, -G], "constraints": lambda t, q: [q @ q - 1], **arguments}
    with pytest.raises(error, match=text):
        sfdae.Solver(sfdae.MultibodyProblem(2, **given))


def test_mistakes_of_callbacks():
    with pytest.raises(TypeError, match="constraint_jacobian is needed"):
        sfdae.MultibodyProblem(2, constraints=lambda t, q: [q @ q - 1], record=False)
    with pytest.raises(TypeError, match="named parameters need recorded formulas"):
        sfdae.MultibodyProblem(2, forces=[0, 0], record=False, parameters={"g": 1})
    wrong = sfdae.MultibodyProblem(
        2,
        constraints=lambda t, q: [q @ q - 1],
        constraint_jacobian=lambda t, q: [3 * q],
        record=False,
    )
    check = sfdae.Solver(wrong).check_multibody_derivatives(0.0, [0.6, -0.8], [0.8, 0.6])
    assert check.suspicious and check.function == "G"
    right = sfdae.Solver(callbacks()).check_multibody_derivatives(0.0, [0.6, -0.8], [0.8, 0.6])
    assert not right.suspicious
    with pytest.raises(ValueError, match="q and v have 1 and 2"):
        sfdae.Solver(callbacks()).check_multibody_derivatives(0.0, [0.6], [0.8, 0.6])
    with pytest.raises(ZeroDivisionError):
        sfdae.solve(
            sfdae.MultibodyProblem(1, forces=lambda t, q, v: 1 / 0, record=False), (0, 1), [0, 0]
        )
