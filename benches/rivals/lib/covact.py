"""covact: scenes, runs, histories."""
import csv
import json
import os
import subprocess

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
BINARY = os.environ.get("COVACT", os.path.join(ROOT, "target", "release", "covact"))
MESSAGES = {3: "refused", 4: "not converged", 5: "files"}


def version():
    return subprocess.run([BINARY, "--version"], capture_output=True, text=True).stdout.split()[-1]


def run(folder, scene):
    """Solves a scene (its file is kept beside the results); returns how it ended and the rows of its history."""
    # One thread, as the other programs have.
    scene["solution"]["threads"] = 1
    path = os.path.join(folder, "scene.json")
    with open(path, "w") as file:
        json.dump(scene, file, indent=1)
    out = os.path.join(folder, "out")
    done = subprocess.run([BINARY, "run", path, "-o", out, "--quiet"], capture_output=True, text=True)
    screen = done.stdout + done.stderr
    with open(os.path.join(folder, "screen.txt"), "w") as file:
        file.write(screen)
    rows, summary = [], {}
    if os.path.exists(os.path.join(out, "history.csv")):
        with open(os.path.join(out, "history.csv")) as file:
            rows = [{k: float(v) for k, v in row.items() if v} for row in csv.DictReader(file)]
    if os.path.exists(os.path.join(out, "summary.json")):
        with open(os.path.join(out, "summary.json")) as file:
            summary = json.load(file)
    return {
        "finished": done.returncode == 0,
        "code": done.returncode,
        "screen": screen,
        "rows": rows,
        "increments": len(rows),
        "iterations": int(summary.get("newton_iterations", sum(r["iterations"] for r in rows))),
        "warnings": summary.get("warnings", []),
    }


def point_field(path, name):
    """Values at the points of a `.vtu` file, and the points (rows)."""
    import re
    import zlib

    import numpy as np

    # Arrays stand behind the tree: the number of blocks, their sizes before compression and after it, then the blocks.
    with open(path, "rb") as file:
        head, _, data = file.read().partition(b'<AppendedData encoding="raw">_')
    text = head.decode()

    def array(tag):
        blocks, _, _ = np.frombuffer(data, "<u8", 3, offset := int(re.search(r' offset="(\d+)"', tag).group(1)))
        sizes = np.frombuffer(data, "<u8", int(blocks), offset + 24)
        ends = offset + 24 + 8 * int(blocks) + np.cumsum(sizes)
        parts = [zlib.decompress(data[int(end - size) : int(end)]) for size, end in zip(sizes, ends)]
        return np.frombuffer(b"".join(parts), np.float32 if 'type="Float32"' in tag else np.float64)

    points = re.search(r"<Points>(.*?)</Points>", text, re.S).group(1)
    field = re.search(rf'<DataArray [^>]*Name="{name}"[^>]*>', text).group(0)
    return array(field), array(points).reshape(-1, 3)
