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
    import base64
    import re
    import zlib

    import numpy as np

    with open(path) as file:
        text = file.read()

    def unpacked(raw):
        if "vtkZLibDataCompressor" not in text[:400]:
            return np.frombuffer(base64.b64decode(raw), dtype=np.uint8)[8:]
        # The number of blocks, their sizes before compression and after it, then the blocks.
        raw = raw.strip()
        blocks = int.from_bytes(base64.b64decode(raw[:12])[:8], "little")
        head = 4 * -(-8 * (3 + blocks) // 3)
        sizes = np.frombuffer(base64.b64decode(raw[:head]), dtype="<u8")[3:]
        body, ends = base64.b64decode(raw[head:]), np.cumsum(sizes)
        parts = [zlib.decompress(body[int(end - size) : int(end)]) for size, end in zip(sizes, ends)]
        return np.frombuffer(b"".join(parts), dtype=np.uint8)

    def array(tag):
        found = re.search(rf"<DataArray [^>]*{tag}[^>]*>([^<]*)</DataArray>", text)
        kind = np.float32 if 'type="Float32"' in found.group(0)[:200] else np.float64
        return unpacked(found.group(1)).view(kind)

    points = re.search(r"<Points>(.*?)</Points>", text, re.S).group(1)
    raw = re.search(r">([^<]*)</DataArray>", points).group(1)
    where = unpacked(raw)
    where = where.view(np.float32 if "Float32" in points else np.float64).reshape(-1, 3)
    return array(f'Name="{name}"'), where
