"""The programs of the guide and of the notebooks run."""

import json
import re

import pytest

from conftest import ROOT

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")


def test_the_programs_of_the_guide(tmp_path, monkeypatch, capsys):
    guide = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    programs = re.findall(r"```python\n(.*?)```", guide, re.S)
    assert len(programs) >= 4
    for name in ("assets", "examples"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    names = {}
    for program in programs:
        exec(compile(program, "docs/python.md", "exec"), names)
    assert names["result"].done and (tmp_path / "press.png").stat().st_size > 10_000
    assert names["stress"].shape[1] == 6 and names["simulation"].value("pressure.max") > 200
    assert abs(names["feet"].distance).max() > 0
    # The ball has come down until it exerted 1, and has gone back.
    assert names["pressed"].done and 0 < names["reached"][0] < 1
    assert names["pressed"].history["way.ball.z"][-1] == 0
    assert "done" in capsys.readouterr().out


def test_the_tutorial(tmp_path, monkeypatch, capsys):
    page = (ROOT / "docs" / "tutorials" / "python.md").read_text(encoding="utf-8")
    programs = re.findall(r"```python\n(.*?)```", page, re.S)
    assert len(programs) >= 4
    (tmp_path / "assets").symlink_to(ROOT / "assets")
    monkeypatch.chdir(tmp_path)
    names = {}
    for program in programs:
        exec(compile(program, "docs/tutorials/python.md", "exec"), names)
    assert names["result"].done and (tmp_path / "press.png").stat().st_size > 10_000
    assert names["simulation"].force("punch")[2] < -10 and not names["simulation"].done
    # Friction holds the sheet: it is stretched more.
    assert names["ends"][0.3] < names["ends"][0.0] < -10
    assert "done" in capsys.readouterr().out


@pytest.mark.parametrize("page", ["python.md", "tutorials/python.md"])
def test_the_first_program_is_as_short_as_it_says(page):
    guide = (ROOT / "docs" / page).read_text(encoding="utf-8")
    first = re.search(r"```python\n(.*?)```", guide, re.S).group(1)
    # From nothing to a picture.
    lines = [line for line in first.splitlines() if line.strip()]
    assert len(lines) <= 10 and "savefig" in first


@pytest.mark.parametrize("name", ["first_press", "punch_radius", "convergence"])
def test_notebooks(name, monkeypatch):
    if name == "punch_radius":
        pytest.importorskip("scipy")
    folder = ROOT / "python" / "notebooks"
    monkeypatch.chdir(folder)
    book = json.loads((folder / f"{name}.ipynb").read_text(encoding="utf-8"))
    names = {}
    pictures = 0
    for cell in book["cells"]:
        if cell["cell_type"] == "code":
            # Each ends in checks of its own.
            exec(compile("".join(cell["source"]), f"{name}.ipynb", "exec"), names)
            pictures += sum("image/png" in output.get("data", {}) for output in cell["outputs"])
    assert pictures >= 1
