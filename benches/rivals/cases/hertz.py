"""Hertz: a rigid sphere of radius 100 pressed .01 into an elastic half space, in one step.

The quarter of a block of side 10, whose far faces follow the Boussinesq displacement of Hertz' force. E = 200, nu = .3:
contact radius a = 1, force F = 2.93040, largest pressure p0 = 1.39916 (K. L. Johnson, Contact Mechanics, 1985, ch. 4)."""
import math

from lib import calculix as ccx
from lib import covact as cov
from lib.grid import Grid, even, fine

TITLE = "Hertz, one step"
RIGHT = "closed form: force and largest pressure"
LIMIT = 0.03
#: Cells over 1.5 a; quadratic elements are twice as large.
CELLS = 6
E, NU, R, DELTA, SIDE = 200.0, 0.3, 100.0, 0.01, 10.0
STAR = E / (1 - NU**2)
A = math.sqrt(R * DELTA)
FORCE = 4 / 3 * STAR * math.sqrt(R) * DELTA**1.5
PEAK = 2 * STAR * A / (math.pi * R)
VARIANTS = {
    "covact": ["nodes"],
    "calculix": ["C3D8I surface, K = 50 E", "C3D8I surface, K = 500 E", "C3D20R surface, K = 50 E", "C3D8I mortar"],
    "getfem": ["Q1, augmented"],
}


def block(n=CELLS):
    c = fine(SIDE, 1.5, n)
    return Grid(c, c, [-x for x in reversed(c)])


def far(x, y, z):
    """Displacement of a half space z < 0 under the force, by Boussinesq."""
    r = math.sqrt(x * x + y * y + z * z)
    c = FORCE * (1 + NU) / (2 * math.pi * E)
    radial = c * (-z / r**3 - (1 - 2 * NU) / (r * (r - z)))
    return radial * x, radial * y, -c * (z * z / r**3 + 2 * (1 - NU) / r)


def result(force, peak, ran):
    error = max(abs(force / FORCE - 1), abs(peak / PEAK - 1))
    return dict(
        answer=f"F {100 * (force / FORCE - 1):+.2f} %, p0 {100 * (peak / PEAK - 1):+.1f} %", error=error, **ran
    )


def covact(folder, variant):
    c = FORCE * (1 + NU) / (2 * math.pi * E)
    root = "sqrt(x^2+y^2+z^2)"
    radial = f"{c:.12e}*t*(-z/{root}^3-0.4/({root}*({root}-z)))"
    away = {"x": f"x*{radial}", "y": f"y*{radial}", "z": f"-{c:.12e}*t*(z^2/{root}^3+1.4/{root})"}
    n, cells = CELLS, len(block().axes[0]) - 1
    part = {"fine": {"length": 1.5, "fine": n}}
    scene = {
        "covact": 1,
        "materials": {"solid": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
        "bodies": {"block": {
            "mesh": {"block": {
                "min": [0, 0, -SIDE], "max": [SIDE, SIDE, 0], "elements": [cells] * 3,
                "spacing": [part, part, {"fine": {"length": 1.5, "fine": n, "from_end": True}}],
            }},
            "material": "solid",
            "element": "h8_displacement",
            "sets": {"zone": {"faces_in_box": {"min": [-0.01, -0.01, -0.01], "max": [2.5, 2.5, 0.01]}}},
        }},
        "surfaces": {"sphere": {
            "sphere": {"radius": R, "center": [0, 0, R]}, "motion": {"translation": [0, 0, f"-{DELTA}*t"]},
        }},
        "contacts": {"press": {"slave": "block.zone", "master": "sphere", "penalty": {"value": 1e5}}},
        "supports": {
            **{f"far_{a}": {"on": f"block.{a}", "displacement": away} for a in ("x_max", "y_max", "z_min")},
            "symmetry_x": {"on": "block.x_min", "symmetry": "x"},
            "symmetry_y": {"on": "block.y_min", "symmetry": "y"},
        },
        "solution": {"step": {"initial": 1, "max": 1}},
        "output": {"every": 0},
    }
    ran = cov.run(folder, scene)
    if not ran["rows"]:
        return dict(answer="", error=None, **ran)
    last = ran["rows"][-1]
    return result(-4 * last["force.sphere.z"], last["pressure.max"], ran)


def calculix(folder, variant):
    kind = variant.split()[0]
    n = CELLS // 2 if kind == "C3D20R" else CELLS
    body = block(n)
    deck = ccx.Deck()
    deck.body("BLOCK", body, kind)
    # The sphere: a cap of quadratic faces finer than those of the block, nodes on the sphere, all held.
    cap = Grid(
        even(0, 2.6, 16), even(0, 2.6, 16), [0, 1],
        lambda x, y, z: (x, y, R - math.sqrt(R * R - x * x - y * y) + 0.3 * z),
    )
    deck.body("CAP", cap, "C3D20R" if kind == "C3D20R" else "C3D8")
    deck.surface("SLAVE", "BLOCK", body, "z_max", lambda e: near(body, e))
    deck.surface("MASTER", "CAP", cap, "z_min")
    tiny = 1e-9
    away = deck.nodes_where(
        "NFAR", "BLOCK", lambda x, y, z: x > SIDE - tiny or y > SIDE - tiny or z < -SIDE + tiny
    )
    deck.nodes_where("NX", "BLOCK", lambda x, y, z: x < tiny and y < SIDE - tiny and z > -SIDE + tiny)
    deck.nodes_where("NY", "BLOCK", lambda x, y, z: y < tiny and x < SIDE - tiny and z > -SIDE + tiny)
    deck.add(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{E}, {NU}")
    deck.add("*SOLID SECTION, ELSET=EBLOCK, MATERIAL=SOLID\n*SOLID SECTION, ELSET=ECAP, MATERIAL=SOLID")
    if "mortar" in variant:
        deck.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{50 * E}")
        deck.add("*CONTACT PAIR, INTERACTION=SI, TYPE=MORTAR\nSLAVE, MASTER")
    else:
        k = float(variant.split("K = ")[1].split()[0]) * E
        deck.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{k}, 1e-3")
        deck.add("*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER")
    deck.add("*BOUNDARY\nNX, 1, 1\nNY, 2, 2")
    deck.add("*STEP, NLGEOM\n*STATIC\n1., 1.\n*BOUNDARY")
    points = dict(deck.points["BLOCK"])
    for node in away:
        for axis, value in enumerate(far(*points[node])):
            deck.add(f"{node}, {axis + 1}, {axis + 1}, {value:.12e}")
    deck.add(f"NCAP, 1, 2, 0.\nNCAP, 3, 3, {-DELTA}")
    deck.add("*NODE PRINT, NSET=NCAP, TOTALS=ONLY\nRF\n*CONTACT FILE\nCDIS, CSTR\n*END STEP")
    ran = ccx.run(folder, deck)
    force = ccx.totals(folder, "NCAP")
    if not force:
        return dict(answer="", error=None, **ran)
    peak = max(v for n, v in ccx.contact_pressures(folder).items() if n in points)
    return result(-4 * force[-1][3], peak, ran)


def near(grid, element):
    """Whether an element begins within 2.5 of the axis."""
    nx, ny, _ = grid.cells
    i, j = element % nx, element // nx % ny
    return grid.axes[0][i] < 2.5 and grid.axes[1][j] < 2.5


def getfem(folder, variant):
    import getfem as gf
    import numpy as np
    from lib import gf as tools

    mesh = tools.mesh(block(), {1: "z_max", 2: "x_min", 3: "y_min", 4: "x_max", 5: "y_max", 6: "z_min"})
    mesh.region_merge(4, 5)
    mesh.region_merge(4, 6)
    fem = gf.MeshFem(mesh, 3)
    fem.set_fem(gf.Fem("FEM_QK(3,1)"))
    one = gf.MeshFem(mesh, 1)
    one.set_fem(gf.Fem("FEM_QK(3,1)"))
    mim = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,4)"))
    model = gf.Model("real")
    model.add_fem_variable("u", fem)
    model.add_initialized_data("lam", E * NU / ((1 + NU) * (1 - 2 * NU)))
    model.add_initialized_data("mu", E / (2 * (1 + NU)))
    model.add_isotropic_linearized_elasticity_brick(mim, "u", "lam", "mu")
    tools.symmetry(model, mim, 2, E / SIDE)
    tools.symmetry(model, mim, 3, E / SIDE)
    nodes = fem.basic_dof_nodes()[:, ::3].T
    model.add_initialized_fem_data(
        "away", fem, np.array([far(*p) if np.abs(p).max() > SIDE - 1e-9 else (0, 0, 0) for p in nodes]).ravel()
    )
    model.add_Dirichlet_condition_with_simplification("u", 4, "away")
    places = one.basic_dof_nodes()
    gap = R - np.sqrt(np.maximum(R**2 - places[0] ** 2 - places[1] ** 2, 0)) - DELTA - places[2]
    model.add_initialized_fem_data("gap", one, gap)
    model.add_filtered_fem_variable("p", one, 1)
    model.add_initialized_data("r", E)
    model.add_integral_contact_with_rigid_obstacle_brick(mim, "u", "p", "gap", "r", 1, 1)
    newton = tools.Newton(model, max_iter=100)
    done = newton.solve()
    pressures = -model.variable("p")
    force = 4 * gf.asm_generic(mim, 0, "-p", 1, model)
    ran = dict(finished=done, increments=1, iterations=newton.iterations, errors=[newton.message] if newton.message else [])
    return result(force, float(np.max(pressures)), ran)
