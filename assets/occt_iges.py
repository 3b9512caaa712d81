"""What the scripts beside this one share: NURBS surfaces to an IGES file, through OCCT ("pip install cadquery-ocp==7.9.*")."""

import io

from OCP.Geom import Geom_BSplineSurface
from OCP.GeomToIGES import GeomToIGES_GeomSurface
from OCP.gp import gp_Pnt
from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer
from OCP.IGESData import IGESData_IGESWriter
from OCP.TCollection import TCollection_HAsciiString
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal

IGESControl_Controller.Init_s()


def bezier(points, weights):
    """One Bezier piece as a B-spline surface; points[i][j] with i along the first direction."""
    n, m = len(points), len(points[0])
    poles, w = TColgp_Array2OfPnt(1, n, 1, m), TColStd_Array2OfReal(1, n, 1, m)
    for i in range(n):
        for j in range(m):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*map(float, points[i][j])))
            w.SetValue(i + 1, j + 1, float(weights[i][j]))
    knots, multiplicities = [], []
    for count in (n, m):
        k, c = TColStd_Array1OfReal(1, 2), TColStd_Array1OfInteger(1, 2)
        for at in (1, 2):
            k.SetValue(at, at - 1.0)
            c.SetValue(at, count)
        knots.append(k)
        multiplicities.append(c)
    return Geom_BSplineSurface(poles, w, *knots, *multiplicities, n - 1, m - 1)


def write(path, surfaces, labels=None, unit="MM"):
    """Free-standing surfaces (entity 128) with 16 digits; a label has up to 8 characters."""
    writer = IGESControl_Writer(unit, 0)
    # IGESControl_Writer.AddGeom refuses surfaces, so they are converted one by one.
    convert = GeomToIGES_GeomSurface()
    convert.SetModel(writer.Model())
    for surface in surfaces:
        entity = convert.TransferSurface(surface, *surface.Bounds())
        if entity is None or not writer.AddEntity(entity):
            raise RuntimeError(f"{path}: OCCT refused a surface")
    writer.ComputeModel()
    model = writer.Model()
    if labels:
        if model.NbEntities() != len(labels):
            raise RuntimeError(f"{path}: {model.NbEntities()} entities for {len(labels)} labels")
        for i, label in enumerate(labels):
            model.Entity(i + 1).SetLabel(TCollection_HAsciiString(label))
    text = IGESData_IGESWriter(model)
    # The writer's own format has nine digits.
    text.FloatWriter().SetFormat("%.15E")
    text.SendModel(model.Protocol())
    out = io.BytesIO()
    if not text.Print(out):
        raise RuntimeError(f"{path}: OCCT could not write")
    with open(path, "wb") as file:
        file.write(out.getvalue())
