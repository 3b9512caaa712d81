"""Makes bracket.msh with gmsh 4.15 (pip install gmsh), the mid-surface of a bent sheet part that comes from a CAD kernel's file,
lengths in mm. Run it in this folder.

         ______________
        /    R 4       \\      z = 25, the flange, from x = 30 to 75, with a round hole and a slot
       |               |     a lip of 7
       |  z from 0 to 25, the web, at x = 30, with a round hole
    ___/                     z = 0, the foot, from x = 0 to 30, with two holes for bolts

All of it is 60 wide (y from 0 to 60); the three bends have radii of 4. OpenCASCADE builds the part and writes it as STEP (IGES
where a name for it is given that says so), as it would come from a CAD system; that file alone is read, its faces are joined and
meshed by quadrilaterals of at most 12 mm (smaller at bends and holes) in the groups `foot`, `web`, `flange`, `lip` and `bends`;
borders of the holes in the foot are the group `bolts`. Of another size into another file:
python3 make_bracket.py 0.72 bracket_fine.msh [bracket.igs] (11,080 of them).
"""

import math
import pathlib
import sys
import tempfile

import gmsh

WIDTH, RADIUS = 60.0, 4.0
# Drawn along y from the lip to the foot, so that normals look up.
SECTION = [(75.0, 18.0), (75.0, 25.0), (30.0, 25.0), (30.0, 0.0), (0.0, 0.0)]
SIZE = float(sys.argv[1]) if len(sys.argv) > 1 else 12.0
FILE = sys.argv[2] if len(sys.argv) > 2 else "bracket.msh"

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ, mesh = gmsh.model.occ, gmsh.model.mesh


def section():
    """Lines and arcs of the section."""
    toward = lambda a, b: [(q - p) / math.dist(a, b) for p, q in zip(a, b)]
    point = lambda x, z: occ.addPoint(x, 0, z)
    start, curves = point(*SECTION[0]), []
    for before, corner, after in zip(SECTION, SECTION[1:], SECTION[2:]):
        back, ahead = toward(corner, before), toward(corner, after)
        first, last = ([c + RADIUS * d for c, d in zip(corner, way)] for way in (back, ahead))
        centre = [c + RADIUS * (a + b) for c, a, b in zip(corner, back, ahead)]
        end, again = point(*first), point(*last)
        curves += [occ.addLine(start, end), occ.addCircleArc(end, point(*centre), again)]
        start = again
    return curves + [occ.addLine(start, point(*SECTION[-1]))]


def cad_file(path):
    """The part as a CAD kernel writes it."""
    gmsh.model.add("part")
    faces = [e for e in occ.extrude([(1, curve) for curve in section()], 0, WIDTH, 0) if e[0] == 2]
    upright = lambda x, y, z, r: (3, occ.addCylinder(x, y, z - 5, 0, 0, 10, r))
    holes = [upright(12, 15, 0, 3.5), upright(12, 45, 0, 3.5), upright(55, 42, 25, 6)]
    holes += [upright(48, 14, 25, 3.5), upright(62, 14, 25, 3.5), (3, occ.addBox(48, 10.5, 20, 14, 7, 10))]
    holes.append((3, occ.addCylinder(25, 30, 12.5, 10, 0, 0, 5)))
    occ.cut(faces, holes)
    occ.synchronize()
    gmsh.write(str(path))
    gmsh.model.remove()


def group(face):
    low_x, _, low, high_x, _, high = gmsh.model.getBoundingBox(2, face)
    if gmsh.model.getType(2, face) != "Plane":
        return "bends"
    if high - low < 1:
        return "foot" if low < 1 else "flange"
    return "web" if low_x < 40 else "lip"


if len(sys.argv) > 3:
    path = pathlib.Path(sys.argv[3])
    cad_file(path)
else:
    path = pathlib.Path(tempfile.mkdtemp()) / "bracket.step"
    cad_file(path)

gmsh.model.add("read")
occ.importShapes(str(path))
occ.removeAllDuplicates()
occ.synchronize()
groups = {}
for _, face in gmsh.model.getEntities(2):
    groups.setdefault(group(face), []).append(face)
for name in sorted(groups):
    gmsh.model.addPhysicalGroup(2, groups[name], name=name)
round_ = lambda curve: gmsh.model.getType(1, curve) in ("Circle", "Ellipse", "TrimmedCurve")
of_foot = {c for _, c in gmsh.model.getBoundary([(2, f) for f in groups["foot"]], oriented=False) if round_(c)}
gmsh.model.addPhysicalGroup(1, sorted(of_foot), name="bolts")

for option, value in [("MeshSizeMin", 2 * SIZE), ("MeshSizeMax", 2 * SIZE), ("RecombineAll", 1), ("Algorithm", 8), ("SubdivisionAlgorithm", 1)]:
    gmsh.option.setNumber("Mesh." + option, value)
mesh.generate(2)
mesh.removeDuplicateNodes()
gmsh.write(FILE)
types, tags, _ = mesh.getElements(2)
print({mesh.getElementProperties(t)[0]: len(n) for t, n in zip(types, tags)})
gmsh.finalize()
