"""What is wrong is told with its place."""

import numpy as np
import pytest

import covact
from conftest import grid, press


def test_a_misspelt_key_is_named_with_its_place_and_the_nearest():
    scene = press()
    scene["contacts"]["press"]["friktion"] = {"coulomb": {"mu": 0.1}}
    with pytest.raises(covact.SceneError, match="did you mean `friction`") as told:
        covact.run(scene)
    problem = told.value.problems[0]
    assert problem["pointer"] == "/contacts/press/friktion"
    assert problem["line"] > 1 and problem["column"] > 1


def test_all_faults_are_told_at_once():
    scene = press()
    scene["contacts"]["press"]["master"] = "bal"
    scene["materials"]["rubber"]["neo_hooke"]["E"] = -1
    with pytest.raises(covact.SceneError) as told:
        covact.check(scene)
    pointers = {problem["pointer"] for problem in told.value.problems}
    assert {"/contacts/press/master", "/materials/rubber/neo_hooke/E"} <= pointers


def test_faults_of_files_name_the_file(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text('{"covact": 1, "bodies": }')
    with pytest.raises(covact.SceneError, match="expected a value") as told:
        covact.run(path)
    assert told.value.problems[0]["line"] == 1
    with pytest.raises(covact.SceneError, match="there is no scene file"):
        covact.run(tmp_path / "scne.json")


def test_names_that_there_are_not():
    simulation = covact.Simulation(press())
    with pytest.raises(KeyError, match="did you mean `ball`"):
        simulation.force("bal")
    with pytest.raises(RuntimeError, match="no step"):
        simulation.force("ball")
    with pytest.raises(KeyError, match="body `sheet`"):
        simulation.body("sheet")
    simulation.step()
    with pytest.raises(KeyError, match="did you mean `force.ball.z`"):
        simulation.history["force.bal.z"]


def test_arrays_that_are_no_mesh():
    points, quads = grid(2)
    scene = press()
    for mesh, told in (
        (covact.Mesh(points, {"quad": quads}, thickness=0.1, cell_sets={"a": [99]}), "99"),
        (covact.Mesh(points, {"quad": quads + 50}, thickness=0.1), "points of cell"),
        (covact.Mesh(points, {"quad": quads}, thickness=-0.1), "thickness"),
        (covact.Mesh(points, {"quad": quads}), "thickness"),
    ):
        scene["bodies"]["plate"]["mesh"] = mesh
        with pytest.raises(covact.SceneError, match=told):
            covact.run(scene)
    with pytest.raises(ValueError, match="tetra"):
        covact.run(press(bodies={"plate": {"mesh": covact.Mesh(points, {"tetra": quads}), "material": "rubber"}}))
    with pytest.raises(ValueError, match=r"\(m, 4\)"):
        covact.Mesh(points, {"quad": quads[:, :3]}).arrays()
    with pytest.raises(TypeError, match="set"):
        covact.run(press(title={1, 2}))
    with pytest.raises(TypeError, match="int"):
        covact.run(3)


def test_numbers_of_numpy_are_numbers():
    scene = press()
    scene["surfaces"]["ball"]["sphere"] = {"radius": np.float64(3), "center": np.array([5, 5, 3.25])}
    assert covact.check(scene)["bodies"][0]["elements"] == 64
