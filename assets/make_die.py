"""Writes die.igs: the block of a deep-drawing die with a round opening whose edge is filleted, as trimmed faces (entity
144), through OCCT ("pip install cadquery-ocp==7.9.*"). Lengths in mm: 80 x 80 x 20, opening of radius 20, fillet of
radius 6; the axis is z, the top lies in z = 0."""

import os

from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

HERE = os.path.dirname(os.path.abspath(__file__))

block = BRepPrimAPI_MakeBox(gp_Pnt(-40, -40, -20), gp_Pnt(40, 40, 0)).Shape()
axis = gp_Ax2(gp_Pnt(0, 0, -30), gp_Dir(0, 0, 1))
bored = BRepAlgoAPI_Cut(block, BRepPrimAPI_MakeCylinder(axis, 20.0, 40.0).Shape()).Shape()

fillet = BRepFilletAPI_MakeFillet(bored)
explorer = TopExp_Explorer(bored, TopAbs_EDGE)
found = 0
while explorer.More():
    edge = TopoDS.Edge_s(explorer.Current())
    curve = BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    points = [curve.Value(first + (last - first) * k / 3) for k in range(3)]
    # The rim of the opening in the top.
    if all(abs(p.Z()) < 1e-9 and abs((p.X() ** 2 + p.Y() ** 2) ** 0.5 - 20) < 1e-6 for p in points):
        fillet.Add(6.0, edge)
        found += 1
    explorer.Next()
if not found:
    raise RuntimeError("the rim was not found")

IGESControl_Controller.Init_s()
writer = IGESControl_Writer("MM", 0)
if not writer.AddShape(fillet.Shape()):
    raise RuntimeError("OCCT refused the block")
writer.ComputeModel()
if not writer.Write(os.path.join(HERE, "die.igs")):
    raise RuntimeError("OCCT could not write")
