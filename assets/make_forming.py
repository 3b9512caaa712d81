"""Makes the tools of the scenes `u_channel` and `deep_cup` (cad/u_*.igs, cad/cup_*.igs) and the blank of the latter
(mesh/cup_blank.inp); lengths in mm. Exact patches; `covact convert` writes them as IGES.

    python make_forming.py [COVACT]

u_punch.igs, u_die.igs, u_holder.igs    NUMISHEET'93 2-D draw bending, the half with x > 0, extruded along y. The top of the die and the
                                        bottoms of punch and holder lie in z = 0; the scene places them.

          punch           | holder                      punch: half width 25, radius 5
     |             |     .'-----------                  die: half opening 26, radius 5
     '.___________.'                                    holder: inner edge at 28, radius 3
                        .-------------  z = 0
                        |    die
     0            25   26

cup_punch.igs, cup_die.igs, cup_holder.igs    the same profiles turned round the z axis, all round: punch of radius 50 with radius 10 at
                                        its edge, die of radius 51.25 with radius 8, holder from 51.25 with radius 8. The flat bottom
                                        of the punch is a square and four pieces around it, so that no patch has a pole.
cup_blank.inp                           mid-surface of a quarter of a round blank of radius 100: a square of n x n elements, and two
                                        blocks of n x m elements around it.
"""

import json
import math
import os
import subprocess
import sys
import tempfile

from profiles import arc, line

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "covact"


def write(name, patches):
    """Patches of one Bezier piece each: points[i][j] and weights[i][j], i along the first direction."""
    made = []
    for number, (points, weights) in enumerate(patches, 1):
        counts = len(points), len(points[0])
        knots = [[0.0] * k + [1.0] * k for k in counts]
        # Homogeneous; the first direction runs fastest.
        places = [(i, j) for j in range(counts[1]) for i in range(counts[0])]
        flat = [[*(weights[i][j] * c for c in points[i][j]), float(weights[i][j])] for i, j in places]
        made.append({"entity": number, "degree": [k - 1 for k in counts], "knots": knots, "points": flat})
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "tool.json")
        with open(path, "w", encoding="ascii") as file:
            json.dump({"covact_geometry": 1, "unit": "mm", "resolution": None, "patches": made}, file)
        tool = os.path.join(HERE, "cad", name)
        if os.path.exists(tool):
            os.remove(tool)
        subprocess.run([PROGRAM, "convert", path, "-o", tool], check=True)


def punch(half, radius, inner, height):
    """The profile from `inner` outwards and up."""
    flat = half - radius
    return [line((inner, 0.0), (flat, 0.0)), arc(flat, radius, radius, -90, 0), line((half, radius), (half, height))]


def die(half, radius, outer, depth):
    """From below up and outwards."""
    edge = half + radius
    return [line((half, -depth), (half, -radius)), arc(edge, -radius, radius, 180, 90), line((edge, 0.0), (outer, 0.0))]


def holder(half, radius, outer, height):
    edge = half + radius
    return [line((half, height), (half, radius)), arc(edge, radius, radius, 180, 270), line((edge, 0.0), (outer, 0.0))]


def extruded(curves, width):
    return [
        ([[(x, y, z) for y in width] for (x, z), _ in curve], [[w, w] for _, w in curve])
        for curve in curves
    ]


def turned(curves):
    """All round in quarters."""
    patches = []
    for curve in curves:
        for quarter in range(4):
            c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter]
            round_ = [(c, s, 1.0), (c - s, s + c, math.sqrt(0.5)), (-s, c, 1.0)]
            patches.append(
                (
                    [[(x * a, x * b, z) for a, b, _ in round_] for (x, z), _ in curve],
                    [[w * v for _, _, v in round_] for _, w in curve],
                )
            )
    return patches


def disc(radius):
    """A flat disc in z = 0 without poles: a square, and four pieces between its sides and the circle."""
    h = radius / 2
    corners = [(h, 0.0), (0.0, h), (-h, 0.0), (0.0, -h)]
    place = lambda p: (p[0], p[1], 0.0)
    a, b, c, d = map(place, corners)
    patches = [([[a, d], [b, c]], [[1, 1], [1, 1]])]
    for quarter in range(4):
        p, q = corners[quarter], corners[(quarter + 1) % 4]
        middle = ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)
        c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter]
        rim = [(radius * c, radius * s), (radius * (c - s), radius * (s + c)), (-radius * s, radius * c)]
        w = [1.0, math.sqrt(0.5), 1.0]
        patches.append(([[place(x) for x in (p, middle, q)], [place(x) for x in rim]], [[1, 1, 1], w]))
    return patches


def blank(name, n, m, inner, radius):
    """A quarter: the corners of the square lie at `inner` on the axes and at .72 of it on the diagonal."""
    nodes, numbers, elements = [], {}, []

    def node(x, y):
        key = (round(x, 7), round(y, 7))
        if key not in numbers:
            numbers[key] = len(nodes) + 1
            nodes.append((x, y))
        return numbers[key]

    a, d = inner, 0.72 * inner

    def square(u, v):
        # Bilinear between (0, 0), (a, 0), (d, d), (0, a).
        return (a * u * (1 - v) + d * u * v, a * v * (1 - u) + d * u * v)

    def outer(u, v, mirror):
        # u along the side from the axis x to the diagonal, v outwards.
        p = square(1.0, u)
        angle = math.radians(45 * u)
        q = (radius * math.cos(angle), radius * math.sin(angle))
        x, y = (p[0] + (q[0] - p[0]) * v, p[1] + (q[1] - p[1]) * v)
        return (y, x) if mirror else (x, y)

    def block(place, n, m, turn):
        for i in range(n):
            for j in range(m):
                at = [place(x / n, y / m) for x, y in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
                quad = [node(*p) for p in at]
                elements.append(quad[::-1] if turn else quad)

    block(square, n, n, False)
    block(lambda u, v: outer(u, v, False), n, m, True)
    block(lambda u, v: outer(u, v, True), n, m, False)
    with open(os.path.join(HERE, "mesh", name), "w") as file:
        file.write("*NODE\n")
        for k, (x, y) in enumerate(nodes):
            file.write(f"{k + 1}, {x:.9g}, {y:.9g}, 0\n")
        file.write("*ELEMENT, TYPE=S4, ELSET=blank\n")
        for k, quad in enumerate(elements):
            file.write(f"{k + 1}, {', '.join(map(str, quad))}\n")
    print(f"{name}: {len(elements)} elements")


if __name__ == "__main__":
    WIDTH = [-20.0, 60.0]
    write("u_punch.igs", extruded(punch(25.0, 5.0, -25.0, 90.0), WIDTH))
    write("u_die.igs", extruded(die(26.0, 5.0, 200.0, 100.0), WIDTH))
    write("u_holder.igs", extruded(holder(28.0, 3.0, 200.0, 20.0), WIDTH))
    write("cup_punch.igs", disc(40.0) + turned(punch(50.0, 10.0, 0.0, 70.0)[1:]))
    write("cup_die.igs", turned(die(51.25, 8.0, 120.0, 80.0)))
    write("cup_holder.igs", turned(holder(51.25, 8.0, 120.0, 20.0)))
    blank("cup_blank.inp", 8, 28, 36.0, 100.0)
