"""Progress in terminals, files and notebooks."""

import io
import os
import signal
import sys
import threading
import types

import pytest

import covact
from conftest import press
from test_run import slow, staged


def test_a_file_gets_a_line_for_every_tenth(capsys):
    result = covact.run(press(), progress=True)
    lines = capsys.readouterr().err.splitlines()
    bars = [line for line in lines if line.startswith("[")]
    parts = [int(line.split("]")[1].split("%")[0]) for line in bars]
    assert result.done and 5 < len(bars) < 30 and parts[-1] == 100 and min(parts) < 30
    # The run begins again with other points, which is no end of it.
    assert len([line for line in bars if "steps," in line]) == 1
    assert "points in contact" in bars[0] and f"done, {len(result.history.rows)} steps" in bars[-1]


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_terminal_has_one_line(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    covact.run(press(), progress=True)
    text = terminal.getvalue()
    assert text.endswith("\n") and text.count("\r") >= 2
    assert text.count("\n") == 1 + text.count("warning:")
    last = text.splitlines()[-1].split("\r")[-1]
    assert last.startswith(f"[{'#' * 24}] 100 % done")


def test_the_line_makes_room_between_steps(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    seen = []
    covact.run(press(), progress=True, callback=lambda run, step: seen.append(terminal.getvalue()[-4:]))
    # Taken back, or nothing was drawn: a step may be shorter than the pause between two states.
    assert set(seen[:-1]) <= {"\r\x1b[K", ""} and "\r\x1b[K" in seen
    assert terminal.getvalue().endswith("\n")


def test_ctrl_c_ends_the_line_and_the_run_goes_on(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    simulation = covact.Simulation(slow(), progress=True)
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        while simulation.step() is not None:
            pass
    assert terminal.getvalue().endswith("\n") and not simulation.done
    assert simulation.step() is not None


def test_observers_hear_of_the_run_beside_the_bar(capsys):
    events = []
    covact.run(press(solution={"end_time": 0.2}), progress=True, observer=lambda event: events.append(event["event"]))
    assert events[0] == "model" and events[-1] == "finished"
    assert "100 % done" in capsys.readouterr().err


def test_a_stage_that_was_begun_moves_the_end(capsys):
    simulation = covact.Simulation(staged(), progress=True)
    assert simulation.end_time == 1.0
    simulation.step()
    simulation.begin_stage({"name": "up", "until": 0.5, "tools": {"ball": [0, 0, 0]}})
    assert simulation.end_time == 0.5 and simulation.run().done
    parts = [int(line.split("]")[1].split("%")[0]) for line in capsys.readouterr().err.splitlines() if line[0] == "["]
    assert max(parts) == 100 and parts == sorted(parts)


def test_a_notebook_shows_a_bar(monkeypatch):
    shown = []

    class Handle:
        def update(self, what):
            shown.append(what._repr_html_())

    def display(what, display_id):
        assert display_id and what._repr_html_() == ""
        return Handle()

    ipython, page = types.ModuleType("IPython"), types.ModuleType("IPython.display")
    ipython.get_ipython = lambda: types.SimpleNamespace(kernel=object())
    ipython.display, page.display = page, display
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", page)
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    covact.run(press(), progress=True)
    assert len(shown) >= 2 and 'value="1.0000"' in shown[-1] and "100 % done" in shown[-1]
    assert "#" not in terminal.getvalue()
    # The shell of a terminal is none.
    ipython.get_ipython = lambda: types.SimpleNamespace()
    assert covact.Progress()._display is None
