"""Writes the panel of `flanged_panel`, lengths in mm: a shallow dish z = A (x/a)^2 + B (y/b)^2 of two patches side by side, whose
knots along their common edge do not match, and two flanges that are bent down by 50 degrees, each one patch along both of them, as
cad/flanged.json. `covact convert cad/flanged.json -o cad/flanged.igs` makes the IGES file of it, which the scene reads.

         ________________________
        /  flange                \\       15 wide
        --------------------------
        |  left   |    right     |       2 b = 80
        |         |              |
        --------------------------
        \\__flange________________/       2 a = 120, the common edge at x = 8
"""

import json
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
A, B = 4.0, 3.0
HALF = (60.0, 40.0)
CUT = 8.0
BEND, WIDTH = math.radians(50.0), 15.0
QUADRATIC = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
LINEAR = [0.0, 0.0, 1.0, 1.0]


def bezier(low, high):
    """Bezier points of s and of s^2 on [low, high]."""
    return (low, 0.5 * (low + high), high), (low * low, low * high, high * high)


def dish(low, high):
    """The dish over low < x < high, x fastest."""
    x, xx = bezier(low, high)
    y, yy = bezier(-HALF[1], HALF[1])
    return [
        [x[i], y[j], A * xx[i] / HALF[0] ** 2 + B * yy[j] / HALF[1] ** 2, 1.0] for j in range(3) for i in range(3)
    ]


def with_knot(points, at):
    """One more knot along y: each column of three points becomes four (W. Boehm)."""
    rows = [points[3 * j : 3 * j + 3] for j in range(3)]

    def mix(a, b):
        return [[(1.0 - at) * p + at * q for p, q in zip(u, v)] for u, v in zip(a, b)]

    return sum([rows[0], mix(rows[0], rows[1]), mix(rows[1], rows[2]), rows[2]], [])


def flange(side):
    """From the edge y = side b of the dish outwards and down, x fastest."""
    x, xx = bezier(-HALF[0], HALF[0])
    out = []
    for s in (0.0, WIDTH):
        for i in range(3):
            y = side * (HALF[1] + s * math.cos(BEND))
            out.append([x[i], y, A * xx[i] / HALF[0] ** 2 + B - s * math.sin(BEND), 1.0])
    return out


if __name__ == "__main__":
    right = with_knot(dish(CUT, HALF[0]), 0.37)
    split = [0.0, 0.0, 0.0, 0.37, 1.0, 1.0, 1.0]
    faces = [
        ("left", [2, 2], [QUADRATIC, QUADRATIC], dish(-HALF[0], CUT)),
        ("right", [2, 2], [QUADRATIC, split], right),
        ("back", [2, 1], [QUADRATIC, LINEAR], flange(1.0)),
        ("front", [2, 1], [QUADRATIC, LINEAR], flange(-1.0)),
    ]
    patches = [
        {"entity": k + 1, "name": name, "degree": degree, "knots": knots, "points": points}
        for k, (name, degree, knots, points) in enumerate(faces)
    ]
    path = os.path.join(HERE, "cad", "flanged.json")
    with open(path, "w", encoding="ascii") as file:
        json.dump({"covact_geometry": 1, "unit": "mm", "resolution": None, "patches": patches}, file)
        file.write("\n")
    print(f"{path}: {len(patches)} patches")
