from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def assets():
    """CAD files of the repository."""
    return ROOT / "assets"


def grid(n):
    """Points and quadrilaterals of the unit square, n by n."""
    t = np.linspace(0.0, 1.0, n + 1)
    y, x = np.meshgrid(t, t, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.column_stack([k[:-1, :-1].ravel(), k[:-1, 1:].ravel(), k[1:, 1:].ravel(), k[1:, :-1].ravel()])
    return points, quads


def cube(n):
    """Points and hexahedra of the unit cube, inner points moved about."""
    t = np.linspace(0.0, 1.0, n + 1)
    z, y, x = np.meshgrid(t, t, t, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    inner = ((points > 0) & (points < 1)).all(axis=1)
    points[inner] += 0.05 * np.sin(7 * points[inner][:, [1, 2, 0]] + 3)
    k = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    corner = lambda i, j, l: k[l : n + l, j : n + j, i : n + i].ravel()  # noqa: E731
    order = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    return points, np.column_stack([corner(*at) for at in order])


def press(**changes):
    """A thin rubber plate, clamped along its rim, under a ball: a second of work."""
    scene = {
        "title": "A ball on a clamped plate",
        "materials": {"rubber": {"neo_hooke": {"E": 2.0, "nu": 0.4}}},
        "bodies": {
            "plate": {"mesh": {"plate": {"size": [10, 10], "thickness": 0.5, "elements": [8, 8]}}, "material": "rubber"}
        },
        "surfaces": {
            "ball": {"sphere": {"radius": 3, "center": [5, 5, 3.25]}, "motion": {"translation": [0, 0, "-t"]}}
        },
        "contacts": {"press": {"slave": "plate.top", "master": "ball"}},
        "supports": {"rim": {"on": ["plate.x_min", "plate.x_max", "plate.y_min", "plate.y_max"], "fixed": True}},
    }
    return scene | changes
