"""Meshes as arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Mapping

import numpy as np

# VTK's numbers of cell types, by meshio's names.
_TYPES = {
    "line": 3,
    "triangle": 5,
    "quad": 9,
    "hexahedron": 12,
    "line3": 21,
    "triangle6": 22,
    "quad8": 23,
    "hexahedron20": 25,
    "quad9": 28,
    "hexahedron27": 29,
}
_NODES = {3: 2, 5: 3, 9: 4, 12: 8, 21: 3, 22: 6, 23: 8, 25: 20, 28: 9, 29: 27}


@dataclass
class Mesh:
    """A mesh for a body of a scene: hexahedra, or a surface that `thickness` makes a body of.

    It stands where a scene has ``{"file": {...}}``, is read as a mesh file of the same content would be, and its sets are
    named as those of such a file (docs/scene_format.md, "Mesh files").

    Parameters
    ----------
    points: array (n, 3)
        Positions, in the unit of length of the scene.
    cells: dict of arrays (m, nodes of a cell)
        By meshio's names: ``quad``, ``triangle``, ``hexahedron``, ``quad9``, ``hexahedron27``, ``line``, ... , with VTK's
        order of nodes.
    cell_sets: dict of arrays
        Numbers of cells, counted over all of `cells` in their order.
    point_sets: dict of arrays
        Numbers of points.
    thickness, offset, layers, scale, only:
        As in a scene's ``file``. A thickness is a number, a dict of numbers by cell set, or an expression of x, y and z.
    """

    points: Any
    cells: Mapping[str, Any]
    cell_sets: Mapping[str, Any] = field(default_factory=dict)
    point_sets: Mapping[str, Any] = field(default_factory=dict)
    thickness: float | Mapping[str, float] | str | None = None
    offset: str | None = None
    layers: int | None = None
    scale: float | None = None
    only: str | None = None

    @classmethod
    def from_meshio(cls, mesh: Any, **options: Any) -> Mesh:
        """A mesh of meshio with its cell and point sets; `options` as those of the class."""
        cells: dict[str, list] = {}
        starts: list[tuple[str, int]] = []
        for block in mesh.cells:
            before = sum(len(part) for part in cells.get(block.type, []))
            starts.append((block.type, before))
            cells.setdefault(block.type, []).append(np.asarray(block.data))
        joined = {name: np.concatenate(parts) for name, parts in cells.items()}
        first = dict(zip(joined, np.cumsum([0] + [len(part) for part in joined.values()])))
        cell_sets = {}
        for name, blocks in getattr(mesh, "cell_sets", {}).items():
            members = [
                np.asarray(block, dtype=np.int64) + first[kind] + before
                for (kind, before), block in zip(starts, blocks)
                if block is not None and len(block) > 0
            ]
            if members:
                cell_sets[name] = np.concatenate(members)
        point_sets = {name: np.asarray(set_) for name, set_ in getattr(mesh, "point_sets", {}).items()}
        points = np.asarray(mesh.points, dtype=float)
        if points.shape[1] == 2:
            points = np.column_stack([points, np.zeros(len(points))])
        return cls(points, joined, cell_sets, point_sets, **options)

    @classmethod
    def from_pyvista(cls, grid: Any, **options: Any) -> Mesh:
        """A mesh of pyvista: an UnstructuredGrid or PolyData; `options` as those of the class."""
        grid = grid.cast_to_unstructured_grid()
        names = {number: name for name, number in _TYPES.items()}
        cells = {}
        for number, nodes in grid.cells_dict.items():
            if int(number) not in names:
                raise ValueError(f"cells of VTK's type {int(number)} are not read; known: {', '.join(_TYPES)}")
            cells[names[int(number)]] = nodes
        return cls(np.asarray(grid.points, dtype=float), cells, **options)

    def options(self) -> dict[str, Any]:
        """What a scene says of the file that the mesh stands for."""
        given = {
            "thickness": dict(self.thickness) if isinstance(self.thickness, Mapping) else self.thickness,
            "offset": self.offset,
            "layers": self.layers,
            "scale": self.scale,
            "only": self.only,
        }
        return {key: value for key, value in given.items() if value is not None}

    def arrays(self) -> dict[str, Any]:
        """The arrays as the compiled half takes them."""
        connectivity, counts, types = [], [], []
        for name, nodes in self.cells.items():
            if name not in _TYPES:
                raise ValueError(f"cells `{name}` are not known; known are {', '.join(_TYPES)}")
            kind = _TYPES[name]
            nodes = np.asarray(nodes)
            if nodes.ndim != 2 or nodes.shape[1] != _NODES[kind]:
                raise ValueError(f"cells `{name}`: expected an array of shape (m, {_NODES[kind]}), found {nodes.shape}")
            connectivity.append(nodes.astype(np.int64).ravel())
            counts.append(np.full(len(nodes), _NODES[kind], dtype=np.int64))
            types.append(np.full(len(nodes), kind, dtype=np.int64))
        join = lambda parts: np.concatenate(parts) if parts else np.zeros(0, dtype=np.int64)  # noqa: E731
        return {
            "points": np.ascontiguousarray(self.points, dtype=np.float64),
            "connectivity": join(connectivity),
            "ends": np.cumsum(join(counts)),
            "types": join(types),
            "cell_sets": _sets(self.cell_sets),
            "point_sets": _sets(self.point_sets),
        }


def _sets(sets: Mapping[str, Any]) -> dict[str, np.ndarray]:
    out = {}
    for name, members in sets.items():
        members = np.asarray(members)
        if members.dtype == bool:
            members = np.flatnonzero(members)
        if members.size and (members.min() < 0 or members.max() > 2**32 - 1):
            raise ValueError(f"set `{name}`: expected numbers from 0")
        out[str(name)] = members.astype(np.uint32).ravel()
    return out
