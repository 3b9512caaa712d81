"""Makes the mesh files of this folder with gmsh 4.15 (pip install gmsh). Run it in this folder."""

import gmsh

mesh, occ, geo = gmsh.model.mesh, gmsh.model.occ, gmsh.model.geo


def plate():
    """Standing plate 0.1 x 2 x 1 with 2 x 4 x 3 elements: its thickness is along x, which is not direction 3."""
    gmsh.clear()
    box = occ.addBox(0, 0, 0, 0.1, 2, 1)
    occ.synchronize()
    for _, curve in gmsh.model.getEntities(1):
        count = {0.1: 2, 2.0: 4, 1.0: 3}[round(occ.getMass(1, curve), 6)]
        mesh.setTransfiniteCurve(curve, count + 1)
    for _, surface in gmsh.model.getEntities(2):
        mesh.setTransfiniteSurface(surface)
        mesh.setRecombine(2, surface)
    mesh.setTransfiniteVolume(box)

    def entity(dim, center):
        for _, tag in gmsh.model.getEntities(dim):
            box = gmsh.model.getBoundingBox(dim, tag)
            if all(abs((box[i] + box[i + 3]) / 2 - center[i]) < 1e-6 for i in range(3)):
                return tag

    def group(dim, center, name):
        gmsh.model.addPhysicalGroup(dim, [entity(dim, center)], name=name)

    group(3, (0.05, 1, 0.5), "sheet")
    group(2, (0.1, 1, 0.5), "top")
    group(2, (0.05, 0, 0.5), "clamped edge")
    group(1, (0, 2, 0.5), "line")
    group(0, (0, 0, 0), "corner")
    mesh.generate(3)


def cylinder():
    """Quarter of a ring about y, mean radius 10, thickness 1, length 8; its groups have no names."""
    gmsh.clear()
    centre = geo.addPoint(0, 0, 0)
    points = [geo.addPoint(*p) for p in ((0, 0, 9.5), (9.5, 0, 0), (0, 0, 10.5), (10.5, 0, 0))]
    inner = geo.addCircleArc(points[0], centre, points[1])
    outer = geo.addCircleArc(points[2], centre, points[3])
    start, end = geo.addLine(points[0], points[2]), geo.addLine(points[1], points[3])
    surface = geo.addPlaneSurface([geo.addCurveLoop([inner, end, -outer, -start])])
    for curve, count in ((inner, 8), (outer, 8), (start, 1), (end, 1)):
        geo.mesh.setTransfiniteCurve(curve, count + 1)
    geo.mesh.setTransfiniteSurface(surface)
    geo.mesh.setRecombine(2, surface)
    out = geo.extrude([(2, surface)], 0, 8, 0, numElements=[3], recombine=True)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(3, [out[1][1]], 7)
    mesh.generate(3)


def tetrahedra():
    gmsh.clear()
    occ.addBox(0, 0, 0, 1, 1, 1)
    occ.synchronize()
    mesh.setSize(gmsh.model.getEntities(0), 1.0)
    mesh.generate(3)


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
plate()
gmsh.write("plate.msh")
gmsh.write("plate.inp")
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write("plate_binary.msh")
gmsh.option.setNumber("Mesh.SaveParametric", 1)
gmsh.write("plate_parametric_binary.msh")
gmsh.option.setNumber("Mesh.Binary", 0)
gmsh.write("plate_parametric.msh")
gmsh.option.setNumber("Mesh.SaveParametric", 0)
gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
gmsh.write("plate_version_2.msh")
gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
mesh.partition(2)
gmsh.write("plate_partitioned.msh")
plate()
mesh.setOrder(2)
gmsh.write("plate_quadratic.msh")
cylinder()
gmsh.write("cylinder.msh")
tetrahedra()
gmsh.write("tetrahedra.msh")
gmsh.finalize()
