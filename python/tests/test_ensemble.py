# SPDX-License-Identifier: BSD-3-Clause
"""Ensembles: the same as one by one, failures of some, what is refused."""

import numpy as np
import pytest

import sfdae
from models import PENDULUM_START, oscillator, pendulum_problem

RATES = np.linspace(0.5, 4, 9)
TIMES = [0.0, 1.0, 2.0]


def test_the_same_as_one_by_one():
    ensemble = sfdae.solve_ensemble(
        oscillator, (0, 2), [1, 0], parameters={"k": RATES}, t_eval=TIMES, threads=3, xdot=True
    )
    assert ensemble.success and len(ensemble) == 9 and ensemble.num_analyses == 1
    assert ensemble.x.shape == ensemble.xdot.shape == (9, 2, 3)
    for i, k in enumerate(RATES):
        alone = sfdae.solve(oscillator, (0, 2), [1, 0], parameters={"k": k}, t_eval=TIMES)
        assert np.array_equal(ensemble.x[i], alone.x)
        assert np.array_equal(ensemble.xdot[i], alone.xdot)
    assert ensemble.x[:, 0] == pytest.approx(np.cos(np.outer(np.sqrt(RATES), TIMES)), abs=1e-3)


def test_start_values_and_names():
    x0 = [[0.6, -0.8, 0, 0, 0], [0.8, -0.6, 0, 0, 0]]
    ensemble = sfdae.solve_ensemble(pendulum_problem(), (0, 1), x0)
    assert ensemble["px"].shape == (2, 1)
    assert ensemble["px"] ** 2 + ensemble["py"] ** 2 == pytest.approx(1, abs=1e-12)
    assert repr(ensemble) == "EnsembleSolution(2 instances, 0 failed, 1 times)"
    with pytest.raises(KeyError, match="no unknown 'angle'"):
        ensemble["angle"]


def test_arrays_of_parameters_and_common_ones():
    def equations(t, x, xdot, rates=np.array([1.0, 2.0]), scale=1.0):
        return xdot + scale * rates * x

    rates = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    ensemble = sfdae.solve_ensemble(
        equations, (0, 1), [1, 1], parameters={"rates": rates, "scale": 0.5}, rtol=1e-9, atol=1e-9
    )
    assert ensemble.x[:, :, 0] == pytest.approx(np.exp(-0.5 * rates), abs=1e-7)


def test_one_that_fails_does_not_disturb_the_others():
    """x' = k x^2, x(0) = 1: x = 1 / (1 - k t)."""

    def explosion(t, x, xdot, k=1.0):
        return [xdot[0] - k * x[0] ** 2]

    with pytest.warns(sfdae.IntegrationWarning):
        ensemble = sfdae.solve_ensemble(
            explosion, (0, 2), [1.0], parameters={"k": [0.1, 1.0, 0.2]}, t_eval=[0.5, 2.0]
        )
    assert [status < 0 for status in ensemble.status] == [False, True, False]
    assert not ensemble.success and ensemble.messages[1] and not ensemble.messages[0]
    assert ensemble.x[:, 0, 0] == pytest.approx(1 / (1 - 0.5 * np.array([0.1, 1.0, 0.2])), abs=1e-3)
    assert np.isnan(ensemble.x[1, 0, 1]) and np.isfinite(ensemble.x[[0, 2], 0, 1]).all()


def test_progress(capsys):
    sfdae.solve_ensemble(oscillator, (0, 1), [1, 0], parameters={"k": RATES}, progress=True)
    assert "9 of 9 instances" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments, error, text",
    [
        (dict(parameters={"q": [1, 2]}), TypeError, "no parameter 'q'; there are k"),
        (dict(parameters={"k": [[1, 2]]}), ValueError, "shape"),
        (dict(parameters={"k": [1, np.nan]}), ValueError, "not finite"),
        (dict(x0=[[1, 0], [1, 0]], parameters={"k": [1, 2, 3]}), ValueError, "3 values, not 2"),
        (dict(x0=[[1, 0, 0], [1, 0, 0]]), (ValueError, IndexError, sfdae.Error), ""),
        (dict(t_eval=[3.0]), ValueError, "outside of t_span"),
        (dict(threads=-1), sfdae.Error, "ILLEGAL_ARGUMENT"),
    ],
)
def test_mistakes(arguments, error, text):
    problem = sfdae.NonlinearProblem(oscillator, 2)
    with pytest.raises(error, match=text):
        sfdae.solve_ensemble(problem, (0, 1), **{"x0": [1, 0], **arguments})


def test_callbacks_are_refused():
    problem = sfdae.LinearProblem([[1.0]], [[-1.0]], lambda t, order: [0.0])
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT"):
        sfdae.solve_ensemble(problem, (0, 1), [[1.0], [2.0]])


def test_values_by_name():
    assert sfdae.solve_ensemble(pendulum_problem(), (0, 1), PENDULUM_START).x.shape == (1, 5, 1)
