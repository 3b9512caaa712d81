"""Reference numbers for geometry/tests/iges_trim_table.rs from an independent CAD kernel, Open CASCADE.

    python cad_reference.py FOLDER cad_table.json

FOLDER holds `made_here` and `real`. Ran with cadquery-ocp 8.0.1.1.0 (Open CASCADE 8.0.1), Python 3.11. For every IGES
file: entities by type and form as the kernel's directory lists them; for every face or free surface its area and box, and
area and box of the whole surface that carries it where that is bounded. Lengths in millimetres.
"""
import collections
import json
import os
import sys

import OCP
from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IGESControl import IGESControl_Controller, IGESControl_Reader
from OCP.Interface import Interface_Static

FACES = (143, 144, 510)
BASES = (108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198)
UNBOUNDED = (108, 190, 192, 194)


def area(shape):
    props = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, props, 1e-10)
    return props.Mass()


def box(shape):
    b = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, b, False, False)
    low, high = b.CornerMin(), b.CornerMax()
    return [low.X(), low.Y(), low.Z(), high.X(), high.Y(), high.Z()]


def read(path):
    reader = IGESControl_Reader()
    Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
    assert int(reader.ReadFile(path)) == 1, path
    model = reader.IGESModel()
    reader.SetReadVisible(False)
    # The list keeps the Python objects alive, so that a pointer to an entity is the same object.
    entities = [model.Entity(i) for i in range(1, model.NbEntities() + 1)]
    numbers = {id(e): 2 * i + 1 for i, e in enumerate(entities)}
    counts = collections.Counter(f"{e.TypeNumber()}.{e.FormNumber()}" for e in entities)
    bases = {numbers[id(e)]: e.Surface() for e in entities if e.TypeNumber() in FACES}
    carried = {numbers[id(b)] for b in bases.values()}
    rows = []
    for e in entities:
        kind, n = e.TypeNumber(), numbers[id(e)]
        if kind not in FACES + BASES or n in carried:
            continue
        base = bases.get(n, e)
        row = {"entity": n, "type": kind, "base": numbers[id(base)], "base_type": base.TypeNumber()}
        for key, entity in (("", e), ("base_", base)):
            if key and (base is e or base.TypeNumber() in UNBOUNDED):
                continue
            reader.ClearShapes()
            reader.TransferOne((numbers[id(entity)] + 1) // 2)
            if reader.NbShapes() > 0:
                shape = reader.OneShape()
                row[key + "area"], row[key + "box"] = area(shape), box(shape)
        rows.append(row)
    return {"entities": dict(sorted(counts.items())), "surfaces": rows}


def main(folder, target):
    IGESControl_Controller.Init_s()
    out = {}
    for part in ("made_here", "real"):
        for name in sorted(os.listdir(os.path.join(folder, part))):
            if name.endswith((".igs", ".iges")):
                out[f"{part}/{name}"] = read(os.path.join(folder, part, name))
                print(name, file=sys.stderr)
    with open(target, "w") as file:
        json.dump({"kernel": f"cadquery-ocp {OCP.__version__}", "files": out}, file, indent=1)
        file.write("\n")


main(*sys.argv[1:])
