# SPDX-License-Identifier: BSD-3-Clause
"""What type checkers see: the examples pass mypy --strict, and mistakes in arguments are found."""

import pathlib

import pytest

import sfdae

EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"
SETTINGS = """
[mypy]
strict = True
[mypy-sfdae.*]
ignore_errors = True
[mypy-sfdae._binding]
ignore_missing_imports = True
[mypy-torch.*]
ignore_missing_imports = True
follow_imports = skip
"""
MISTAKES = """
import sfdae
sol = sfdae.solve(print, (0, 1), [1.0], names="x", method=3)
sol.statuses
sfdae.Solver(print)
sfdae.sinus(1.0)
text: str = sfdae.sin(0.5)
"""


@pytest.fixture(scope="module")
def check(tmp_path_factory):
    """Runs mypy on files; what it knows of the package is kept between the tests."""
    api = pytest.importorskip("mypy.api")
    folder = tmp_path_factory.mktemp("mypy")
    (folder / "mypy.ini").write_text(SETTINGS)
    options = ["--config-file", str(folder / "mypy.ini"), "--cache-dir", str(folder / "cache")]

    def run(*files):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("MYPYPATH", str(pathlib.Path(sfdae.__file__).parent.parent))
            return api.run([*options, *map(str, files)])[0]

    return run


def test_the_examples_are_strictly_typed(check):
    files = [file for file in EXAMPLES.glob("*.py") if file.name != "conftest.py"]
    assert "Success: no issues found in 6 source files" in check(*files)


def test_mistakes_are_found(check, tmp_path):
    (tmp_path / "program.py").write_text(MISTAKES)
    found = check(tmp_path / "program.py")
    for part in ('"method"', '"statuses"', 'to "Solver"', '"sinus"', 'has type "float"'):
        assert part in found
    assert "Found 5 errors" in found


def test_all_functions_of_expressions_have_a_type():
    assert set(sfdae.__annotations__) == set(sfdae._functions.PUBLIC)
