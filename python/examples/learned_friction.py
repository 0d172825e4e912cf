# SPDX-License-Identifier: BSD-3-Clause
"""Which friction acts on a pendulum? A small neural network inside the equations learns it from
positions, by gradients of PyTorch.

    p' = u,   q' = v,   u' = -2 p s + q F(w),   v' = -2 q s - g - p F(w),   0 = p^2 + q^2 - 1,

with the angular velocity w = p v - q u, and the network F(w) = sum_j a_j tanh(b_j w). The index is
3 (strangeness index 2). Check: the network agrees with the friction that made the data, and the
constraint and its derivative hold to 1e-12 with every network that was tried."""

from typing import Any, Callable

import numpy as np
import torch

import sfdae
import sfdae.torch

START = {"p": np.sin(2.0), "q": -np.cos(2.0)}
TIMES = np.linspace(0.1, 4.0, 40)
TOLERANCES: dict[str, Any] = {"rtol": 1e-8, "atol": 1e-8, "method": "radau"}


def pendulum(t: Any, x: Any, xdot: Any, force: Callable[[Any], Any]) -> list[Any]:
    p, q, u, v, s = x
    F = force(p * v - q * u)
    balance = [xdot[2] + 2 * p * s - q * F, xdot[3] + 2 * q * s + 9.81 + p * F]
    return [xdot[0] - u, xdot[1] - v, *balance, p**2 + q**2 - 1]


def friction(w: Any) -> Any:
    """The friction to be found: dry, smoothed, and viscous."""
    return 0.5 * np.tanh(2 * w) + 0.1 * w


def true_pendulum(t: Any, x: Any, xdot: Any) -> list[Any]:
    return pendulum(t, x, xdot, friction)


def network_pendulum(t: Any, x: Any, xdot: Any, a: Any, b: Any) -> list[Any]:
    return pendulum(t, x, xdot, lambda w: (a * np.tanh(b * w)).sum())


NAMES = ["p", "q", "u", "v", "s"]
measured = sfdae.solve(true_pendulum, (0, 4), START, names=NAMES, t_eval=TIMES, **TOLERANCES).x[:2]

a = torch.full((3,), 0.1, dtype=torch.float64, requires_grad=True)
b = torch.tensor([0.1, 0.5, 1.5], dtype=torch.float64, requires_grad=True)
given = {"a": a.detach().numpy(), "b": b.detach().numpy()}
problem = sfdae.NonlinearProblem(network_pendulum, names=NAMES, parameters=given)
optimizer = torch.optim.LBFGS(
    [a, b], max_iter=100, tolerance_change=1e-14, line_search_fn="strong_wolfe"
)
target = torch.from_numpy(measured)
residuals, losses = [], []


def evaluate() -> torch.Tensor:
    optimizer.zero_grad()
    x = sfdae.torch.solve(
        problem, (0, 4), START, parameters={"a": a, "b": b}, t_eval=TIMES, **TOLERANCES
    )
    p, q, u, v, _ = x.detach().numpy()
    residuals.append(max(np.abs(p**2 + q**2 - 1).max(), np.abs(p * u + q * v).max()))
    loss = ((x[:2] - target) ** 2).sum()
    loss.backward()
    losses.append(float(loss))
    return loss


optimizer.step(evaluate)
speeds = np.linspace(-4, 4, 81)
weights = a.detach().numpy(), b.detach().numpy()
learned = (weights[0][:, None] * np.tanh(np.outer(weights[1], speeds))).sum(axis=0)
error = np.abs(learned - friction(speeds)).max()
print(f"{len(losses)} solutions, sum of squares from {losses[0]:.2e} to {losses[-1]:.2e}")
print(f"largest error of the friction {error:.4f}, of the constraints {max(residuals):.1e}")
assert error < 0.02 and max(residuals) <= 1e-12
