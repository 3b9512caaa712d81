"""Writes the tools of `draw_bead`, lengths in mm, as lines of exact patches (entity 128) extruded along y, every other of
them from its other end:

cad/bead.igs    upper tool, what lies above the line: a round bead whose tip is in z = 0;
cad/groove.igs  lower tool, what lies below the line: two round shoulders whose tops are in z = 0, the groove between them.

    |       R       |  H                                  ____.----.             .----.____
    |               |                                    /    S     '           '          \\
     '.           .'                                    /           |           |
       '._______.'     z = 0                                        '-----------'  -G
            0                                                      -B     0     B
"""

import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from occt_iges import bezier, write
from profiles import arc, line

HERE = os.path.dirname(os.path.abspath(__file__))
R, H = 8.0, 20.0
S, B, G = 8.0, 10.0, 16.0
RAMP = 20.0  # length of the ramps outside
WIDTH = [-2.0, 4.0]


def tool(name, left, middle=()):
    """`left` are the curves with x < 0 in the order of x, `middle` one that is its own mirror image."""
    right = [[((-x, z), w) for (x, z), w in reversed(curve)] for curve in reversed(left)]
    surfaces = []
    for k, curve in enumerate([*left, *middle, *right]):
        curve = curve if k % 2 == 0 else curve[::-1]
        surfaces.append(bezier([[(x, y, z) for y in WIDTH] for (x, z), _ in curve], [[w, w] for _, w in curve]))
    write(os.path.join(HERE, "cad", name), surfaces)
    print(f"{name}: {len(surfaces)} patches")


def bead():
    tool("bead.igs", [line((-R, H), (-R, R)), arc(0.0, R, R, 180.0, 270.0)])


def groove():
    c = math.sqrt(0.5)
    start = (-B - S - c * S, -S + c * S)
    tool(
        "groove.igs",
        [
            line((start[0] - c * RAMP, start[1] - c * RAMP), start),
            arc(-B - S, -S, S, 135.0, 90.0),
            arc(-B - S, -S, S, 90.0, 0.0),
            line((-B, -S), (-B, -G)),
        ],
        [line((-B, -G), (B, -G))],
    )


if __name__ == "__main__":
    bead()
    groove()
