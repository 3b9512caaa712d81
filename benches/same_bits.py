#!/usr/bin/env python3
"""Compares two builds of covact bit for bit: a change that is not meant to change results is checked by this.

    benches/same_bits.py OLD NEW [--profile dev|release] [--only TEXT] [--quick] [--jobs N] [--threads 1,4]
                                 [--limit SECONDS] [--keep FOLDER]

    benches/same_bits.py main HEAD                        what the branch changed
    benches/same_bits.py HEAD~1 HEAD --quick              only cases that take below two seconds
    benches/same_bits.py main HEAD --only scene/ball      the cases whose names contain this text
    benches/same_bits.py main target/debug/covact         a program that is built already, e.g. of a changed tree

OLD and NEW are commits or programs. Commits are built one after the other in a git worktree (target/same_bits/tree) with
cargo's target folder of this checkout, so that the dependencies are built once, here and there; the programs are kept in
target/same_bits by commit and profile.

Cases, each at every number of threads:

    scene/NAME          examples/scenes/NAME.json of OLD, by `covact run`
    soak/SEED           the random scene of a seed, 1 to 12, by `covact soak` and `covact run`
    gauntlet/GROUP/NAME twenty cases of `covact gauntlet`

Compared are, of a run, the exit code, the names of its files, history.csv, every .vtu and .pvd file, and summary.json but
for times, memory, threads, versions and the wording of the plan (LEFT_OUT); checkpoints are not. Of a random scene also the
scene itself. Of a case of the gauntlet all numbers of `--json` but the seconds. A row of the table is a case; of one that
differs it tells the first difference, and the largest of the whole history relative to its column's largest value.

Exit code: 0 all cases are the same; 1 one differs, ran in one build only, or left nothing to compare; 2 wrong usage, or a
build failed. Needs Python 3.9, git and cargo.
"""
import argparse
import base64
import concurrent.futures
import csv
import fcntl
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
import zlib

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CACHE = os.path.join(ROOT, "target", "same_bits")
#: Shipped scenes and seeds that `--quick` leaves out: two seconds or more in the dev profile on one thread.
SLOW = set()
SEEDS = range(1, 13)
GAUNTLET = [
    "geometry/pole", "geometry/weights", "geometry/small_radius", "geometry/beyond_focal", "geometry/crease",
    "geometry/corner", "geometry/trim", "geometry/free_edge", "motion/sharp_corner", "motion/full_turn", "motion/reversal",
    "conditioning/penalty_under_ball", "conditioning/far", "instability/slides_off", "instability/between_tools",
    "friction/hysteresis", "friction/wedge", "friction/fast_turn", "invariance/carried_along", "elements/distorted",
]
#: Fields of summary.json that may differ between two runs of one program, or that are words about the plan.
LEFT_OUT = {"wall_s", "cpu_s", "phases", "peak_memory_mb", "threads", "versions", "plan"}

#: Endings of the files that are compared, in this order.
RESULTS = [".csv", ".json", ".vtu", ".pvd"]


class Unusable(Exception):
    """Why there is nothing to compare, in words."""


# Building


def git(*args):
    done = subprocess.run(["git", "-C", ROOT, *args], capture_output=True, text=True)
    if done.returncode != 0:
        raise Unusable(f"git {' '.join(args)}: {done.stderr.strip()}")
    return done.stdout.strip()


class Build:
    """A program, and where it comes from: a commit or a file."""

    def __init__(self, name):
        self.name = name
        self.program = None
        self.commit = None
        if os.path.isfile(name) and os.access(name, os.X_OK):
            self.program = os.path.abspath(name)
        else:
            try:
                self.commit = git("rev-parse", "--verify", "--quiet", f"{name}^{{commit}}")
            except Unusable:
                raise Unusable(f"`{name}` is neither a commit nor a program") from None

    def title(self):
        if self.commit is None:
            return self.program
        return f"{self.name} ({git('log', '-1', '--format=%h %s', self.commit)})"

    def make(self, profile):
        """Builds the program where it is not kept from before."""
        if self.program is not None:
            return
        kept = os.path.join(CACHE, f"covact-{self.commit[:16]}-{profile}")
        if not os.path.exists(kept):
            begin = time.monotonic()
            tree = os.path.join(CACHE, "tree")
            remove_tree(tree)
            git("worktree", "add", "--quiet", "--force", "--detach", tree, self.commit)
            try:
                cargo_build(tree, profile, kept)
            except subprocess.CalledProcessError:
                raise Unusable(f"{self.name} does not build") from None
            finally:
                remove_tree(tree)
            say(f"built {self.name} in {time.monotonic() - begin:.0f} s")
        self.program = kept

    def has_gauntlet_threads(self):
        command = [self.program, "gauntlet", "--help"]
        return "--threads" in subprocess.run(command, capture_output=True, text=True).stdout

    def inputs(self, folder):
        """Copies the shipped scenes and what they name."""
        parts = ["examples/scenes", "assets"]
        if self.commit is None:
            for part in parts:
                shutil.copytree(os.path.join(ROOT, part), os.path.join(folder, part))
            return
        archive = subprocess.Popen(
            ["git", "-C", ROOT, "archive", self.commit, *parts], stdout=subprocess.PIPE
        )
        subprocess.run(["tar", "-x", "-C", folder], stdin=archive.stdout, check=True)
        archive.stdout.close()
        if archive.wait() != 0:
            raise Unusable(f"the scenes of {self.name} cannot be read")


def cargo_build(tree, profile, kept):
    """Builds the program of a tree and copies it; the one of this checkout stays where cargo put it."""
    target = os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target"))
    built = os.path.join(target, {"dev": "debug"}.get(profile, profile), "covact")
    own = kept + ".own"
    if os.path.exists(built):
        os.replace(built, own)
    try:
        command = ["cargo", "build", "--quiet", "--locked", "--bin", "covact", "--profile", profile]
        subprocess.run(command, cwd=tree, env=dict(os.environ, CARGO_TARGET_DIR=target), check=True)
        shutil.copy2(built, kept + ".new")
        os.replace(kept + ".new", kept)
    finally:
        if os.path.exists(own):
            os.replace(own, built)


def remove_tree(tree):
    """Removes the worktree, also one that an interrupted call left."""
    shutil.rmtree(tree, ignore_errors=True)
    git("worktree", "prune")


def say(text):
    print(text, file=sys.stderr, flush=True)


# Running


class Run:
    """What a program left: exit code, what it printed, files."""

    def __init__(self, command, folder, limit):
        os.makedirs(folder)
        environment = dict(os.environ, RAYON_NUM_THREADS="1")
        with open(os.path.join(folder, "stdout"), "w+") as out, open(os.path.join(folder, "stderr"), "w+") as err:
            try:
                self.code = subprocess.run(
                    command, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, env=environment, timeout=limit
                ).returncode
            except subprocess.TimeoutExpired:
                self.code = f"stopped after {limit} s"
            out.seek(0)
            err.seek(0)
            self.stdout, self.stderr = out.read(), err.read()
        self.folder = folder


def run_scene(build, scene, threads, folder, limit):
    return Run([build.program, "run", scene, "-o", "out", "--quiet", "--threads", str(threads)], folder, limit)


def draw(build, seed, folder, limit):
    """Has a seed's scene written; the run that comes with it is stopped at once, because it cannot take threads."""
    drawn = Run([build.program, "soak", "--seed", str(seed), "--count", "1", "--limit", "0", "-o", "."], folder, limit)
    scene = os.path.join(folder, f"seed_{seed:06}", "scene.json")
    if not os.path.exists(scene):
        raise Unusable(f"`covact soak` wrote no scene: {drawn.stderr.strip()}")
    shutil.rmtree(os.path.join(os.path.dirname(scene), "out"), ignore_errors=True)
    with open(scene) as file:
        written = json.load(file)
    # Random scenes write no fields: those of the last step are compared as well.
    written["output"]["every"] = 1_000_000
    with open(scene, "w") as file:
        json.dump(written, file, indent=1)
    return scene


def compare_case(case, threads, builds, inputs, work, limit):
    """Runs a case by both programs; what is compared in words, and the first difference or None."""
    kind, name = case.split("/", 1)
    folders = [os.path.join(work, side) for side in ("old", "new")]
    if kind == "gauntlet":
        option = ["--threads", str(threads)] if threads != 1 else []
        runs = [
            Run([b.program, "gauntlet", name, "--json", *option], folder, limit)
            for b, folder in zip(builds, folders)
        ]
        return compare_verdicts(*runs)
    if kind == "soak":
        scenes = [draw(b, name and int(name), f + ".drawn", limit) for b, f in zip(builds, folders)]
        for file in ("scene.json", "tool.json"):
            found = compare_text(file, *(os.path.join(os.path.dirname(s), file) for s in scenes))
            if found:
                return "", found
    else:
        scenes = [os.path.join(inputs, "examples", "scenes", f"{name}.json")] * 2
    runs = [run_scene(b, s, threads, f, limit) for b, s, f in zip(builds, scenes, folders)]
    return compare_runs(*runs)


# Comparing


def compare_runs(old, new):
    if old.code != new.code:
        return "", f"exit code: {old.code} | {new.code}; {first_line(old.stderr)} | {first_line(new.stderr)}"
    outs = [os.path.join(run.folder, "out") for run in (old, new)]
    names = [files(out) for out in outs]
    both = sorted(names[0] & names[1], key=lambda n: (RESULTS.index(os.path.splitext(n)[1]), n))
    if "history.csv" not in both or "summary.json" not in both:
        raise Unusable(f"exit code {old.code}: {first_line(old.stderr) or 'no history'}")
    steps = 0
    for name in both:
        paths = [os.path.join(out, name) for out in outs]
        if name == "summary.json":
            found = compare_summaries(*paths)
        elif name == "history.csv":
            steps, found = compare_histories(*paths)
        elif same_bytes(*paths):
            found = None
        elif name.endswith(".vtu"):
            found = compare_grids(*paths)
        else:
            found = compare_text(name, *paths)
        if found:
            return "", found if name == "history.csv" else f"{name}: {found}"
    for name in sorted(names[0] ^ names[1]):
        return "", f"{name} is only in {'old' if name in names[0] else 'new'}"
    if steps == 0:
        raise Unusable("no step was accepted")
    return f"{steps} steps, {len(both)} files", None


def files(folder):
    """Names of the results; checkpoints are left out."""
    there = os.listdir(folder) if os.path.isdir(folder) else []
    return {n for n in there if os.path.splitext(n)[1] in RESULTS}


def same_bytes(a, b):
    with open(a, "rb") as first, open(b, "rb") as second:
        return first.read() == second.read()


def first_line(text):
    return text.strip().splitlines()[0] if text.strip() else ""


def compare_text(name, a, b):
    there = [os.path.exists(p) for p in (a, b)]
    if there == [False, False]:
        return None
    if there[0] != there[1]:
        return f"{name} is only in {'old' if there[0] else 'new'}"
    with open(a, errors="replace") as first, open(b, errors="replace") as second:
        lines = first.read().splitlines(), second.read().splitlines()
    for number, (one, other) in enumerate(zip(*lines), 1):
        if one != other:
            return f"line {number}: {one.strip()[:80]} | {other.strip()[:80]}"
    if len(lines[0]) != len(lines[1]):
        return f"{len(lines[0])} lines | {len(lines[1])} lines"
    return None


def read_history(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def compare_histories(a, b):
    """Accepted steps, and the first cell that differs."""
    (columns, old), (others, new) = read_history(a), read_history(b)
    if same_bytes(a, b):
        return len(old), None
    alone = [f"only {side} has the column {c}" for side, mine, its in (("old", columns, others), ("new", others, columns))
             for c in mine if c not in its]
    if alone:
        return len(old), f"history.csv: {alone[0]}"
    if columns != others:
        return len(old), "history.csv: the order of columns"
    for i, (row, other) in enumerate(zip(old, new)):
        for column, x, y in zip(columns, row, other):
            if x != y:
                largest = largest_difference(columns, old, new)
                return len(old), f"history.csv, row {i + 1}, {column}: {x} | {y}; {largest}"
    return len(old), f"history.csv: {len(old)} rows | {len(new)} rows"


def largest_difference(columns, old, new):
    """Of the rows that both have, relative to the largest value of the column."""
    worst = (0.0, "")
    for i, column in enumerate(columns):
        pairs = [(float(a[i]), float(b[i])) for a, b in zip(old, new)]
        size = max((abs(x) for x, _ in pairs if math.isfinite(x)), default=0.0)
        for x, y in pairs:
            if x != y and not (math.isnan(x) and math.isnan(y)):
                share = abs(x - y) / size if size > 0 and math.isfinite(x - y) else math.inf
                worst = max(worst, (share, column))
    rows = "" if len(old) == len(new) else f", {len(old)} rows | {len(new)} rows"
    return f"largest {worst[0]:.1e} in {worst[1]}{rows}"


def compare_summaries(a, b):
    with open(a) as first, open(b) as second:
        old, new = json.load(first), json.load(second)
    for summary in (old, new):
        for key in LEFT_OUT:
            summary.pop(key, None)
    return compare_json("", old, new)


def compare_json(place, old, new):
    """The first difference of two JSON values, depth first; numbers are equal where their texts are."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(k for k in new if k not in old)]:
            if key not in old or key not in new:
                return f"{place}/{key} is only in {'old' if key in old else 'new'}"
            found = compare_json(f"{place}/{key}", old[key], new[key])
            if found:
                return found
        return None
    if isinstance(old, list) and isinstance(new, list):
        for i, (x, y) in enumerate(zip(old, new)):
            found = compare_json(f"{place}/{i}", x, y)
            if found:
                return found
        return None if len(old) == len(new) else f"{place}: {len(old)} entries | {len(new)} entries"
    return None if json.dumps(old) == json.dumps(new) else f"{place}: {json.dumps(old)} | {json.dumps(new)}"


def compare_grids(a, b):
    """The first difference of two .vtu files whose bytes differ."""
    roots = [tree(p) for p in (a, b)]
    packed = ["compressor" in root.attrib for root in roots]
    old, new = (list(root.iter("DataArray")) for root in roots)
    names = [[array.get("Name") or "points" for array in arrays] for arrays in (old, new)]
    if names[0] != names[1]:
        alone = [n for n in names[0] + names[1] if (n in names[0]) != (n in names[1])]
        return f"the arrays {', '.join(alone)}" if alone else "the order of arrays"
    for name, first, second in zip(names[0], old, new):
        if (first.text or "").strip() == (second.text or "").strip():
            continue
        x, y = numbers(first, packed[0]), numbers(second, packed[1])
        if len(x) != len(y):
            return f"{name}: {len(x)} numbers | {len(y)} numbers"
        size = int(first.get("NumberOfComponents") or 1)
        for i, (one, other) in enumerate(zip(x, y)):
            if struct.pack("<d", one) != struct.pack("<d", other):
                return f"{name}, row {i // size}, component {i % size}: {one!r} | {other!r}"
    return "attributes or tags"


def tree(path):
    """The tree of a .vtu file, arrays that stand behind it as text in base64."""
    start = b'<AppendedData encoding="raw">_'
    head, _, data = path.read_bytes().partition(start)
    if not data:
        return ElementTree.fromstring(head)
    root = ElementTree.fromstring(head + b"</VTKFile>")
    for array in root.iter("DataArray"):
        own = data[int(array.get("offset")) :]
        blocks = struct.unpack_from("<Q", own)[0]
        sizes = struct.unpack_from(f"<{3 + blocks}Q", own)[3:]
        head = 8 * (3 + blocks)
        array.text = (base64.b64encode(own[:head]) + base64.b64encode(own[head : head + sum(sizes)])).decode()
    return root


#: Types of VTK's arrays as `struct` names them.
TYPES = {"Float64": "d", "Float32": "f", "Int64": "q", "UInt64": "Q", "Int32": "i", "UInt32": "I", "Int8": "b", "UInt8": "B"}


def numbers(array, packed=False):
    """The numbers of an array, inline base64 behind its length or ASCII."""
    text = "".join((array.text or "").split())
    kind = TYPES[array.get("type")]
    if array.get("format") == "ascii":
        return [float(x) for x in (array.text or "").split()]
    if packed:
        # The number of blocks, their sizes before compression and after it, then the blocks.
        blocks = struct.unpack("<Q", base64.b64decode(text[:12])[:8])[0]
        head = 4 * -(-8 * (3 + blocks) // 3)
        sizes = struct.unpack(f"<{3 + blocks}Q", base64.b64decode(text[:head]))[3:]
        body, data = base64.b64decode(text[head:]), b""
        for size in sizes:
            data, body = data + zlib.decompress(body[:size]), body[size:]
        return struct.unpack(f"<{len(data) // struct.calcsize(kind)}{kind}", data)
    # The length is a base64 block of its own, which ends in padding, or the head of the only block.
    head = base64.b64decode(text[:12])
    length = struct.unpack("<Q", head[:8])[0]
    data = base64.b64decode(text)[8:] if not text[:12].endswith("=") else base64.b64decode(text[12:])
    count = min(length, len(data)) // struct.calcsize(kind)
    return struct.unpack(f"<{count}{kind}", data[: count * struct.calcsize(kind)])


def compare_verdicts(old, new):
    verdicts = []
    for side, run in (("old", old), ("new", new)):
        if run.code not in (0, 4):
            return "", f"{side}: exit code {run.code}: {first_line(run.stderr)}"
        verdicts.append(json.loads(run.stdout))
        for verdict in verdicts[-1]:
            del verdict["seconds"]
    found = compare_json("", *verdicts)
    if found:
        return "", found
    checks = sum(len(v["checks"]) for v in verdicts[0])
    if checks == 0:
        raise Unusable("the case checks nothing")
    return f"{checks} checks, {sum(v['iterations'] for v in verdicts[0])} iterations", None


# The table


def cases(builds, inputs, only, quick):
    scenes = sorted(f[:-5] for f in os.listdir(os.path.join(inputs, "examples", "scenes")) if f.endswith(".json"))
    scenes = [s for s in scenes if s != "schema"]
    every = [f"scene/{s}" for s in scenes] + [f"soak/{s}" for s in SEEDS] + [f"gauntlet/{c}" for c in GAUNTLET]
    return [c for c in every if (not only or any(text in c for text in only)) and not (quick and c in SLOW)]


def main():
    summary, _, rest = __doc__.partition("\n")
    parser = argparse.ArgumentParser(
        description=summary, epilog=rest, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", metavar="OLD")
    parser.add_argument("new", metavar="NEW")
    parser.add_argument("--profile", choices=["dev", "release"], default="dev")
    parser.add_argument("--only", metavar="TEXT", action="append", help="cases whose name holds this; repeatable")
    parser.add_argument("--quick", action="store_true", help="only cases that take below two seconds")
    parser.add_argument("--jobs", metavar="N", type=int, default=1, help="cases that run at once (1)")
    parser.add_argument("--threads", metavar="N,N", default="1,4", help="numbers of threads (1,4)")
    parser.add_argument("--limit", metavar="SECONDS", type=int, default=3600, help="seconds a run may take (3600)")
    parser.add_argument("--keep", metavar="FOLDER", help="keep what the programs wrote, a folder per case")
    args = parser.parse_args()
    if args.keep and os.path.exists(args.keep):
        parser.error(f"{args.keep} is there already")
    try:
        threads = [int(n) for n in args.threads.split(",")]
        builds = [Build(args.old), Build(args.new)]
        os.makedirs(CACHE, exist_ok=True)
        with open(os.path.join(CACHE, "lock"), "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            for build in builds:
                build.make(args.profile)
    except (Unusable, ValueError) as e:
        say(f"error: {e}")
        return 2
    for side, build in zip(("old", "new"), builds):
        print(f"{side}: {build.title()}")
    with tempfile.TemporaryDirectory(prefix="same_bits_") as work:
        if args.keep:
            work = os.path.abspath(args.keep)
        inputs = os.path.join(work, "input")
        os.makedirs(inputs)
        builds[0].inputs(inputs)
        return table(builds, inputs, work, threads, args)


def table(builds, inputs, work, threads, args):
    begin = time.monotonic()
    listed = cases(builds, inputs, args.only, args.quick)
    if not listed:
        say("error: no case has such a name")
        return 2
    gauntlet_threads = all(b.has_gauntlet_threads() for b in builds)
    wanted = [(c, n) for c in listed for n in threads if n == 1 or not c.startswith("gauntlet/") or gauntlet_threads]
    if len(wanted) < len(listed) * len(threads) and any(c.startswith("gauntlet/") for c in listed):
        print("the gauntlet runs on one thread only: `covact gauntlet` of one program has no --threads")

    def one(case, n):
        folder = os.path.join(work, f"{case.replace('/', '.')}.{n}")
        start = time.monotonic()
        try:
            what, difference = compare_case(case, n, builds, inputs, folder, args.limit)
        except Unusable as e:
            what, difference = "", f"nothing to compare: {e}"
        if not args.keep:
            shutil.rmtree(folder, ignore_errors=True)
        return what, difference, time.monotonic() - start

    width, different = max(len(c) for c, _ in wanted), 0
    print(f"{'case':{width}} threads  result     seconds  first difference (old | new)")
    with concurrent.futures.ThreadPoolExecutor(max(1, args.jobs)) as pool:
        for (case, n), done in [(w, pool.submit(one, *w)) for w in wanted]:
            what, difference, seconds = done.result()
            different += difference is not None
            result = "same" if difference is None else "DIFFERENT"
            print(f"{case:{width}} {n:7}  {result:9} {seconds:8.1f}  {difference or what}", flush=True)
    print(f"{different} of {len(wanted)} differ, {time.monotonic() - begin:.0f} s" if different
          else f"all {len(wanted)} are the same to the last bit, {time.monotonic() - begin:.0f} s")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
