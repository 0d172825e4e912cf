"""Runs the program and reads what it writes."""

import csv
import io
import os
import subprocess

PROGRAM = os.environ["SFDAE_PROGRAM"]
MODELS = os.environ["SFDAE_MODELS"]
EXPORTS = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "models")
PENDULUM = os.path.join(MODELS, "pendulum.mo")


def run(*arguments, code=0, text=None, environment=None, directory=None):
    """Runs the program with pipes for input and outputs and checks its exit code."""
    result = subprocess.run([PROGRAM, *map(str, arguments)], input=text, capture_output=True, text=True, timeout=300,
                            env={**os.environ, **(environment or {})}, cwd=directory)
    assert result.returncode == code, (result.returncode, result.stderr, result.stdout[:500])
    return result


def table(text):
    """Names of columns, and rows of texts."""
    rows = list(csv.reader(io.StringIO(text)))
    assert all(len(row) == len(rows[0]) for row in rows)
    return rows[0], rows[1:]


def columns(text):
    """Columns of numbers by name."""
    names, rows = table(text)
    return {name: [float(row[j]) for row in rows] for j, name in enumerate(names)}


def model(path, declarations, equations, name="M"):
    """Writes a model file and returns its path."""
    path = path / "model.mo"
    path.write_text(f"//! base 0.1.0\npackage '{name}'\n  model '{name}'\n{declarations}\n  equation\n{equations}\n"
                    f"  end '{name}';\nend '{name}';\n")
    return path
