"""Studies: one scene over a grid of choices, with its error against its cost."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from . import _covact
from .__main__ import program


class Study:
    """What a study has found."""

    def __init__(self, record: dict[str, Any], folder: Path) -> None:
        #: ``study.json``.
        self.record = record
        #: Folder with the report, ``report.html``.
        self.folder = folder

    @property
    def warnings(self) -> list[str]:
        """What the user should know."""
        return self.record["warnings"]

    def table(self) -> list[dict[str, Any]]:
        """A row for every run: its choices, the quantities, their errors and its cost (for pandas: ``DataFrame(table)``)."""
        names = [quantity["name"] for quantity in self.record["quantities"]]
        rows = []
        for run in self.record["runs"]:
            row = {"id": run["id"], "ending": run["ending"]}
            row |= {choice: label["text"] for choice, label in run["choices"].items()}
            for name, measured in zip(names, run["measured"]):
                row |= {name: measured["value"], f"{name}, error": measured["error"]}
            row |= {"wall_s": (run["wall"] or {}).get("median"), "cpu_s": (run["cpu"] or {}).get("median")}
            row |= {key: run[key] for key in ("dofs", "steps", "newton_iterations", "peak_memory_mb")}
            rows.append(row)
        return rows

    def __repr__(self) -> str:
        return f"Study({self.record['title']!r}, {len(self.record['runs'])} runs)"


def study(path: str | os.PathLike, out: str | os.PathLike) -> Study:
    """Does the runs of a study file that have not been done, each in a process of its own, and writes the report to `out`.

    Ctrl-C keeps what is done; the same call goes on.
    """
    found = program()
    if found is None:
        raise _covact.Error("there is no program `covact`, in whose processes runs of a study are done")
    record = json.loads(_covact.study(Path(path), Path(out), Path(found)))
    return Study(record, Path(out))
