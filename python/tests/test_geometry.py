"""Surfaces against closed forms."""

import importlib.util

import numpy as np
import pytest

import covact
from conftest import ROOT
from covact.geometry import Location, Status

R = 2.0


def quarter():
    """A quarter of a cylinder of radius R and height 3, exact as its weights say."""
    w = np.sqrt(0.5)
    points = [[[R, 0, 0], [R, 0, 3]], [[R, R, 0], [R, R, 3]], [[0, R, 0], [0, R, 3]]]
    weights = [[1, 1], [w, w], [1, 1]]
    return covact.geometry.patch([2, 1], [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]], points, weights)


def test_closest_points_on_a_cylinder():
    random = np.random.default_rng(1)
    angle, radius, z = random.uniform(0.1, 1.4, 500), random.uniform(0.5, 4.0, 500), random.uniform(0.1, 2.9, 500)
    direction = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(500)])
    points = radius[:, None] * direction + z[:, None] * [0, 0, 1]
    feet = quarter().closest(points)
    assert len(feet) == 500 and np.all(feet.status == Status.UNIQUE) and np.all(feet.location == Location.FACE)
    assert np.abs(feet.distance - (radius - R)).max() < 1e-12
    assert np.abs(feet.normal - direction).max() < 1e-12
    assert np.abs(feet.point - (R * direction + z[:, None] * [0, 0, 1])).max() < 1e-12
    # Every second point: rows that do not follow each other.
    apart = quarter().closest(points[::2])
    assert np.array_equal(apart.distance, feet.distance[::2])


def test_points_without_a_foot_and_on_the_border():
    feet = quarter().closest([[9.0, 1, 1], [np.nan, 0, 0], [1, 1, 5]], reach=4.0)
    assert list(feet.patch) == [-1, -1, 0]
    assert feet.location[0] == Location.NONE and np.isnan(feet.distance[:2]).all()
    assert feet.location[2] == Location.FREE_EDGE
    assert feet.point[2, 2] == pytest.approx(3.0)


def test_frames_of_a_cylinder():
    xi = np.random.default_rng(2).uniform(0, 1, (50, 2))
    frames = quarter().frames(0, xi)
    assert np.linalg.norm(frames.rho[:, :2], axis=1) == pytest.approx(np.full(50, R), rel=1e-14)
    # One principal curvature is that of the circle, the other none; the outward normal makes it negative.
    largest = np.abs(frames.principal).max(axis=1)
    assert largest == pytest.approx(np.full(50, 1 / R), rel=1e-12)
    assert np.abs(frames.principal).min(axis=1).max() < 1e-12
    # a_11 and h_11 by their definitions.
    a11 = np.einsum("ij,ij->i", frames.rho_i[:, 0], frames.rho_i[:, 0])
    h11 = np.einsum("ij,ij->i", frames.rho_ij[:, 0], frames.normal)
    assert frames.metric[:, 0] == pytest.approx(a11, rel=1e-14) and frames.curvature[:, 0] == pytest.approx(h11, rel=1e-12)
    assert np.all(h11 < 0)


def test_a_cad_file(assets):
    sphere = covact.geometry.load(assets / "sphere.igs")
    assert len(sphere) == len(sphere.faces) and sphere.skipped == [] and sphere.unit
    # A sphere about the origin; the box is one around its control points.
    low, high = sphere.bounds
    radius = 5.0
    assert np.all(low <= -radius) and np.all(high >= radius)
    direction = np.random.default_rng(3).normal(size=(200, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    feet = sphere.closest(1.5 * radius * direction)
    assert np.abs(np.linalg.norm(feet.point, axis=1) - radius).max() < 1e-9 * radius
    drawn = sphere.tessellate(16)
    corners = drawn["points"][drawn["corners"]]
    diagonals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    area = 0.5 * np.linalg.norm(diagonals, axis=1).sum()
    whole = 4 * np.pi * radius**2
    # Facets inscribed in a sphere have less, by a part that falls with the square of their size.
    assert 0.98 * whole < area < whole
    metres = covact.geometry.load(assets / "sphere.igs", unit="m")
    factor = metres.bounds[1, 0] / high[0]
    assert sphere.unit == "mm" and factor == pytest.approx(1e-3)


def test_faults():
    with pytest.raises(covact.Error, match="none.igs"):
        covact.geometry.load("none.igs")
    with pytest.raises(ValueError, match=r"\(n, 3\)"):
        quarter().closest([[1.0, 2.0]])
    with pytest.raises(ValueError, match="patch 3"):
        quarter().frames(3, [[0.5, 0.5]])
    with pytest.raises(ValueError, match="unknown unit"):
        covact.geometry.load("none.igs", unit="parsec")
    with pytest.raises(covact.Error, match="knot"):
        covact.geometry.patch([2, 1], [[0, 0, 1, 1], [0, 0, 1, 1]], np.zeros((3, 2, 3)))


def test_points_are_not_copied(monkeypatch):
    surface = quarter()
    handed = []

    class Compiled:
        def closest(self, points, reach):
            handed.append(points)
            return quarter()._surface.closest(points, reach)

    monkeypatch.setattr(surface, "_surface", Compiled())
    points = np.random.default_rng(4).uniform(0, 3, (20, 3))
    feet = surface.closest(points)
    assert handed[0] is points
    # A part of a longer array is a view of it.
    surface.closest(points[5:15])
    assert np.shares_memory(handed[1], points)
    # Columns, and single precision, have to be.
    same = surface.closest(np.asfortranarray(points))
    assert not np.shares_memory(handed[2], points) and np.array_equal(same.distance, feet.distance)


def test_points_from_numpy_take_no_longer_than_the_command_line(assets):
    spec = importlib.util.spec_from_file_location("measure", ROOT / "assets" / "measure_projection.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    own, program = module.measure(assets / "sphere.igs", 200_000, 3)
    # Within 5 % on a machine that does nothing else; here others may be at work.
    assert own < 1.5 * program, f"{own} us per point from numpy, {program} us by the command line"
