"""Scenes put together by calls are those of files."""

import importlib.util
import inspect
import json
import re

import numpy as np
import pytest

import covact
from conftest import ROOT, cube, press

SCENES = sorted(path for path in (ROOT / "examples" / "scenes").glob("*.json") if path.stem != "schema")


def generator():
    spec = importlib.util.spec_from_file_location("make_builders", ROOT / "assets" / "make_builders.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_methods_are_those_of_the_schema():
    maker = generator()
    assert maker.TARGET.read_text(encoding="utf-8") == maker.text(), "run assets/make_builders.py"


def test_every_method_says_what_its_arguments_are():
    methods = [(name, method) for name, method in inspect.getmembers(covact.Scene, inspect.isfunction) if name[0] != "_"]
    assert len(methods) > 25
    for name, method in methods:
        text = inspect.getdoc(method)
        assert text and text[0].isupper(), name
        for argument in list(inspect.signature(method).parameters)[1:]:
            if name not in ("check", "run", "save"):
                assert re.search(rf"^{argument}: .+\n +\S", text, re.M), f"{name}: {argument}"


def built(scene):
    """The same scene, every part by a method."""
    new = covact.Scene()
    schema = generator().Schema()
    laws, meshes = dict(schema.kinds("MaterialChoice")), dict(schema.kinds("MeshSource"))
    for name, law in scene["materials"].items():
        if isinstance(law, str):
            new.material(name, law)
        else:
            ((kind, keys),) = law.items()
            assert kind in laws
            getattr(new, kind)(name, **keys)
    for name, body in scene["bodies"].items():
        rest = {key: value for key, value in body.items() if key not in ("mesh", "nurbs")}
        if "nurbs" in body:
            new.nurbs(name, **rest, **body["nurbs"])
            continue
        mesh = {"file": body["mesh"]} if isinstance(body["mesh"], str) else body["mesh"]
        ((kind, keys),) = mesh.items()
        assert kind in meshes
        keys = {"path": keys} if isinstance(keys, str) else keys
        getattr(new, "mesh_file" if kind == "file" else kind)(name, **rest, **keys)
    for name, surface in scene.get("surfaces", {}).items():
        (kind,) = set(surface) & {"cad", "sphere", "cylinder", "plane"}
        keys = {"file": surface[kind]} if isinstance(surface[kind], str) else surface[kind]
        getattr(new, kind)(name, **keys, **{key: value for key, value in surface.items() if key not in (kind, "motion")})
        if "motion" in surface:
            new.move(name, **surface["motion"])
    for section in ("contacts", "supports", "loads", "probes"):
        for name, part in scene.get(section, {}).items():
            getattr(new, section[:-1])(name, **part)
    for stage in scene.get("stages", []):
        new.stage(**stage)
    for name in ("units", "solution", "output"):
        if name in scene:
            getattr(new, name)(**scene[name])
    return new


def whole(scene):
    """With the words that stand for a file written in full."""
    for body in scene["bodies"].values():
        if isinstance(body.get("mesh"), str):
            body["mesh"] = {"file": body["mesh"]}
        if isinstance(body.get("mesh", {}).get("file"), str):
            body["mesh"] = {"file": {"path": body["mesh"]["file"]}}
    for surface in scene.get("surfaces", {}).values():
        if isinstance(surface.get("cad"), str):
            surface["cad"] = {"file": surface["cad"]}
    return scene


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_shipped_scenes_can_be_built(path):
    # Lines of comments.
    text = re.sub(r"^\s*//.*$", "", path.read_text(encoding="utf-8"), flags=re.M)
    scene = whole(json.loads(text))
    new = built(scene)
    for key in ("$schema", "title"):
        scene.pop(key, None)
    assert new == scene


def test_a_scene_of_calls_runs_as_its_dict():
    scene = covact.Scene("A ball on a clamped plate")
    scene.neo_hooke("rubber", E=2.0, nu=0.4)
    scene.plate("plate", "rubber", size=[10, 10], thickness=0.5, elements=[8, 8])
    scene.sphere("ball", radius=3, center=[5, 5, 3.25]).move("ball", translation=[0, 0, "-t"])
    scene.contact("press", "plate.top", "ball")
    scene.support("rim", ["plate.x_min", "plate.x_max", "plate.y_min", "plate.y_max"], fixed=True)
    assert scene == {"covact": 1} | press()
    assert scene.check()["bodies"][0]["elements"] == 64
    scene.solution(end_time=0.2)
    result = scene.run()
    expected = covact.run(press(solution={"end_time": 0.2}))
    assert result.done and np.array_equal(result.history.rows, expected.history.rows)


def test_a_scene_is_saved_and_taken_up(tmp_path):
    scene = covact.Scene(scene=press()).solution(end_time=np.float64(0.1))
    path = scene.save(tmp_path / "press.json")
    assert covact.run(path).history["time"][-1] == 0.1
    # A scene to start from is not changed.
    start = press()
    covact.Scene(scene=start).move("ball", translation=[0, 0, 1]).solution(threads=1)
    assert start == press()


def test_arrays_stand_in_scenes_of_calls(tmp_path):
    points, hexahedra = cube(2)
    scene = covact.Scene().material("m", "steel").units(length="mm", force="N")
    scene.mesh("cube", "m", covact.Mesh(points, {"hexahedron": hexahedra}))
    knots = [0, 0, 1, 1]
    plane = covact.geometry.patch([1, 1], [knots, knots], [[[0, 0, 1], [0, 1, 1]], [[1, 0, 1], [1, 1, 1]]])
    scene.patches("tool", plane, side="reversed").move("tool", translation=[0, 0, "-0.01*t"])
    scene.support("below", "cube", fixed=True)
    report = scene.check()
    assert report["bodies"][0]["elements"] == 8 and report["surfaces"][0]["patches"] == 1
    with pytest.raises(TypeError, match="Mesh"):
        scene.save(tmp_path / "cube.json")


def test_faults_of_calls():
    scene = covact.Scene()
    with pytest.raises(KeyError, match="no `ball` among its surfaces: none"):
        scene.move("ball", translation=[0, 0, 1])
    with pytest.raises(TypeError, match="thicknes"):
        scene.plate("sheet", "steel", size=[1, 1], thicknes=1, elements=[1, 1])
    with pytest.raises(covact.SceneError, match="materials"):
        scene.check()
