"""What Open CASCADE finds in the CAD files of a folder, for `cargo run -p covact-geometry --example cad_table`.

    python cad_truth.py FOLDER truth.json

Needs cadquery-ocp (`pip install cadquery-ocp`); ran with 8.0.1.1.0 (Open CASCADE 8.0.1) and Python 3.11. For every STEP and
IGES file: number of faces, area of each, volume of each solid, box, and 50 points at random (seeded) in a box 1.5 times as
large, each with its distance from the faces and, where the file holds solids, -1 inside of one and 1 outside, else 0.
Millimetres.

Areas and volumes are integrated to 1e-9: the default of BRepGProp is off by 1e-3 on B-splines of many spans. Even the
adaptive one is off by 1e-4 where the knots of a surface that is not trimmed are of full multiplicity, so such surfaces are
integrated here, by Gauss points in every span.

Where the area so found differs by more than a thousandth from that of triangles within 1e-5 of the face's size, the triangles
count, and a line says so. In `CTS17806-38038.igs` and `PRO20358-X28.igs` of Open CASCADE's own samples it does: BRepGProp gives
5.580 and 7412 to 9967, depending on the tolerance asked for, where the triangles have 6.0734 and 8831.75.
"""
import json
import os
import random
import sys

from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GeomAbs import GeomAbs_BSplineSurface
from OCP.gp import gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Reader
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_IN, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound

COUNT = 50
# Points and weights of the Gauss rule with five points on (-1, 1).
GAUSS = [(0.0, 128 / 225)]
for x, w in ((245 - 14 * 70**0.5, 322 + 13 * 70**0.5), (245 + 14 * 70**0.5, 322 - 13 * 70**0.5)):
    GAUSS += [(x**0.5 / 21, w / 900), (-(x**0.5) / 21, w / 900)]


def parts(shape, kind):
    found, explorer = [], TopExp_Explorer(shape, kind)
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def spans(knots, first, last, pieces):
    inner = [k for k in knots if first < k < last]
    ends = [first, *inner, last]
    for a, b in zip(ends, ends[1:]):
        for k in range(pieces):
            yield a + (b - a) * k / pieces, a + (b - a) * (k + 1) / pieces


def whole(surface, knots, pieces):
    """Area of the rectangle of parameters that a surface is adapted to."""
    total = 0.0
    point, du, dv = gp_Pnt(), gp_Vec(), gp_Vec()
    us = list(spans(knots[0], surface.FirstUParameter(), surface.LastUParameter(), pieces))
    vs = list(spans(knots[1], surface.FirstVParameter(), surface.LastVParameter(), pieces))
    for u0, u1 in us:
        for v0, v1 in vs:
            for x, w in GAUSS:
                for y, v in GAUSS:
                    at = (u0 + u1 + (u1 - u0) * x) / 2, (v0 + v1 + (v1 - v0) * y) / 2
                    surface.D1(*at, point, du, dv)
                    total += w * v * (u1 - u0) * (v1 - v0) / 4 * du.Crossed(dv).Magnitude()
    return total


def area(face):
    found, triangles = integrated(face), triangulated(face)
    if triangles is None or abs(found - triangles) < 1e-3 * triangles:
        return found
    print(f"  {found} by integration, {triangles} by triangles", file=sys.stderr)
    return triangles


def triangulated(face):
    """Area of triangles near a face; None where there are none."""
    box = Bnd_Box()
    BRepBndLib.Add_s(face, box, False)
    BRepMesh_IncrementalMesh(face, 1e-5 * box.SquareExtent() ** 0.5, False, 0.02)
    mesh = BRep_Tool.Triangulation_s(TopoDS.Face(face), TopLoc_Location())
    if mesh is None:
        return None
    total = 0.0
    for i in range(1, mesh.NbTriangles() + 1):
        a, b, c = (mesh.Node(k) for k in mesh.Triangle(i).Get())
        total += gp_Vec(a, b).Crossed(gp_Vec(a, c)).Magnitude() / 2
    return total


def integrated(face):
    surface = BRepAdaptor_Surface(TopoDS.Face(face))
    if surface.GetType() == GeomAbs_BSplineSurface:
        spline = surface.BSpline()
        if natural(face, spline.Bounds()):
            u = [spline.UKnot(i) for i in range(1, spline.NbUKnots() + 1)]
            v = [spline.VKnot(i) for i in range(1, spline.NbVKnots() + 1)]
            if len(u) * len(v) < 5000:
                coarse, fine = (whole(surface, (u, v), pieces) for pieces in (2, 4))
                # Not so near points where the tangents vanish.
                if abs(fine - coarse) < 1e-8 * fine:
                    return fine
    props = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, props, 1e-10)
    return props.Mass()


def natural(face, bounds):
    """Whether all edges run along the border of the surface."""
    u0, u1, v0, v1 = bounds
    for edge in parts(face, TopAbs_EDGE):
        curve = BRep_Tool.CurveOnSurface_s(TopoDS.Edge(edge), TopoDS.Face(face), 0.0, 0.0)
        if curve is None:
            return False
        a, b = BRep_Tool.Range_s(TopoDS.Edge(edge), TopoDS.Face(face))
        points = [curve.Value(a + (b - a) * k / 8) for k in range(9)]
        near = lambda x, y, size: abs(x - y) < 1e-9 * size
        sides = [
            all(near(p.X(), u0, u1 - u0) for p in points),
            all(near(p.X(), u1, u1 - u0) for p in points),
            all(near(p.Y(), v0, v1 - v0) for p in points),
            all(near(p.Y(), v1, v1 - v0) for p in points),
        ]
        if not any(sides):
            return False
    return True


def read(path):
    iges = path.lower().endswith((".igs", ".iges"))
    reader = IGESControl_Reader() if iges else STEPControl_Reader()
    Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
    assert int(reader.ReadFile(path)) == 1, path
    if iges:
        reader.SetReadVisible(False)
    reader.TransferRoots()
    return reader.OneShape()


def points(shape, solids, bounds):
    # Distances from a solid would be zero inside of it.
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for face in parts(shape, TopAbs_FACE):
        builder.Add(compound, face)
    size = sum((b - a) ** 2 for a, b in bounds) ** 0.5
    classifiers = [BRepClass3d_SolidClassifier(s) for s in solids]
    rng = random.Random(1)
    rows = []
    for _ in range(COUNT):
        x = [(a + b) / 2 + 1.5 * (b - a + 1e-2 * size) * (rng.random() - 0.5) for a, b in bounds]
        x = [float(f"{c:.6g}") for c in x]
        p = gp_Pnt(*x)
        distance = BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(p).Vertex(), compound).Value()
        side = 0
        if classifiers:
            side = 1
            for classifier in classifiers:
                classifier.Perform(p, 1e-9 * size)
                side = -1 if classifier.State() == TopAbs_IN else side
        rows.append([*x, float(f"{distance:.12g}"), side])
    return rows


def row(path):
    shape = read(path)
    faces, solids = parts(shape, TopAbs_FACE), parts(shape, TopAbs_SOLID)
    areas = [area(face) for face in faces]
    volumes = []
    for solid in solids:
        props = GProp_GProps()
        BRepGProp.VolumeProperties_s(solid, props, 1e-9, True, False)
        volumes.append(props.Mass())
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    low, high = [low.X(), low.Y(), low.Z()], [high.X(), high.Y(), high.Z()]
    return {
        "faces": len(faces),
        "area_mm2": sum(areas),
        "volumes_mm3": volumes,
        "box_mm": [*low, *high],
        "face_areas": areas,
        "points": points(shape, solids, list(zip(low, high))),
    }


def main(folder, target):
    table = {}
    for name in sorted(os.listdir(folder)):
        if name.lower().endswith((".igs", ".iges", ".stp", ".step")):
            table[name] = row(os.path.join(folder, name))
            print(name, file=sys.stderr, flush=True)
            with open(target, "w") as file:
                json.dump(table, file)


main(*sys.argv[1:])
