"""Modes with more constraints are entered by impulses; actions of when clauses depend on conditions."""

import math
import random

import pytest
from program import columns, model, run


def last(path, *arguments):
    result = run("solve", path, "--tol", "1e-9", *arguments)
    assert result.stderr == ""
    return {name: values[-1] for name, values in columns(result.stdout).items()}


def variations(count=5):
    draw = random.Random(39)
    return [[draw.uniform(0.3, 5.0) for _ in range(6)] for _ in range(count)]


@pytest.mark.parametrize("J1, J2, n, w1, w2, t1", variations())
def test_gears_keep_angular_momentum(J1, J2, n, w1, w2, t1, tmp_path):
    path = model(tmp_path, f"Real 'w1'(start={w1}, fixed=true), 'w2'(start={-w2}, fixed=true), 'tau'; Boolean 'lock';",
                 f"{J1}*der('w1') = -'tau'; {J2}*der('w2') = {n}*'tau'; 'lock' = time >= {t1};"
                 f"if 'lock' then 'w1' = {n}*'w2'; else 'tau' = 0; end if;")
    # J1 w1 + J2 w2 / n is kept.
    wanted = (J1 * w1 - J2 * w2 / n) / (J1 * n + J2 / n)
    assert last(path, "--to", 2 * t1)["w2"] == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("C1, C2, C3, u1, u2, R", variations())
def test_capacitors_keep_charge(C1, C2, C3, u1, u2, R, tmp_path):
    """Two are connected at 0.5, all three at 1, over a resistor before; the first two are separated again at 1.5."""
    path = model(tmp_path, f"Real 'u1'(start={u1}, fixed=true), 'u2'(start={u2}, fixed=true), "
                 "'u3'(start=0, fixed=true), 'i', 'j'; Boolean 'a', 'b';",
                 f"{C1}*der('u1') = -'i'; {C2}*der('u2') = 'i' - 'j'; {C3}*der('u3') = 'j';"
                 "'a' = time >= 0.5 and time < 1.5; 'b' = time >= 1;"
                 "if 'a' then 'u1' = 'u2'; else 'i' = 0; end if; if 'b' then 'u2' = 'u3'; else 'j' = 0; end if;")
    joined = (C1 * u1 + C2 * u2) / (C1 + C2)
    assert last(path, "--to", 0.75)["u2"] == pytest.approx(joined, abs=1e-6)
    together = (C1 * u1 + C2 * u2) / (C1 + C2 + C3)
    end = last(path, "--to", 2)
    assert [end["u1"], end["u2"], end["u3"]] == pytest.approx([together] * 3, abs=1e-6)


@pytest.mark.parametrize("speed", [0.5, 1.0, 3.0])
def test_string_becomes_taut(speed, tmp_path):
    """The radial velocity of a ball ends when its string becomes taut; the tangential one and the position stay."""
    path = model(tmp_path, f"Real 'x'(start=0.2, fixed=true), 'y'(start=0, fixed=true), 'u'(start={speed}, fixed=true),"
                 " 'v'(start=0, fixed=true), 'F'; Boolean 'taut'(start=false, fixed=true);",
                 "der('x') = 'u'; der('y') = 'v'; der('u') = -'F'*'x'; der('v') = -'F'*'y' - 9.81;"
                 "when 'x'^2 + 'y'^2 > 1 then 'taut' = true; end when;"
                 "if 'taut' then 'x'^2 + 'y'^2 = 1; else 'F' = 0; end if;")
    rows = columns(run("solve", path, "--to", 1, "--tol", "1e-9").stdout)
    k = rows["taut"].index(1.0)
    assert rows["time"][k] == rows["time"][k - 1]
    before, after = ({name: rows[name][row] for name in "xyuv"} for row in (k - 1, k))
    assert [after["x"], after["y"]] == pytest.approx([before["x"], before["y"]], abs=1e-6)
    assert after["x"] * after["u"] + after["y"] * after["v"] == pytest.approx(0, abs=1e-6)
    tangential = [at["x"] * at["v"] - at["y"] * at["u"] for at in (before, after)]
    assert tangential[1] == pytest.approx(tangential[0], abs=1e-6)
    assert math.hypot(rows["x"][-1], rows["y"][-1]) == pytest.approx(1, abs=1e-9)


def test_change_that_impulses_do_not_determine(tmp_path):
    """der(a) = z, der(b) = z^2: an impulse of z has no square."""
    path = model(tmp_path, "Real 'a'(start=0, fixed=true), 'b'(start=1, fixed=true), 'z'; Boolean 'lock';",
                 "der('a') = 'z'; der('b') = 'z'^2; 'lock' = time >= 0.5; if 'lock' then 'a' = 'b'; else 'z' = 0.1; end if;")
    result = run("solve", path, "--to", 1, code=1)
    assert "states have to jump" in result.stderr and "0.5" in result.stderr


@pytest.mark.parametrize("first", [True, False])
def test_reinit_in_both_branches(first, tmp_path):
    body = "reinit('x', 10);", "reinit('x', -10);"
    path = model(tmp_path, "Real 'x'(start=0, fixed=true); Boolean 'b';",
                 f"'b' = {'time > 0.5' if first else 'time < 0.5'}; der('x') = 0; when sample(0.75, 5) then "
                 f"if 'b' then {body[0]} else {body[1]} end if; end when;")
    assert last(path, "--to", 1)["x"] == pytest.approx(10 if first else -10)
    path = model(tmp_path, "Real 'x'(start=0, fixed=true); Boolean 'b';",
                 f"'b' = {'time > 0.5' if first else 'time < 0.5'}; der('x') = 0; when sample(0.75, 5) then "
                 f"if 'b' then {body[0]} end if; if not 'b' then {body[1]} end if; end when;")
    assert last(path, "--to", 1)["x"] == pytest.approx(10 if first else -10)


def test_terminate_under_a_condition(tmp_path):
    path = model(tmp_path, "Real 'x'(start=0, fixed=true);",
                 "der('x') = 1; when sample(0.1, 0.1) then if 'x' > 0.55 then terminate(\"far\"); end if; end when;")
    assert last(path, "--to", 1)["x"] == pytest.approx(0.6)


@pytest.mark.parametrize("value", ["0", "4", "1.5"])
def test_values_of_enumerations(value, tmp_path):
    path = tmp_path / "model.mo"
    path.write_text("//! base 0.1.0\npackage 'M'\n  type 'E' = enumeration('a', 'b', 'c');\n  model 'M'\n"
                    "    parameter 'E' 'e' = 'E'.'b'; Real 'x'(start=0, fixed=true);\n  equation\n"
                    "    der('x') = if 'e' == 'E'.'c' then 3 else 1;\n  end 'M';\nend 'M';\n")
    assert "parameter e" in run("solve", path, "--set", f"e={value}", code=2).stderr
    assert last(path, "--to", 1, "--set", "e=3")["x"] == pytest.approx(3)
