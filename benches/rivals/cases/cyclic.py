"""The plate and the ball of `plate`, pushed 5 deep and lifted 1 clear, twenty times, each stroke in one step.

Nothing is lost in an elastic plate without friction: the force of every stroke is that of the first, and there is none when
the ball is clear."""
from lib import calculix as ccx
from lib import covact as cov

from . import plate

TITLE = "contact opens and closes 20 times"
RIGHT = "every stroke gives the force of the first, none when open"
LIMIT = 1e-3
DEEP, CLEAR, STROKES = 5.0, 1.0, 20
VARIANTS = {
    "covact": ["H8 12 x 12"],
    "calculix": ["C3D8I 12 x 12, surface, K = 5 E", "C3D8I 12 x 12, node, K = 5 E"],
    "getfem": ["Q2 6 x 6", "Q2 6 x 6, line search `simplest`"],
}


def result(closed, opened, ran):
    worst = max(abs(f / closed[0] - 1) for f in closed)
    left = max(abs(f / closed[0]) for f in opened)
    answer = f"force {closed[0]:.1f}, changes by {100 * worst:.1e} %, open {100 * left:.1e} %, {len(closed)} strokes"
    return dict(answer=answer, error=max(worst, left), **ran)


def covact(folder, variant):
    scene = plate.scene(12, end_time=2 * STROKES)
    table = [[t, -DEEP if t % 2 else CLEAR] for t in range(2 * STROKES + 1)]
    scene["surfaces"]["ball"]["motion"]["translation"][2] = {"table": table}
    ran = cov.run(folder, scene)
    forces = {round(r["time"]): -4 * r["force.ball.z"] for r in ran["rows"] if abs(r["time"] - round(r["time"])) < 1e-9}
    return strokes(forces, ran)


def strokes(forces, ran):
    closed = [f for t, f in sorted(forces.items()) if t % 2 and t > 0]
    opened = [f for t, f in sorted(forces.items()) if t % 2 == 0 and t > 0]
    if len(opened) < STROKES:
        return dict(answer=f"{len(closed)} strokes of {STROKES}", error=None, **ran)
    return result(closed, opened, ran)


def calculix(folder, variant):
    kind, elements = variant.split()[0], int(variant.split()[1])
    deck = plate.deck(kind, elements, "node" in variant)
    for stroke in range(1, 2 * STROKES + 1):
        deck.add(f"*STEP, NLGEOM, INC=1000\n*STATIC\n1., 1.\n*BOUNDARY\nNBALL, 3, 3, {-DEEP if stroke % 2 else CLEAR}")
        if stroke == 1:
            deck.add("*NODE PRINT, NSET=NBALL, TOTALS=ONLY\nRF")
        deck.add("*END STEP")
    ran = ccx.run(folder, deck)
    found = {round(t): -4 * z for t, _, _, z in ccx.totals(folder, "NBALL") if abs(t - round(t)) < 1e-6}
    return strokes(found, ran)


def getfem(folder, variant):
    from lib import gf as tools

    m, force = plate.model(int(variant.split()[1]))
    search = {"lsearch": "simplest"} if "simplest" in variant else {}
    newton = tools.Newton(m, max_iter=60, max_res=1e-6, **search)
    place = lambda z: m.set_variable("c", [0, 0, plate.R + plate.T / 2 + z])
    forces, steps, z, done = {}, 0, 0.0, True
    for stroke in range(1, 2 * STROKES + 1):
        goal = -DEEP if stroke % 2 else CLEAR
        begin = z
        done, more, _ = tools.march(m, newton, lambda t: place(begin + t * (goal - begin)))
        steps, z = steps + more, goal
        if not done:
            break
        forces[stroke] = abs(force())
    ran = dict(finished=done, increments=steps, iterations=newton.iterations, errors=[newton.message] if newton.message else [])
    return strokes(forces, ran)
