"""Closest points of a CAD file from numpy beside the command line: microseconds per point, least of several rounds.

    python3 assets/measure_projection.py [CAD file] [points] [rounds]

Both are the same compiled program, on all cores; of the command line only the projection counts, as it reports it, not the
reading and writing of text.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import covact

ASSETS = Path(__file__).resolve().parents[1] / "assets"


def measure(cad: Path, number: int, rounds: int) -> tuple[float, float]:
    """Microseconds per point from numpy, and by the command line."""
    surface = covact.geometry.load(cad)
    low, high = surface.bounds
    points = np.random.default_rng(1).uniform(low, high, (number, 3))
    own, program = [], []
    with tempfile.TemporaryDirectory() as folder:
        text = Path(folder) / "points.txt"
        np.savetxt(text, points, fmt="%.17g")
        command = [sys.executable, "-m", "covact", "project", str(cad), str(text), "-o", str(Path(folder) / "feet.csv")]
        for _ in range(rounds):
            start = time.perf_counter()
            surface.closest(points)
            own.append(1e6 * (time.perf_counter() - start) / number)
            said = subprocess.run(command, capture_output=True, text=True, check=True).stderr
            program.append(float(re.search(r"([\d.]+) us per point for the projection", said).group(1)))
    return min(own), min(program)


def main() -> None:
    given = sys.argv[1:]
    cad = Path(given[0]) if given else ASSETS / "die.igs"
    number = int(float(given[1])) if len(given) > 1 else 1_000_000
    rounds = int(given[2]) if len(given) > 2 else 5
    own, program = measure(cad, number, rounds)
    print(f"{cad.name}, {number} points: {own:.3f} us per point from numpy, {program:.3f} us by the command line, ratio {own / program:.3f}")


if __name__ == "__main__":
    main()
