"""Structured hexahedral meshes, the same for every program.

A grid is three ascending lists of coordinates and a map of its points into space. Nodes are numbered along x first, then
y, then z, from 0. Linear elements have 8 nodes, serendipity ones 20 (the mid-edge points of the grid's cells)."""
import itertools


def fine(length, fine_length, fine_cells, growth=1.35):
    """Coordinates from 0 to `length`: equal cells up to `fine_length`, then cells that grow by about `growth`."""
    h = fine_length / fine_cells
    rest = length - fine_length
    n = 1
    while sum(h * growth**k for k in range(1, n + 1)) < rest:
        n += 1
    # The growth for which n cells end at `length`, by bisection.
    low, high = 1.0, growth
    for _ in range(200):
        mid = 0.5 * (low + high)
        if sum(h * mid**k for k in range(1, n + 1)) < rest:
            low = mid
        else:
            high = mid
    x = [i * h for i in range(fine_cells + 1)]
    for k in range(1, n + 1):
        x.append(x[-1] + h * high**k)
    x[-1] = length
    return x


def even(start, end, cells):
    return [start + (end - start) * i / cells for i in range(cells + 1)]


class Grid:
    """Hexahedra over the product of three coordinate lists; `place` maps (x, y, z) into space."""

    def __init__(self, xs, ys, zs, place=None):
        self.axes = (list(xs), list(ys), list(zs))
        self.place = place or (lambda x, y, z: (x, y, z))
        self.cells = tuple(len(a) - 1 for a in self.axes)

    def linear(self):
        """(points, hexahedra of 8 nodes in the order of C3D8)"""
        nx, ny, nz = (c + 1 for c in self.cells)
        points = [
            self.place(x, y, z) for z in self.axes[2] for y in self.axes[1] for x in self.axes[0]
        ]
        number = lambda i, j, k: i + nx * (j + ny * k)
        corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        cells = itertools.product(range(nz - 1), range(ny - 1), range(nx - 1))
        return points, [[number(i + a, j + b, k + c) for a, b, c in corners] for k, j, i in cells]

    def serendipity(self):
        """(points, hexahedra of 20 nodes in the order of C3D20)"""
        halves = [[0.5 * (a[i // 2] + a[(i + 1) // 2]) for i in range(2 * len(a) - 1)] for a in self.axes]
        index, points = {}, []
        for (k, z), (j, y), (i, x) in itertools.product(
            enumerate(halves[2]), enumerate(halves[1]), enumerate(halves[0])
        ):
            if (i % 2) + (j % 2) + (k % 2) <= 1:
                index[i, j, k] = len(points)
                points.append(self.place(x, y, z))
        corner = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
        edge = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)]
        rise = [(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
        cells = itertools.product(*(range(c) for c in reversed(self.cells)))
        return points, [
            [index[2 * i + a, 2 * j + b, 2 * k + c] for a, b, c in corner + edge + rise] for k, j, i in cells
        ]

    def side(self, name):
        """Numbers of the elements along a side: `x_min`, ..., `z_max`."""
        axis, end = "xyz".index(name[0]), name[2:]
        nx, ny, nz = self.cells
        at = 0 if end == "min" else self.cells[axis] - 1
        return [
            n
            for n, (k, j, i) in enumerate(itertools.product(range(nz), range(ny), range(nx)))
            if (i, j, k)[axis] == at
        ]


#: Face of a C3D8 or C3D20 element of a grid on every side.
FACE = {"z_min": "S1", "z_max": "S2", "y_min": "S3", "x_max": "S4", "y_max": "S5", "x_min": "S6"}
