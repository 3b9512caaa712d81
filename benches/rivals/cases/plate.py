"""A ball of radius 25 pushed 10 deep into a clamped plate of 100 x 100 x 2 (a quarter of it): five thicknesses, asked for
in one single step. Every program may cut it by its own step control.

The force of the whole plate, 16600 +- 60: linear solid-shells of 80 x 80 elements and quadratic ones of 20 x 20, one
layer, end at 16577, two layers at 16640, by two independent programs (docs/verification.md, "Plate under a ball")."""
import math

from lib import calculix as ccx
from lib import covact as cov
from lib.grid import Grid, even

TITLE = "plate under a ball, five thicknesses in one step"
RIGHT = "converged reference: force 16600 +- .4 %"
LIMIT = 0.02
E, NU, R, T, SIDE, DEPTH, FORCE = 12000.0, 0.3, 25.0, 2.0, 50.0, 10.0, 16600.0
VARIANTS = {
    "covact": ["H8 25 x 25"],
    "calculix": ["C3D20R 10 x 10, surface, K = 5 E", "C3D8I 20 x 20, surface, K = 5 E", "C3D8I 20 x 20, node, K = 5 E"],
    "getfem": ["Q2 10 x 10, one solve", "Q2 10 x 10, steps halved by the script"],
}


def result(force, ran):
    return dict(answer=f"F {force:.0f}", error=abs(force / FORCE - 1), **ran)


def scene(elements=25, motion=f"-{DEPTH}*t", **solution):
    return {
        "covact": 1,
        "materials": {"plate": {"st_venant_kirchhoff": {"E": E, "nu": NU}}},
        "bodies": {"plate": {
            "mesh": {"plate": {"size": [SIDE, SIDE], "thickness": T, "elements": [elements, elements]}},
            "material": "plate",
        }},
        "surfaces": {"ball": {
            "sphere": {"radius": R, "center": [0, 0, R + T / 2]}, "motion": {"translation": [0, 0, motion]},
        }},
        "contacts": {"press": {"slave": "plate.top", "master": "ball", "points": {"gauss": 2}, "penalty": {"value": 5 * E}}},
        "supports": {
            "clamped_x": {"on": "plate.x_max", "fixed": True},
            "clamped_y": {"on": "plate.y_max", "fixed": True},
            "symmetry_x": {"on": "plate.x_min", "symmetry": "x"},
            "symmetry_y": {"on": "plate.y_min", "symmetry": "y"},
        },
        "solution": {"step": {"initial": 1, "max": 1}, **solution},
        "output": {"every": 0},
    }


def covact(folder, variant):
    ran = cov.run(folder, scene())
    # The force is an answer only where the ball has arrived.
    if not ran["finished"]:
        return dict(answer="", error=None, **ran)
    return result(-4 * ran["rows"][-1]["force.ball.z"], ran)


def deck(kind, elements, node, stiffness=5):
    """Plate, ball, contact and supports; the ball's nodes are `NBALL`."""
    plate = Grid(even(0, SIDE, elements), even(0, SIDE, elements), [-T / 2, T / 2])
    # A quarter of the ball's lower side as one layer of elements between two spheres: rays through a grid of angles.
    def ray(a, b, inside):
        d = math.tan(a), math.tan(b), -1.0
        length = math.hypot(*d)
        return tuple(c * (R - inside) / length + o for c, o in zip(d, (0, 0, R + T / 2)))

    ball = Grid(even(0, math.pi / 4, 16), even(0, math.pi / 4, 16), [0, 5], ray)
    d = ccx.Deck()
    d.body("PLATE", plate, kind)
    d.body("BALL", ball, "C3D20R" if "20" in kind else "C3D8")
    d.surface("SLAVE", "PLATE", plate, "z_max")
    d.surface("MASTER", "BALL", ball, "z_min")
    d.nodes_where("NHELD", "PLATE", lambda x, y, z: x > SIDE - 1e-9 or y > SIDE - 1e-9)
    d.nodes_where("NX", "PLATE", lambda x, y, z: x < 1e-9 and y < SIDE - 1e-9)
    d.nodes_where("NY", "PLATE", lambda x, y, z: y < 1e-9 and x < SIDE - 1e-9)
    d.add(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{E}, {NU}")
    d.add("*SOLID SECTION, ELSET=EPLATE, MATERIAL=SOLID\n*SOLID SECTION, ELSET=EBALL, MATERIAL=SOLID")
    d.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{stiffness * E}, 1e-3")
    d.add(f"*CONTACT PAIR, INTERACTION=SI, TYPE={'NODE' if node else 'SURFACE'} TO SURFACE\nSLAVE, MASTER")
    d.add("*BOUNDARY\nNHELD, 1, 3\nNX, 1, 1\nNY, 2, 2\nNBALL, 1, 2")
    return d


def calculix(folder, variant):
    kind, elements = variant.split()[0], int(variant.split()[1])
    d = deck(kind, elements, "node" in variant)
    d.add(f"*STEP, NLGEOM, INC=1000\n*STATIC\n1., 1.\n*BOUNDARY\nNBALL, 3, 3, {-DEPTH}")
    d.add("*NODE PRINT, NSET=NBALL, TOTALS=ONLY\nRF\n*END STEP")
    ran = ccx.run(folder, d)
    force = ccx.totals(folder, "NBALL")
    if not ran["finished"] or not force:
        return dict(answer=f"reached {100 * ran['time']:.0f} %", error=None, **ran)
    return result(-4 * force[-1][3], ran)


def model(elements):
    """The plate against a ball whose centre is the data `c`, by the brick of large sliding contact."""
    import getfem as gf
    from lib import gf as tools

    plate = Grid(even(0, SIDE, elements), even(0, SIDE, elements), [-T / 2, T / 2])
    mesh = tools.mesh(plate, {1: "z_max", 2: "x_min", 3: "y_min", 4: "x_max", 5: "y_max"})
    mesh.region_merge(4, 5)
    fem = gf.MeshFem(mesh, 3)
    fem.set_fem(gf.Fem("FEM_QK(3,2)"))
    one = gf.MeshFem(mesh, 1)
    one.set_fem(gf.Fem("FEM_QK(3,1)"))
    mim = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,6)"))
    m = gf.Model("real")
    m.add_fem_variable("u", fem)
    m.add_initialized_data("lame", [E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))])
    m.add_finite_strain_elasticity_brick(mim, "SaintVenant Kirchhoff", "u", "lame")
    tools.symmetry(m, mim, 2, E / SIDE)
    tools.symmetry(m, mim, 3, E / SIDE)
    m.add_Dirichlet_condition_with_simplification("u", 4)
    # Multiplier and augmentation as in GetFEM's tutorial on a wheel in contact, the ball's distance in closed form.
    m.add_initialized_data("c", [0, 0, R + T / 2])
    m.add_initialized_data("r", E / T)
    m.add_filtered_fem_variable("p", one, 1)
    gap = f"(Norm(X+u-c)-{R})"
    normal = "Normalized(X+u-c)"
    m.add_nonlinear_term(mim, f"-neg_part(p+r*{gap})*({normal}.Test_u)", 1)
    m.add_nonlinear_term(mim, f"-(1/r)*(p+neg_part(p+r*{gap}))*Test_p", 1)
    total = f"neg_part(p+r*{gap})*({normal}.[0;0;1])"
    return m, lambda: -4 * float(gf.asm_generic(mim, 0, total, 1, m))


def getfem(folder, variant):
    from lib import gf as tools

    m, force = model(10)
    newton = tools.Newton(m, max_iter=60, max_res=1e-6)
    place = lambda t: m.set_variable("c", [0, 0, R + T / 2 - DEPTH * t])
    done, steps, time = tools.march(m, newton, place, smallest=1 if "one" in variant else 1 / 64)
    ran = dict(finished=done, increments=steps, iterations=newton.iterations, errors=[newton.message] if newton.message else [])
    if not done:
        return dict(answer=f"reached {100 * time:.0f} %", error=None, **ran)
    return result(abs(force()), ran)
