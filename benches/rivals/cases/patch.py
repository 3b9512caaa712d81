"""Patch test: two blocks whose meshes do not match, pressed together (3 x 3 elements on 2 x 2; after M. A. Crisfield,
IJNME 48 (2000), and R. L. Taylor and P. Papadopoulos, 1991).

The stress is the same everywhere, so the contact pressure at every point is force / area."""
import os

from lib import calculix as ccx
from lib import covact as cov
from lib.grid import Grid, even

TITLE = "patch test, meshes do not match"
RIGHT = "constant pressure: largest deviation of a point from force / area"
LIMIT = 0.01
E, NU, PRESS = 1000.0, 0.3, 1e-4
VARIANTS = {
    "covact": ["segments"],
    "calculix": ["surface, C3D8", "mortar, C3D8", "node, C3D8"],
    "getfem": ["integral, Q1, order 4", "integral, Q1, order 11"],
}
TOP = Grid(even(0, 1, 3), even(0, 1, 3), [0, 0.5])
LOW = Grid(even(0, 1, 2), even(0, 1, 2), [-0.5, 0])


def result(force, pressures, ran):
    mean = force
    error = max(abs(p / mean - 1) for p in pressures)
    return dict(answer=f"pressures {100 * (min(pressures) / mean - 1):+.2g} to {100 * (max(pressures) / mean - 1):+.2g} %", error=error, **ran)


def covact(folder, variant):
    def block(z, n):
        return {"mesh": {"block": {"min": [0, 0, z], "max": [1, 1, z + 0.5], "elements": [n, n, 1]}},
                "material": "elastic", "element": "h8_displacement"}

    scene = {
        "covact": 1,
        "materials": {"elastic": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
        "bodies": {"upper": block(0, 3), "lower": block(-0.5, 2)},
        "contacts": {"joint": {"slave": "upper.z_min", "master": "lower.z_max", "points": {"segments": 2}}},
        "supports": {
            "floor": {"on": "lower.z_min", "symmetry": "z"},
            "press": {"on": "upper.z_max", "displacement": {"z": f"-{PRESS}*t"}},
            **{f"{b}_{a}": {"on": f"{b}.{a}_min", "symmetry": a} for b in ("upper", "lower") for a in "xy"},
        },
        "solution": {"step": {"initial": 1, "max": 1}},
        "output": {"every": 1},
    }
    ran = cov.run(folder, scene)
    if not ran["rows"]:
        return dict(answer="", error=None, **ran)
    last = ran["rows"][-1]
    values, where = cov.point_field(os.path.join(folder, "out", "upper_0001.vtu"), "contact_pressure")
    low = min(v for v, p in zip(values, where) if p[2] < 1e-9)
    return result(-last["force.press.z"], [low, last["pressure.max"]], ran)


def calculix(folder, variant):
    deck = ccx.Deck()
    deck.body("TOP", TOP, "C3D8")
    deck.body("LOW", LOW, "C3D8")
    deck.surface("MASTER", "LOW", LOW, "z_max")
    deck.surface("SLAVE", "TOP", TOP, "z_min")
    for name, body, test in (
        ("NPRESS", "TOP", lambda x, y, z: z > 0.5 - 1e-9), ("NFLOOR", "LOW", lambda x, y, z: z < 1e-9 - 0.5),
        ("NX", "TOP", lambda x, y, z: x < 1e-9), ("NY", "TOP", lambda x, y, z: y < 1e-9),
        ("NXL", "LOW", lambda x, y, z: x < 1e-9), ("NYL", "LOW", lambda x, y, z: y < 1e-9),
    ):
        deck.nodes_where(name, body, test)
    deck.add(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{E}, {NU}")
    deck.add("*SOLID SECTION, ELSET=ETOP, MATERIAL=SOLID\n*SOLID SECTION, ELSET=ELOW, MATERIAL=SOLID")
    deck.add("*SURFACE INTERACTION, NAME=SI")
    if "mortar" in variant:
        deck.add(f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{50 * E}\n*CONTACT PAIR, INTERACTION=SI, TYPE=MORTAR")
    else:
        kind = "NODE TO SURFACE" if "node" in variant else "SURFACE TO SURFACE"
        deck.add(f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{50 * E}, 1e-3\n*CONTACT PAIR, INTERACTION=SI, TYPE={kind}")
    deck.add("SLAVE, MASTER")
    deck.add("*BOUNDARY\nNX, 1, 1\nNXL, 1, 1\nNY, 2, 2\nNYL, 2, 2\nNFLOOR, 3, 3")
    deck.add(f"*STEP, NLGEOM\n*STATIC\n1., 1.\n*BOUNDARY\nNPRESS, 3, 3, {-PRESS}")
    deck.add("*NODE PRINT, NSET=NPRESS, TOTALS=ONLY\nRF\n*CONTACT FILE\nCDIS, CSTR\n*END STEP")
    ran = ccx.run(folder, deck)
    force = ccx.totals(folder, "NPRESS")
    if not force:
        return dict(answer="", error=None, **ran)
    found = ccx.contact_pressures(folder)
    pressures = [found[n] for n, p in deck.points["TOP"] if p[2] < 1e-9 and n in found]
    return result(-force[-1][3], pressures, ran) if pressures else dict(answer="no pressures", error=None, **ran)


def getfem(folder, variant):
    import getfem as gf
    import numpy as np
    from lib import gf as tools

    model = gf.Model("real")
    model.add_initialized_data("lam", E * NU / ((1 + NU) * (1 - 2 * NU)))
    model.add_initialized_data("mu", E / (2 * (1 + NU)))
    mims = {}
    for name, grid, contact, held, value in (("ut", TOP, "z_min", "z_max", -PRESS), ("ul", LOW, "z_max", "z_min", 0.0)):
        mesh = tools.mesh(grid, {1: contact, 2: held, 3: "x_min", 4: "y_min"})
        fem = gf.MeshFem(mesh, 3)
        fem.set_fem(gf.Fem("FEM_QK(3,1)"))
        mim = mims[name] = gf.MeshIm(mesh, gf.Integ(f"IM_GAUSS_PARALLELEPIPED(3,{variant.split()[-1]})"))
        model.add_fem_variable(name, fem)
        model.add_isotropic_linearized_elasticity_brick(mim, name, "lam", "mu")
        tools.symmetry(model, mim, 3, E, name)
        tools.symmetry(model, mim, 4, E, name)
        # Held along z by a penalty as the symmetries are.
        model.add_linear_term(mim, f"{1e8 * E}*({name}(3)-({value}))*Test_{name}(3)", 2)
        if name == "ut":
            one = gf.MeshFem(mesh, 1)
            one.set_fem(gf.Fem("FEM_QK(3,1)"))
            model.add_filtered_fem_variable("p", one, 1)
    model.add_initialized_data("r", E)
    model.add_integral_contact_between_nonmatching_meshes_brick(mims["ut"], "ut", "ul", "p", "r", 1, 1)
    newton = tools.Newton(model, max_iter=100)
    done = newton.solve()
    pressures = np.abs(model.variable("p"))
    force = gf.asm_generic(mims["ut"], 0, f"{1e8 * E}*(ut(3)+{PRESS})", 2, model)
    ran = dict(finished=done, increments=1, iterations=newton.iterations, errors=[newton.message] if newton.message else [])
    return result(abs(float(force)), [float(v) for v in pressures], ran)
