"""Files are written completely or not at all."""

import os
import stat
import subprocess

import pytest
from program import PENDULUM, PROGRAM, run

FILES = [("--csv", "o.csv"), ("--json", "o.json"), ("--html", "o.html"), ("--plot", "o.svg")]


@pytest.mark.parametrize("option, name", FILES)
def test_missing_directory_is_reported_before_the_work_begins(option, name, tmp_path):
    result = run("solve", PENDULUM, "--to", "1e9", option, tmp_path / "nowhere" / name, code=5)
    assert "cannot write" in result.stderr and "nowhere" in result.stderr and result.stdout == ""


@pytest.mark.parametrize("option, name", FILES[:3])
def test_directory_cannot_be_written(option, name, tmp_path):
    assert "cannot write" in run("solve", PENDULUM, option, tmp_path, code=5).stderr


@pytest.mark.parametrize("option, name", FILES[:3])
def test_full_device_is_reported(option, name):
    assert "cannot write /dev/full" in run("solve", PENDULUM, option, "/dev/full", code=5).stderr


def test_full_standard_output_is_reported():
    with open("/dev/full", "w") as full:
        result = subprocess.run([PROGRAM, "solve", PENDULUM], stdout=full, stderr=subprocess.PIPE, text=True)
    assert result.returncode == 5 and "cannot write to standard output" in result.stderr


def test_existing_file_is_replaced_and_keeps_its_mode(tmp_path):
    path = tmp_path / "o.csv"
    path.write_text("old")
    path.chmod(0o640)
    run("solve", PENDULUM, "--csv", path)
    assert path.read_text().startswith("time,") and stat.S_IMODE(path.stat().st_mode) == 0o640
    assert os.listdir(tmp_path) == ["o.csv"]


def test_new_file_has_the_usual_mode(tmp_path):
    run("solve", PENDULUM, "--csv", tmp_path / "new.csv")
    (tmp_path / "usual").write_text("")
    assert (tmp_path / "new.csv").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_link_stays_a_link(tmp_path):
    (tmp_path / "link.csv").symlink_to(tmp_path / "target.csv")
    (tmp_path / "target.csv").write_text("old")
    run("solve", PENDULUM, "--csv", tmp_path / "link.csv")
    assert (tmp_path / "link.csv").is_symlink() and (tmp_path / "target.csv").read_text().startswith("time,")


def test_wrong_use_leaves_files_alone(tmp_path):
    path = tmp_path / "o.csv"
    path.write_text("old")
    run("solve", PENDULUM, "--csv", path, "--set", "nothing=1", code=2)
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["o.csv"]


def test_device_as_file():
    assert run("solve", PENDULUM, "--csv", "/dev/stdout", "--quiet").stdout.startswith("time,")
    assert run("solve", PENDULUM, "--csv", "/dev/null").stdout.startswith("Pendulum: solved")


def test_minus_is_standard_output():
    assert run("solve", PENDULUM, "--json", "-").stdout.startswith("{")
    assert run("solve", PENDULUM, "--html", "-").stdout.startswith("<!DOCTYPE html>")
    assert run("check", PENDULUM, "--json", "-").stdout.startswith("{")


def test_page_is_opened_in_the_browser(tmp_path):
    opener, seen = tmp_path / "xdg-open", tmp_path / "seen"
    os.mkfifo(seen)
    opener.write_text(f'#!/bin/sh\necho "$1" > {seen}\n')
    opener.chmod(0o755)
    environment = {"PATH": f"{tmp_path}:{os.environ['PATH']}", "DISPLAY": ":0"}
    page = tmp_path / "p.html"
    assert run("solve", PENDULUM, "--html", page, "--show", environment=environment).stderr == ""
    assert seen.read_text() == f"{page}\n"


def test_page_without_a_screen(tmp_path):
    environment = {"DISPLAY": "", "PATH": str(tmp_path)}
    result = run("solve", PENDULUM, "--html", tmp_path / "p.html", "--show", environment=environment)
    assert "open " + str(tmp_path / "p.html") in result.stderr
    assert "--show needs a file" in run("solve", PENDULUM, "--show", code=2).stderr
