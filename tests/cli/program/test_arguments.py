"""Wrong use and how it is answered: exit code 2, and a message that names what is wrong."""

import pathlib
import re
import subprocess

import pytest
from program import MODELS, PENDULUM, PROGRAM, model, run


def test_version_is_that_of_the_library():
    assert run("--version").stdout.startswith("sfdae 0.")


def test_help_documents_every_exit_code_and_command():
    text = run("--help").stdout
    for word in ("check", "analyze", "solve", "sweep", "\n  0 ", "\n  1 ", "\n  2 ", "\n  3 ", "\n  4 ", "\n  5 ", "130"):
        assert word in text
    for command in ("check", "analyze", "solve", "sweep"):
        assert "MODEL" in run(command, "--help").stdout


def test_every_option_is_in_manual_and_guide():
    root = pathlib.Path(MODELS).parent.parent
    manual = (root / "cli" / "program" / "sfdae.1").read_text().replace("\\-", "-")
    guide = (root / "docs" / "guide" / "program.md").read_text()
    for command in ("check", "analyze", "solve", "sweep"):
        for option in re.findall(r"--[a-z-]+", run(command, "--help").stdout):
            assert option in manual and (option in guide or option == "--help"), (command, option)


@pytest.mark.parametrize("arguments, message", [
    ([], "subcommand is required"),
    (["solve"], "MODEL is required"),
    (["fly", PENDULUM], "no command 'fly'"),
    (["solve", PENDULUM, "--to"], "--to"),
    (["solve", PENDULUM, "--to", "soon"], "'soon' is not a number"),
    (["solve", PENDULUM, "--to", "nan"], "'nan' is not a number"),
    (["solve", PENDULUM, "--to", "1,5"], "'1,5' is not a number"),
    (["solve", PENDULUM, "--tol", "0"], "--tol: must be positive"),
    (["solve", PENDULUM, "--tol", "-1e-3"], "--tol: must be positive"),
    (["solve", PENDULUM, "--method", "euler"], "euler"),
    (["solve", PENDULUM, "--outputs", "0"], "--outputs"),
    (["solve", PENDULUM, "--max-steps", "-3"], "--max-steps"),
    (["solve", PENDULUM, "--colour"], "--colour"),
    (["solve", PENDULUM, "--set", "g"], "has to be NAME=VALUE"),
    (["solve", PENDULUM, "--set", "g="], "has to be NAME=VALUE"),
    (["solve", PENDULUM, "--set", "=1"], "has to be NAME=VALUE"),
    (["solve", PENDULUM, "--set", "g=heavy"], "'heavy' is not a number"),
    (["solve", PENDULUM, "--set", "g=inf"], "'inf' is not a number"),
    (["solve", PENDULUM, "--set", "g=1", "--set", "g=2"], "'g' is set twice"),
    (["solve", PENDULUM, "--set", "enrgy=1"], "did you mean energy?"),
    (["solve", PENDULUM, "--set", "g=1:3"], "several values; that is for sfdae sweep"),
    (["solve", PENDULUM, "--variables", "velocity_of_light"], "'velocity_of_light' is no name"),
    (["solve", PENDULUM, "--variables", "["], "'[' is no name"),
    (["solve", PENDULUM, "--plot", "out.gif"], "has to end in .svg, .png or .pdf"),
    (["sweep", PENDULUM], "needs --set"),
    (["sweep", PENDULUM, "--set", "L=1:-0.1:2"], "is empty"),
    (["sweep", PENDULUM, "--set", "L=1:0:2"], "is empty"),
    (["sweep", PENDULUM, "--set", "L=1:2:3:4"], "START:STEP:STOP"),
    (["sweep", PENDULUM, "--set", "L=0:1e-9:1"], "more than 1e7"),
    (["sweep", PENDULUM, "--set", "L=1:5000", "--set", "g=1:5000"], "more than 1e7 combinations"),
    (["sweep", PENDULUM, "--set", "L=1:2", "--jobs", "0"], "--jobs"),
    (["solve", "nowhere.mo"], "nowhere.mo"),
    (["solve", "/"], "is a directory"),
])
def test_wrong_use(arguments, message):
    result = run(*arguments, code=2)
    assert message in result.stderr, result.stderr
    assert result.stdout == ""


def test_error_in_a_model_is_named_with_its_line(tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0, fixed = true);", "    der('x') = -'x' + 'y';")
    result = run("solve", path, code=2)
    assert f"{path}:6:" in result.stderr and "y" in result.stderr


def test_text_that_is_no_model_is_refused():
    for text in ("", "hello", "model M", "\0\1\2"):
        assert "standard input:" in run("solve", "-", text=text, code=2).stderr


def test_model_from_standard_input():
    with open(PENDULUM) as file:
        text = file.read()
    assert run("solve", "-", "--to", "1", text=text).stdout == run("solve", PENDULUM, "--to", "1").stdout


def test_numbers_do_not_depend_on_the_locale():
    expected = run("solve", PENDULUM, "--to", "1.5").stdout
    locales = subprocess.run(["locale", "-a"], capture_output=True, text=True).stdout.split()
    for name in ["de_DE.UTF-8", *[name for name in locales if name.startswith(("de", "fr"))][:2]]:
        assert run("solve", PENDULUM, "--to", "1.5", environment={"LC_ALL": name}).stdout == expected


# Kinds of failure and their exit codes.

def test_too_few_equations_are_wrong_use(tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0);\n    Real 'y';", "    der('x') = -'x';")
    assert "no valid model" in run("solve", path, code=2).stderr


def test_contradicting_equations_cannot_be_solved(tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0);\n    Real 'y';", "    'x' + 'y' = sin(time);\n    'x' + 'y' = 2.0;")
    result = subprocess.run([PROGRAM, "solve", path], capture_output=True, text=True)
    assert result.returncode in (3, 4) and "sfdae: M is not" in result.stderr and result.stdout == ""


def test_no_consistent_start(tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0);\n    Real 'y'(start = 1.0, fixed = true);",
                 "    der('y') = -'y';\n    'x' ^ 2 + 'y' ^ 2 = -1.0;")
    assert "not started" in run("solve", path, code=4).stderr


def test_solution_that_ends_early_is_not_solved(tmp_path):
    # x = 1 / (1 - t) ends at 1.
    path = model(tmp_path, "    Real 'x'(start = 1.0, fixed = true);", "    der('x') = 'x' ^ 2;")
    result = run("solve", path, "--to", "2", code=1)
    assert "not finished, reached t = " in result.stderr
    assert 0.9 < float(result.stdout.splitlines()[-1].split(",")[0]) <= 1.0


def test_failed_assertion_ends_the_run(tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0, fixed = true);",
                 "    der('x') = 'x';\n    assert('x' < 2.0, \"x has become too large\");")
    assert "x has become too large" in run("solve", path, "--to", "2", code=1).stderr
