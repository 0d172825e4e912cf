# SPDX-License-Identifier: BSD-3-Clause
"""A progress bar: time reached, step size and order; by tqdm if installed."""

from __future__ import annotations

import sys
import time
from typing import Any, Callable, TextIO

_INTERVAL = 0.1  # seconds between two updates: as fast as one can read


class ProgressBar:
    """Shows the progress of an integration from t0 to t1, on standard error by default."""

    def __init__(self, t0: float, t1: float, file: TextIO | None = None) -> None:
        self._t0, self._length = t0, t1 - t0
        self._file = sys.stderr if file is None else file
        self._next = 0.0
        self._shown = 0.0
        self._is_open = False
        self._bar: Any = None
        try:
            from tqdm import tqdm
        except ImportError:
            return
        layout = "{l_bar}{bar}| {elapsed}<{remaining}{postfix}"
        self._bar = tqdm(total=100.0, file=self._file, unit="%", bar_format=layout, leave=True)

    def watch(self, monitor: Callable[[Any], Any] | None) -> Callable[[Any], Any]:
        """A monitor that updates the bar, and then calls the user's."""

        def after_step(progress: Any) -> Any:
            self.update(progress.t, progress.step, progress.order)
            return monitor is not None and monitor(progress)

        return after_step

    def update(self, t: float, step: float, order: int) -> None:
        """Called after every step; draws a few times a second."""
        now = time.monotonic()
        if now >= self._next:
            self._next = now + _INTERVAL
            self._draw(t, f"t={t:.6g}, step={abs(step):.2g}, order={order}")

    def close(self, t: float, steps: int) -> None:
        """Shows the end of the integration."""
        self._draw(t, f"t={t:.6g}, {steps} steps")
        if self._bar is not None:
            self._bar.close()
        elif self._is_open:
            self._file.write("\n")

    def _draw(self, t: float, text: str) -> None:
        percent = min(max(100.0 * (t - self._t0) / self._length, 0.0), 100.0)
        if self._bar is not None:
            self._bar.set_postfix_str(text, refresh=False)
            self._bar.update(percent - self._shown)
            self._shown = percent
            return
        self._is_open = True
        self._file.write(f"\r{percent:5.1f} %  {text:<48}")
        self._file.flush()


class InstancesBar:
    """Shows how many instances of an ensemble have ended."""

    def __init__(self, count: int, file: TextIO | None = None) -> None:
        self._count = count
        self._file = sys.stderr if file is None else file
        self._next = 0.0
        self._ended = 0

    def update(self, ended: int) -> None:
        """Called whenever an instance has ended; draws a few times a second."""
        self._ended = max(self._ended, ended)
        now = time.monotonic()
        if now >= self._next:
            self._next = now + _INTERVAL
            self._draw()

    def close(self) -> None:
        """Shows how many have ended."""
        self._draw()
        self._file.write("\n")

    def _draw(self) -> None:
        self._file.write(f"\r{self._ended} of {self._count} instances")
        self._file.flush()
