"""The command line and studies, whose runs are processes of it."""

import json
import subprocess
import sys

import pytest

import covact
from conftest import press


def test_the_command_line():
    done = subprocess.run([sys.executable, "-m", "covact", "--version"], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.split() == ["covact", covact.__version__]
    wrong = subprocess.run([sys.executable, "-m", "covact", "run", "none.json", "-o", "none"], capture_output=True, text=True)
    assert wrong.returncode == 3 and "none.json" in wrong.stderr


def test_a_study_and_its_table(tmp_path):
    (tmp_path / "press.json").write_text(json.dumps({"covact": 1} | press(solution={"end_time": 0.3})))
    study = {
        "covact_study": 1,
        "title": "Meshes",
        "question": "What does a finer mesh change?",
        "scene": "press.json",
        "grids": [
            {
                "choices": [
                    {"key": {"name": "n", "at": ["/bodies/plate/mesh/plate/elements"], "values": [[4, 4], [8, 8]]}}
                ]
            }
        ],
        "quantities": [{"name": "force", "of": {"column": {"name": "force.ball.z"}}, "unit": "N"}],
    }
    (tmp_path / "study.json").write_text(json.dumps(study))
    if covact.study.__globals__["program"]() is None:
        pytest.skip("the program `covact` is not on the path")
    found = covact.study(tmp_path / "study.json", tmp_path / "out")
    assert (tmp_path / "out" / "report.html").is_file()
    rows = found.table()
    assert len(rows) == 2 and rows[0]["id"] != rows[1]["id"]
    assert [row["n"] for row in rows] == ["n 4 x 4", "n 8 x 8"]
    assert rows[0]["dofs"] == 54 and rows[1]["dofs"] == 294 and all(row["ending"] == "done" for row in rows)
    direct = covact.run(tmp_path / "press.json")
    assert rows[1]["force"] == pytest.approx(direct.history["force.ball.z"][-1], rel=1e-12)
    # What is done is not done again.
    assert covact.study(tmp_path / "study.json", tmp_path / "out").table()[0]["wall_s"] == rows[0]["wall_s"]


def test_a_table_has_errors_and_runs_that_failed(tmp_path):
    """`force` against a given value; one of the runs cannot converge."""
    (tmp_path / "press.json").write_text(json.dumps({"covact": 1} | press(solution={"end_time": 0.1})))
    strict = {"/solution/newton": {"max_iterations": 1}, "/solution/step": {"initial": 0.1, "min": 0.1, "max": 0.1}}
    study = {
        "covact_study": 1,
        "title": "Limits",
        "scene": "press.json",
        "may_fail": True,
        "grids": [
            {
                "choices": [
                    {"variants": {"name": "limits", "values": [{"label": "plain"}, {"label": "strict", "set": strict}]}}
                ]
            }
        ],
        "quantities": [
            {
                "name": "force",
                "of": {"column": {"name": "force.ball.z"}},
                "reference": {"value": {"value": -2.0, "source": "made up"}},
                "unit": "N",
            },
            {"name": "height", "of": {"column": {"name": "way.ball.z", "take": "min"}}},
        ],
    }
    (tmp_path / "study.json").write_text(json.dumps(study))
    if covact.study.__globals__["program"]() is None:
        pytest.skip("the program `covact` is not on the path")
    found = covact.study(tmp_path / "study.json", tmp_path / "out")
    assert repr(found) == "Study('Limits', 2 runs)" and found.folder == tmp_path / "out"
    plain, strict = found.table()
    assert (plain["limits"], plain["ending"]) == ("plain", "done") and plain["height"] == pytest.approx(-0.1)
    assert plain["force, error"] == pytest.approx(abs(plain["force"] + 2) / 2, rel=1e-9)
    assert set(plain) == set(strict) and strict["limits"] == "strict"
    assert strict["ending"] != "done" and strict["force"] is None and strict["force, error"] is None
    for key in ("wall_s", "cpu_s", "dofs", "steps", "newton_iterations", "peak_memory_mb"):
        assert plain[key] > 0, key
    json.dumps(found.table())
