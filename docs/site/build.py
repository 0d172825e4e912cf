#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the site: guide, reference of all languages, design.

    build.py --output <dir> [--python-package <dir that contains sfdae>]

Below <dir>: `source`, the pages as Sphinx gets them, and `html`. Any warning is a failure. Programs used: doxygen and
sphinx-build with MyST, Breathe and Furo. Without the package the reference of Python is left out."""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

import c_reference
import fortran_reference
import python_reference

ROOT = pathlib.Path(__file__).resolve().parents[2]
# What pages are made of, or link to.
PARTS = ["docs", "examples", "include", "benchmarks", "scripts", "tests", "LICENSE", "CHANGELOG.md", "CONTRIBUTING.md",
         "SECURITY.md", "CITATION.cff", "CODE_OF_CONDUCT.md",
         "python/README.md", "python/examples", "fortran_bindings/README.md", "octave/examples", "octave/make_package.sh"]

CONTENTS = """
```{toctree}
:hidden:
:caption: Guide

docs/guide/index
docs/guide/quick_start
docs/guide/initial_values
docs/guide/status
docs/guide/report
docs/guide/formulations
docs/guide/mistakes
docs/guide/tolerances
docs/guide/performance
docs/guide/events_and_ensembles
docs/guide/machines
docs/guide/linearization
docs/guide/sensitivities
docs/guide/modes
docs/guide/impulses
docs/guide/hybrid
docs/guide/branches
docs/guide/python
docs/guide/octave
docs/guide/program
docs/guide/coverage
docs/guide/limitations
examples/README
```

```{toctree}
:hidden:
:caption: Theory

docs/guide/theory
```

```{toctree}
:hidden:
:caption: Moving from other codes

docs/guide/moving
docs/moving_from_gelda
```

```{toctree}
:hidden:
:caption: Reference

reference/c
reference/cpp
reference/fortran
reference/python
python/README
fortran_bindings/README
```

```{toctree}
:hidden:
:caption: More

docs/performance
docs/architecture
docs/guide/promise
SECURITY
CODE_OF_CONDUCT
```

```{toctree}
:hidden:
:caption: Design

docs/design/README
docs/design/steps
docs/design/derivative_array
docs/design/rank_decisions
docs/design/scaling_and_units
docs/design/structural_analysis
docs/design/minimal_extension
docs/design/finite_differences
docs/design/consistent_initialization
docs/design/linearization
docs/design/error_control
docs/design/bdf
docs/design/radau
docs/design/iteration_matrices
docs/design/singular_points
docs/design/multibody
docs/design/inputs_and_discontinuities
docs/design/events_and_switching
docs/design/hybrid_systems
docs/design/sensitivities
docs/design/adjoint
docs/design/kernels
docs/design/sparse_algebra
docs/design/memory
docs/design/checkpoints
docs/design/interfaces
```

```{toctree}
:hidden:
:caption: Development

CHANGELOG
CONTRIBUTING
tests/campaign/README
```
"""

DOXYFILE = """
PROJECT_NAME = sfdae
INPUT = "{include}"
FILE_PATTERNS = *.h *.hpp
OUTPUT_DIRECTORY = "{output}"
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
QUIET = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = SFDAE_API=
TYPEDEF_HIDES_STRUCT = YES
AUTOLINK_SUPPORT = NO
WARN_IF_UNDOCUMENTED = NO
WARN_AS_ERROR = FAIL_ON_WARNINGS
"""


def version():
    """That of the library, from its header."""
    header = (ROOT / "include" / "sfdae" / "sfdae.h").read_text()
    return ".".join(re.findall(r"#define SFDAE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header))


def lay_out(source):
    """The pages at the same places as in the source tree, so that their links hold; README is the first one."""
    for old in (source, source.parent / "html", source.parent / "doctrees", source.parent / "xml"):
        shutil.rmtree(old, ignore_errors=True)
    for part in PARTS:
        place = source / part
        place.parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / part).exists():
            place.symlink_to(ROOT / part)
    (source / "index.md").write_text((ROOT / "README.md").read_text() + CONTENTS)


def run(command, **settings):
    """Runs a program; ends this one if it fails."""
    result = subprocess.run(command, **settings)
    if result.returncode:
        sys.exit(f"{command[0]} failed")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--python-package", type=pathlib.Path)
    options = parser.parse_args()
    output = options.output.resolve()
    source = output / "source"

    lay_out(source)
    doxyfile = output / "Doxyfile"
    doxyfile.write_text(DOXYFILE.format(include=ROOT / "include" / "sfdae", output=output))
    run(["doxygen", str(doxyfile)])

    reference = source / "reference"
    reference.mkdir()
    for name, text in {**c_reference.pages(ROOT, output / "xml"), **fortran_reference.pages(ROOT),
                       **python_reference.pages(options.python_package)}.items():
        (reference / name).write_text(text)

    environment = dict(os.environ, SFDAE_DOCS_VERSION=version(), SFDAE_DOCS_XML=str(output / "xml"),
                       PYTHONDONTWRITEBYTECODE="1", OPENBLAS_NUM_THREADS="1")
    if options.python_package:
        environment["PYTHONPATH"] = str(options.python_package)
    run([sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", "-c", str(ROOT / "docs" / "site"),
         "-d", str(output / "doctrees"), str(source), str(output / "html")], env=environment)
    print(f"{output / 'html' / 'index.html'}")


if __name__ == "__main__":
    main()
