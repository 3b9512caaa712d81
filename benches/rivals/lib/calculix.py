"""CalculiX: decks from grids, runs, what `.dat`, `.sta` and the screen say."""
import os
import re
import signal
import subprocess

from .grid import FACE


class Deck:
    """Nodes, elements, sets and surfaces of several grids in one deck; text of steps is written by the case."""

    def __init__(self):
        self.lines = []
        self.nodes = 0
        self.elements = 0
        self.points = {}
        self.first = {}

    def add(self, text):
        self.lines.append(text.strip("\n"))

    def body(self, name, grid, kind):
        """Adds a body; `kind` is an element type. Node set `N<name>`, element set `E<name>`."""
        points, cells = grid.serendipity() if "20" in kind else grid.linear()
        node, element = self.nodes, self.elements
        self.add(f"*NODE, NSET=N{name}")
        self.add("\n".join(f"{node + i + 1}, {x:.12e}, {y:.12e}, {z:.12e}" for i, (x, y, z) in enumerate(points)))
        self.add(f"*ELEMENT, TYPE={kind}, ELSET=E{name}")
        for i, c in enumerate(cells):
            numbers = [str(element + i + 1)] + [str(node + n + 1) for n in c]
            # At most 16 entries a line.
            self.add(", ".join(numbers[:16]) + ("," if len(numbers) > 16 else ""))
            if len(numbers) > 16:
                self.add(", ".join(numbers[16:]))
        self.points[name] = [(node + i + 1, p) for i, p in enumerate(points)]
        self.first[name] = element
        self.nodes += len(points)
        self.elements += len(cells)

    def node(self, name, point):
        """A node of its own, e.g. the reference node of a rigid body; returns its number."""
        self.nodes += 1
        self.add(f"*NODE, NSET={name}\n{self.nodes}, " + ", ".join(f"{c:.12e}" for c in point))
        return self.nodes

    def nodes_where(self, name, body, test):
        """A node set of the nodes of a body for whose point `test` holds."""
        found = [n for n, p in self.points[body] if test(*p)]
        self.add(f"*NSET, NSET={name}")
        self.add(",\n".join(str(n) for n in found))
        return found

    def surface(self, name, body, grid, side, test=lambda n: True):
        """A surface of the faces of a side of a grid."""
        self.add(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        self.add("\n".join(f"{self.first[body] + n + 1}, {FACE[side]}" for n in grid.side(side) if test(n)))

    def text(self):
        return "\n".join(self.lines) + "\n"


def run(folder, deck):
    """Runs a deck; returns what the screen said, the increments and how it ended."""
    with open(os.path.join(folder, "deck.inp"), "w") as file:
        file.write(deck.text() if isinstance(deck, Deck) else deck)
    done = subprocess.run(["ccx", "deck"], cwd=folder, capture_output=True, text=True, errors="replace")
    screen = done.stdout + done.stderr
    with open(os.path.join(folder, "screen.txt"), "w") as file:
        file.write(screen)
    increments, iterations, attempts = 0, 0, 0
    path = os.path.join(folder, "deck.cvg")
    if os.path.exists(path):
        with open(path) as file:
            for line in file:
                if re.match(r"\s*\d+\s+\d+\s+\d+\s+\d+\s", line):
                    iterations += 1
    path = os.path.join(folder, "deck.sta")
    time = 0.0
    if os.path.exists(path):
        with open(path) as file:
            for line in file:
                words = line.split()
                if len(words) >= 7 and words[0].isdigit():
                    attempts += 1
                    if not words[2].endswith("U"):
                        increments += 1
                        time = float(words[4])
    errors = [l.strip() for l in re.findall(r"\*ERROR[^\n]*(?:\n[^\n*]+)?", screen)]
    finished = "Job finished" in screen and done.returncode == 0
    return {
        "finished": finished,
        "code": done.returncode,
        "late": done.returncode == -signal.SIGXCPU,
        "increments": increments,
        "iterations": iterations,
        "time": time,
        "errors": [" ".join(e.split()) for e in errors],
        "warnings": sorted({" ".join(w.split()) for w in re.findall(r"\*WARNING[^\n]*", screen)}),
    }


def totals(folder, name):
    """[(time, fx, fy, fz)] of `*NODE PRINT, NSET=name, TOTALS=ONLY` with RF."""
    found, take, time = [], False, None
    with open(os.path.join(folder, "deck.dat")) as file:
        for line in file:
            head = re.match(r"\s*total force .* for set (\S+) and time\s+(\S+)", line)
            if head:
                take, time = head.group(1) == name.upper(), float(head.group(2))
            elif take and line.strip():
                found.append((time, *[float(w) for w in line.split()[:3]]))
                take = False
    return found


def displacements(folder, name):
    """{time: {node: (ux, uy, uz)}} of `*NODE PRINT, NSET=name` with U."""
    found, table = {}, None
    with open(os.path.join(folder, "deck.dat")) as file:
        for line in file:
            head = re.match(r"\s*displacements .* for set (\S+) and time\s+(\S+)", line)
            if head:
                table = found.setdefault(float(head.group(2)), {}) if head.group(1) == name.upper() else None
            elif re.match(r"\s*[a-z]", line):
                table = None
            elif table is not None and line.strip():
                words = line.split()
                table[int(words[0])] = tuple(float(w) for w in words[1:4])
    return found


def contact_pressures(folder):
    """{node: pressure} of the last `CONTACT` block of the `.frd` file (`*CONTACT FILE` with CDIS, CSTR)."""
    found, take = {}, False
    with open(os.path.join(folder, "deck.frd")) as file:
        for line in file:
            if line.startswith(" -4"):
                take = "CONTACT" in line
                if take:
                    found = {}
            elif line.startswith(" -3"):
                take = False
            elif take and line.startswith(" -1"):
                values = [line[13 + 12 * k : 25 + 12 * k] for k in range(6)]
                found[int(line[3:13])] = float(values[3])
    return found
