"""What solve, analyze and check write."""

import json
import math
import os

import pytest
from program import EXPORTS, MODELS, PENDULUM, columns, model, run, table


def test_csv_to_a_pipe_has_all_variables_over_time():
    names, rows = table(run("solve", PENDULUM).stdout)
    assert names == ["time", "x", "y", "vx", "vy", "F", "energy"]
    assert len(rows) == 501 and float(rows[-1][0]) == 10.0


def test_numbers_read_back_exactly(tmp_path):
    report = tmp_path / "r.json"
    solution = columns(run("solve", PENDULUM, "--to", "1", "--csv", "-", "--json", report).stdout)
    data = json.loads(report.read_text())
    assert data["time"] == solution["time"]
    for variable in data["variables"]:
        assert variable["values"] == solution[variable["name"]]


def test_zero_has_no_sign(tmp_path):
    path = model(tmp_path, """    Real 'x'(start = 0.0, fixed = true);
    Real 'y';
    Real 'v'(start = 0.0);
  initial equation
    'v' = 0.0;""", "    'y' = -'x';\n    der('x') = 0.0 * time;\n    der('v') = 1.0;")
    names, rows = table(run("solve", path, "--outputs", "2").stdout)
    assert names == ["time", "x", "y", "v"]
    assert rows[0] == ["0"] * 4 and [row[1:3] for row in rows] == [["0", "0"]] * 3


def test_outputs_are_equidistant():
    time = columns(run("solve", PENDULUM, "--from", "1", "--to", "3", "--outputs", "8").stdout)["time"]
    assert time == pytest.approx([1 + k / 4 for k in range(9)], abs=1e-12)


def test_every_step_is_an_output():
    few = columns(run("solve", PENDULUM, "--to", "1", "--outputs", "1").stdout)["time"]
    all_steps = columns(run("solve", PENDULUM, "--to", "1", "--outputs", "1", "--every-step").stdout)["time"]
    assert len(few) == 2 and len(all_steps) > 5 and sorted(all_steps) == all_steps


def test_end_comes_after_the_start():
    assert "is not after the start time" in run("solve", PENDULUM, "--from", "2", "--to", "1", code=2).stderr


def test_tolerance_is_used(tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0, fixed = true);\n    Real 'y'(start = 0.0, fixed = true);",
                 "    der('x') = 'y';\n    der('y') = -'x';")
    errors = []
    for tolerance in ("1e-3", "1e-6", "1e-9"):
        solution = columns(run("solve", path, "--to", "20", "--tol", tolerance).stdout)
        errors.append(abs(solution["x"][-1] - math.cos(20)))
    assert errors[2] < 1e-6 and errors[2] < errors[1] < errors[0]


def test_start_values_and_parameters_are_set():
    solution = columns(run("solve", PENDULUM, "--to", "0.1", "--set", "L=2", "--set", "x=2", "--set", "'y'=-1").stdout)
    assert solution["y"][0] == -1.0 and solution["x"][0] == pytest.approx(math.sqrt(3), rel=1e-9)


def test_variables_by_name_and_pattern():
    assert table(run("solve", PENDULUM, "--variables", "y,v.").stdout)[0] == ["time", "y", "vx", "vy"]
    assert table(run("solve", PENDULUM, "--variables", "'F'", "--variables", ".*y").stdout)[0] == \
        ["time", "y", "vy", "F", "energy"]
    assert set(columns(run("solve", PENDULUM, "--variables", "g", "--set", "g=1.62").stdout)["g"]) == {1.62}


def test_limit_of_steps():
    result = run("solve", PENDULUM, "--outputs", "1", "--max-steps", "3", code=1)
    assert "not finished" in result.stderr


def test_statistics_of_runs_that_fail(tmp_path):
    report = tmp_path / "r.json"
    run("solve", PENDULUM, "--outputs", "1", "--max-steps", "3", "--json", report, code=1)
    data = json.loads(report.read_text())
    assert data["statistics"]["steps"] == 3 and data["statistics"]["evaluations"] > 0
    assert data["headline"].endswith("3 steps")


def test_json_has_everything(tmp_path):
    report = tmp_path / "r.json"
    result = run("solve", PENDULUM, "--json", report, "--set", "g=1.62")
    assert result.stdout.startswith("Pendulum: solved from 0 to 10 s")
    data = json.loads(report.read_text())
    assert data["model"] == "Pendulum" and data["outcome"] == "solved" and data["file"] == PENDULUM
    assert data["index"]["differentiation_index"] == 3 and data["index"]["differential"] == 2
    assert "Index 3 (strangeness index 2)." in data["index"]["words"]
    assert data["statistics"]["steps"] > 10
    assert data["decisions"] and all(d["verdict"] in ("clear", "confirmed") for d in data["decisions"])
    assert {"name": "g", "value": 1.62, "unit": "m/s2", "description": "gravity", "given": True} in data["parameters"]
    assert [v["unit"] for v in data["variables"]] == ["m", "m", "m/s", "m/s", "N/m", "J"]


def test_quiet_says_nothing(tmp_path):
    result = run("solve", PENDULUM, "--quiet", "--csv", tmp_path / "o.csv")
    assert result.stdout == "" and result.stderr == ""
    assert run("solve", PENDULUM, "--quiet").stdout.startswith("time,")


def test_analyze_reports_the_index_in_words(tmp_path):
    text = run("analyze", PENDULUM, "--json", tmp_path / "a.json").stdout
    assert "Index 3 (strangeness index 2)." in text and "strangeness index 2 (differentiation index 3)" in text
    data = json.loads((tmp_path / "a.json").read_text())
    values = {v["name"]: v["values"] for v in data["variables"]}
    # m vx' = -F x, m vy' = -F y - m g, at rest in (1, 0): F = 0.
    assert values["x"] == pytest.approx([1.0]) and values["F"] == pytest.approx([0.0], abs=1e-9)
    assert data["time"] == [0.0]


def test_check_counts(tmp_path):
    text = run("check", PENDULUM, "--names").stdout
    assert "6 continuous variables, 0 discrete, 3 parameters" in text and "6 equations" in text
    assert "  parameter\tg\tm/s2\tgravity\n" in text and "Index 3" in text
    run("check", PENDULUM, "--json", tmp_path / "c.json")
    assert json.loads((tmp_path / "c.json").read_text())["index"]["strangeness_index"] == 2


def test_check_finds_what_is_wrong(tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0, fixed = true);", "    der('x') = -'x';\n    'x' = 1.0;")
    result = run("check", path, code=2)
    assert "no valid model" in result.stderr and "2 equations" in result.stdout


def test_check_compares_with_the_pattern_of_equations():
    # The line currents of the delta add up to zero whatever the numbers are, which no pattern shows.
    text = run("check", os.path.join(MODELS, "delta_load.mo")).stdout
    assert "Index 2 (strangeness index 1)." in text and "The pattern of the equations alone says index 1" in text
    for name in ("pendulum", "crane", "servo_chain", "squeezer", "rlc_ladder", "two_capacitors", "transistor_amplifier"):
        assert "The pattern" not in run("check", os.path.join(MODELS, name + ".mo")).stdout


def test_index_after_elimination_is_named_as_such(tmp_path):
    """Positions by angles of joints: an index of 3 becomes 1 where they are put in."""
    text = run("check", os.path.join(EXPORTS, "double_pendulum.bmo")).stdout
    assert "Index 1 (strangeness index 0).\n  18 differentiated unknowns have been replaced" in text
    assert "By their pattern the equations as they stand have index 3." in text
    assert "1 differentiated unknown has been replaced" in run("analyze", os.path.join(MODELS, "two_capacitors.mo")).stdout
    run("check", os.path.join(EXPORTS, "double_pendulum.bmo"), "--json", tmp_path / "c.json")
    assert json.loads((tmp_path / "c.json").read_text())["index"]["replaced_states"] == 18
    assert "replaced" not in run("check", os.path.join(MODELS, "squeezer.mo")).stdout


def test_what_substitution_finds_makes_index_one(tmp_path):
    report = tmp_path / "c.json"
    text = run("check", os.path.join(MODELS, "thermostat.mo"), "--json", report).stdout
    assert "Index 1 (strangeness index 0)." in text and "(1 more is found by substitution)" in text
    assert "ordinary" not in text and json.loads(report.read_text())["index"]["differentiation_index"] == 1
    path = model(tmp_path, "    Real 'x'(start = 1.0, fixed = true);", "    der('x') = -'x';")
    assert "Index 0 (strangeness index 0)." in run("check", path).stdout


def test_models_without_differential_equations_have_no_unknown_of_the_library(tmp_path):
    report = tmp_path / "a.json"
    text = run("analyze", os.path.join(EXPORTS, "timers.bmo"), "--json", report).stdout
    assert "No differential equations are left" in text and "n = 1 unknowns" not in text
    data = json.loads(report.read_text())
    assert data["index"]["differential"] == 0 and data["decisions"] == [] and data["report"] == ""


def test_files_whose_names_look_like_unknowns_keep_them(tmp_path):
    path = model(tmp_path, "    Real 'load'(start = 0.0, fixed = true);", "    der('load') = sqrt(0.5 - 'load') + 1.0;")
    box = path.rename(tmp_path / "box[0].mo")
    message = run("solve", box, code=1).stderr
    assert " in equation (" in message and "box[0].mo:6)" in message


# Results that users would not expect are errors or warnings.

@pytest.mark.parametrize("value, operation", [("sqrt('x')", "sqrt(-0.04)"), ("1 + log('x')", "log(-0.04)"),
                                              ("1 / ('x' - 'x')", "0"), ("1 / 0", "1/0"), ("log(-1)", "log(-1)")])
def test_values_that_are_not_finite_are_no_solution(tmp_path, value, operation):
    path = model(tmp_path, "    Real 'x'(start = 1.01, fixed = true);\n    Real 'y';",
                 f"    der('x') = -2.1;\n    'y' = {value};")
    result = run("solve", path, "--outputs", "10", code=1)
    assert f"{path}:8" in result.stderr and " t = " in result.stderr and "'y'" not in result.stderr, result.stderr
    assert operation in result.stderr and " y is " in result.stderr
    assert "nan" not in result.stdout and "inf" not in result.stdout


def test_integers_that_are_not_whole_are_no_solution(tmp_path):
    path = model(tmp_path, "    parameter Real 'p' = 1;\n    Integer 'a';", "    'a' = 'p' + sin('p');")
    result = run("solve", path, code=1)
    assert f"a is 1.84147 at t = 0" in result.stderr and f"{path}:7: a = p + sin(p)" in result.stderr


def test_text_after_the_model_is_an_error(tmp_path):
    path = model(tmp_path, "    Real 'x';", "    'x' = time;")
    text = path.read_text()
    path.write_text(text + "  equation\n    'x' = 2 * time;\n  end 'M';\n")
    assert f"{path}:9:3: expected the end of the file" in run("solve", path, code=2).stderr
    path.write_text(text + "Notification: a message of the compiler isn't part of the model\n")
    assert columns(run("solve", path).stdout)["x"][-1] == 1


def test_guesses_that_are_not_kept_are_named(tmp_path):
    warning = "x is only a guess, its start value is not fixed; x starts at 2"
    path = model(tmp_path, "    Real 'x'(start = 1.0);\n    Real 'y'(start = 1.0, fixed = true);",
                 "    der('y') = 0;\n    'x' = 2 * 'y';")
    result = run("solve", path, "--set", "x=0.3")
    assert f"warning: {path}:4: the value 0.3 given for {warning}" in result.stderr
    assert columns(result.stdout)["x"][0] == 2
    assert run("solve", path, "--set", "x=0.3", "--quiet").stderr == ""
    assert run("solve", path, "--set", "x=2").stderr == ""
    assert run("solve", path, "--set", "y=2").stderr == ""
    assert f"the value 0.3 given for {warning}" in run("analyze", path, "--set", "x=0.3").stderr


def test_parameters_outside_of_their_limits_are_named(tmp_path):
    path = model(tmp_path, "    parameter Real 'p'(min = 0, max = 2) = 1;\n    Real 'x'(start = 1.0, fixed = true, max = 1.5);",
                 "    der('x') = 0 * 'p';")
    assert run("solve", path).stderr == ""
    assert f"warning: {path}:4: parameter p is 3, above max = 2" in run("solve", path, "--set", "p=3").stderr
    assert f"warning: {path}:4: parameter p is -1, below min = 0" in run("check", path, "--set", "p=-1").stderr
    assert f"warning: {path}:5: x is 2 at t = 0, above max = 1.5" in run("solve", path, "--set", "x=2").stderr
