"""Results as arrays."""

from __future__ import annotations

import csv
import difflib
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ._covact import Error

# Nodes of elements are numbered along r, then s, then t; VTK goes around.
_HEXAHEDRON = [0, 1, 3, 2, 4, 5, 7, 6]
# The corners of a cell that is quadratic in its plane and linear through the thickness.
_Q18_CORNERS = [0, 2, 8, 6, 9, 11, 17, 15]


class History(Mapping):
    """The history of a run: an array for every column, a number for every accepted step."""

    def __init__(self, columns: list[str], rows: np.ndarray) -> None:
        self.columns = list(columns)
        self.rows = rows
        self._index = {name: k for k, name in enumerate(self.columns)}

    def __getitem__(self, column: str) -> np.ndarray:
        try:
            return self.rows[:, self._index[column]]
        except KeyError:
            near = difflib.get_close_matches(column, self.columns, 1)
            hint = f": did you mean `{near[0]}`?" if near else ""
            raise KeyError(f"there is no column `{column}`{hint}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __repr__(self) -> str:
        return f"History({len(self.rows)} steps, {len(self.columns)} columns)"


@dataclass
class Body:
    """A body with its fields at the last accepted step."""

    name: str
    #: Positions (n, 3) of the undeformed nodes.
    nodes: np.ndarray
    #: Nodes of the elements, (m, 8) or (m, 18): along r fastest, then s, then t, which is the thickness.
    elements: np.ndarray
    #: Fields at the nodes, (n,) or (n, components), by the names of the ``.vtu`` files.
    fields: dict[str, np.ndarray]
    #: Nodes of the named sets.
    node_sets: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def displacement(self) -> np.ndarray:
        """Displacements (n, 3)."""
        return self.fields["displacement"]

    @property
    def deformed(self) -> np.ndarray:
        """Positions (n, 3) of the deformed nodes."""
        return self.nodes + self.displacement

    def hexahedra(self) -> np.ndarray:
        """Corners (m, 8) of the elements in VTK's order."""
        order = _HEXAHEDRON if self.elements.shape[1] == 8 else _Q18_CORNERS
        return self.elements[:, order]

    def outer_faces(self) -> np.ndarray:
        """Corners (k, 4) of the faces that belong to one element only, in order around them."""
        sides = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
        faces = self.hexahedra()[:, sides].reshape(-1, 4)
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        return faces[first[count == 1]]

    def to_meshio(self) -> Any:
        """The undeformed body with its fields as a mesh of meshio."""
        import meshio

        cells = [("hexahedron", self.hexahedra())]
        return meshio.Mesh(self.nodes, cells, point_data=dict(self.fields), point_sets=dict(self.node_sets))

    def to_pyvista(self, deformed: bool = True) -> Any:
        """The body with its fields as an UnstructuredGrid of pyvista."""
        import pyvista

        grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: self.hexahedra()}, self.deformed if deformed else self.nodes)
        for name, values in self.fields.items():
            grid.point_data[name] = values
        return grid

    def plot(self, field: str | None = None, axes: Any = None, component: int | None = None, **options: Any) -> Any:
        """Draws the outer faces of the deformed body by matplotlib, coloured by a field; returns the axes."""
        import matplotlib.pyplot as plt
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        if axes is None:
            # Little of a figure is left blank.
            axes = plt.figure(figsize=(8, 5)).add_axes((0, 0, 0.86, 1), projection="3d")
        faces, x = self.outer_faces(), self.deformed
        drawn = Poly3DCollection(x[faces], clip_on=False, **({"edgecolor": "0.3", "linewidth": 0.2} | options))
        if field is None:
            drawn.set_facecolor(options.get("facecolor", "0.8"))
        else:
            values = np.asarray(self.fields[field], dtype=float)
            if values.ndim > 1:
                values = np.linalg.norm(values, axis=1) if component is None else values[:, component]
            drawn.set_array(values[faces].mean(axis=1))
            right = axes.get_position(original=True).x1
            scale = axes.figure.add_axes((right + 0.01, 0.25, 0.02, 0.5))
            axes.figure.colorbar(drawn, cax=scale, label=field)
        axes.add_collection3d(drawn)
        _fit(axes, x)
        return axes


def _fit(axes: Any, x: np.ndarray) -> None:
    """Widens the limits of axes of matplotlib to hold points, with one scale along all three."""
    low, high = x.min(axis=0), x.max(axis=0)
    if getattr(axes, "_covact_limits", None) is not None:
        low = np.minimum(low, axes._covact_limits[0])
        high = np.maximum(high, axes._covact_limits[1])
    axes._covact_limits = (low, high)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    sizes = high - low
    axes.set_box_aspect(np.maximum(sizes, 1e-3 * sizes.max()), zoom=1.05)
    # Ticks of a short axis would lie on one another.
    for axis, size in zip("xyz", sizes):
        axes.locator_params(axis=axis, nbins=max(1, round(6 * size / sizes.max())))


@dataclass
class Result:
    """What a run has computed."""

    #: The account, as in ``summary.json``.
    summary: dict[str, Any]
    history: History
    #: By name.
    bodies: dict[str, Body]

    @property
    def status(self) -> str:
        """``done``, or why the run did not reach its end."""
        return self.summary["status"]

    @property
    def done(self) -> bool:
        """Whether the end time was reached."""
        return self.status == "done"

    @property
    def warnings(self) -> list[str]:
        """What the user should know."""
        return self.summary.get("warnings", [])

    def __repr__(self) -> str:
        steps = len(self.history.rows)
        return f"Result({self.status}, {steps} steps, bodies: {', '.join(self.bodies)})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{name}</td><td>{value}</td></tr>"
            for name, value in (
                ("status", self.status),
                ("steps", len(self.history.rows)),
                ("bodies", ", ".join(self.bodies)),
                ("warnings", len(self.warnings)),
            )
        )
        return f"<table>{rows}</table>"


def read(folder: str | os.PathLike) -> Result:
    """History and account of a results folder that ``covact run`` has left; fields stay in its ``.vtu`` files.

    Raises
    ------
    Error
        There is no run in the folder.
    """
    folder = Path(folder)
    try:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        with open(folder / "history.csv", newline="", encoding="utf-8") as file:
            lines = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    except FileNotFoundError as missing:
        raise Error(f"{folder} holds no finished run: there is no {Path(missing.filename).name}") from None
    rows = np.array(lines[1:], dtype=float).reshape(len(lines) - 1, len(lines[0]))
    return Result(summary, History(lines[0], rows), {})
