"""Pictures by gnuplot."""

import os

import pytest
from program import MODELS, PENDULUM, model, run


def test_svg_has_curves_and_units(tmp_path):
    run("solve", PENDULUM, "--plot", tmp_path / "o.svg")
    picture = (tmp_path / "o.svg").read_text()
    for text in ("Pendulum", ">x<", ">vy<", ">energy<", ">m/s<", ">N/m<", "time in s"):
        assert text in picture, text
    assert os.listdir(tmp_path) == ["o.svg"]


@pytest.mark.parametrize("ending, start", [("png", b"\x89PNG"), ("pdf", b"%PDF")])
def test_formats(ending, start, tmp_path):
    run("solve", os.path.join(MODELS, "bouncing_ball.mo"), "--plot", tmp_path / f"o.{ending}")
    assert (tmp_path / f"o.{ending}").read_bytes().startswith(start)


def test_strange_names(tmp_path):
    path = model(tmp_path, "    Real 'it\\'s \"<b>\" $x %d {a_b^c} `ls`'(start = 1.0, fixed = true, unit = \"it's\");",
                 "    der('it\\'s \"<b>\" $x %d {a_b^c} `ls`') = 1.0;", name="a_b'c".replace("'", "\\'"))
    run("solve", path, "--plot", tmp_path / "o.svg")
    assert "&lt;b" in (tmp_path / "o.svg").read_text() and "{a_b^c} `ls`" in (tmp_path / "o.svg").read_text()


def test_too_many_curves_are_reported(tmp_path):
    names = [f"x[{k}]" for k in range(20)]
    path = model(tmp_path, "\n".join(f"    Real '{n}'(start = 1.0, fixed = true);" for n in names),
                 "\n".join(f"    der('{n}') = -'{n}';" for n in names))
    assert "shows 12 of 20 curves" in run("solve", path, "--plot", tmp_path / "o.svg").stderr
    assert run("solve", path, "--plot", tmp_path / "o.svg", "--variables", r"x\[1.\]").stderr == ""


def test_missing_gnuplot_is_named(tmp_path):
    result = run("solve", PENDULUM, "--plot", tmp_path / "o.svg", environment={"PATH": str(tmp_path)}, code=5)
    assert "gnuplot" in result.stderr and "apt install gnuplot-nox" in result.stderr
    assert os.listdir(tmp_path) == []


def test_failing_gnuplot_is_reported(tmp_path):
    (tmp_path / "gnuplot").write_text("#!/bin/sh\necho broken terminal >&2\nexit 1\n")
    (tmp_path / "gnuplot").chmod(0o755)
    path = f"{tmp_path}:{os.environ['PATH']}"
    result = run("solve", PENDULUM, "--plot", tmp_path / "o.svg", environment={"PATH": path}, code=5)
    assert "gnuplot failed: broken terminal" in result.stderr and not (tmp_path / "o.svg").exists()
