# SPDX-License-Identifier: BSD-3-Clause
"""Pages of the Python reference, made from the docstrings of what the package makes public."""

import importlib.util
import inspect
import os
import subprocess
import sys

from headers import title

# Asks another interpreter, as the package may need settings before numpy is imported.
QUESTION = """
import inspect, sfdae
for name in sfdae.__all__:
    thing = getattr(sfdae, name)
    kind = "class" if inspect.isclass(thing) else "function" if callable(thing) else "data"
    print(kind, name)
"""


def public_names(package):
    """(kind, name) of what the package makes public."""
    answer = subprocess.run([sys.executable, "-c", QUESTION], capture_output=True, text=True, check=True,
                            env=dict(os.environ, PYTHONPATH=str(package), PYTHONDONTWRITEBYTECODE="1"))
    return [line.split() for line in answer.stdout.splitlines()]


def pages(package):
    """Names and texts of the pages."""
    lines = title("Python")
    if not package:
        return {"python.rst": "\n".join([*lines, "The package was not built when these pages were made."]) + "\n"}
    names = public_names(package)
    functions = [name for kind, name in names if kind == "function"]
    solving = [name for name in functions if name.startswith(("solve", "analyze", "make_"))]
    lines += [".. automodule:: sfdae", "", *title("Solving", "-")]
    lines += [line for name in solving for line in (f".. autofunction:: sfdae.{name}", "")]
    if importlib.util.find_spec("torch") is not None:  # else the module cannot be imported
        lines += [*title("PyTorch", "-"), ".. autofunction:: sfdae.torch.solve", ""]
    lines += title("Classes", "-")
    lines += [line for kind, name in names if kind == "class"
              for line in (f".. autoclass:: sfdae.{name}", "   :members:", "")]
    lines += title("Functions of expressions, and others", "-")
    lines += [line for name in functions if name not in solving for line in (f".. autofunction:: sfdae.{name}", "")]
    return {"python.rst": "\n".join(lines) + "\n"}
