"""Writes the tools of `draw_bead`, lengths in mm: cad/bead.igs (upper tool, a round bead on a flat binder) and
cad/groove.igs (lower tool, the groove with its two round shoulders), each of a line of exact patches (entity 128) in the
order of x that join smoothly. Their flat parts lie in z = 0: the upper tool is above its surface, the lower one below.

      ------.          .------  z = 0       R, r   radii of bead and of its fillets
             ) r    r (                     D      depth of the bead below the binder
             '.  R   .'                     S      radius of the shoulders
               '---'   -D                   B      half width of the groove
      ------.           .-----  z = 0
           S )         ( S
             |         |
             '---------'  -G
"""

import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from occt_iges import bezier, write

HERE = os.path.dirname(os.path.abspath(__file__))
R, r, D = 8.0, 2.0, 5.0
S, B, G = 8.0, 10.0, 12.0
LENGTH = 75.0  # from the middle to the ends
WIDTH = [-2.0, 6.0]


def line(p, q):
    return [(p, 1.0), (q, 1.0)]


def arc(centre, radius, start, end):
    """Angles in degrees from the x axis towards z, less than 180 apart."""
    start, end = math.radians(start), math.radians(end)
    middle, w = (start + end) / 2, math.cos((end - start) / 2)
    at = lambda a, k: (centre[0] + k * radius * math.cos(a), centre[1] + k * radius * math.sin(a))
    return [(at(start, 1.0), 1.0), (at(middle, 1.0 / w), w), (at(end, 1.0), 1.0)]


def tool(path, curves):
    """Extrudes the curves along y; every other patch starts at its other end."""
    surfaces = []
    for k, curve in enumerate(curves):
        curve = curve if k % 2 == 0 else curve[::-1]
        rows = [[(x, y, z) for y in WIDTH] for (x, z), _ in curve]
        surfaces.append(bezier(rows, [[w, w] for _, w in curve]))
    write(os.path.join(HERE, "cad", path), surfaces)
    print(f"{path}: {len(surfaces)} patches")


def bead():
    # Bead and fillet touch where the line between their centres, a long, meets them.
    up = R - D  # height of the centre of the bead
    a = math.degrees(math.asin((up + r) / (R + r)))
    x = (R + r) * math.cos(math.radians(a))
    tool(
        "bead.igs",
        [
            line((-LENGTH, 0.0), (-x, 0.0)),
            arc((-x, -r), r, 90.0, -a) if up + r < 0 else arc((-x, -r), r, 90.0, a),
        ],
    )


if __name__ == "__main__":
    bead()
