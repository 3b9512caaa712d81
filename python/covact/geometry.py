"""CAD surfaces: read, evaluated, projected onto."""

from __future__ import annotations

import os
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np

from . import _covact

__all__ = ["Feet", "Frames", "Location", "Status", "Surface", "load", "patch"]


class Location(IntEnum):
    """Where a closest point lies."""

    FACE = 0
    #: Over an edge or corner the surface goes on with the same tangent plane.
    SMOOTH_EDGE = 1
    SHARP_EDGE = 2
    #: On the border of the surface.
    FREE_EDGE = 3
    SHARP_CORNER = 4
    FREE_CORNER = 5
    #: On a knot line inside a patch that breaks the tangent.
    CREASE = 6
    #: Where an edge of a patch is one point.
    POLE = 7
    #: There is no closest point: beyond the reach, or the query is not finite.
    NONE = 255


class Status(IntEnum):
    """How sure a closest point is."""

    UNIQUE = 0
    #: Others are as near.
    NON_UNIQUE = 1
    #: The iteration did not reach its tolerance; the best point found is given.
    NOT_CONVERGED = 2
    NONE = 255


@dataclass
class Feet:
    """Closest points of n queries."""

    #: Number (n,) of the patch; -1 where there is no closest point.
    patch: np.ndarray
    #: Parameters (n, 2).
    xi: np.ndarray
    #: Closest points (n, 3).
    point: np.ndarray
    #: Outward unit normals (n, 3); at sharp edges and corners those of the angle-weighted mean.
    normal: np.ndarray
    #: Distances (n,), negative inside.
    distance: np.ndarray
    #: Numbers (n,) of :class:`Location`.
    location: np.ndarray
    #: Numbers (n,) of :class:`Status`.
    status: np.ndarray

    def __len__(self) -> int:
        return len(self.patch)


@dataclass
class Frames:
    """The local frame at n points of a surface. Rows of poles, where there is none, are NaN."""

    #: Points (n, 3).
    rho: np.ndarray
    #: Tangents rho_1 and rho_2, (n, 2, 3).
    rho_i: np.ndarray
    #: Second derivatives rho_11, rho_12, rho_22, (n, 3, 3).
    rho_ij: np.ndarray
    #: Outward unit normals (n, 3).
    normal: np.ndarray
    #: Metric a_11, a_12, a_22, (n, 3).
    metric: np.ndarray
    #: Curvature h_11, h_12, h_22, (n, 3); negative on a convex surface with outward normal.
    curvature: np.ndarray
    #: Principal curvatures (n, 2).
    principal: np.ndarray


class Surface:
    """NURBS patches, joined over their common edges: of a CAD file (:func:`load`) or of arrays (:func:`patch`).

    In a scene it stands where a surface has a file: ``"surfaces": {"punch": {"patches": surface, "motion": {...}}}``.
    """

    def __init__(self, surface: _covact.Surface) -> None:
        self._surface = surface

    def __len__(self) -> int:
        return len(self._surface)

    def __repr__(self) -> str:
        unit = f", in {self.unit}" if self.unit else ""
        return f"Surface({len(self)} patches{unit})"

    @property
    def unit(self) -> str | None:
        """Unit of length, where the file says so."""
        return self._surface.unit

    @property
    def bounds(self) -> np.ndarray:
        """Two corners (2, 3) of a box around the surface."""
        return self._surface.bounds

    @property
    def faces(self) -> list[dict[str, Any]]:
        """For each patch: number and name in the file, degrees, counts of control points, domain, whether trimmed."""
        return self._surface.faces

    @property
    def skipped(self) -> list[dict[str, Any]]:
        """Faces of the file that could not be read, each with the reason."""
        return self._surface.skipped

    @property
    def notes(self) -> list[str]:
        """What was tolerated or changed on reading."""
        return self._surface.notes

    def closest(self, points: Any, reach: float = np.inf) -> Feet:
        """Closest points, found by a global search, on all cores.

        Parameters
        ----------
        points: array (n, 3)
            It is not copied where it is of doubles whose rows follow each other.
        reach: float
            Farther points have none.
        """
        points = np.asarray(points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points: expected an array of shape (n, 3), found {points.shape}")
        if not points.flags.c_contiguous:
            points = np.ascontiguousarray(points)
        if not reach >= 0:
            raise ValueError(f"reach: expected a length, found {reach}")
        return Feet(**self._surface.closest(points, reach))

    def frames(self, patch: Any, xi: Any) -> Frames:
        """Points, derivatives, metric and curvature at parameters `xi` (n, 2) of patches `patch` (n,) or one number."""
        xi = np.ascontiguousarray(np.atleast_2d(xi), dtype=np.float64)
        if xi.shape[1] != 2:
            raise ValueError(f"xi: expected an array of shape (n, 2), found {xi.shape}")
        patch = np.ascontiguousarray(np.broadcast_to(np.asarray(patch, dtype=np.int64), len(xi)))
        jets = self._surface.jets(patch, xi)
        rest = self._surface.frames(patch, xi)
        return Frames(rho=jets[:, 0], rho_i=jets[:, 1:3], rho_ij=jets[:, 3:6], **rest)

    def tessellate(self, divisions: int = 8) -> dict[str, np.ndarray]:
        """Quadrilaterals for drawing, `divisions` along each side of every span; finer along trim curves.

        Returns
        -------
        dict
            ``points`` (n, 3), ``normals`` (n, 3), ``corners`` (m, 4) and ``patch`` (m,).
        """
        return self._surface.tessellate(divisions)

    def to_pyvista(self, divisions: int = 8) -> Any:
        """The tessellated surface as PolyData of pyvista."""
        import pyvista

        drawn = self.tessellate(divisions)
        corners = drawn["corners"]
        mesh = pyvista.PolyData(drawn["points"], np.column_stack([np.full(len(corners), 4), corners]).ravel())
        mesh.point_data["Normals"] = drawn["normals"]
        mesh.cell_data["patch"] = drawn["patch"]
        return mesh

    def plot(self, axes: Any = None, move: Any = (0.0, 0.0, 0.0), divisions: int = 8, **options: Any) -> Any:
        """Draws the surface, moved by `move`, by matplotlib; returns the axes."""
        import matplotlib.pyplot as plt
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        from .results import _fit

        if axes is None:
            axes = plt.figure(figsize=(8, 5)).add_axes((0, 0, 0.86, 1), projection="3d")
        drawn = self.tessellate(divisions)
        points = drawn["points"] + np.asarray(move)
        look = {"facecolor": (0.4, 0.55, 0.8, 0.35), "edgecolor": "none"} | options
        axes.add_collection3d(Poly3DCollection(points[drawn["corners"]], **look))
        _fit(axes, points)
        return axes


def load(
    path: str | os.PathLike, unit: str | None = None, *, hidden: bool = False, tolerance: float | None = None
) -> Surface:
    """Reads the surfaces of a CAD file: STEP, IGES, or JSON of Kratos, geomdl and covact.

    Parameters
    ----------
    path: path
        The file; what it holds decides the format.
    unit: str, optional
        Converts lengths to this unit, e.g. ``"mm"``; default: as in the file.
    hidden: bool
        Read what the CAD system hides as well.
    tolerance: float, optional
        Edges nearer than this are the same edge; default: by the file's own resolution.
    """
    return Surface(_covact.Surface.load(Path(path), unit, hidden, tolerance))


def patch(degrees: Any, knots: Any, points: Any, weights: Any = None) -> Surface:
    """A NURBS patch.

    Parameters
    ----------
    degrees: (2,) of int
    knots: two sequences
        Knot vectors along both directions, with ``count + degree + 1`` knots each.
    points: array (n1, n2, 3)
        Control points, not multiplied by their weights.
    weights: array (n1, n2), optional
        By default all 1.
    """
    points = np.ascontiguousarray(points, dtype=np.float64)
    if points.ndim != 3:
        raise ValueError(f"points: expected an array of shape (n1, n2, 3), found {points.shape}")
    if weights is not None:
        weights = np.ascontiguousarray(weights, dtype=np.float64)
        if weights.ndim != 2:
            raise ValueError(f"weights: expected an array of shape (n1, n2), found {weights.shape}")
    knots = [[float(k) for k in vector] for vector in knots]
    return Surface(_covact.Surface.patch_of([int(d) for d in degrees], knots, points, weights))
