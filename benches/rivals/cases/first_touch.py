"""A heavy ball hangs .05 above a cushion and is let go: its weight is all that drives it, the cushion all that stops it.

At rest the floor carries the weight, and the ball has sunk by what the same ball, lowered by hand to the same force, has."""
import math

from lib import calculix as ccx
from lib import covact as cov
from lib.grid import Grid, even

TITLE = "ball falls on a cushion: first touch"
RIGHT = "the floor carries the weight"
LIMIT = 1e-3
E, NU, R, GAP, SIDE, CELLS, WEIGHT = 1000.0, 0.3, 10.0, 0.05, 4.0, 6, 500.0
VARIANTS = {
    "covact": ["as it is"],
    "calculix": ["C3D8I surface", "C3D8I node", "C3D8I surface, weak spring at the ball"],
    "getfem": ["as it is", "weak spring at the ball", "begins .01 in the cushion"],
}
#: A spring that takes 5e-4 of the weight.
SPRING = 5e-4 * WEIGHT / 0.24


def result(carried, sunk, ran):
    if not ran["finished"] or carried is None:
        return dict(answer="", error=None, **ran)
    return dict(answer=f"floor carries {100 * carried / WEIGHT:.3f} %, ball sinks {sunk:.5f}", error=abs(carried / WEIGHT - 1), **ran)


def covact(folder, variant):
    ran = cov.run(folder, {
        "covact": 1,
        "materials": {"soft": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
        "bodies": {"cushion": {
            "mesh": {"block": {"min": [0, 0, -SIDE], "max": [SIDE, SIDE, 0], "elements": [CELLS] * 3}},
            "material": "soft",
            "element": "h8_displacement",
        }},
        "surfaces": {"ball": {
            "sphere": {"radius": R, "center": [0, 0, R + GAP]},
            "motion": {"free": {"force": {"z": {"table": [[0, 0], [1, -WEIGHT / 4]]}}}},
        }},
        "contacts": {"lie": {"slave": "cushion.z_max", "master": "ball", "points": {"gauss": 2}}},
        "supports": {
            "floor": {"on": "cushion.z_min", "fixed": True},
            "symmetry_x": {"on": "cushion.x_min", "symmetry": "x"},
            "symmetry_y": {"on": "cushion.y_min", "symmetry": "y"},
        },
        "solution": {"step": {"initial": 1, "max": 1}},
        "output": {"every": 0},
    })
    if not ran["rows"]:
        return result(None, None, ran)
    last = ran["rows"][-1]
    return result(4 * last["force.floor.z"], -last["displacement.ball.z"] - GAP, ran)


def calculix(folder, variant):
    block = Grid(even(0, SIDE, CELLS), even(0, SIDE, CELLS), even(-SIDE, 0, CELLS))
    cap = Grid(
        even(0, 4.5, 16), even(0, 4.5, 16), [0, 1],
        lambda x, y, z: (x, y, GAP + R - math.sqrt(R * R - x * x - y * y) + z),
    )
    deck = ccx.Deck()
    deck.body("BLOCK", block, "C3D8I")
    deck.body("CAP", cap, "C3D8")
    ref, turn = deck.node("NREF", (0, 0, R + GAP)), deck.node("NROT", (0, 0, R + GAP))
    if "spring" in variant:
        deck.add(f"*ELEMENT, TYPE=SPRING1, ELSET=ESPRING\n{deck.elements + 1}, {ref}\n*SPRING, ELSET=ESPRING\n3\n{SPRING / 4}")
    deck.surface("SLAVE", "BLOCK", block, "z_max")
    deck.surface("MASTER", "CAP", cap, "z_min")
    deck.nodes_where("NFLOOR", "BLOCK", lambda x, y, z: z < 1e-9 - SIDE)
    deck.nodes_where("NX", "BLOCK", lambda x, y, z: x < 1e-9 and z > 1e-9 - SIDE)
    deck.nodes_where("NY", "BLOCK", lambda x, y, z: y < 1e-9 and z > 1e-9 - SIDE)
    deck.add(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{E}, {NU}")
    deck.add("*SOLID SECTION, ELSET=EBLOCK, MATERIAL=SOLID\n*SOLID SECTION, ELSET=ECAP, MATERIAL=SOLID")
    deck.add(f"*RIGID BODY, NSET=NCAP, REF NODE={ref}, ROT NODE={turn}")
    deck.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{50 * E}, 1e-3")
    deck.add(f"*CONTACT PAIR, INTERACTION=SI, TYPE={'NODE' if 'node' in variant else 'SURFACE'} TO SURFACE\nSLAVE, MASTER")
    deck.add(f"*BOUNDARY\nNFLOOR, 1, 3\nNX, 1, 1\nNY, 2, 2\n{turn}, 1, 3\n{ref}, 1, 2")
    deck.add(f"*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1.\n*CLOAD\n{ref}, 3, {-WEIGHT / 4}")
    deck.add("*NODE PRINT, NSET=NFLOOR, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=NREF\nU\n*END STEP")
    ran = ccx.run(folder, deck)
    force = ccx.totals(folder, "NFLOOR")
    if not ran["finished"] or not force:
        return result(None, None, ran)
    places = ccx.displacements(folder, "NREF")
    return result(4 * force[-1][3], -places[max(places)][ref][2] - GAP, ran)


def getfem(folder, variant):
    import getfem as gf
    from lib import gf as tools

    grid = Grid(even(0, SIDE, CELLS), even(0, SIDE, CELLS), even(-SIDE, 0, CELLS))
    mesh = tools.mesh(grid, {1: "z_max", 2: "x_min", 3: "y_min", 4: "z_min"})
    fem = gf.MeshFem(mesh, 3)
    fem.set_fem(gf.Fem("FEM_QK(3,1)"))
    one = gf.MeshFem(mesh, 1)
    one.set_fem(gf.Fem("FEM_QK(3,1)"))
    mim = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,4)"))
    m = gf.Model("real")
    m.add_fem_variable("u", fem)
    m.add_variable("d", 1)
    m.add_initialized_data("load", [0.0])
    m.add_initialized_data("lame", [E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))])
    m.add_finite_strain_elasticity_brick(mim, "SaintVenant Kirchhoff", "u", "lame")
    tools.symmetry(m, mim, 2, E / SIDE)
    tools.symmetry(m, mim, 3, E / SIDE)
    m.add_Dirichlet_condition_with_simplification("u", 4)
    m.add_initialized_data("r", E * CELLS / SIDE)
    m.add_filtered_fem_variable("p", one, 1)
    away = f"(X+u-[0;0;{R + GAP}+d])"
    gap, normal = f"(Norm({away})-{R})", f"Normalized({away})"
    pressure = f"neg_part(p+r*{gap})"
    m.add_nonlinear_term(mim, f"-{pressure}*({normal}.Test_u)", 1)
    m.add_nonlinear_term(mim, f"-(1/r)*(p+{pressure})*Test_p", 1)
    spring = SPRING / 4 if "spring" in variant else 0.0
    area = SIDE * SIDE
    m.add_nonlinear_term(mim, f"({pressure}*({normal}.[0;0;1])+({spring}*d+load)/{area})*Test_d", 1)
    if "begins" in variant:
        m.set_variable("d", [-GAP - 0.01])
    newton = tools.Newton(m, max_iter=100)
    done, steps, _ = tools.march(m, newton, lambda t: m.set_variable("load", [t * WEIGHT / 4]), step=0.1)
    ran = dict(finished=done, increments=steps, iterations=newton.iterations, errors=[newton.message] if newton.message else [])
    carried = 4 * abs(float(gf.asm_generic(mim, 0, f"{pressure}*({normal}.[0;0;1])", 1, m)))
    return result(carried, -float(m.variable("d")[0]) - GAP, ran)
