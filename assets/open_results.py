"""Opens all results of a run with meshio, pyvista and ParaView, as far as they are installed.

    pip install meshio pyvista
    python3 assets/open_results.py OUT

Bodies and tessellated surfaces open with all of them, exact (Bezier) surfaces with pyvista and ParaView. Fails where a program
prints a message, where a grid lacks a `displacement`, or where a displacement does not fit its grid.
"""

from __future__ import annotations

import importlib.util
import pathlib
import shutil
import subprocess
import sys

#: Version of the files with Bezier cells, which meshio does not know.
EXACT = b'version="2.2"'

#: For each program, what it runs for the files that are its arguments.
PROGRAMS = {
    "meshio": """
import sys, meshio
for file in sys.argv[1:]:
    grid = meshio.read(file)
    assert grid.point_data["displacement"].shape == grid.points.shape, file
""",
    "pyvista": """
import sys, pyvista
for file in sys.argv[1:]:
    grid = pyvista.read(file)
    assert grid.n_cells > 0 and grid.warp_by_vector("displacement").n_points == grid.n_points, file
""",
    "pvpython": """
import sys
from paraview.simple import OpenDataFile, WarpByVector, UpdatePipeline
for file in sys.argv[1:]:
    warped = WarpByVector(Input=OpenDataFile(file), Vectors=["POINTS", "displacement"])
    UpdatePipeline(proxy=warped)
    assert warped.GetDataInformation().GetNumberOfCells() > 0, file
""",
}


def main() -> None:
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    files = sorted(pathlib.Path(sys.argv[1]).glob("*.vtu"))
    if not files:
        raise SystemExit(f"no .vtu in {sys.argv[1]}")
    for name, script in PROGRAMS.items():
        program = shutil.which(name) if name == "pvpython" else sys.executable
        if program is None or (name != "pvpython" and importlib.util.find_spec(name) is None):
            print(f"{name}: not installed")
            continue
        opened = [file for file in files if name != "meshio" or EXACT not in file.read_bytes()[:500]]
        done = subprocess.run([program, "-c", script, *map(str, opened)], capture_output=True, text=True)
        if done.returncode or done.stderr.strip():
            raise SystemExit(f"{name}: exit code {done.returncode}\n{done.stderr}")
        print(f"{name}: {len(opened)} of {len(files)} files, no message")


if __name__ == "__main__":
    main()
