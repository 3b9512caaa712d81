"""Writes punch.igs: a rectangular punch with rounded edges, as 45 untrimmed NURBS patches. Lengths in mm.

The flat bottom lies in z = 0, the walls rise from it. All first x second tangents point out of the punch. Neighbours
share whole edges, so every edge but the upper rim belongs to exactly two patches, and the only corners with a tangent
plane of their own are those of the planar pieces. No edge is degenerate.

        view from above, one quarter               profile
        y
     15 +--------------12---.                     |  | wall, z = 5 .. 15
        |     wall          |  '.  R = 8          |  |
     10 +--------------B.   |    \                 '. fillet, r = 5
        |   side       | 'M.|     |                  '._____ bottom, z = 0
      7 +--------------C----A-----+ 20  x
        |   centre     |side| 15
"""

import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from occt_iges import bezier, write

A, B = 20.0, 15.0  # half widths
R, r = 8.0, 5.0  # radius of the vertical corners, of the bottom edge
H = 10.0  # height of the walls above the fillet
X, Y = A - R, B - R  # axis of the corner in the first quadrant
S = R - r  # radius of the flat bottom's corners

surfaces, labels = [], []


def add(label, points, weights, turn):
    """Adds a patch; `turn` exchanges the directions, which turns the normal over."""
    if turn:
        points, weights = [list(row) for row in zip(*points)], [list(row) for row in zip(*weights)]
    surfaces.append(bezier(points, weights))
    labels.append(label)


def arc(start, end):
    """Unit circular arc between two angles: three points and their weights."""
    half = (end - start) / 2
    w = math.cos(half)
    angles = (start, start + half, end)
    return [(math.cos(t) / k, math.sin(t) / k) for t, k in zip(angles, (1, w, 1))], [1, w, 1]


def flat(label, p, q, s, t, turn):
    """Planar quadrilateral p q s t (in this order around) at the bottom."""
    place = lambda x: (x[0], x[1], 0.0)
    add(label, [[place(p), place(t)], [place(q), place(s)]], [[1, 1], [1, 1]], turn)


def strip(label, start, end, out, turn):
    """Fillet and wall over the straight edge from `start` to `end` of the bottom; `out` points outwards in the plane."""
    along, w = arc(-math.pi / 2, 0.0)
    ends = []
    for p in (start, end):
        ends.append([(p[0] + r * c * out[0], p[1] + r * c * out[1], r + r * s) for c, s in along])
    add("fillet", ends, [w, w], turn)
    rim = [[(p[0] + r * out[0], p[1] + r * out[1], z) for z in (r, r + H)] for p in (start, end)]
    add("wall", rim, [[1, 1], [1, 1]], turn)


# Bottom: the middle, four strips on each pair of sides. An odd number of mirrors turns the orientation.
half_x, half_y = X + S / 2, Y + S / 2
flat("bottom", (-X, -Y), (X, -Y), (X, Y), (-X, Y), True)
for sign in (1, -1):
    for near, far in ((Y, half_y), (half_y, Y + S)):
        flat("bottom", (-X, sign * near), (X, sign * near), (X, sign * far), (-X, sign * far), sign > 0)
    for near, far in ((X, half_x), (half_x, X + S)):
        flat("bottom", (sign * near, -Y), (sign * far, -Y), (sign * far, Y), (sign * near, Y), sign > 0)
    strip("fillet", (-X, sign * (Y + S)), (X, sign * (Y + S)), (0, sign), sign > 0)
    strip("fillet", (sign * (X + S), -Y), (sign * (X + S), Y), (sign, 0), sign < 0)

# Corners: both halves of the arc, mirrored into the four quadrants.
profile, profile_w = arc(-math.pi / 2, 0.0)
for sx in (1, -1):
    for sy in (1, -1):
        place = lambda x, y, z=0.0: (sx * x, sy * y, z)
        even = sx * sy > 0
        inner = (half_x, half_y)
        flat(
            "bottom",
            place(X, Y)[:2],
            place(half_x, Y)[:2],
            place(*inner)[:2],
            place(X, half_y)[:2],
            even,
        )
        for start, end, line in (
            (0.0, math.pi / 4, ((half_x, Y), inner)),
            (math.pi / 4, math.pi / 2, (inner, (X, half_y))),
        ):
            circle, circle_w = arc(start, end)
            middle = [(p + q) / 2 for p, q in zip(*line)]
            rows = [
                [place(*p) for p in (line[0], middle, line[1])],
                [place(X + S * c, Y + S * s) for c, s in circle],
            ]
            # The straight edge keeps its even parameter; the weights turn linearly into those of the arc.
            add("bottom", rows, [[1, 1, 1], circle_w], even)
            torus = [
                [place(X + (S + r * c) * u, Y + (S + r * c) * v, r + r * s) for c, s in profile]
                for u, v in circle
            ]
            add("corner", torus, [[a * b for b in profile_w] for a in circle_w], not even)
            wall = [[place(X + R * u, Y + R * v, z) for z in (r, r + H)] for u, v in circle]
            add("wall", wall, [[a, a] for a in circle_w], not even)

if __name__ == "__main__":
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "punch.igs")
    write(path, surfaces, labels)
    print(f"{path}: {len(surfaces)} patches")
