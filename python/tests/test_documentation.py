# SPDX-License-Identifier: BSD-3-Clause
"""Everything public is documented, and every function of the library can be reached from Python."""

import doctest
import inspect
import pathlib
import re

import pytest

import sfdae
from sfdae import _binding

SOURCES = sorted(pathlib.Path(sfdae.__file__).parent.glob("*.py"))


def public_objects():
    for name in sfdae.__all__:
        thing = getattr(sfdae, name)
        yield name, thing
        if inspect.isclass(thing) and thing.__module__.startswith("sfdae"):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    yield f"{name}.{member}", value


def test_every_public_object_has_a_docstring():
    missing = [
        name
        for name, thing in public_objects()
        if (callable(thing) or isinstance(thing, property))
        and not (inspect.getdoc(thing) or "").strip()
        and not re.match(r"Expression\.", name)  # methods that numpy calls, those of its ufuncs
    ]
    assert not missing


DOCUMENTED = [
    "solve",
    "solve_ensemble",
    "analyze",
    "make_consistent",
    "parameter",
    "choose",
    "Event",
    "Solver",
    "Descriptor",
]
DOCUMENTED += ["LinearProblem", "NonlinearProblem", "MultibodyProblem"]


@pytest.mark.parametrize("name", DOCUMENTED)
def test_every_argument_is_documented(name):
    thing = getattr(sfdae, name)
    text = inspect.getdoc(thing)
    assert [
        a for a in inspect.signature(thing).parameters if not re.search(rf"\b{a}\b", text)
    ] == []


def test_every_function_of_the_library_is_used():
    text = "\n".join(source.read_text() for source in SOURCES)
    kinds = ["linear", "nonlinear", "multibody"]
    reached = set(re.findall(r"lib\.(sfdae_\w+)", text))
    support = pathlib.Path(__file__).resolve().parent.parent / "binding_support.c"
    reached |= set(re.findall(r"(sfdae_\w+)\(", support.read_text()))
    reached |= {f"sfdae_{verb}_{kind}" for kind in kinds for verb in ("create", "check")}
    reached |= {f"sfdae_{kind}_problem_init" for kind in kinds}
    reached |= {f"sfdae_{name}" for name in sfdae._functions.OF_C}
    reached |= {
        f"sfdae_{name}_init"
        for name in re.findall(r'(?:_filled|filled|prepared)\(\s*"(\w+)"', text)
    }
    functions = {
        name
        for name in dir(_binding.lib)
        if name.startswith("sfdae_")
        and _binding.ffi.typeof(getattr(_binding.lib, name)).kind == "function"
    }
    assert functions - reached == set()


def test_the_example_of_solve():
    result = doctest.testmod(sfdae._solve)
    assert result.attempted >= 4 and result.failed == 0


def test_status_codes_are_those_of_c():
    assert sfdae.Status.OK == 0 and sfdae.Status.STEP_TOO_SMALL == _binding.lib.SFDAE_STEP_TOO_SMALL
    assert len(sfdae.Status) > 25
    assert sfdae.status_name(-41) == "SFDAE_STEP_TOO_SMALL"
    assert sfdae.__version__ == sfdae.version()


def test_errors_say_what_they_are():
    error = sfdae.Error(-20, "index")
    assert (str(error), error.status) == (
        "SFDAE_INDEX_TOO_HIGH: index",
        sfdae.Status.INDEX_TOO_HIGH,
    )
    assert str(sfdae.Error(-77)) == "unknown status"
    assert sfdae.Error(-77).status == -77


def test_structs_are_complete():
    fields = {name for name, _ in _binding.ffi.typeof("sfdae_characteristics").fields} - {"size"}
    report = sfdae.analyze(sfdae.LinearProblem([[1.0]], [[1.0]]))
    assert set(report.characteristics._asdict()) == fields


def test_files_are_short():
    assert max(len(source.read_text().splitlines()) for source in SOURCES) <= 400


def test_the_program_of_the_readme(tmp_path, monkeypatch):
    """At most 10 lines, and it draws a pendulum that swings."""
    pytest.importorskip("matplotlib").use("Agg")
    readme = pathlib.Path(__file__).resolve().parent.parent / "README.md"
    program = re.search(r"```python\n(.*?)```", readme.read_text(), re.DOTALL)[1]
    assert len([line for line in program.splitlines() if line.strip()]) <= 10
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(program, names)
    assert (tmp_path / "pendulum.svg").stat().st_size > 5000
    assert names["sol"].success and names["sol"]["px"].min() < -0.59
