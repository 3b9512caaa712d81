"""Writes what `ball_drag` drags over what, lengths in mm:

cad/hills.igs       a doubly curved surface of eight NURBS patches that join smoothly (entity 128): orders 3 to 5,
                    directions exchanged and turned round, one of them rational, graded along both;
cad/hills_one.json  the same surface as the one bicubic B-spline it was cut from, in geomdl's format;
mesh/half_ball.inp  the lower half of a thick hollow ball of solid-shell hexahedra, outer radius 15, wall 5, with the face sets
                    `outer`, `inner` and `rim` (in z = 0).

    y  25 +---------+--------+--------+------+     patches, two by four, borders at x = -16, 4, 20 and y = 4;
          |         |        |        |      |     knots that are no borders at x = -28 and y = -10
        4 +---------+--------+--------+------+
          |         |        |        |      |
      -25 +---------+--------+--------+------+
         -40       -16       4        20    40  x
"""

import json
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from occt_iges import bezier, write

HERE = os.path.dirname(os.path.abspath(__file__))
U = [-40.0, -28.0, -16.0, 4.0, 20.0, 40.0]
V = [-25.0, -10.0, 4.0, 25.0]
BORDERS_U, BORDERS_V = [-40.0, -16.0, 4.0, 20.0, 40.0], [-25.0, 4.0, 25.0]


def height(x, y):
    """Heights of the control points."""
    return 3.0 * math.sin(2 * math.pi * x / 60 + 0.4) - 0.010 * (y + 2) ** 2 + 0.012 * x * y


def clamped(knots):
    return [knots[0]] * 3 + knots + [knots[-1]] * 3


def greville(knots):
    return [sum(knots[i + 1 : i + 4]) / 3 for i in range(len(knots) - 4)]


def whole():
    """Knots and control points of the bicubic; its parameters are x and y."""
    ku, kv = clamped(U), clamped(V)
    return ku, kv, [[(x, y, height(x, y)) for y in greville(kv)] for x in greville(ku)]


def bspline(ku, kv, points):
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

    poles = TColgp_Array2OfPnt(1, len(points), 1, len(points[0]))
    for i, row in enumerate(points):
        for j, p in enumerate(row):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*p))
    arrays = []
    for knots in (U, V):
        k, m = TColStd_Array1OfReal(1, len(knots)), TColStd_Array1OfInteger(1, len(knots))
        for i, value in enumerate(knots):
            k.SetValue(i + 1, value)
            m.SetValue(i + 1, 4 if i in (0, len(knots) - 1) else 1)
        arrays.append((k, m))
    return Geom_BSplineSurface(poles, arrays[0][0], arrays[1][0], arrays[0][1], arrays[1][1], 3, 3)


def graded(piece, along_u, along_v):
    """A Bezier piece with both parameters mapped by s -> c s / (1 + (c - 1) s), which makes it rational."""
    nu, nv = piece.NbUPoles(), piece.NbVPoles()
    poles = [[piece.Pole(i + 1, j + 1) for j in range(nv)] for i in range(nu)]
    points = [[(p.X(), p.Y(), p.Z()) for p in row] for row in poles]
    return bezier(points, [[along_u**i * along_v**j for j in range(nv)] for i in range(nu)])


def hills():
    surfaces = []
    # What is done to the patches, column by column: orders, then exchanged, u and v turned round.
    changes = [
        ((3, 3), False, False, False),
        ((4, 3), True, False, False),
        ((3, 3), True, True, False),
        ((3, 5), False, True, True),
        ((5, 4), True, False, True),
        ((3, 3), False, True, False),
        ((4, 5), True, True, True),
        ((3, 3), True, False, False),
    ]
    for i in range(4):
        for j in range(2):
            piece = bspline(*whole())
            piece.Segment(BORDERS_U[i], BORDERS_U[i + 1], BORDERS_V[j], BORDERS_V[j + 1], 1e-9, 1e-9)
            orders, exchanged, back_u, back_v = changes[2 * i + j]
            if (i, j) == (2, 1):
                piece = graded(piece, 1.7, 0.6)
            piece.IncreaseDegree(*orders)
            if back_u:
                piece.UReverse()
            if back_v:
                piece.VReverse()
            if exchanged:
                piece.ExchangeUV()
            surfaces.append(piece)
    write(os.path.join(HERE, "cad", "hills.igs"), surfaces, [f"hill{k}" for k in range(8)])


def hills_one():
    ku, kv, points = whole()
    data = {
        "type": "spline",
        "rational": False,
        "dimension": 3,
        "degree_u": 3,
        "degree_v": 3,
        "knotvector_u": ku,
        "knotvector_v": kv,
        "size_u": len(points),
        "size_v": len(points[0]),
        "control_points": {"points": [p for row in points for p in row]},
    }
    with open(os.path.join(HERE, "cad", "hills_one.json"), "w") as file:
        json.dump({"shape": {"type": "surface", "count": 1, "data": [data]}}, file, indent=1)
        file.write("\n")


def half_ball(n=12, layers=2, radius=15.0, wall=5.0):
    """Columns on the lower half of a cube, n x n below and n x n / 2 on each side, cast on the sphere."""
    numbers, nodes, elements = {}, [], []
    sides = {"outer": [], "inner": [], "rim": []}

    def node(a, b, c, layer):
        """Of the grid -n..n (in steps of 2) on the cube; equal angles between the columns."""
        key = (a, b, c, layer)
        if key not in numbers:
            d = [math.tan(math.pi / 4 * x / n) for x in (a, b, c)]
            length = math.sqrt(sum(x * x for x in d))
            r = radius - wall + wall * layer / layers
            nodes.append([r * x / length for x in d])
            numbers[key] = len(nodes)
        return numbers[key]

    quads = []
    grid = range(-n, n, 2)
    for p in grid:
        for q in grid:
            # From outside anticlockwise.
            quads.append([(p, q, -n), (p, q + 2, -n), (p + 2, q + 2, -n), (p + 2, q, -n)])
            if q < 0:
                quads.append([(n, p, q), (n, p + 2, q), (n, p + 2, q + 2), (n, p, q + 2)])
                quads.append([(-n, p, q), (-n, p, q + 2), (-n, p + 2, q + 2), (-n, p + 2, q)])
                quads.append([(p, n, q), (p, n, q + 2), (p + 2, n, q + 2), (p + 2, n, q)])
                quads.append([(p, -n, q), (p + 2, -n, q), (p + 2, -n, q + 2), (p, -n, q + 2)])
    for quad in quads:
        for layer in range(layers):
            elements.append([node(*p, layer) for p in quad] + [node(*p, layer + 1) for p in quad])
            e = len(elements)
            if layer == 0:
                sides["inner"].append((e, "S1"))
            if layer + 1 == layers:
                sides["outer"].append((e, "S2"))
            for k in range(4):
                if quad[k][2] == 0 and quad[(k + 1) % 4][2] == 0:
                    sides["rim"].append((e, f"S{k + 3}"))
    with open(os.path.join(HERE, "mesh", "half_ball.inp"), "w") as file:
        file.write("*HEADING\nLower half of a hollow ball, made by make_hills.py\n*NODE\n")
        for k, p in enumerate(nodes):
            file.write(f"{k + 1}, " + ", ".join(f"{x + 0.0:.12g}" for x in p) + "\n")
        file.write("*ELEMENT, TYPE=SC8R\n")
        for k, e in enumerate(elements):
            file.write(f"{k + 1}, " + ", ".join(map(str, e)) + "\n")
        for name, faces in sides.items():
            file.write(f"*SURFACE, TYPE=ELEMENT, NAME={name}\n")
            file.writelines(f"{e}, {face}\n" for e, face in faces)
    print(f"{len(nodes)} nodes, {len(elements)} elements")


if __name__ == "__main__":
    hills()
    hills_one()
    half_ball()
