"""Makes cad/folded_panel.step and cad/round_punch.step, the sheet and the tool of `folded_panel`.

    python make_folded.py cad

Needs cadquery-ocp (`pip install cadquery-ocp`); ran with 8.0.1.1.0 (Open CASCADE 8.0.1) and Python 3.11. Millimetres.

- `folded_panel`: three plane faces, sewn, 50 wide along y: one of 60 along x with a round hole of radius 9 about (-34, 25), one of 40 that
  is folded down by 25 degrees along x = 0, and one of 20 beyond it that is level again;
- `round_punch`: a pin of radius 20 about z whose lower end is half of a ball, its lowest point at the origin.
"""
import math
import os
import sys

from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopoDS import TopoDS

WIDTH, FOLD = 50.0, math.radians(25.0)
HOLE, RADIUS = (-34.0, 25.0), 9.0
PIN, HEIGHT = 20.0, 30.0


def strip(start, end):
    """The face between two lines along y, each given by its x and z."""
    polygon = BRepBuilderAPI_MakePolygon()
    for (x, z), y in ((start, 0.0), (end, 0.0), (end, WIDTH), (start, WIDTH)):
        polygon.Add(gp_Pnt(x, y, z))
    polygon.Close()
    return BRepBuilderAPI_MakeFace(polygon.Wire(), True)


def panel():
    down = (40.0 * math.cos(FOLD), -40.0 * math.sin(FOLD))
    flat = strip((-60.0, 0.0), (0.0, 0.0))
    circle = gp_Circ(gp_Ax2(gp_Pnt(*HOLE, 0.0), gp_Dir(0.0, 0.0, 1.0)), RADIUS)
    hole = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()
    flat.Add(TopoDS.Wire_s(hole.Reversed()) if hasattr(TopoDS, "Wire_s") else TopoDS.Wire(hole.Reversed()))
    sewing = BRepBuilderAPI_Sewing(1e-6)
    sewing.Add(flat.Face())
    sewing.Add(strip((0.0, 0.0), down).Face())
    sewing.Add(strip(down, (down[0] + 20.0, down[1])).Face())
    sewing.Perform()
    return sewing.SewedShape()


def punch():
    axis = gp_Ax2(gp_Pnt(0.0, 0.0, PIN), gp_Dir(0.0, 0.0, 1.0))
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(0.0, 0.0, PIN), PIN).Shape()
    return BRepAlgoAPI_Fuse(ball, BRepPrimAPI_MakeCylinder(axis, PIN, HEIGHT).Shape()).Shape()


def write(shape, path):
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(path)


if __name__ == "__main__":
    folder = sys.argv[1]
    write(panel(), os.path.join(folder, "folded_panel.step"))
    write(punch(), os.path.join(folder, "round_punch.step"))
