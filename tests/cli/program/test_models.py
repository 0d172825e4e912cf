"""The models in examples/models against what is known of them."""

import json
import math
import os

import pytest
from known_values import KNOWN
from program import EXPORTS, MODELS, columns, run


def test_every_model_has_known_values():
    assert {name[:-3] for name in os.listdir(MODELS) if name.endswith(".mo")} == set(KNOWN)


@pytest.mark.parametrize("name", sorted(KNOWN))
def test_values_at_the_end(name, tmp_path):
    strangeness_index, freedom, end, values, tolerance = KNOWN[name]
    report = tmp_path / "report.json"
    result = run("solve", os.path.join(MODELS, name + ".mo"), "--tol", "1e-9", "--json", report, "--variables", ".*")
    assert result.stderr == ""
    data = json.loads(report.read_text())
    assert data["outcome"] == "solved" and data["time"][-1] == end
    solution = {v["name"]: v["values"] for v in data["variables"]}
    solution.update({p["name"]: [p["value"]] for p in data["parameters"]})
    for variable, (value, scale) in values.items():
        error = abs(solution[variable][-1] - value) / max(abs(value), scale)
        assert error <= tolerance, (variable, solution[variable][-1], value)
    if strangeness_index >= 0:
        assert data["index"]["strangeness_index"] == strangeness_index
    assert data["index"]["differential"] == freedom


def test_pendulum_returns_after_a_period():
    # T = 4 sqrt(L / g) K(sin(pi / 4)), K(1 / sqrt(2)) = 1.85407467730137192.
    length, gravity = 2.5, 1.62
    period = 4 * math.sqrt(length / gravity) * 1.85407467730137192
    solution = columns(run("solve", os.path.join(MODELS, "pendulum.mo"), "--to", period, "--tol", "1e-10", "--set",
                           f"L={length}", "--set", f"g={gravity}").stdout)
    # At rest where it was released: errors of the period count quadratically for x.
    assert abs(solution["x"][-1] - length) < 1e-7 and abs(solution["y"][-1]) < 1e-5
    assert max(abs(e) for e in solution["energy"]) < 1e-6 * gravity * length


def test_bouncing_ball_flies_on_parabolas(tmp_path):
    report = tmp_path / "ball.json"
    run("solve", os.path.join(MODELS, "bouncing_ball.mo"), "--json", report, "--tol", "1e-10")
    data = json.loads(report.read_text())
    ball = {v["name"]: v["values"] for v in data["variables"]}
    impacts = [k for k in range(1, len(data["time"])) if ball["n"][k] > ball["n"][k - 1]]
    time, speed = math.sqrt(2 / 9.81), math.sqrt(2 * 9.81)
    for count, k in enumerate(impacts):
        assert data["time"][k] == data["time"][k - 1] == pytest.approx(time, abs=1e-7)
        assert ball["v"][k - 1] == pytest.approx(-speed, abs=1e-6)
        speed *= 0.7
        assert ball["v"][k] == pytest.approx(speed if count < 12 else 0.0, abs=1e-6)
        time += 2 * speed / 9.81
    assert len(impacts) == 13
    assert len(data["events"]) >= 13


def test_thermostat_switches_on_time(tmp_path):
    report = tmp_path / "thermostat.json"
    run("solve", os.path.join(MODELS, "thermostat.mo"), "--json", report, "--tol", "1e-10")
    data = json.loads(report.read_text())
    switches = next(v["values"] for v in data["variables"] if v["name"] == "switches")
    times = [data["time"][k] for k in range(1, len(switches)) if switches[k] > switches[k - 1]]
    # Heating from 19 to 21 of 35 degrees and cooling back to 5 take 1e4 ln(16 / 14) each.
    expected = [1e4 * (math.log(20 / 14) + k * math.log(16 / 14)) for k in range(13)]
    assert times == pytest.approx(expected, rel=1e-7)


def test_delta_load_keeps_the_sum_of_its_currents():
    solution = columns(run("solve", os.path.join(MODELS, "delta_load.mo")).stdout)
    for currents in zip(*(solution[f"line[{k}].i"] for k in (1, 2, 3))):
        assert abs(sum(currents)) < 1e-9


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_both_methods_solve_the_pendulum(method):
    _, _, _, values, _ = KNOWN["pendulum"]
    solution = columns(run("solve", os.path.join(MODELS, "pendulum.mo"), "--method", method, "--tol", "1e-9").stdout)
    for variable, (value, scale) in values.items():
        assert abs(solution[variable][-1] - value) <= 1e-4 * max(abs(value), scale)


def test_check_visits_shared_parts_of_formulas_once():
    """Newton's method in a function: 2^30 paths lead through its formulas; a walk along all of them never ends."""
    assert run("check", os.path.join(EXPORTS, "water_functions.bmo")).returncode == 0
