"""Reference distances and sides for geometry/tests/iges_points.rs from an independent CAD kernel, Open CASCADE.

    python cad_points.py FOLDER cad_points.json

FOLDER holds `made_here` and `real`. Ran with cadquery-ocp 8.0.1.1.0 (Open CASCADE 8.0.1), Python 3.11. For every IGES file:
50 points at random in a box 1.5 times that of the file (seeded, rounded to six digits), the distance of each from the faces
(BRepExtrema_DistShapeShape) and, for closed files, -1 inside and 1 outside (BRepClass3d_SolidClassifier on the sewn faces), else
0. Lengths in millimetres.
"""
import json
import os
import random
import sys

import OCP
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_MakeVertex, BRepBuilderAPI_Sewing
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Pnt
from OCP.IGESControl import IGESControl_Controller, IGESControl_Reader
from OCP.Interface import Interface_Static
from OCP.TopAbs import TopAbs_FACE, TopAbs_IN, TopAbs_OUT, TopAbs_SHELL
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Shell

CLOSED = ("box", "cylinder", "cone", "sphere", "torus", "single_rounded_cube", "bearing")
COUNT = 50


def solid(shape, size):
    sewing = BRepBuilderAPI_Sewing(1e-5 * size)
    sewing.Add(shape)
    sewing.Perform()
    shells = TopExp_Explorer(sewing.SewedShape(), TopAbs_SHELL)
    if not shells.More():
        # One face that closes on itself.
        shell, builder = TopoDS_Shell(), BRep_Builder()
        builder.MakeShell(shell)
        faces = TopExp_Explorer(shape, TopAbs_FACE)
        while faces.More():
            builder.Add(shell, faces.Current())
            faces.Next()
        return BRepBuilderAPI_MakeSolid(shell).Solid()
    return BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(shells.Current())).Solid()


def read(path, closed):
    reader = IGESControl_Reader()
    Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
    assert int(reader.ReadFile(path)) == 1, path
    reader.SetReadVisible(False)
    reader.TransferRoots()
    shape = reader.OneShape()
    b = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, b, False, False)
    low, high = b.CornerMin(), b.CornerMax()
    bounds = [[low.X(), high.X()], [low.Y(), high.Y()], [low.Z(), high.Z()]]
    size = sum((b - a) ** 2 for a, b in bounds) ** 0.5
    # Distances from a solid would be zero inside of it.
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    faces = TopExp_Explorer(shape, TopAbs_FACE)
    while faces.More():
        builder.Add(compound, faces.Current())
        faces.Next()
    classifier = BRepClass3d_SolidClassifier(solid(shape, size)) if closed else None
    outside = 1
    if classifier:
        classifier.PerformInfinitePoint(1e-9 * size)
        outside = 1 if classifier.State() == TopAbs_OUT else -1
    rng = random.Random(1)
    rows = []
    for _ in range(COUNT):
        x = [(a + b) / 2 + 1.5 * (b - a + 1e-2 * size) * (rng.random() - 0.5) for a, b in bounds]
        x = [float(f"{c:.6g}") for c in x]
        p = gp_Pnt(*x)
        distance = BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(p).Vertex(), compound).Value()
        side = 0
        if classifier:
            classifier.Perform(p, 1e-9 * size)
            side = {TopAbs_IN: -outside, TopAbs_OUT: outside}[classifier.State()]
        rows.append([*x, float(f"{distance:.12g}"), side])
    return {"size": float(f"{size:.6g}"), "points": rows}


def main(folder, target):
    IGESControl_Controller.Init_s()
    out = []
    for part in ("made_here", "real"):
        for name in sorted(os.listdir(os.path.join(folder, part))):
            if name.endswith((".igs", ".iges")):
                stem = name.split(".")[0].removesuffix("_brep").removesuffix("_faces").removesuffix("_nurbs")
                row = read(os.path.join(folder, part, name), stem in CLOSED)
                points = ",\n".join(json.dumps(p) for p in row["points"])
                out.append(f'"{part}/{name}": {{"size": {row["size"]}, "points": [\n{points}]}}')
                print(name, file=sys.stderr, flush=True)
    with open(target, "w") as file:
        file.write(f'{{"kernel": "cadquery-ocp {OCP.__version__}", "files": {{\n' + ",\n".join(out) + "\n}}\n")


main(*sys.argv[1:])
