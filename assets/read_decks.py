"""Reads input decks of CalculiX, such as those of Debian's package calculix-ccx-test, with `covact check`.

    apt-get download calculix-ccx-test && dpkg-deb -x calculix-ccx-test_*.deb decks
    python3 assets/read_decks.py target/release/covact decks

Every deck loads, as a body of solid elements or as a surface that is given a thickness, or is refused with a message that
names what it needs; anything else, such as a crash, fails. Refusals are printed.
"""

from __future__ import annotations

import gzip
import json
import pathlib
import subprocess
import sys
import tempfile

#: Exit codes of a scene that can be run, and of one that is refused.
RIGHT, REFUSED = 0, 3


def scene(path: pathlib.Path, element: str, surface: bool) -> str:
    mesh = {"path": str(path), **({"thickness": 0.1} if surface else {})}
    body = {"mesh": {"file": mesh}, "material": "m", "element": element}
    return json.dumps({"covact": 1, "materials": {"m": {"neo_hooke": {"E": 1, "nu": 0.3}}}, "bodies": {"b": body}})


def read(program: str, deck: pathlib.Path, folder: pathlib.Path) -> tuple[bool, str]:
    """Whether a deck loads in any way, and else why not."""
    file = folder / "deck.inp"
    data = deck.read_bytes()
    file.write_bytes(gzip.decompress(data) if deck.suffix == ".gz" else data)
    messages = []
    for surface in (False, True):
        for element in ("h8", "q18"):
            (folder / "scene.json").write_text(scene(file, element, surface), encoding="utf-8")
            done = subprocess.run([program, "check", str(folder / "scene.json")], capture_output=True, text=True, timeout=300)
            # A body that nothing supports has been read.
            if done.returncode == RIGHT or "can move freely" in done.stderr:
                return True, ""
            if done.returncode != REFUSED:
                raise SystemExit(f"{deck.name}: exit code {done.returncode}\n{done.stderr}")
            first = done.stderr.splitlines()[0]
            messages.append(first.split(f"{file}", 1)[-1].lstrip(":0123456789 "))
    # As a surface it lacks quadrilaterals: what it lacks as a solid is meant, and that of `q18`, which takes more.
    return False, messages[1] if "no quadrilaterals" in messages[2] and "no hexahedra" not in messages[1] else messages[2]


def main() -> None:
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    decks = sorted([*pathlib.Path(sys.argv[2]).rglob("*.inp"), *pathlib.Path(sys.argv[2]).rglob("*.inp.gz")])
    loaded = 0
    with tempfile.TemporaryDirectory() as folder:
        for deck in decks:
            right, why = read(str(pathlib.Path(sys.argv[1]).resolve()), deck, pathlib.Path(folder))
            loaded += right
            if not right:
                print(f"{deck.name}: {why}")
    print(f"{loaded} of {len(decks)} decks load")


if __name__ == "__main__":
    main()
