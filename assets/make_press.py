"""Makes cad/press.step: a stamped bracket with two threaded studs, each with a pad at its end, as an assembly.

    python make_press.py cad/press.step

Needs cadquery-ocp (`pip install cadquery-ocp`); ran with 8.0.1.1.0 (Open CASCADE 8.0.1) and Python 3.11. Millimetres; the axis z
points up, the pads' faces lie at z = 0. Parts, each once in the file and placed by the assembly:

- `bracket`: sheet of 3 mm, 70 x 24, its ends bent down by a quarter of a turn over a radius of 4, rounded corners, a slot and
  two holes for the studs;
- `stud` (twice): M8-like, a core of radius 3.2 with a helical ridge of three turns, its head a hexagon with chamfered edges;
- `pad` (twice, the second turned by half a turn): a disc of radius 9 whose rim is rounded with 2 mm, a cross of grooves in its
  face and a dimple for the stud.
"""
import math
import sys

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon, BRepBuilderAPI_MakeWire
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepLib import BRepLib
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipeShell
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeSphere,
)
from OCP.Geom import Geom_CylindricalSurface
from OCP.Geom2d import Geom2d_Line
from OCP.GeomAbs import GeomAbs_Circle, GeomAbs_Line
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d, gp_Trsf, gp_Vec
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_EDGE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from OCP.XCAFDoc import XCAFDoc_DocumentTool

PAD, RIM, HEIGHT = 9.0, 2.0, 5.0
CORE, PITCH, LENGTH = 3.2, 1.25, 30.0
APART = 17.0


def axis(x, y, z, direction=(0, 0, 1)):
    return gp_Ax2(gp_Pnt(x, y, z), gp_Dir(*direction))


def parts(shape, kind):
    found, explorer = [], TopExp_Explorer(shape, kind)
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def box(low, high):
    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()


def cut(shape, *others):
    for other in others:
        shape = BRepAlgoAPI_Cut(shape, other).Shape()
    return shape


def rounded(shape, radius, chosen):
    fillet = BRepFilletAPI_MakeFillet(shape)
    seen = []
    for edge in map(TopoDS.Edge, parts(shape, TopAbs_EDGE)):
        if any(edge.IsSame(s) for s in seen):
            continue
        seen.append(edge)
        if chosen(BRepAdaptor_Curve(edge)):
            fillet.Add(radius, edge)
    return fillet.Shape()


def middle(curve):
    return curve.Value(0.5 * (curve.FirstParameter() + curve.LastParameter()))


def pad():
    disc = BRepPrimAPI_MakeCylinder(axis(0, 0, 0), PAD, HEIGHT).Shape()
    disc = rounded(disc, RIM, lambda c: c.GetType() == GeomAbs_Circle and middle(c).Z() < 1e-6)
    grooves = [BRepPrimAPI_MakeCylinder(axis(-20, 0, -1.2, (1, 0, 0)), 1.6, 40).Shape()]
    grooves.append(BRepPrimAPI_MakeCylinder(axis(0, -20, -1.2, (0, 1, 0)), 1.6, 40).Shape())
    dimple = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, HEIGHT + 1), 4).Shape()
    return cut(disc, *grooves, dimple)


def stud():
    """From the tip at z = 0 upwards."""
    core = BRepPrimAPI_MakeCylinder(axis(0, 0, 1.5), CORE, LENGTH - 1.5).Shape()
    tip = BRepPrimAPI_MakeCone(axis(0, 0, 0), 1.7, CORE, 1.5).Shape()
    bolt = BRepAlgoAPI_Fuse(core, tip).Shape()
    # The ridge: a trapezium that follows a helix on the core.
    surface = Geom_CylindricalSurface(gp_Ax3(gp_Pnt(0, 0, 8), gp_Dir(0, 0, 1)), CORE)
    turns = 3
    line = Geom2d_Line(gp_Pnt2d(0, 0), gp_Dir2d(2 * math.pi, PITCH))
    spine = BRepBuilderAPI_MakeEdge(line, surface, 0.0, turns * math.hypot(2 * math.pi, PITCH)).Edge()
    BRepLib.BuildCurves3d_s(spine)
    profile = BRepBuilderAPI_MakePolygon()
    for r, z in ((CORE - 0.3, -0.55), (CORE + 0.7, -0.1), (CORE + 0.7, 0.1), (CORE - 0.3, 0.55)):
        profile.Add(gp_Pnt(r, 0, 8 + z))
    profile.Close()
    sweep = BRepOffsetAPI_MakePipeShell(BRepBuilderAPI_MakeWire(spine).Wire())
    sweep.SetMode(gp_Dir(0, 0, 1))
    sweep.Add(profile.Wire())
    sweep.Build()
    sweep.MakeSolid()
    bolt = BRepAlgoAPI_Fuse(bolt, sweep.Shape()).Shape()
    hexagon = BRepBuilderAPI_MakePolygon()
    for k in range(6):
        hexagon.Add(gp_Pnt(7.5 * math.cos(k * math.pi / 3), 7.5 * math.sin(k * math.pi / 3), LENGTH))
    hexagon.Close()
    head = BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(hexagon.Wire()).Face(), gp_Vec(0, 0, 5.5)).Shape()
    head = BRepAlgoAPI_Common(head, BRepPrimAPI_MakeCone(axis(0, 0, LENGTH - 5.5), 13.5, 5, 14.5).Shape()).Shape()
    return BRepAlgoAPI_Fuse(bolt, head).Shape()


def bracket():
    """Its upper face at z = 0, the flanges down to z = -22."""
    outer = box((-35, -12, -22), (35, 12, 0))
    along_y = lambda c: c.GetType() == GeomAbs_Line and abs(c.Line().Direction().Y()) > 0.99
    outer = rounded(outer, 7, lambda c: along_y(c) and middle(c).Z() > -1)
    inner = box((-32, -20, -30), (32, 20, -3))
    inner = rounded(inner, 4, lambda c: along_y(c) and middle(c).Z() > -4)
    sheet = cut(outer, inner)
    along_x = lambda c: c.GetType() == GeomAbs_Line and abs(c.Line().Direction().X()) > 0.99
    sheet = rounded(sheet, 5, lambda c: along_x(c) and middle(c).Z() < -21)
    holes = [BRepPrimAPI_MakeCylinder(axis(x, 0, -10), 4.2, 20).Shape() for x in (-APART, APART)]
    slot = box((-4, -3, -10), (4, 3, 10))
    slot = rounded(slot, 2.9, lambda c: abs(c.Line().Direction().Z()) > 0.99)
    return cut(sheet, *holes, slot)


def solid(shape):
    [only] = parts(shape, TopAbs_SOLID)
    return only


def placed(x, z, turn=0.0):
    turned, moved = gp_Trsf(), gp_Trsf()
    turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turn)
    moved.SetTranslation(gp_Vec(x, 0, z))
    return TopLoc_Location(moved.Multiplied(turned))


def main(path):
    document = TDocStd_Document(TCollection_ExtendedString("press"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    name = lambda label, text: TDataStd_Name.Set_s(label, TCollection_ExtendedString(text))
    assembly = tool.NewShape()
    name(assembly, "press")
    for text, shape, places in (
        ("bracket", bracket(), [placed(0, 26)]),
        ("stud", stud(), [placed(-APART, 2), placed(APART, 2, 0.4)]),
        ("pad", pad(), [placed(-APART, 0), placed(APART, 0, math.pi)]),
    ):
        label = tool.AddShape(solid(shape), False)
        name(label, text)
        for k, place in enumerate(places):
            name(tool.AddComponent(assembly, label, place), f"{text}_{k + 1}")
    tool.UpdateAssemblies()
    Interface_Static.SetCVal_s("write.step.schema", "AP214IS")
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    assert writer.Transfer(document, STEPControl_AsIs)
    writer.Write(path)
    # The time of writing would make every file another one.
    with open(path) as file:
        lines = file.read().split("\n")
    at = next(k for k, line in enumerate(lines) if line.startswith("FILE_NAME"))
    lines[at] = lines[at].split(",")[0].replace(path, "press.step") + ",'2026-01-01T00:00:00',('covact'),(''),"
    while not lines[at + 1].endswith(";"):
        del lines[at + 1]
    lines[at + 1] = "  '','Open CASCADE 8.0.1','');"
    with open(path, "w") as file:
        file.write("\n".join(lines))


main(*sys.argv[1:])
