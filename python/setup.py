# SPDX-License-Identifier: BSD-3-Clause
"""Builds the package by CMake: the library, and the module sfdae._binding that contains it.

SFDAE_PREFIX=<prefix>: an installed library is put into the package instead of one that is built.
SFDAE_PYTHON_LINK=shared: it is not put into the package, but found where it is installed (packages
of distributions). CMAKE_ARGS: further arguments for CMake."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # setuptools before 70.1
    from wheel.bdist_wheel import bdist_wheel

HERE = pathlib.Path(__file__).resolve().parent
# Of the library: beside this package in a checkout, below it in a source distribution.
ROOT = HERE / "library" if (HERE / "library").is_dir() else HERE.parent
MODULE = "_binding.abi3.so"


def version() -> str:
    """That of the library, from its header."""
    prefix = os.environ.get("SFDAE_PREFIX")
    places = [ROOT / "include", *([pathlib.Path(prefix) / "include"] if prefix else [])]
    header = next(
        (place / "sfdae/sfdae.h" for place in places if (place / "sfdae/sfdae.h").is_file()), None
    )
    if header is None:
        raise SystemExit(
            "sfdae/sfdae.h was not found: build the package from a checkout, or set SFDAE_PREFIX"
        )
    text = header.read_text()
    return ".".join(
        re.search(rf"SFDAE_VERSION_{part} (\d+)", text)[1] for part in ("MAJOR", "MINOR", "PATCH")
    )


def cmake_arguments(prefix: "str | None") -> "list[str]":
    link = os.environ.get("SFDAE_PYTHON_LINK", "static")
    arguments = [f"-DSFDAE_PYTHON_EXECUTABLE={sys.executable}", f"-DSFDAE_PYTHON_LINK={link}"]
    arguments += ["-DCMAKE_BUILD_TYPE=Release"]
    if prefix:
        return [*arguments, f"-DCMAKE_PREFIX_PATH={prefix}"]
    for part in ("BUILD_FORTRAN", "BUILD_PROGRAM", "INSTALL"):
        arguments.append(f"-DSFDAE_{part}=OFF")
    return [*arguments, "-DSFDAE_BUILD_PYTHON=ON"]


class Build(build_py):
    """Adds the compiled module to the files of the package."""

    def run(self) -> None:
        shutil.rmtree(
            pathlib.Path(self.build_lib) / "sfdae", ignore_errors=True
        )  # of earlier builds
        super().run()
        if shutil.which("cmake") is None:
            raise SystemExit(
                "cmake is needed to build sfdae (Debian: apt install cmake g++ liblapack-dev)"
            )
        prefix = os.environ.get("SFDAE_PREFIX")
        source = HERE if prefix else ROOT
        build = pathlib.Path(self.build_lib).resolve().parent / "sfdae-cmake"
        more = shlex.split(os.environ.get("CMAKE_ARGS", ""))
        subprocess.run(
            ["cmake", "-S", source, "-B", build, *cmake_arguments(prefix), *more], check=True
        )
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        subprocess.run(
            ["cmake", "--build", build, "--target", "sfdae_python", "--parallel", jobs], check=True
        )
        modules = [*build.glob(f"**/sfdae/{MODULE}")]
        if not modules:
            raise SystemExit(f"CMake did not build {MODULE}: see its messages above")
        target = pathlib.Path(self.build_lib) / "sfdae" / MODULE
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(modules[0], target)
        if (ROOT / "LICENSE").is_file():
            shutil.copy2(ROOT / "LICENSE", target.parent / "LICENSE")


class SourceDistribution(sdist):
    """Adds what CMake needs to build the library."""

    def make_release_tree(self, base_dir: str, files: "list[str]") -> None:
        super().make_release_tree(base_dir, files)
        package, library = pathlib.Path(base_dir), pathlib.Path(base_dir) / "library"
        shutil.rmtree(library, ignore_errors=True)
        for folder in ("cmake", "include", "src", "fortran_bindings/f77"):
            shutil.copytree(ROOT / folder, library / folder)
        (library / "python").mkdir()
        for name in ("CMakeLists.txt", "build_binding.py", "binding_support.c"):
            shutil.copy2(HERE / name, package / name)
            shutil.copy2(HERE / name, library / "python" / name)
        for name in ("CMakeLists.txt", "LICENSE"):
            shutil.copy2(ROOT / name, library / name)


class Wheel(bdist_wheel):
    """The module keeps to Python's stable interface: one wheel for all versions from 3.9 on."""

    def get_tag(self) -> "tuple[str, str, str]":
        return ("cp39", "abi3", super().get_tag()[2])


class BinaryDistribution(Distribution):
    """Contains a compiled module, though setuptools does not build it."""

    def has_ext_modules(self) -> bool:
        return True


setup(
    version=version(),
    distclass=BinaryDistribution,
    cmdclass={"build_py": Build, "bdist_wheel": Wheel, "sdist": SourceDistribution},
)
