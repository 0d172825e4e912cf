# SPDX-License-Identifier: BSD-3-Clause
"""Pictures: what is drawn, and what stands at the axes."""

import numpy as np
import pytest

import sfdae
from models import PENDULUM_START, pendulum_problem

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
plt = pytest.importorskip("matplotlib.pyplot")


@pytest.fixture(autouse=True)
def close_figures():
    yield
    plt.close("all")


def solution(**more):
    units = {"px": "m", "py": "m", "u": "m/s", "v": "m/s", "lambda": "N/m", "t": "s"}
    return sfdae.solve(pendulum_problem(units=units), (0, 1), PENDULUM_START, **more)


def test_one_axis_for_each_unit():
    axes = solution().plot().axes
    assert [ax.get_ylabel() for ax in axes] == ["px, py [m]", "u, v [m/s]", "lambda [N/m]"]
    assert axes[-1].get_xlabel() == "t [s]"
    assert [text.get_text() for text in axes[0].get_legend().get_texts()] == ["px", "py"]


def test_chosen_unknowns_on_a_given_axis():
    figure, ax = plt.subplots()
    sol = solution(t_eval=[0, 0.5, 1])
    assert sol.plot("px", ax=ax) is figure
    assert np.array_equal(ax.lines[0].get_ydata(), sol["px"])
    with pytest.raises(KeyError, match="no unknown 'angle'"):
        sol.plot("angle")


def test_curves_are_smooth_and_events_are_marked():
    sol = sfdae.solve(
        pendulum_problem(),
        (0, 2),
        PENDULUM_START,
        events=lambda t, x: x[0],
        method="radau",
        rtol=1e-9,
        atol=1e-9,
    )
    (ax,) = sol.plot("px").axes
    t, px = ax.lines[0].get_data()
    assert t.size > 5 * sol.t.size and np.all(np.diff(t) >= 0)
    assert px == pytest.approx(sol(t)[0], abs=1e-8)
    assert len(ax.lines) == 1 + len(sol.events) > 1


def test_names_without_units():
    (ax,) = sfdae.solve(pendulum_problem(), (0, 1), PENDULUM_START).plot().axes
    assert ax.get_ylabel() == "unknowns"
    assert solution().plot("px").axes[0].get_ylabel() == "px [m]"


def test_pictures_are_figures_whatever_the_number_of_axes(tmp_path):
    for names in ([], ["px"], ["px", "u"]):
        figure = solution().plot(*names)
        assert isinstance(figure, matplotlib.figure.Figure)
        figure.savefig(tmp_path / "picture.svg")
        assert (tmp_path / "picture.svg").stat().st_size > 5000


def test_steps():
    ax = solution().plot_steps()
    assert ax.get_ylabel() == "step size [s]" and ax.get_yscale() == "log"
    assert {other.get_ylabel() for other in ax.figure.axes} == {"step size [s]", "order"}


def test_rank_decisions():
    report = solution().report
    ax = report.plot()
    assert ax.get_yscale() == "log"
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "smallest kept",
        "largest dropped",
        "noise",
    ]
    assert ax.get_title() == "strangeness index 2, d = 2, a = 3"
    kept = ax.lines[0].get_ydata()
    assert kept.tolist() == [decision.kept for decision in report.decisions if decision.rank > 0]
