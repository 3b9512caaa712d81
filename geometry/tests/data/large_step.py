"""Writes a large STEP file: waves cut into bicubic faces, each bounded by four B-spline edges in space.

    python large_step.py FILE [FACES]

20,000 faces (the default) make 100 MB. Neighbours share their edges; every hundred faces are one sheet.
"""
import math
import sys

N = 8
SIDE = 10


def knots(n):
    inner = n - 4
    return "(4," + "1," * inner + "4)", "(" + ",".join(f"{k / (inner + 1):.9f}" for k in range(inner + 2)) + ")"


class File:
    def __init__(self, out):
        self.out, self.count = out, 0

    def add(self, text):
        self.count += 1
        self.out.write(f"#{self.count}={text};\n")
        return f"#{self.count}"


def sheet(file, number):
    """A square of faces; points of one control net, so that neighbours meet."""
    per = N - 1
    points = {}
    shift = number * 1.25 * SIDE * 10.0

    def point(i, j):
        if (i, j) not in points:
            x, y = 10.0 * i / per, 10.0 * j / per
            z = 2.0 * math.sin(0.3 * x) * math.cos(0.2 * y) + 0.3 * math.sin(1.7 * x + 0.9 * y)
            points[i, j] = file.add(f"CARTESIAN_POINT('',({x + shift:.13f},{y:.13f},{z:.13f}))")
        return points[i, j]

    vertices, edges = {}, {}

    def vertex(i, j):
        if (i, j) not in vertices:
            vertices[i, j] = file.add(f"VERTEX_POINT('',{point(i * per, j * per)})")
        return vertices[i, j]

    def edge(i, j, along):
        if (i, j, along) not in edges:
            line = [point(i * per + k * (along == 0), j * per + k * (along == 1)) for k in range(N)]
            m, t = knots(N)
            curve = file.add(
                f"B_SPLINE_CURVE_WITH_KNOTS('',3,({','.join(line)}),.UNSPECIFIED.,.F.,.F.,{m},{t},.UNSPECIFIED.)"
            )
            ends = vertex(i, j), vertex(i + (along == 0), j + (along == 1))
            edges[i, j, along] = file.add(f"EDGE_CURVE('',{ends[0]},{ends[1]},{curve},.T.)")
        return edges[i, j, along]

    faces = []
    for i in range(SIDE):
        for j in range(SIDE):
            rows = [[point(i * per + a, j * per + b) for b in range(N)] for a in range(N)]
            net = ",".join("(" + ",".join(row) + ")" for row in rows)
            m, t = knots(N)
            surface = file.add(
                f"B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({net}),.UNSPECIFIED.,.F.,.F.,.F.,{m},{m},{t},{t},.UNSPECIFIED.)"
            )
            around = [(edge(i, j, 0), "T"), (edge(i + 1, j, 1), "T"), (edge(i, j + 1, 0), "F"), (edge(i, j, 1), "F")]
            used = [file.add(f"ORIENTED_EDGE('',*,*,{e},.{f}.)") for e, f in around]
            loop = file.add(f"EDGE_LOOP('',({','.join(used)}))")
            bound = file.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
            faces.append(file.add(f"ADVANCED_FACE('wave {number}',({bound}),{surface},.T.)"))
    shell = file.add(f"OPEN_SHELL('',({','.join(faces)}))")
    return file.add(f"SHELL_BASED_SURFACE_MODEL('wave {number}',({shell}))")


def main(path, count=20000):
    with open(path, "w") as out:
        out.write("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n")
        out.write("FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n")
        file = File(out)
        length = file.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = file.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        near = file.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),{length},'distance_accuracy_value','')")
        context = file.add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({near}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle}))REPRESENTATION_CONTEXT('',''))"
        )
        sheets = [sheet(file, k) for k in range(-(-int(count) // SIDE**2))]
        file.add(f"MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',({','.join(sheets)}),{context})")
        out.write("ENDSEC;\nEND-ISO-10303-21;\n")


main(*sys.argv[1:])
