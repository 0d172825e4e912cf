"""Output to a terminal is for people."""

import os
import pty
import subprocess

from program import PENDULUM, PROGRAM, model


def on_terminal(*arguments):
    """Exit code and output of the program where everything goes to one terminal."""
    reading, writing = pty.openpty()
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=writing, stderr=writing, stdin=writing)
    os.close(writing)
    seen = b""
    try:
        while part := os.read(reading, 4096):
            seen += part
    except OSError:  # how a terminal ends
        pass
    os.close(reading)
    return process.wait(60), seen.decode()


def test_summary_in_words():
    code, text = on_terminal("solve", PENDULUM)
    assert code == 0
    assert "Pendulum: solved from 0 to 10 s" in text and "Index 3 (strangeness index 2)." in text
    assert "energy" in text and "time,x" not in text


def test_progress_bar_is_wiped():
    code, text = on_terminal("solve", PENDULUM, "--tol", "1e-10", "--outputs", "20000")
    assert code == 0 and "\r[" in text and " of 10, step " in text and ", order " in text
    assert text.rindex("\r\033[K") > text.rindex("\r[")


def test_quiet_shows_nothing():
    assert on_terminal("solve", PENDULUM, "--quiet") == (0, "")


def test_no_progress_bar_in_a_pipe():
    result = subprocess.run([PROGRAM, "solve", PENDULUM, "--tol", "1e-10"], capture_output=True, text=True)
    assert result.stderr == ""


def test_sweep_shows_its_table():
    code, text = on_terminal("sweep", PENDULUM, "--set", "L=1,2", "--to", "1", "--variables", "x")
    assert code == 0 and "  instance  L  outcome  time  x\r\n" in text and "2 of 2 instances solved" in text
    assert "  2         2  solved   1     " in text


def test_only_tables_that_are_cut_say_so():
    for count, is_cut in ((200, False), (201, True)):
        values = ",".join(str(1 + k / 1000) for k in range(count))
        code, text = on_terminal("sweep", PENDULUM, "--set", f"L={values}", "--to", "0.001", "--variables", "x", "--jobs", "1")
        assert code == 0 and ("only the first rows" in text) == is_cut


def test_one_variable_that_is_left_out(tmp_path):
    names = "abcdefg"
    path = model(tmp_path, "\n".join(f"    Real '{n}'(start = 1.0, fixed = true);" for n in names),
                 "\n".join(f"    der('{n}') = -'{n}';" for n in names))
    assert "  1 more variable is left out;" in on_terminal("sweep", path, "--set", "a=1,2")[1]
