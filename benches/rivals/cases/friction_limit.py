"""At the limit of friction: a rigid sled on an elastic slab, pressed by V and then drawn by H = .3 V.

Coulomb's law decides: with mu = .303 the sled holds, the shear of the slab carries H; with mu = .297 there is no
equilibrium, and a program must say so. The displacement of the sled that holds is held against finer meshes. Plane
strain, nu = 0, so that the slab is uniformly pressed before the sled is drawn."""
from lib import calculix as ccx
from lib import covact as cov
from lib.grid import Grid, even

TITLE = "sled at the limit of friction, +-1 %"
RIGHT = "mu 1 % above H/V holds, with the sled where a finer mesh has it; 1 % below has no equilibrium: must be told"
LIMIT = 0.05
E, NU, V, RATIO = 1000.0, 0.0, 4.0, 0.3
H = RATIO * V
SIZE, CELLS = (4.0, 1.0, 1.0), (32, 1, 8)
#: Displacement of the sled that holds: extrapolated from meshes of 32, 64 and 128 elements (.9226, .9376, .9431 e-3).
SHIFT = 9.45e-4
VARIANTS = {
    "covact": ["penalty", "augmented"],
    "calculix": [
        "C3D8I surface, K = 50 E, stick 5 E", "C3D8I surface, K = 50 E, stick 50 E",
        "C3D8I node, K = 50 E, stick 5 E", "C3D8I node, K = 50 E, stick 50 E",
    ],
    "getfem": ["Alart-Curnier, Q1, r = E"],
}


def judge(holds, slides, shift):
    """The row from both runs: `holds`, `slides` as the programs ended them."""
    error = None if shift is None or not holds["finished"] else abs(shift / SHIFT - 1)
    said = "; ".join(slides.get("errors", [])[:2])
    ran = dict(
        iterations=holds["iterations"] + slides["iterations"], increments=holds["increments"] + slides["increments"],
        finished=holds["finished"], late=holds.get("late") or slides.get("late"), errors=holds.get("errors", []), error=error, screen=holds.get("screen", ""),
    )
    first = f"above: {f'{shift:.6f}' if shift is not None else 'none'}" if holds["finished"] else "above: gives up"
    second = "below: converges" if slides["finished"] else "below: stops"
    ran["answer"] = f"{first}; {second}"
    if slides["finished"]:
        ran.update(verdict="wrong, silently", said="converged where no equilibrium exists")
    elif holds["finished"] and error is not None and error <= LIMIT:
        ran.update(verdict="right" if said else "stopped without a message", said=said)
    elif not holds["finished"]:
        ran["verdict"] = "gives up where it holds"
        ran["said"] = "; ".join(holds.get("errors", [])[:1])
    return ran


def scene(mu, variant, refine=1):
    found = {
        "covact": 1,
        "materials": {"slab": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
        "bodies": {"slab": {
            "mesh": {"block": {"min": [0, 0, 0], "max": SIZE, "elements": [refine * c for c in CELLS]}},
            "material": "slab",
            "element": "h8_displacement",
        }},
        "surfaces": {"sled": {
            "plane": {"center": [2, 0.5, 1], "normal": [0, 0, -1], "size": [8, 4]},
            "motion": {"free": {"force": {
                "z": {"table": [[0, 0], [1, -V], [2, -V]]}, "x": {"table": [[0, 0], [1, 0], [2, H]]},
            }}},
        }},
        "contacts": {"rub": {
            "slave": "slab.z_max", "master": "sled", "points": {"gauss": 2}, "friction": {"coulomb": {"mu": mu}},
        }},
        "supports": {"ground": {"on": "slab.z_min", "fixed": True}},
        "solution": {"end_time": 2, "step": {"initial": 1, "max": 1, "min": 1e-3}},
        "output": {"every": 0},
    }
    if variant == "augmented":
        found["contacts"]["rub"]["augmentation"] = {"gap": 1e-5, "slip": 1e-5}
    return found


def covact(folder, variant):
    import os

    runs = []
    for name, factor in (("above", 1.01), ("below", 0.99)):
        os.makedirs(os.path.join(folder, name))
        ran = cov.run(os.path.join(folder, name), scene(factor * RATIO, variant))
        ran["errors"] = [] if ran["finished"] else [" ".join(ran["screen"].split())]
        runs.append(ran)
    shift = runs[0]["rows"][-1]["displacement.sled.x"] if runs[0]["rows"] else None
    return judge(*runs, shift)


def calculix(folder, variant):
    import os

    kind = variant.split()[0]
    runs, shift = [], None
    for name, factor in (("above", 1.01), ("below", 0.99)):
        inner = os.path.join(folder, name)
        os.makedirs(inner)
        deck, sled = ccx_deck(kind, variant, factor * RATIO)
        runs.append(ccx.run(inner, deck))
        if name == "above" and runs[0]["finished"]:
            last = ccx.displacements(inner, "NREF")
            shift = last[max(last)][sled][0]
    return judge(*runs, shift)


def ccx_deck(kind, variant, mu):
    normal = float(variant.split("K = ")[1].split()[0]) * E
    stick = float(variant.split("stick ")[1].split()[0]) * E
    slab = Grid(*(even(0, size, cells) for size, cells in zip(SIZE, CELLS)))
    sled = Grid(even(-2, 6, 4), even(-1, 2, 1), [1, 1.5])
    deck = ccx.Deck()
    deck.body("SLAB", slab, kind)
    deck.body("SLED", sled, "C3D8")
    ref, turn = deck.node("NREF", (2, 0.5, 1)), deck.node("NROT", (2, 0.5, 1))
    deck.nodes_where("NGROUND", "SLAB", lambda x, y, z: z < 1e-9)
    deck.nodes_where("NSIDE", "SLAB", lambda x, y, z: z > 1e-9)
    deck.surface("SLAVE", "SLAB", slab, "z_max")
    deck.surface("MASTER", "SLED", sled, "z_min")
    deck.add(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{E}, {NU}")
    deck.add("*SOLID SECTION, ELSET=ESLAB, MATERIAL=SOLID\n*SOLID SECTION, ELSET=ESLED, MATERIAL=SOLID")
    deck.add(f"*RIGID BODY, NSET=NSLED, REF NODE={ref}, ROT NODE={turn}")
    deck.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{normal}, 1e-3")
    deck.add(f"*FRICTION\n{mu:.6f}, {stick}")
    deck.add(f"*CONTACT PAIR, INTERACTION=SI, TYPE={'NODE' if 'node' in variant else 'SURFACE'} TO SURFACE\nSLAVE, MASTER")
    deck.add(f"*BOUNDARY\nNGROUND, 1, 3\nNSIDE, 2, 2\n{turn}, 1, 3\n{ref}, 2, 2")
    load = f"*CLOAD\n{ref}, 3, {-V}"
    # The sled is guided along its path while it is pressed on, and let go afterwards.
    deck.add(f"*STEP, NLGEOM, INC=500\n*STATIC\n1., 1., 1e-3\n*BOUNDARY\n{ref}, 1, 1\n{load}\n*END STEP")
    deck.add(f"*STEP, NLGEOM, INC=500\n*STATIC\n1., 1., 1e-3\n*BOUNDARY, OP=NEW\nNGROUND, 1, 3\nNSIDE, 2, 2\n{turn}, 1, 3\n{ref}, 2, 2")
    deck.add(f"{load}\n{ref}, 1, {H}\n*NODE PRINT, NSET=NREF\nU\n*NODE PRINT, NSET=NGROUND, TOTALS=ONLY\nRF\n*END STEP")
    return deck, ref


def getfem(folder, variant):
    runs, shift = [], None
    for factor in (1.01, 0.99):
        m, newton, _kept = model(factor * RATIO)
        m.set_variable("load", [0, -V])
        done = newton.solve()
        increments = int(done)
        if done:
            m.set_variable("u0", m.variable("u"))
            m.set_variable("d0", m.variable("d"))
            m.set_variable("load", [H, -V])
            done = newton.solve()
            increments += int(done)
        if factor > 1 and done:
            shift = float(m.variable("d")[0])
        errors = [newton.message] if newton.message else []
        runs.append(dict(finished=done, increments=increments, iterations=newton.iterations, errors=errors))
    return judge(*runs, shift)


def model(mu):
    """Slab and sled; the sled's displacement `d` (x, z) is a variable of the model."""
    import getfem as gf
    import numpy as np
    from lib import gf as tools

    slab = Grid(*(even(0, size, cells) for size, cells in zip(SIZE, CELLS)))
    mesh = tools.mesh(slab, {1: "z_max", 2: "z_min", 3: "y_min", 4: "y_max"})
    fem = gf.MeshFem(mesh, 3)
    fem.set_fem(gf.Fem("FEM_QK(3,1)"))
    mim = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,4)"))
    m = gf.Model("real")
    m.add_fem_variable("u", fem)
    m.add_fem_data("u0", fem)
    m.add_variable("d", 2)
    m.add_initialized_data("d0", [0, 0])
    m.add_initialized_data("load", [0, 0])
    m.add_initialized_data("lam", E * NU / ((1 + NU) * (1 - 2 * NU)))
    m.add_initialized_data("shear", E / (2 * (1 + NU)))
    m.add_isotropic_linearized_elasticity_brick(mim, "u", "lam", "shear")
    tools.symmetry(m, mim, 3, E)
    tools.symmetry(m, mim, 4, E)
    m.add_Dirichlet_condition_with_simplification("u", 2)
    # Alart and Curnier's projection of the traction `s` on the slab (top at z = 1, normal along z).
    m.add_filtered_fem_variable("s", fem, 1)
    m.add_initialized_data("r", E)
    m.add_initialized_data("friction", mu)
    gap = "(d(2)-u(3))"
    slip = "[u(1)-u0(1)-d(1)+d0(1);u(2)-u0(2)]"
    pressure = f"neg_part(s(3)+r*{gap})"
    held = f"Ball_projection([s(1);s(2)]-r*{slip},friction*{pressure})"
    m.add_nonlinear_term(mim, "-s.Test_u", 1)
    m.add_nonlinear_term(mim, f"-(1/r)*((s(3)+{pressure})*Test_s(3)+([s(1);s(2)]-{held}).[Test_s(1);Test_s(2)])", 1)
    area = SIZE[0] * SIZE[1]
    m.add_nonlinear_term(mim, f"s(1)*Test_d(1)+s(3)*Test_d(2)-(load/{area}).Test_d", 1)
    # The sled begins slightly pressed on: without any contact nothing holds it.
    m.set_variable("d", [0, -1e-3])
    return m, tools.Newton(m, max_iter=100), (mesh, fem, mim)
