"""A rigid die (cylinder) pressed into a slab in plane strain and drawn along it over eight elements, without friction.

Without friction nothing resists the motion: away from the slab's ends the pressing force is steady and the resistance
is zero. What is left, largest resistance over pressing force, is the noise of meeting one element after the other."""
import math

from lib import calculix as ccx
from lib import covact as cov
from lib.grid import Grid, even

TITLE = "die slides over the elements' borders"
RIGHT = "no friction, no resistance: largest resistance / pressing force"
LIMIT = 0.02
E, NU, R, DEPTH, WAY, STEPS = 10.0, 0.3, 4.0, 0.4, 3.0, 60
SIZE, CELLS, START = (12.0, 0.375, 3.0), (32, 1, 4), 4.5
VARIANTS = {
    "covact": ["H8, Gauss 2, penalty 3 E / h"],
    "calculix": [
        "C3D8I surface, K = 5 E", "C3D8I surface, K = 50 E", "C3D8I node, K = 50 E", "C3D20R surface, K = 5 E",
        "C3D20R surface, K = 50 E",
    ],
    "getfem": ["Q1, multiplier Q1", "Q2, multiplier Q1"],
}


def result(forces, ran):
    """`forces`: (resistance, pressing force) at the steps of the slide."""
    if not ran["finished"] or len(forces) < STEPS:
        return dict(answer=f"{len(forces)} steps of {STEPS}", error=None, **ran)
    worst = max(abs(h) for h, _ in forces) / (sum(v for _, v in forces) / len(forces))
    presses = [v for _, v in forces]
    answer = f"resistance {100 * worst:.2f} %, pressing force {min(presses):.3f} to {max(presses):.3f}"
    return dict(answer=answer, error=worst, **ran)


def covact(folder, variant):
    ran = cov.run(folder, {
        "covact": 1,
        "materials": {"slab": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
        "bodies": {"slab": {
            "mesh": {"block": {"min": [0, 0, -SIZE[2]], "max": [SIZE[0], SIZE[1], 0], "elements": CELLS}},
            "material": "slab",
        }},
        "surfaces": {"die": {
            "cylinder": {"radius": R, "length": 2, "center": [START, 0, R]},
            "motion": {"translation": [
                {"table": [[0, 0], [1, 0], [2, WAY]]}, 0, {"table": [[0, 0], [1, -DEPTH], [2, -DEPTH]]},
            ]},
        }},
        "contacts": {"iron": {
            "slave": "slab.z_max", "master": "die", "points": {"gauss": 2}, "penalty": {"scaled": 3},
        }},
        "supports": {
            "floor": {"on": "slab.z_min", "fixed": True},
            "front": {"on": "slab.y_min", "symmetry": "y"},
            "back": {"on": "slab.y_max", "symmetry": "y"},
        },
        "solution": {"end_time": 2, "step": {"initial": 1 / STEPS, "max": 1 / STEPS, "adaptive": False}},
        "output": {"every": 0},
    })
    return result([(r["force.die.x"], -r["force.die.z"]) for r in ran["rows"] if r["time"] > 1 + 1e-9], ran)


def slab(cells=CELLS):
    return Grid(even(0, SIZE[0], cells[0]), even(0, SIZE[1], cells[1]), even(-SIZE[2], 0, cells[2]))


def calculix(folder, variant):
    kind = variant.split()[0]
    body = slab((16, 1, 2) if "20" in kind else CELLS)
    # The lower side of the cylinder within 50 degrees, as one layer of elements; as wide as the slab and more.
    die = Grid(
        even(-5 * math.pi / 18, 5 * math.pi / 18, 96), [-0.5, 1], [0, 0.5],
        lambda a, y, inside: (START + (R - inside) * math.sin(a), y, R - (R - inside) * math.cos(a)),
    )
    deck = ccx.Deck()
    deck.body("SLAB", body, kind)
    deck.body("DIE", die, "C3D20R" if "20" in kind else "C3D8")
    deck.surface("SLAVE", "SLAB", body, "z_max")
    deck.surface("MASTER", "DIE", die, "z_min")
    deck.nodes_where("NFLOOR", "SLAB", lambda x, y, z: z < 1e-9 - SIZE[2])
    deck.nodes_where("NSIDE", "SLAB", lambda x, y, z: z > 1e-9 - SIZE[2] and (y < 1e-9 or y > SIZE[1] - 1e-9))
    deck.add(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{E}, {NU}")
    deck.add("*SOLID SECTION, ELSET=ESLAB, MATERIAL=SOLID\n*SOLID SECTION, ELSET=EDIE, MATERIAL=SOLID")
    k = float(variant.split("K = ")[1].split()[0]) * E
    deck.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{k}, 1e-3")
    deck.add(f"*CONTACT PAIR, INTERACTION=SI, TYPE={'NODE' if 'node' in variant else 'SURFACE'} TO SURFACE\nSLAVE, MASTER")
    deck.add("*BOUNDARY\nNFLOOR, 1, 3\nNSIDE, 2, 2\nNDIE, 2, 2")
    for x, z, step in ((0, -DEPTH, 0.1), (WAY, -DEPTH, 1 / STEPS)):
        deck.add(f"*STEP, NLGEOM, INC=2000\n*STATIC\n{step:.9f}, 1., 1e-5, {step:.9f}")
        deck.add(f"*BOUNDARY\nNDIE, 1, 1, {x}\nNDIE, 3, 3, {z}\n*NODE PRINT, NSET=NDIE, TOTALS=ONLY\nRF\n*END STEP")
    ran = ccx.run(folder, deck)
    return result([(x, -z) for t, x, _, z in ccx.totals(folder, "NDIE") if t > 1 + 1e-6], ran)


def getfem(folder, variant):
    import getfem as gf
    from lib import gf as tools

    degree = int(variant[1])
    mesh = tools.mesh(slab((16, 1, 2) if degree == 2 else CELLS), {1: "z_max", 2: "z_min", 3: "y_min", 4: "y_max"})
    fem = gf.MeshFem(mesh, 3)
    fem.set_fem(gf.Fem(f"FEM_QK(3,{degree})"))
    one = gf.MeshFem(mesh, 1)
    one.set_fem(gf.Fem("FEM_QK(3,1)"))
    mim = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,6)"))
    m = gf.Model("real")
    m.add_fem_variable("u", fem)
    m.add_initialized_data("lame", [E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))])
    m.add_finite_strain_elasticity_brick(mim, "SaintVenant Kirchhoff", "u", "lame")
    tools.symmetry(m, mim, 3, E)
    tools.symmetry(m, mim, 4, E)
    m.add_Dirichlet_condition_with_simplification("u", 2)
    m.add_initialized_data("c", [START, 0, R])
    m.add_initialized_data("r", E)
    m.add_filtered_fem_variable("p", one, 1)
    away = "[X(1)+u(1)-c(1);0;X(3)+u(3)-c(3)]"
    gap, normal = f"(Norm({away})-{R})", f"Normalized({away})"
    m.add_nonlinear_term(mim, f"-neg_part(p+r*{gap})*({normal}.Test_u)", 1)
    m.add_nonlinear_term(mim, f"-(1/r)*(p+neg_part(p+r*{gap}))*Test_p", 1)
    newton = tools.Newton(m, max_iter=60, max_res=1e-8 * E)
    total = lambda axis: float(gf.asm_generic(mim, 0, f"neg_part(p+r*{gap})*({normal}.{axis})", 1, m))
    done, steps, _ = tools.march(m, newton, lambda t: m.set_variable("c", [START, 0, R - DEPTH * t]), step=0.1)
    forces = []
    while done and len(forces) < STEPS:
        at = len(forces)
        done, more, _ = tools.march(
            m, newton, lambda t: m.set_variable("c", [START + WAY * (at + t) / STEPS, 0, R - DEPTH])
        )
        steps += more
        forces.append((total("[1;0;0]"), abs(total("[0;0;1]"))))
    ran = dict(finished=done, increments=steps, iterations=newton.iterations, errors=[newton.message] if newton.message else [])
    return result(forces, ran)
