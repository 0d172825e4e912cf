"""Ctrl-C and closed pipes."""

import os
import pty
import re
import signal
import subprocess

import pytest
from program import MODELS, PENDULUM, PROGRAM, table

# Long enough to be interrupted anywhere.
LONG = ["--to", "1e6", "--outputs", "1000000", "--tol", "1e-10"]


def started(*arguments, **keywords):
    """A process whose standard error is a terminal, and what to read there."""
    reading, writing = pty.openpty()
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], stderr=writing, **keywords)
    os.close(writing)
    return process, reading


def read_until(descriptor, pattern):
    seen = b""
    while not re.search(pattern, seen):
        seen += os.read(descriptor, 4096)


def read_all(descriptor):
    seen = b""
    try:
        while part := os.read(descriptor, 4096):
            seen += part
    except OSError:  # how a terminal ends
        pass
    return seen.decode()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruption_writes_what_there_is(number, tmp_path):
    process, errors = started("solve", PENDULUM, *LONG, "--csv", tmp_path / "o.csv", stdout=subprocess.DEVNULL)
    read_until(errors, rb"t = [1-9]\d")
    process.send_signal(number)
    text = read_all(errors)
    assert process.wait(60) == 130
    assert "is stopped, reached t = " in text
    names, rows = table((tmp_path / "o.csv").read_text())
    assert names[0] == "time" and 0 < float(rows[-1][0]) < 1e6


def test_sweep_is_interrupted(tmp_path):
    process, errors = started("sweep", PENDULUM, "--set", "L=0.5:0.1:2", "--to", "200", "--jobs", "2", "--csv",
                              tmp_path / "s.csv", stdout=subprocess.DEVNULL)
    read_until(errors, b" of 16 instances")
    process.send_signal(signal.SIGINT)
    assert "interrupted; " in read_all(errors)
    assert process.wait(60) == 130
    names, rows = table((tmp_path / "s.csv").read_text())
    outcomes = [row[names.index("outcome")] for row in rows]
    assert 1 <= len(rows) <= 16 and "solved" in outcomes and set(outcomes) <= {"solved", "stopped"}


def test_closed_pipe_makes_no_noise():
    for arguments in (["solve", PENDULUM, "--outputs", "100000"], ["sweep", PENDULUM, "--set", "L=1:0.1:2", "--to", "1"],
                      ["analyze", PENDULUM], ["check", os.path.join(MODELS, "squeezer.mo"), "--names"]):
        result = subprocess.run(["sh", "-c", '"$@" | head -n 1', "sh", PROGRAM, *arguments], capture_output=True,
                                text=True, timeout=300)
        assert result.stderr == "" and len(result.stdout.splitlines()) == 1
