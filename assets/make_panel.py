"""Writes the panel of `panel_pressed`, lengths in mm: a shallow dish z = A (x/a)^2 + B (y/b)^2 over a trapezoid, one biquadratic
patch, as cad/panel.json. `covact convert cad/panel.json -o cad/panel.igs` makes the IGES file of it, which the scene reads.

              ___________
             /     y     \\        2 b = 80
            /      |_x    \\       edges along x: 2 a (1 -+ T)
           /_______________\\
"""

import json
import os

HERE = os.path.dirname(os.path.abspath(__file__))
A, B = 4.0, 3.0
HALF = (60.0, 40.0)
T = 0.1  # taper
SQUARE = (1.0, -1.0, 1.0)  # Bezier points of s^2 on [-1, 1]
LINE = (-1.0, 0.0, 1.0)


def points():
    """Homogeneous, x fastest. The product of two parameters is bilinear: its Bezier points are those of the factors."""
    for j in range(3):
        for i in range(3):
            x = HALF[0] * LINE[i] * (1.0 - T * LINE[j])
            yield [x, HALF[1] * LINE[j], A * SQUARE[i] + B * SQUARE[j], 1.0]


if __name__ == "__main__":
    knots = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
    patch = {"entity": 1, "name": "panel", "degree": [2, 2], "knots": [knots, knots], "points": list(points())}
    path = os.path.join(HERE, "cad", "panel.json")
    with open(path, "w", encoding="ascii") as file:
        json.dump({"covact_geometry": 1, "unit": "mm", "resolution": None, "patches": [patch]}, file)
        file.write("\n")
    print(f"{path}: 1 patch")
