"""Writes sphere.igs and the samples in cad/ that the reader is tested on, and cad/reference.json with areas and bounding
boxes as OCCT finds them. Lengths in mm."""

import json
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from occt_iges import write
from OCP.Bnd import Bnd_Box
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_NurbsConvert
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakePrism, BRepPrimAPI_MakeRevol, BRepPrimAPI_MakeTorus
from OCP.Geom import Geom_SphericalSurface
from OCP.GeomAPI import GeomAPI_PointsToBSpline, GeomAPI_PointsToBSplineSurface
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Reader, IGESControl_Writer
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt

CAD = os.path.join(HERE, "cad")


def wave(n=12):
    points = TColgp_Array2OfPnt(1, n, 1, n)
    for i in range(n):
        for j in range(n):
            points.SetValue(i + 1, j + 1, gp_Pnt(i, j, math.sin(0.6 * i) * math.cos(0.5 * j)))
    return GeomAPI_PointsToBSplineSurface(points, 3, 3).Surface()


def shapes():
    patch = BRepBuilderAPI_MakeFace(wave(), 1e-6).Face()
    axis = gp_Ax2(gp_Pnt(5, 5, -10), gp_Dir(0, 0, 1))
    sphere = BRepPrimAPI_MakeSphere(5.0).Shape()
    yield "bicubic_patch", patch
    yield "trimmed_patch", BRepAlgoAPI_Cut(patch, BRepPrimAPI_MakeCylinder(axis, 2.0, 20.0).Shape()).Shape()
    yield "box", BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape()
    yield "sphere", sphere
    yield "cylinder", BRepPrimAPI_MakeCylinder(3.0, 10.0).Shape()
    yield "cone", BRepPrimAPI_MakeCone(3.0, 1.0, 5.0).Shape()
    points = TColgp_Array1OfPnt(1, 5)
    for i in range(5):
        points.SetValue(i + 1, gp_Pnt(3 + math.sin(i), 0, 2 * i))
    edge = BRepBuilderAPI_MakeEdge(GeomAPI_PointsToBSpline(points).Curve()).Edge()
    yield "revolution", BRepPrimAPI_MakeRevol(edge, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 1.5 * math.pi).Shape()
    yield "extrusion", BRepPrimAPI_MakePrism(edge, gp_Vec(0, 5, 0)).Shape()
    yield "torus", BRepPrimAPI_MakeTorus(10.0, 3.0).Shape()
    yield "sphere_nurbs", BRepBuilderAPI_NurbsConvert(sphere, True).Shape()


def measure(path):
    """Area of all surfaces and the box around them, in mm."""
    reader = IGESControl_Reader()
    reader.ReadFile(path)
    reader.TransferRoots()
    shape, props, box = reader.OneShape(), GProp_GProps(), Bnd_Box()
    BRepGProp.SurfaceProperties_s(shape, props, 1e-12)
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return {"area": props.Mass(), "low": [low.X(), low.Y(), low.Z()], "high": [high.X(), high.Y(), high.Z()]}


if __name__ == "__main__":
    sphere = Geom_SphericalSurface(gp_Ax3(), 5.0)
    write(os.path.join(HERE, "sphere.igs"), [GeomConvert.SurfaceToBSplineSurface_s(sphere)], ["sphere"])
    for name, shape in shapes():
        for mode, kind in enumerate(("faces", "brep")):
            writer = IGESControl_Writer("MM", mode)
            writer.AddShape(shape)
            writer.ComputeModel()
            writer.Write(os.path.join(CAD, f"{name}_{kind}.igs"))
    files = ["punch.igs", "sphere.igs", "cad/bicubic_patch_faces.igs"]
    reference = {f: measure(os.path.join(HERE, f)) for f in files}
    # Files that are not kept here can be measured too: paths as arguments.
    reference |= {os.path.basename(f): measure(f) for f in sys.argv[1:]}
    with open(os.path.join(CAD, "reference.json"), "w") as file:
        json.dump(reference, file, indent=2)
        file.write("\n")
