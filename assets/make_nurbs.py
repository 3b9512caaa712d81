"""Writes faces that the NURBS shells of shipped scenes are made of, lengths in mm, as cad/tube.json, cad/dish.json,
cad/flat.json and cad/clip.json.
`covact convert cad/tube.json -o cad/tube.igs` makes the IGES file that the scene reads; the others likewise.

tube  a cylinder about y, radius 20, from y = -30 to 30: two rational half-turns, the upper one (z > 0) and the lower one
dish  z = .02 x^2 + .025 y^2 over 30 by 24 about the origin, polynomial
clip  a strip of 30 by 6 from the origin in z = 0 with a bump near its free end, polynomial, in eight spans along x
flat  1: a square of 50 from the origin in z = 0; 2: a strip of 130 by 2 from the origin in z = .5 (for studies, read as JSON)
"""

import json
import os

HERE = os.path.dirname(os.path.abspath(__file__))
RADIUS, HALF = 20.0, 30.0
LINEAR, QUADRATIC = [0.0, 0.0, 1.0, 1.0], [0.0] * 3 + [1.0] * 3
CUBIC = [0.0] * 4 + [1.0] * 4


def patch(entity, name, degree, knots, points):
    return {"entity": entity, "name": name, "degree": degree, "knots": knots, "points": points}


def half_turn(side):
    """Homogeneous points (x, z, w) of the half circle from x = -side to x = side, a rational cubic without knots inside."""
    return [
        [-side * RADIUS, 0.0, 1.0],
        [-side * RADIUS / 3.0, side * 2.0 * RADIUS / 3.0, 1.0 / 3.0],
        [side * RADIUS / 3.0, side * 2.0 * RADIUS / 3.0, 1.0 / 3.0],
        [side * RADIUS, 0.0, 1.0],
    ]


def tube():
    for entity, (name, side) in enumerate((("upper", 1.0), ("lower", -1.0))):
        points = [[x, w * y, z, w] for y in (-HALF, HALF) for x, z, w in half_turn(side)]
        yield patch(entity + 1, name, [3, 1], [CUBIC, LINEAR], points)


def squares(half):
    """Bezier points of s and of s^2 on [-half, half]."""
    return (-half, 0.0, half), (half**2, -(half**2), half**2)


def dish():
    (x, xx), (y, yy) = squares(15.0), squares(12.0)
    points = [[x[i], y[j], 0.02 * xx[i] + 0.025 * yy[j], 1.0] for j in range(3) for i in range(3)]
    yield patch(1, "dish", [2, 2], [QUADRATIC, QUADRATIC], points)


def clip():
    line = [(0, 0), (3, 0), (8, 0), (13, 0), (17, 0), (20, 1.7), (22, 1.85), (24, 1.7), (27, 0), (29, 0), (30, 0)]
    knots = [0.0] * 3 + [k / 8.0 for k in range(9)] + [1.0] * 3
    points = [[float(x), y, float(z), 1.0] for y in (0.0, 6.0) for x, z in line]
    yield patch(1, "clip", [3, 1], [knots, LINEAR], points)


def flat():
    for entity, (name, (x, y), z) in enumerate((("plate", (50.0, 50.0), 0.0), ("strip", (130.0, 2.0), 0.5))):
        points = [[i * x, j * y, z, 1.0] for j in range(2) for i in range(2)]
        yield patch(entity + 1, name, [1, 1], [LINEAR, LINEAR], points)


def write(name, patches):
    geometry = {"covact_geometry": 1, "unit": "mm", "resolution": None, "patches": list(patches)}
    with open(os.path.join(HERE, "cad", f"{name}.json"), "w") as file:
        json.dump(geometry, file)
        file.write("\n")


if __name__ == "__main__":
    write("tube", tube())
    write("dish", dish())
    write("clip", clip())
    write("flat", flat())
