# SPDX-License-Identifier: BSD-3-Clause
"""Every example is a test: it runs as a program or a notebook does and checks its own answer."""

import pathlib
import runpy

import pytest


class Program(pytest.Item):
    def runtest(self):
        if "import torch" in self.path.read_text():
            pytest.importorskip("torch")
        runpy.run_path(str(self.path), run_name="__main__")

    def reportinfo(self):
        return self.path, 0, f"example {self.name}"


class Notebook(Program):
    def runtest(self):
        preprocessors = pytest.importorskip("nbconvert.preprocessors")
        pytest.importorskip("ipykernel")
        nbformat = pytest.importorskip("nbformat")
        notebook = nbformat.read(self.path, as_version=4)
        preprocessors.ExecutePreprocessor(timeout=120, kernel_name="python3").preprocess(notebook)
        pictures = [
            output
            for cell in notebook.cells
            for output in cell.get("outputs", [])
            if "image/png" in output.get("data", {})
        ]
        assert len(pictures) == 2


class ExampleFile(pytest.File):
    def collect(self):
        kind = Program if self.path.suffix == ".py" else Notebook
        yield kind.from_parent(self, name=self.path.stem)


def pytest_collect_file(file_path: pathlib.Path, parent):
    if file_path.suffix in (".py", ".ipynb") and file_path.name != "conftest.py":
        return ExampleFile.from_parent(parent, path=file_path)
    return None
