# SPDX-License-Identifier: BSD-3-Clause
"""Tensors of PyTorch: gradients agree with forward sensitivities and finite differences."""

import subprocess
import sys
import time

import numpy as np
import pytest

import sfdae
from models import PENDULUM_NAMES

torch = pytest.importorskip("torch")
import sfdae.torch  # noqa: E402

START = [0.6, -0.8, 0, 0, 0]
TIMES = np.linspace(0.25, 2, 8)


def damped(t, x, xdot, g=9.81, c=0.1):
    """The pendulum with viscous friction; differentiation index 3 (strangeness index 2)."""
    p, q, u, v, s = x
    balance = [xdot[2] + 2 * p * s + c * u, xdot[3] + 2 * q * s + g + c * v]
    return [xdot[0] - u, xdot[1] - v, *balance, p**2 + q**2 - 1]


PROBLEM = sfdae.NonlinearProblem(damped, names=PENDULUM_NAMES)


def tensor(value):
    return torch.tensor(value, dtype=torch.float64, requires_grad=True)


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_gradients_agree_with_forward_sensitivities(method):
    """Both differentiate the formulas of their steps; at these tolerances the difference of the
    steps is below 1e-8 of the gradient.
    """
    options = dict(t_eval=TIMES, method=method, rtol=1e-10, atol=1e-10)
    weights = np.random.default_rng(1).normal(size=(5, 8))
    g, c, x0 = tensor(9.81), tensor(0.1), tensor(START)
    x = sfdae.torch.solve(PROBLEM, (0, 2), x0, parameters={"g": g, "c": c}, **options)
    (x * torch.from_numpy(weights)).sum().backward()
    names = ["g", "c", *PENDULUM_NAMES]
    forward = sfdae.solve(PROBLEM, (0, 2), START, sensitivities=names, **options)
    assert x.detach().numpy() == pytest.approx(forward.x, abs=1e-9)
    expected = np.einsum("npk,nk->p", forward.S, weights)
    found = np.array([g.grad, c.grad, *x0.grad])
    assert np.abs(found - expected).max() <= 1e-8 * np.abs(expected).max()


def test_gradcheck():
    """x' = -k x, y = a x^2, and a pendulum, by finite differences."""

    def equations(t, x, xdot, k=1.0, a=np.ones(2)):
        return [xdot[0] + k * x[0], x[1] - a[0] * x[0] ** 2 - a[1]]

    def small(k, a, x0):
        return sfdae.torch.solve(
            equations, (0, 1), x0, parameters={"k": k, "a": a}, t_eval=[0.0, 0.4, 1.0], rtol=1e-10,
            atol=1e-10, method="radau", fixed=[0],
        )  # fmt: skip

    assert torch.autograd.gradcheck(small, (tensor(0.7), tensor([1.0, 0.5]), tensor([2.0, 4.5])))

    def pendulum(values):
        return sfdae.torch.solve(
            PROBLEM, (0, 0.5), START, parameters=values, rtol=1e-11, atol=1e-11, method="radau"
        )

    assert torch.autograd.gradcheck(pendulum, (tensor([9.81, 0.1]),))


def test_batches_and_shared_values():
    gravity = tensor(np.linspace(2, 10, 5))
    c, x0 = tensor(0.1), tensor(START)
    options = dict(t_eval=[0.5, 1.0], rtol=1e-8, atol=1e-8)
    batch = sfdae.torch.solve(PROBLEM, (0, 1), x0, parameters={"g": gravity, "c": c}, **options)
    assert batch.shape == (5, 5, 2)
    (batch**2).sum().backward()
    alone = [tensor(0.1), tensor(START), []]
    for k in range(5):
        g = tensor(float(gravity[k]))
        given = {"g": g, "c": alone[0]}
        x = sfdae.torch.solve(PROBLEM, (0, 1), alone[1], parameters=given, **options)
        assert torch.equal(x, batch[k])
        (x**2).sum().backward()
        alone[2].append(float(g.grad))
    assert gravity.grad.numpy() == pytest.approx(np.array(alone[2]), rel=1e-12)
    assert float(c.grad) == pytest.approx(float(alone[0].grad), rel=1e-12)
    assert x0.grad.numpy() == pytest.approx(alone[1].grad.numpy(), rel=1e-12, abs=1e-12)


def test_batches_without_gradients_are_ensembles():
    starts = np.array([START, [0.8, -0.6, 0, 0, 0]])
    with torch.no_grad():
        x = sfdae.torch.solve(PROBLEM, (0, 1), starts, parameters={"g": tensor(5.0)})
    ensemble = sfdae.solve_ensemble(PROBLEM, (0, 1), starts, parameters={"g": 5.0})
    assert not x.requires_grad and np.array_equal(x.numpy(), ensemble.x)


def test_values_by_name_and_pieces_of_long_integrations():
    p, g = tensor(0.6), tensor(9.81)
    results = []
    for kept in (0, 20):
        x = sfdae.torch.solve(
            damped, (0, 1), {"p": p, "q": -0.8}, parameters={"g": g}, max_kept_steps=kept
        )
        results.append(torch.autograd.grad(x[0, 0], (p, g)))
    assert results[0] == results[1] and all(entry != 0 for entry in results[0])


def test_a_training_loop_reduces_the_loss():
    target = sfdae.solve(PROBLEM, (0, 1), START, parameters={"c": 0.4}, t_eval=TIMES[:4]).x[:2]
    c = tensor(0.0)
    optimizer = torch.optim.LBFGS([c], line_search_fn="strong_wolfe")

    def loss():
        optimizer.zero_grad()
        x = sfdae.torch.solve(PROBLEM, (0, 1), START, parameters={"c": c}, t_eval=TIMES[:4])
        value = ((x[:2] - torch.from_numpy(target)) ** 2).sum()
        value.backward()
        return value

    optimizer.step(loss)
    assert float(c) == pytest.approx(0.4, abs=1e-4)


@pytest.mark.parametrize(
    "more, error, text",
    [
        (dict(parameters={"g": torch.tensor(1.0)}), TypeError, "'g' is a tensor of torch.float32"),
        (dict(parameters={"k": tensor(1.0)}), TypeError, "no parameter 'k'; there are g, c"),
        (dict(parameters=tensor([1.0])), ValueError, r"2 entries of parameters \(g, c\)"),
        (dict(parameters={"g": tensor([[1.0]])}), ValueError, r"g has shape \(1, 1\)"),
        (dict(x0=tensor([1.0, 2.0])), ValueError, r"x0 has shape \(2,\)"),
        (dict(t_eval=[]), ValueError, "no times"),
        (dict(rtoll=1e-3), TypeError, "did you mean 'rtol'"),
        (dict(parameters={"g": [1.0, 2.0], "c": [1.0, 2.0, 3.0]}), ValueError, "2 x"),
    ],
)
def test_mistakes(more, error, text):
    with pytest.raises(error, match=text):
        sfdae.torch.solve(PROBLEM, (0, 1), **{"x0": START, **more})


def test_failures_are_raised():
    """x' = k x^2, x(0) = 1 ends at t = 1 / k; callbacks have no gradients."""
    k = tensor([0.1, 1.0])

    def explosion(t, x, xdot, k=1.0):
        return [xdot[0] - k * x[0] ** 2]

    for given in (k, k.detach()):
        with pytest.raises(sfdae.Error, match="STEP_TOO_SMALL"):
            sfdae.torch.solve(explosion, (0, 2), [1.0], parameters={"k": given})
    problem = sfdae.NonlinearProblem(explosion, 1, record=False)
    with pytest.raises(sfdae.Error, match="ILLEGAL_ARGUMENT"):
        sfdae.torch.solve(problem, (0, 0.1), [1.0], parameters={"k": tensor(1.0)})


def test_pytorch_is_loaded_on_demand_only():
    program = "import sys, sfdae; print('torch' in sys.modules, bool(sfdae.torch.solve))"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert result.stdout == "False True\n", result.stderr
    with pytest.raises(AttributeError, match="no attribute 'tensorflow'"):
        sfdae.tensorflow


def test_a_gradient_costs_at_most_three_solutions():
    """The smallest of five times of the processor, which other programs hardly change."""
    options = dict(t_eval=TIMES, rtol=1e-8, atol=1e-8)

    def seconds(function):
        times = []
        for _ in range(5):
            begin = time.process_time()
            function()
            times.append(time.process_time() - begin)
        return min(times)

    def gradient():
        x = sfdae.torch.solve(PROBLEM, (0, 2), START, parameters=tensor([9.81, 0.1]), **options)
        x.sum().backward()

    solution = seconds(lambda: sfdae.solve(PROBLEM, (0, 2), START, **options))
    assert seconds(gradient) <= 3 * solution
