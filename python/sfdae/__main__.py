# SPDX-License-Identifier: BSD-3-Clause
"""``python -m sfdae``: versions and file names for problem reports."""

from __future__ import annotations

import importlib
import os
import pathlib
import platform
import re

from . import _binding, version

_PACKAGES = ("numpy", "scipy", "cffi", "matplotlib", "pandas")


def _version_of(package: str) -> str:
    try:
        return str(importlib.import_module(package).__version__)
    except ImportError:
        return "not installed"


def _libraries() -> list[str]:
    """Files of sfdae, BLAS and LAPACK loaded by this process; empty if unknown."""
    maps = pathlib.Path("/proc/self/maps")
    if not maps.exists():
        return []
    files = {line.split(maxsplit=5)[-1] for line in maps.read_text().splitlines()}
    return sorted(file for file in files if re.search(r"/[^/]*(sfdae|blas|lapack)[^/]*\.so", file))


def main() -> None:
    lines = [("sfdae", version()), ("Python", platform.python_version())]
    lines += [(package, _version_of(package)) for package in _PACKAGES]
    lines += [("system", platform.platform()), ("module", _binding.__file__)]
    lines += [("loaded", file) for file in _libraries() if file != _binding.__file__]
    lines += [("processors", str(os.cpu_count()))]
    lines += [(n, os.environ[n]) for n in sorted(os.environ) if n.endswith("_NUM_THREADS")]
    for name, text in lines:
        print(f"{name:24}{text}")


if __name__ == "__main__":
    main()
