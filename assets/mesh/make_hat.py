"""Makes hat.msh with gmsh 4.15 (pip install gmsh), the mid-surface of a hat profile with a round hole, lengths in mm. Run
it in this folder.

        ______________            z = 12, the crown, 30 wide, with a hole of radius 6
       |              |
    ___|              |___        z = 0, two feet, 8 wide

All of it is 60 long (y from -30 to 30). Quadrilaterals of about 3 mm, in the groups `crown`, `webs` and `feet`; the border of
the hole is the group `hole`. Of another size into another file: python3 make_hat.py 0.62 hat_fine.msh (11,377 of them).
"""

import sys

import gmsh

HALF, LENGTH, HEIGHT, FOOT = 15.0, 30.0, 12.0, 8.0
SIZE = float(sys.argv[1]) if len(sys.argv) > 1 else 3.0
FILE = sys.argv[2] if len(sys.argv) > 2 else "hat.msh"

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ, mesh = gmsh.model.occ, gmsh.model.mesh

# The section from foot to foot, drawn along y, against x so that normals look up and outward.
section = [
    (HALF + FOOT, 0.0), (HALF, 0.0), (HALF, HEIGHT), (-HALF, HEIGHT), (-HALF, 0.0), (-HALF - FOOT, 0.0)
]
points = [occ.addPoint(x, -LENGTH, z) for x, z in section]
lines = [occ.addLine(a, b) for a, b in zip(points, points[1:])]
faces = [tag for dim, tag in occ.extrude([(1, line) for line in lines], 0, 2 * LENGTH, 0) if dim == 2]
disk = occ.addDisk(0, 14, HEIGHT, 6, 6)
occ.cut([(2, faces[2])], [(2, disk)])
occ.fragment(occ.getEntities(2), [])
occ.synchronize()

groups = {"crown": [], "webs": [], "feet": []}
for _, face in gmsh.model.getEntities(2):
    _, _, low, _, _, high = gmsh.model.getBoundingBox(2, face)
    kind = "webs" if high - low > 1 else "crown" if low > 1 else "feet"
    groups[kind].append(face)
for name, found in groups.items():
    gmsh.model.addPhysicalGroup(2, found, name=name)
hole = [
    curve
    for _, curve in gmsh.model.getEntities(1)
    if gmsh.model.getType(1, curve) in ("Circle", "Ellipse")
]
gmsh.model.addPhysicalGroup(1, hole, name="hole")

gmsh.option.setNumber("Mesh.MeshSizeMin", SIZE)
gmsh.option.setNumber("Mesh.MeshSizeMax", SIZE)
gmsh.option.setNumber("Mesh.RecombineAll", 1)
gmsh.option.setNumber("Mesh.Algorithm", 8)
gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 2)
mesh.generate(2)
mesh.removeDuplicateNodes()
gmsh.write(FILE)
types, tags, _ = mesh.getElements(2)
print({mesh.getElementProperties(t)[0]: len(n) for t, n in zip(types, tags)})
gmsh.finalize()
