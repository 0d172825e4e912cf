# SPDX-License-Identifier: BSD-3-Clause
"""Every example is a test: it runs as a program does and checks its own answer."""

import pathlib
import runpy

import pytest


class Example(pytest.Item):
    def runtest(self):
        runpy.run_path(str(self.path), run_name="__main__")

    def reportinfo(self):
        return self.path, 0, f"example {self.name}"


class ExampleFile(pytest.File):
    def collect(self):
        yield Example.from_parent(self, name=self.path.stem)


def pytest_collect_file(file_path: pathlib.Path, parent):
    if file_path.suffix == ".py" and file_path.name != "conftest.py":
        return ExampleFile.from_parent(parent, path=file_path)
    return None
