"""Runs the cases; called by run.sh. `rivals.py` all, `rivals.py NAME ...` some, `--program P` one program,
`--setting TEXT` the settings whose name contains it, `--keep FOLDER` keeps what the programs read and wrote."""
import csv
import importlib
import json
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
CASES = ["patch", "hertz", "plate", "ironing", "friction_limit", "first_touch", "cyclic", "units"]
PROGRAMS = ["covact", "calculix", "getfem"]
NAMES = {"covact": "covact", "calculix": "CalculiX", "getfem": "GetFEM"}
#: Processor seconds a run may take; on a busy machine it may last four times as long.
LIMIT = int(os.environ.get("RIVALS_LIMIT", "180"))


def worker(case, program, variant, folder):
    """In a process of its own: runs one variant and leaves `result.json`."""
    module = importlib.import_module(f"cases.{case}")
    found = getattr(module, program)(folder, variant)
    found.pop("rows", None)
    with open(os.path.join(folder, "result.json"), "w") as file:
        json.dump(found, file)


def measure(case, program, variant, folder):
    """Runs a variant within the time limit; a row of the table."""
    module = importlib.import_module(f"cases.{case}")
    os.makedirs(folder)
    begin = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(os.path.join(folder, "worker.txt"), "w") as log:
        child = subprocess.Popen(
            [sys.executable, os.path.join(HERE, "rivals.py"), "--worker", case, program, variant, folder],
            stdout=log, stderr=log, start_new_session=True, env=dict(os.environ, OMP_NUM_THREADS="1"),
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT + 5)),
        )
        try:
            child.wait(4 * LIMIT)
            late = child.returncode == -signal.SIGXCPU
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()
            late = True
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    row = {
        "case": case, "program": NAMES[program], "setting": variant, "answer": "", "error": None, "iterations": "",
        "increments": "", "wall_s": round(time.monotonic() - begin, 1),
        "cpu_s": round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 1),
    }
    path = os.path.join(folder, "result.json")
    if late:
        row.update(verdict="no end", said=f"nothing within {LIMIT} s")
        return row
    if not os.path.exists(path):
        with open(os.path.join(folder, "worker.txt")) as log:
            last = [l.strip() for l in log if l.strip()][-1:]
        row.update(verdict="stopped", said=f"script ended with code {child.returncode}: {last[0] if last else 'no message'}")
        return row
    with open(path) as file:
        found = json.load(file)
    row.update({k: found.get(k, "") for k in ("answer", "error", "iterations", "increments")})
    said = found.get("said") or "; ".join(list(dict.fromkeys(found.get("errors", [])))[:2])
    if found.get("late"):
        row.update(verdict="no end", said=f"nothing within {LIMIT} s")
    elif found.get("verdict"):
        row.update(verdict=found["verdict"], said=said)
    elif not found["finished"]:
        if not said and program == "covact":
            said = next((l for l in found["screen"].splitlines() if l.strip()), "")
        signal_ = f"ended by signal {-found['code']}" if found.get("code", 0) < 0 else ""
        row.update(verdict="stopped, said why" if said else "stopped without a message", said=said or signal_)
    elif found["error"] is None or not math.isfinite(found["error"]):
        row.update(verdict="wrong, silently", said="converged")
    elif found["error"] <= module.LIMIT:
        row.update(verdict="right", said=said or "converged")
    elif found["error"] <= 10 * module.LIMIT:
        row.update(verdict="inaccurate", said=said or "converged")
    else:
        row.update(verdict="wrong, silently", said=said or "converged")
    return row


HEAD = """# Results

Written by `run.sh`; cases, right answers, limits and settings: [README.md](README.md); every row: [results.csv](results.csv). Best setting of each program: verdict, error, processor seconds on one thread, how many of the settings tried are right.

"""
RANK = {"right": 0, "inaccurate": 1, "stopped, said why": 2, "stopped without a message": 3, "stopped": 3, "no end": 4, "wrong, silently": 5}


def best(rows):
    """The best setting of a program: what is right before what stops, what stops before what is silently wrong."""
    return min(rows, key=lambda r: (RANK.get(r["verdict"], 2), r["error"] if r["error"] is not None else 9e9, r["wall_s"]))


def percent(value):
    if value is None or value == "":
        return ""
    value = 100 * float(value)
    return f"{value:.2g} %" if value >= 1e-3 else f"{value:.0e} %"


def table(rows, versions):
    lines = ["| case | " + " | ".join(f"{NAMES[p]} {versions.get(NAMES[p], '')}".strip() for p in PROGRAMS) + " |", "|---|---|---|---|"]
    for case in CASES:
        if not any(r["case"] == case for r in rows):
            continue
        module = importlib.import_module(f"cases.{case}")
        cells = []
        for program in PROGRAMS:
            mine = [r for r in rows if r["case"] == case and r["program"] == NAMES[program]]
            if not mine:
                cells.append("not run")
                continue
            b = best(mine)
            error = percent(b["error"])
            right = sum(r["verdict"] == "right" for r in mine)
            tried = f"; {right} of {len(mine)} settings" if len(mine) > 1 else ""
            cells.append(f"{b['verdict']}{', ' + error if error else ''} ({b['cpu_s']} s{tried})")
        lines.append(f"| {module.TITLE} | " + " | ".join(cells) + " |")
    others = [r for r in rows if r["verdict"] != "right"]
    if others:
        lines += ["", "Settings that are not right:", "", "| case | program | setting | verdict | answer | what it said |", "|---|---|---|---|---|---|"]
        for r in others:
            cells = [r[k] for k in ("case", "program", "setting", "verdict", "answer", "said")]
            lines.append("| " + " | ".join(str(c).replace("|", "/")[:160] for c in cells) + " |")
    return lines


def variants(case, program):
    """The settings of a program, by its name in the table."""
    key = next(k for k, name in NAMES.items() if name == program)
    return importlib.import_module(f"cases.{case}").VARIANTS[key]


def main(arguments):
    if arguments[:1] == ["--worker"]:
        return worker(*arguments[1:])
    programs = PROGRAMS
    if "--program" in arguments:
        at = arguments.index("--program")
        programs = [arguments[at + 1]]
        del arguments[at : at + 2]
    setting = ""
    if "--setting" in arguments:
        at = arguments.index("--setting")
        setting = arguments[at + 1]
        del arguments[at : at + 2]
    keep = None
    if "--keep" in arguments:
        at = arguments.index("--keep")
        keep = os.path.abspath(arguments[at + 1])
        del arguments[at : at + 2]
    write = os.path.join(HERE, "results")
    cases = arguments or CASES
    unknown = [c for c in cases if c not in CASES]
    if unknown:
        print(f"no case `{unknown[0]}`; the cases are {', '.join(CASES)}", file=sys.stderr)
        return 2
    from lib import covact, gf

    versions = {"covact": covact.version(), "CalculiX": "", "GetFEM": gf.version()}
    said = subprocess.run(["ccx", "-v"], capture_output=True, text=True).stdout.split()
    versions["CalculiX"] = said[-1] if said else ""
    work = keep or tempfile.mkdtemp()
    rows = []
    for case in cases:
        module = importlib.import_module(f"cases.{case}")
        for program in programs:
            for n, variant in enumerate(module.VARIANTS[program]):
                if setting not in variant:
                    continue
                folder = os.path.join(work, case, f"{program}_{n}")
                shutil.rmtree(folder, ignore_errors=True)
                row = measure(case, program, variant, folder)
                row["version"] = versions[NAMES[program]]
                rows.append(row)
                print(f"{case:15} {NAMES[program]:9} {variant:32} {row['verdict']:22} {row['answer']}  [{row['iterations']} its, {row['increments']} incs, {row['wall_s']} s] {row['said'][:150]}", flush=True)
    # Rows of earlier runs stay for what was not run now.
    if os.path.exists(write + ".csv"):
        with open(write + ".csv") as file:
            for row in csv.DictReader(file):
                row["error"] = float(row["error"]) if row["error"] else None
                known = row["case"] in CASES and row["setting"] in variants(row["case"], row["program"])
                if known and not any(all(row[k] == r[k] for k in ("case", "program", "setting")) for r in rows):
                    rows.append(row)
    order = lambda r: (
        CASES.index(r["case"]), list(NAMES.values()).index(r["program"]), variants(r["case"], r["program"]).index(r["setting"])
    )
    rows.sort(key=order)
    columns = ["case", "program", "version", "setting", "answer", "error", "verdict", "said", "iterations", "increments", "wall_s", "cpu_s"]
    with open(write + ".csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            error = row["error"]
            writer.writerow({**{c: row.get(c, "") for c in columns}, "error": "" if error is None else f"{error:.3g}"})
    lines = table(rows, versions)
    with open(write + ".md", "w") as file:
        file.write(HEAD + "\n".join(lines) + "\n")
    print("\n".join(lines))
    if not keep:
        shutil.rmtree(work)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
