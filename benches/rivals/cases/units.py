"""A ball pressed into a cushion, once with lengths about 1, once as nanometres written in metres (1e-9), once as kilometres
written in millimetres (1e6); E stays, so forces go with the square of the length.

Nothing but round-off may change: force / length^2 is the same to 1e-6 (CalculiX prints seven digits)."""
import os

from lib import calculix as ccx
from lib import covact as cov
from lib.grid import Grid, even

TITLE = "lengths in nm and in km"
RIGHT = "force / length^2 is that of lengths about 1"
LIMIT = 1e-6
E, NU, R, DEPTH, SIDE, CELLS = 1000.0, 0.3, 10.0, 0.2, 4.0, 6
SCALES = (1.0, 1e-9, 1e6)
VARIANTS = {
    "covact": ["automatic penalty"],
    "calculix": ["C3D8I surface, K = 50 E / h", "C3D8I node, K = 50 E / h"],
    "getfem": ["default tolerance", "tolerance scaled by the user"],
}


def result(forces, runs):
    """Forces over length^2 by scale; None where a run ended early."""
    ran = {k: sum(r[k] for r in runs) for k in ("increments", "iterations")}
    ran["finished"] = all(r["finished"] for r in runs)
    ran["errors"] = [f"length {s:g}: {e}" for s, r in zip(SCALES, runs) if not r["finished"] for e in r.get("errors", [])[:1]]
    ran["screen"] = "".join(r.get("screen", "") for r in runs)
    base = forces[0]
    shown = [f"{f:.6g}" if f is not None else "none" for f in forces]
    error = None
    if base:
        error = max(abs(f / base - 1) for f in forces if f is not None)
        if error > 10 * LIMIT:
            ran["verdict"], ran["said"] = "wrong, silently", "converged"
        elif not ran["finished"]:
            error = None
    return dict(answer="force / length^2 " + ", ".join(shown), error=error, **ran)


def covact(folder, variant):
    forces, runs = [], []
    for n, s in enumerate(SCALES):
        inner = os.path.join(folder, str(n))
        os.makedirs(inner)
        ran = cov.run(inner, {
            "covact": 1,
            "materials": {"soft": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
            "bodies": {"cushion": {
                "mesh": {"block": {"min": [0, 0, -SIDE * s], "max": [SIDE * s, SIDE * s, 0], "elements": [CELLS] * 3}},
                "material": "soft",
                "element": "h8_displacement",
            }},
            "surfaces": {"ball": {
                "sphere": {"radius": R * s, "center": [0, 0, R * s]},
                "motion": {"translation": [0, 0, {"table": [[0, 0], [1, -DEPTH * s]]}]},
            }},
            "contacts": {"press": {"slave": "cushion.z_max", "master": "ball", "points": {"gauss": 2}}},
            "supports": {
                "floor": {"on": "cushion.z_min", "fixed": True},
                "symmetry_x": {"on": "cushion.x_min", "symmetry": "x"},
                "symmetry_y": {"on": "cushion.y_min", "symmetry": "y"},
            },
            "solution": {"step": {"initial": 1, "max": 1}},
            "output": {"every": 0},
        })
        ran["errors"] = [] if ran["finished"] else [" ".join(ran["screen"].split())]
        runs.append(ran)
        forces.append(-4 * ran["rows"][-1]["force.ball.z"] / s**2 if ran["finished"] else None)
    return result(forces, runs)


def calculix(folder, variant):
    import math

    forces, runs = [], []
    for n, s in enumerate(SCALES):
        inner = os.path.join(folder, str(n))
        os.makedirs(inner)
        scaled = lambda place: lambda x, y, z: tuple(s * c for c in place(x, y, z))
        block = Grid(even(0, SIDE, CELLS), even(0, SIDE, CELLS), even(-SIDE, 0, CELLS), scaled(lambda x, y, z: (x, y, z)))
        cap = Grid(
            even(0, 4.5, 16), even(0, 4.5, 16), [0, 1],
            scaled(lambda x, y, z: (x, y, R - math.sqrt(R * R - x * x - y * y) + z)),
        )
        deck = ccx.Deck()
        deck.body("BLOCK", block, "C3D8I")
        deck.body("CAP", cap, "C3D8")
        tiny = 1e-6 * s
        deck.surface("SLAVE", "BLOCK", block, "z_max")
        deck.surface("MASTER", "CAP", cap, "z_min")
        deck.nodes_where("NFLOOR", "BLOCK", lambda x, y, z: z < tiny - SIDE * s)
        deck.nodes_where("NX", "BLOCK", lambda x, y, z: x < tiny and z > tiny - SIDE * s)
        deck.nodes_where("NY", "BLOCK", lambda x, y, z: y < tiny and z > tiny - SIDE * s)
        deck.add(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{E}, {NU}")
        deck.add("*SOLID SECTION, ELSET=EBLOCK, MATERIAL=SOLID\n*SOLID SECTION, ELSET=ECAP, MATERIAL=SOLID")
        k = 50 * E * CELLS / SIDE / s
        deck.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{k:.9e}, {1e-3 * E:.3e}")
        deck.add(f"*CONTACT PAIR, INTERACTION=SI, TYPE={'NODE' if 'node' in variant else 'SURFACE'} TO SURFACE\nSLAVE, MASTER")
        deck.add("*BOUNDARY\nNFLOOR, 1, 3\nNX, 1, 1\nNY, 2, 2")
        deck.add(f"*STEP, NLGEOM, INC=1000\n*STATIC\n1., 1.\n*BOUNDARY\nNCAP, 1, 2, 0.\nNCAP, 3, 3, {-DEPTH * s:.9e}")
        deck.add("*NODE PRINT, NSET=NCAP, TOTALS=ONLY\nRF\n*END STEP")
        ran = ccx.run(inner, deck)
        runs.append(ran)
        found = ccx.totals(inner, "NCAP") if ran["finished"] else []
        forces.append(-4 * found[-1][3] / s**2 if found else None)
    return result(forces, runs)


def getfem(folder, variant):
    import getfem as gf
    from lib import gf as tools

    forces, runs = [], []
    for s in SCALES:
        grid = Grid(even(0, SIDE * s, CELLS), even(0, SIDE * s, CELLS), even(-SIDE * s, 0, CELLS))
        mesh = tools.mesh(grid, {1: "z_max", 2: "x_min", 3: "y_min", 4: "z_min"})
        fem = gf.MeshFem(mesh, 3)
        fem.set_fem(gf.Fem("FEM_QK(3,1)"))
        one = gf.MeshFem(mesh, 1)
        one.set_fem(gf.Fem("FEM_QK(3,1)"))
        mim = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,4)"))
        m = gf.Model("real")
        m.add_fem_variable("u", fem)
        m.add_initialized_data("lame", [E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))])
        m.add_finite_strain_elasticity_brick(mim, "SaintVenant Kirchhoff", "u", "lame")
        tools.symmetry(m, mim, 2, E / (SIDE * s))
        tools.symmetry(m, mim, 3, E / (SIDE * s))
        m.add_Dirichlet_condition_with_simplification("u", 4)
        m.add_initialized_data("c", [0, 0, (R - DEPTH) * s])
        m.add_initialized_data("r", E * CELLS / (SIDE * s))
        m.add_filtered_fem_variable("p", one, 1)
        gap, normal = f"(Norm(X+u-c)-{R * s:.15e})", "Normalized(X+u-c)"
        m.add_nonlinear_term(mim, f"-neg_part(p+r*{gap})*({normal}.Test_u)", 1)
        m.add_nonlinear_term(mim, f"-(1/r)*(p+neg_part(p+r*{gap}))*Test_p", 1)
        options = {"max_iter": 100}
        if "user" in variant:
            options["max_res"] = 1e-9 * E * s * s
        newton = tools.Newton(m, **options)
        done = newton.solve()
        total = float(gf.asm_generic(mim, 0, f"neg_part(p+r*{gap})*({normal}.[0;0;1])", 1, m))
        runs.append(dict(finished=done, increments=1, iterations=newton.iterations, errors=[newton.message] if newton.message else []))
        forces.append(4 * abs(total) / s**2 if done else None)
    return result(forces, runs)
