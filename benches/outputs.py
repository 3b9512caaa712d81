#!/usr/bin/env python3
"""Bytes of results and of the page, and the time that the page takes, for shipped scenes.

    benches/outputs.py PROGRAM [SCENE...] [--keep FOLDER]

PROGRAM is a built `covact`; SCENE a name in examples/scenes, all of them without any. Each is run on one thread, its page made
again three times by `covact view`, of which the fastest counts. The table gives the seconds of the run (wall), the megabytes of
all .vtu files, what they are of plain ones (inline in base64, uncompressed, double precision, every tool in every step, without
resultants and reactions), the kilobytes of report.html, the seconds of the page and their share in the run.

Exit code: 0 all within bounds; 1 a scene failed, or left a page above 3 MB, or one that took more than 5 % of the run and more
than .3 s (on a machine that is busy, run it again), or the field files of all scenes together take more than a fifth of plain
ones. Needs Python 3.9 only.
"""
import argparse
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import time

SCENES = pathlib.Path(__file__).parent.parent / "examples" / "scenes"
START = b'<AppendedData encoding="raw">_'
WIDTH = {"Float32": 2}
LATER = {"membrane_force", "bending_moment", "shear_force", "reaction"}


def plain(path):
    """Bytes that the arrays of a file would take as plain ones."""
    head, _, data = path.read_bytes().partition(START)
    total = 0
    for tag in re.findall(rb"<DataArray ([^>]*)>", head):
        value = {k.decode(): v.decode() for k, v in re.findall(rb'(\w+)="([^"]*)"', tag)}
        if value.get("Name") in LATER:
            continue
        blocks, size, last = struct.unpack_from("<3Q", data, int(value["offset"]))
        raw = (blocks - 1) * size + last if last else blocks * size
        total += raw * WIDTH.get(value["type"], 1) * 4 // 3
    return total


def sizes(out):
    """Bytes of all field files, and of plain ones with every tool in every step."""
    listed = []
    for name in ("results.pvd", "results_tessellated.pvd"):
        files = re.findall(r' file="([^"]*)"', (out / name).read_text())
        # Bodies are in both collections.
        listed += [f for f in files if name == "results.pvd" or "tessellated" in f]
    each = {f: plain(out / f) for f in set(listed)}
    return sum((out / f).stat().st_size for f in each), sum(each[f] for f in listed)


def page(program, out):
    """Seconds that the page takes."""
    best = float("inf")
    for _ in range(3):
        begun = time.perf_counter()
        subprocess.run([program, "view", str(out)], check=True, capture_output=True)
        best = min(best, time.perf_counter() - begun)
    return best


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("program")
    arguments.add_argument("scenes", nargs="*")
    arguments.add_argument("--keep", type=pathlib.Path, help="folder for the results")
    given = arguments.parse_args()
    names = given.scenes or sorted(p.stem for p in SCENES.glob("*.json") if p.stem != "schema")
    failed, written, whole = False, 0, 0
    print("| scene | run s | fields MB | of plain | page kB | page s | share |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            out = (given.keep or pathlib.Path(folder)) / name
            command = [given.program, "run", str(SCENES / f"{name}.json"), "-o", str(out), "--quiet", "--force", "--threads", "1"]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode:
                print(f"{name}: exit code {done.returncode}\n{done.stderr}", file=sys.stderr)
                failed = True
                continue
            seconds = json.loads((out / "summary.json").read_text())["wall_s"]
            fields, of = sizes(out)
            took = page(given.program, out)
            size = (out / "report.html").stat().st_size
            written, whole = written + fields, whole + of
            bad = size > 3e6 or took > max(0.3, 0.05 * seconds)
            failed |= bad
            print(
                f"| `{name}` | {seconds:.1f} | {fields / 1e6:.1f} | {100 * fields / of:.0f} % | {size / 1e3:.0f} "
                f"| {took:.2f} | {100 * took / seconds:.1f} % |{' above a bound' if bad else ''}",
                flush=True,
            )
    if whole:
        much = not given.scenes and written > 0.2 * whole
        failed |= much
        print(f"| all | | {written / 1e6:.1f} | {100 * written / whole:.1f} % | | | |{' above a bound' if much else ''}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
