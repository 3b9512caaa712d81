"""GetFEM: meshes from grids, regions, the standard Newton."""
import getfem
import numpy as np


def version():
    import subprocess

    done = subprocess.run(["dpkg-query", "-W", "-f=${Version}", "python3-getfem"], capture_output=True, text=True)
    return done.stdout.split("+")[0].split("-")[0] or "?"


def mesh(grid, regions):
    """Mesh of trilinear hexahedra; `regions` maps a number to a side of the grid."""
    result = getfem.Mesh("empty", 3)
    points, cells = grid.linear()
    kind = getfem.GeoTrans("GT_QK(3,1)")
    points = np.array(points)
    # GetFEM numbers the corners of a cell along x first, then y, then z.
    for c in cells:
        result.add_convex(kind, points[[c[i] for i in (0, 1, 3, 2, 4, 5, 7, 6)]].T)
    for number, side in regions.items():
        axis, end = "xyz".index(side[0]), side[2:]
        # Faces of GT_QK(3,1): 0 is x = 1, 1 is x = 0, 2 is y = 1, ...
        face = 2 * axis + (end == "min")
        result.set_region(number, np.array([[n, face] for n in grid.side(side)]).T)
    return result


def symmetry(model, mim, region, stiffness, name="u"):
    """No displacement along the normal of a region, by a penalty 1e8 times as stiff as the body."""
    model.add_linear_term(mim, f"{1e8 * stiffness:.6e}*({name}.Normal)*(Test_{name}.Normal)", region)


class Newton:
    """Counts what the standard solver takes; `solve` is False where it gives up."""

    def __init__(self, model, **options):
        self.model, self.iterations, self.solves = model, 0, 0
        self.options = []
        for key, value in options.items():
            self.options += [key, value]

    def solve(self):
        self.solves += 1
        try:
            count, converged = self.model.solve(*self.options)
        except RuntimeError as problem:
            self.message = str(problem).strip().splitlines()[-1]
            return False
        self.iterations += int(count)
        self.message = "" if converged else "the iterations are used up"
        return bool(converged)


def march(model, newton, set_time, end=1.0, step=1.0, smallest=1 / 64, start=0.0):
    """From `start` to `end`; a step that fails is halved from the last good state, by this script, as GetFEM has no
    step control of its own. Returns (reached the end, accepted steps, time reached)."""
    time, steps, good = start, 0, model.from_variables()
    while time < end - 1e-12:
        set_time(min(time + step, end))
        if newton.solve() and np.all(np.isfinite(model.from_variables())):
            time, steps, good = min(time + step, end), steps + 1, model.from_variables()
            continue
        model.to_variables(good)
        step *= 0.5
        if step < smallest * (1 - 1e-9):
            return False, steps, time
    return True, steps, time
