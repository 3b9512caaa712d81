"""How far a run has got, in notebooks, terminals and files."""

from __future__ import annotations

import sys
import time
from html import escape
from typing import Any, TextIO

__all__ = ["Progress"]

#: Cells of the bar in a terminal.
_WIDTH = 24
#: Seconds between two states of a bar.
_PAUSE = 0.1


class Progress:
    """Shows how far a run has got: ``covact.run(scene, progress=True)``.

    It is an observer (:class:`covact.Simulation`), which hears of every event of a run. In a notebook it shows a bar, in a
    terminal a line that is written anew, elsewhere a line whenever a tenth of the time is done. Warnings are shown in full.

    Parameters
    ----------
    end: float
        Time at the end of the run.
    file: text file, optional
        Where lines are written; default: the standard error.
    """

    def __init__(self, end: float = 1.0, file: TextIO | None = None) -> None:
        self.end = end
        self._file = file
        self._display = None if file is not None else _notebook()
        self._time = 0.0
        self._step = 0
        self._text = ""
        self._drawn = -1.0
        self._tenths = 0
        self._open = False
        self._ended = False

    @property
    def part(self) -> float:
        """Part of the time that is done, 0 to 1."""
        return min(max(self._time / self.end, 0.0), 1.0) if self.end > 0 else 0.0

    def __call__(self, event: dict[str, Any]) -> None:
        kind = event["event"]
        self._ended = kind == "finished"
        if kind == "model":
            self._text = f"{event['dofs']} unknowns"
        elif kind == "step_started":
            # A run may begin again at time 0.
            self._step, self._time = event["step"], event["time"] - event["dt"]
            self._tenths = min(self._tenths, self._done)
        elif kind == "iteration":
            self._text = f"step {self._step}, iteration {event['iteration']}, {event['active']} points in contact"
        elif kind == "step_accepted":
            self._step, self._time = event["step"], event["time"]
            self._text = f"step {self._step}, {event['iterations']} iterations, {event['active']} points in contact"
        elif kind == "step_cut":
            self._text = f"step {self._step} is cut"
        elif kind == "warning":
            self._say(f"warning: {event['text']}")
        elif kind == "finished":
            self._text = f"{event['status']}, {self._step} steps, {event['wall_s']:.1f} s"
        self._show()

    def pause(self, keep: bool = False) -> None:
        """Makes room for what others write: takes the line back that is being written, or keeps it and begins another.

        The line of a run that has ended is kept.
        """
        if self._ended:
            # A run that begins again has gone on before anybody comes here.
            self._ended, keep = False, True
            self._show(last=True)
        if self._open:
            self._out.write("\n" if keep else "\r\x1b[K")
            self._out.flush()
            self._open = False

    @property
    def _done(self) -> int:
        """Tenths that are done."""
        return int(10 * self.part + 1e-9)

    @property
    def _out(self) -> TextIO:
        return self._file if self._file is not None else sys.stderr

    def _say(self, text: str) -> None:
        if self._open:
            self._out.write("\r\x1b[K")
            self._open = False
        self._out.write(text + "\n")
        self._out.flush()

    def _show(self, last: bool = False) -> None:
        now = time.monotonic()
        if not last and now - self._drawn < _PAUSE:
            return
        if self._display is not None:
            self._drawn = now
            self._display.update(self)
        elif getattr(self._out, "isatty", lambda: False)():
            self._drawn = now
            # A shorter line leaves nothing of a longer one.
            self._out.write(f"\r{self}\x1b[K")
            self._out.flush()
            self._open = True
        elif last or self._done > self._tenths and not self._ended:
            self._tenths = self._done
            self._out.write(f"{self}\n")
            self._out.flush()

    def __repr__(self) -> str:
        full = round(_WIDTH * self.part)
        return f"[{'#' * full}{'.' * (_WIDTH - full)}] {100 * self.part:3.0f} % {self._text}"

    def _repr_html_(self) -> str:
        return f'<progress value="{self.part:.4f}" max="1" style="width: 20em"></progress> {100 * self.part:.0f} % {escape(self._text)}'


def _notebook() -> Any:
    """A place on the page of a notebook that can be written anew; None elsewhere. Nothing is imported that is not there already."""
    if "IPython" not in sys.modules:
        return None
    from IPython import get_ipython

    # The shell of a terminal has no kernel.
    if not hasattr(get_ipython(), "kernel"):
        return None
    from IPython.display import display

    return display(_Blank(), display_id=True)


class _Blank:
    """What stands there before the first event."""

    def __repr__(self) -> str:
        return ""

    def _repr_html_(self) -> str:
        return ""
