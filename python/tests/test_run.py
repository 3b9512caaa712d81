"""Runs: in memory, stepped, stopped, into folders."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import covact
from conftest import cube, grid, press


def test_results_come_without_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = covact.run(press())
    assert result.done and result.status == "done"
    force = result.history["force.ball.z"]
    # The ball goes down and is held up ever more.
    assert result.history["time"][-1] == 1.0 and np.all(np.diff(force) < 0)
    assert len(force) == len(result.history.rows) == result.summary["steps"]
    plate = result.bodies["plate"]
    assert plate.nodes.shape == (162, 3) and plate.elements.shape == (64, 8)
    assert plate.fields["cauchy_stress"].shape == (162, 6)
    assert plate.displacement[:, 2].min() < -0.8
    # What the ball exerts, the rim holds.
    rim = ((plate.nodes[:, :2] == 0) | (plate.nodes[:, :2] == 10)).any(axis=1)
    reaction = plate.fields["reaction"][rim].sum(axis=0)
    assert reaction[2] == pytest.approx(-force[-1], rel=1e-6)
    assert os.listdir(tmp_path) == []


def test_a_cube_of_arrays_under_a_patch_has_its_closed_form():
    """Uniaxial stress of a St. Venant-Kirchhoff material: P = E/2 (l^2 - 1) l on any mesh of plain bricks."""
    points, hexahedra = cube(4)
    mesh = covact.Mesh(points, {"hexahedron": hexahedra})
    knots = [0, 0, 0, 1, 1, 1]
    x, y = np.meshgrid([-0.5, 0.7, 1.5], [-0.5, 0.2, 1.5], indexing="ij")
    # Rational, so that its parameters run unevenly over the plane; the normal looks down.
    weights = np.array([[1.0, 0.6, 1.0], [0.8, 2.0, 0.8], [1.0, 1.3, 1.0]])
    tool = covact.geometry.patch([2, 2], [knots, knots], np.stack([x, y, np.ones_like(x)], axis=-1), weights)
    symmetric = lambda side, axis: {"on": f"cube.{side}", "symmetry": axis}  # noqa: E731
    facing = lambda normal: {"faces_facing": {"normal": normal, "angle": 10}}  # noqa: E731
    scene = {
        "materials": {"elastic": {"st_venant_kirchhoff": {"E": 100.0, "nu": 0.3}}},
        "bodies": {
            "cube": {
                "mesh": mesh,
                "material": "elastic",
                "element": "h8_displacement",
                "sets": {
                    "left": facing([-1, 0, 0]),
                    "front": facing([0, -1, 0]),
                    "below": facing([0, 0, -1]),
                    "above": facing([0, 0, 1]),
                },
            }
        },
        "surfaces": {"tool": {"patches": tool, "motion": {"translation": [0, 0, "-0.1*t"]}}},
        "contacts": {"press": {"slave": "cube.above", "master": "tool", "accuracy": 2e-4}},
        "supports": {"x": symmetric("left", "x"), "y": symmetric("front", "y"), "z": symmetric("below", "z")},
    }
    result = covact.run(scene)
    assert result.done
    stretch = 0.9
    expected = 100.0 * 0.5 * (stretch**2 - 1) * stretch
    assert result.history["force.tool.z"][-1] == pytest.approx(expected, rel=1e-3)
    above = points[:, 2] == 1.0
    pressure = result.bodies["cube"].fields["contact_pressure"]
    # The same nodes in the same order.
    assert np.abs(result.bodies["cube"].nodes - points).max() < 1e-12
    assert np.abs(pressure[above] / -expected - 1).max() < 1e-3


def test_a_surface_of_arrays_is_the_plate_of_the_generator():
    points, quads = grid(8)
    points[:, :2] *= 10
    mesh = covact.Mesh(points, {"quad": quads}, thickness=0.5, point_sets={"middle": [40]})
    scene = press()
    expected = covact.run(scene).history["force.ball.z"]
    scene["bodies"] = {"plate": {"mesh": mesh, "material": "rubber"}}
    scene["supports"] = {"rim": {"on": "plate.border", "fixed": True}}
    scene["probes"] = {"middle": {"on": "plate.middle", "quantity": "displacement"}}
    result = covact.run(scene)
    assert result.history["force.ball.z"] == pytest.approx(expected, rel=1e-9)
    assert result.history["probe.middle.z"][-1] < -0.8


def test_steps_are_taken_one_by_one_and_a_callback_ends_a_run():
    simulation = covact.Simulation(press())
    first = simulation.step()
    assert (first.number, simulation.steps, simulation.time) == (1, 1, first.time)
    assert simulation.force("ball")[2] < 0
    assert simulation.value("force.ball.z") == simulation.force("ball")[2]
    seen = [(first.attempt, first.number)]

    def enough(run, step):
        seen.append((step.attempt, step.number))
        return run.force("ball")[2] > -0.03

    result = simulation.run(enough)
    # The ball sinks in between the nodes: the run begins again with Gauss points.
    attempts = sorted({attempt for attempt, _ in seen})
    assert attempts == [1, 2] and not simulation.done
    for attempt in attempts:
        numbers = [number for a, number in seen if a == attempt]
        assert numbers == list(range(1, 1 + len(numbers)))
    assert simulation.steps == len(result.history["time"]) == len(numbers)
    force = result.history["force.ball.z"]
    assert force[-1] <= -0.03 and np.all(force[:-1] > -0.03)
    # It can go on from there.
    assert [step.number for step in simulation][0] == numbers[-1] + 1
    assert simulation.done and simulation.step() is None


def test_an_observer_hears_of_iterations_and_may_end_a_run():
    events = []
    covact.run(press(), observer=events.append)
    kinds = [event["event"] for event in events]
    assert kinds[0] == "model" and kinds[-1] == "finished" and kinds.count("iteration") > 10

    def fault(event):
        if event["event"] == "step_accepted":
            raise ZeroDivisionError("enough")

    with pytest.raises(ZeroDivisionError, match="enough"):
        covact.run(press(), observer=fault)


def slow():
    """Some seconds of work, most of them in one step."""
    scene = press()
    scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = [60, 60]
    return scene


def test_other_threads_go_on_while_a_run_is_solved():
    simulation = covact.Simulation(slow())
    ticks = 0
    ended = threading.Event()

    def count():
        nonlocal ticks
        while not ended.wait(0.005):
            ticks += 1

    thread = threading.Thread(target=count)
    thread.start()
    start = time.perf_counter()
    simulation.step()
    took = time.perf_counter() - start
    ended.set()
    thread.join()
    # A tenth of what would be counted alone, on a busy machine.
    assert ticks > max(2, 0.1 * took / 0.005)


def test_ctrl_c_ends_a_step_and_the_next_goes_on():
    simulation = covact.Simulation(slow())
    simulation.step()
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        for _ in simulation:
            pass
    before = simulation.steps
    assert not simulation.done
    assert simulation.step().number == before + 1


def test_a_folder_holds_what_memory_holds(tmp_path):
    result = covact.run(press(), tmp_path / "out")
    assert (tmp_path / "out" / "results.pvd").is_file()
    read = covact.read(tmp_path / "out")
    assert read.history.columns == result.history.columns
    assert np.array_equal(read.history.rows, result.history.rows)
    assert read.status == "done"
    # Nobody asked to replace it.
    with pytest.raises(covact.Error, match="out"):
        covact.run(press(), tmp_path / "out")
    again = covact.run(press(), tmp_path / "out", replace=True)
    assert np.array_equal(again.history.rows, result.history.rows)
    with pytest.raises(covact.Error, match="reached its end"):
        covact.run(press(), tmp_path / "out", resume=True)


def test_a_run_is_taken_up_where_it_was_left(tmp_path):
    out = tmp_path / "out"
    whole = covact.run(press())
    first = covact.Simulation(press(), out)
    first.step()
    first.step()
    del first
    second = covact.Simulation(press(), out, resume=True)
    result = second.run()
    assert result.done
    assert np.allclose(result.history.rows, whole.history.rows, rtol=1e-9, atol=1e-12)


def test_what_does_not_converge_says_so():
    scene = press(solution={"step": {"initial": 1.0, "min": 1.0, "max": 1.0}, "newton": {"max_iterations": 1}})
    simulation = covact.Simulation(scene)
    with pytest.raises(covact.NotConverged):
        simulation.step()
    result = covact.run(scene)
    assert not result.done and result.status == "not_converged"


def test_meshes_of_meshio(tmp_path):
    meshio = pytest.importorskip("meshio")
    points, quads = grid(4)
    sets = {"half": [np.arange(8)], "rest": [np.arange(8, 16)]}
    mesh = covact.Mesh.from_meshio(meshio.Mesh(10 * points, [("quad", quads)], cell_sets=sets), thickness=0.5)
    scene = press(supports={"rim": {"on": "plate.border", "fixed": True}})
    scene["bodies"]["plate"]["mesh"] = mesh
    report = covact.check(scene)
    assert report["bodies"][0]["elements"] == 16
    scene["contacts"]["press"]["slave"] = "plate.half_top"
    body = covact.run(scene | {"solution": {"end_time": 0.1}}).bodies["plate"]
    body.to_meshio().write(tmp_path / "plate.vtu")
    again = meshio.read(tmp_path / "plate.vtu")
    assert np.array_equal(again.point_data["displacement"], body.displacement)
    assert len(again.cells[0].data) == 16


def test_files_that_meshio_writes(tmp_path):
    meshio = pytest.importorskip("meshio")
    points, quads = grid(4)
    # A bent sheet: its faces look one way in every file.
    points = 10 * points + np.outer(np.sin(points[:, 0]), [0, 0, 1])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    for name, kind, options in [
        ("gmsh.msh", "gmsh", {"binary": False}),
        ("gmsh_binary.msh", "gmsh", {"binary": True}),
        ("gmsh_2.msh", "gmsh22", {"binary": False}),
        ("gmsh_2_binary.msh", "gmsh22", {"binary": True}),
        ("abaqus.inp", "abaqus", {}),
        ("large.bdf", "nastran", {}),
        ("small.bdf", "nastran", {"point_format": "fixed-small", "cell_format": "fixed-small"}),
        ("legacy_4.vtk", "vtk42", {"binary": False}),
        ("legacy_4_binary.vtk", "vtk42", {"binary": True}),
        ("legacy_5.vtk", "vtk51", {"binary": False}),
        ("legacy_5_binary.vtk", "vtk51", {"binary": True}),
        ("text.vtu", "vtu", {"binary": False}),
        ("zlib.vtu", "vtu", {"compression": "zlib"}),
        ("plain.vtu", "vtu", {"compression": None}),
        ("text.stl", "stl", {"binary": False}),
        ("binary.stl", "stl", {"binary": True}),
    ]:
        # Every triangle is cut into three quadrilaterals.
        cells = [("triangle", triangles, 96)] + ([("quad", quads, 16)] if kind != "stl" else [])
        for shape, connectivity, elements in cells:
            meshio.write(tmp_path / name, meshio.Mesh(points, [(shape, connectivity)]), file_format=kind, **options)
            scene = press(supports={"rim": {"on": "plate.border", "fixed": True}}, contacts={}, surfaces={})
            scene["bodies"]["plate"]["mesh"] = {"file": {"path": str(tmp_path / name), "thickness": 0.5}}
            report = covact.check(scene)
            assert report["bodies"][0]["elements"] == elements, (name, shape)


def test_meshes_of_pyvista():
    pyvista = pytest.importorskip("pyvista")
    # A surface of pyvista is a body once it has a thickness.
    plane = pyvista.Plane(center=(5, 5, 0), i_size=10, j_size=10, i_resolution=4, j_resolution=4)
    mesh = covact.Mesh.from_pyvista(plane, thickness=0.5)
    scene = press(supports={"rim": {"on": "plate.border", "fixed": True}})
    scene["bodies"]["plate"]["mesh"] = mesh
    body = covact.run(scene | {"solution": {"end_time": 0.1}}).bodies["plate"]
    drawn = body.to_pyvista()
    assert drawn.n_cells == 16 and np.array_equal(drawn.points, body.deformed)
    assert np.array_equal(drawn.point_data["displacement"], body.displacement)
    assert drawn.volume == pytest.approx(50, rel=1e-3)
    # Its hexahedra are a body as they are; other cells are refused.
    again = covact.Mesh.from_pyvista(body.to_pyvista(deformed=False))
    assert again.cells["hexahedron"].shape == (16, 8)
    wedge = pyvista.UnstructuredGrid({pyvista.CellType.WEDGE: np.arange(6)[None]}, np.eye(6)[:, :3])
    with pytest.raises(ValueError, match="type 13"):
        covact.Mesh.from_pyvista(wedge)


def test_surfaces_of_pyvista(assets):
    pyvista = pytest.importorskip("pyvista")
    sphere = covact.geometry.load(assets / "sphere.igs")
    drawn = sphere.to_pyvista(divisions=24)
    assert isinstance(drawn, pyvista.PolyData)
    low, high = sphere.bounds
    radius = (high - low)[0] / 2
    assert drawn.area == pytest.approx(4 * np.pi * radius**2, rel=0.01)
    # Normals point outwards.
    away = np.asarray(drawn.points) - (low + high) / 2
    assert ((away * drawn.point_data["Normals"]).sum(axis=1) > 0.9 * radius).all()


def staged():
    scene = press()
    ball = dict(scene["surfaces"]["ball"])
    del ball["motion"]
    stages = [{"name": "down", "tools": {"ball": [0, 0, -1]}}]
    return scene | {"surfaces": {"ball": ball}, "stages": stages}


def test_a_callback_decides_on_what_comes_next():
    turned = []

    def turn(simulation, step):
        if not turned and simulation.force("ball")[2] < -0.02:
            turned.append(step.time)
            simulation.begin_stage({"name": "up", "until": step.time + 0.4, "tools": {"ball": np.array([0, 0, 0.1])}})

    result = covact.run(staged(), callback=turn)
    way = result.history["way.ball.z"]
    assert result.done and 0 < turned[0] < 1
    assert result.history["time"][-1] == pytest.approx(turned[0] + 0.4)
    # The ball has turned where it was, and has left the plate.
    assert way.min() == pytest.approx(-turned[0]) and way[-1] == pytest.approx(0.1)
    assert result.history["force.ball.z"].min() < -0.02 and result.history["force.ball.z"][-1] == 0
    assert [stage["name"] for stage in result.summary["stages"]] == ["down", "up"]


def test_stages_that_cannot_begin():
    simulation = covact.Simulation(staged())
    with pytest.raises(covact.SceneError, match="no step yet"):
        simulation.begin_stage({"name": "up", "until": 2})
    simulation.step()
    with pytest.raises(covact.SceneError, match="bal"):
        simulation.begin_stage({"name": "up", "until": 2, "tools": {"bal": [0, 0, 0]}})
    with pytest.raises(covact.Error, match="no stage"):
        simulation.begin_stage({"name": "up", "til": 2})
    with pytest.raises(covact.SceneError, match="has no stages"):
        plain = covact.Simulation(press())
        plain.step()
        plain.begin_stage({"name": "up", "until": 2})
    assert simulation.run().done


def test_probes_are_what_fields_say():
    scene = press(
        probes={
            "middle": {"near": [5, 5, 0]},
            "rim": {"on": ["plate.x_min", "plate.x_max", "plate.y_min", "plate.y_max"], "quantity": "reaction"},
            "stress": {"body": "plate", "quantity": "von_mises"},
            "deepest": {"body": "plate", "take": "max"},
            "top": {"on": "plate.top", "take": "mean"},
        },
        solution={"end_time": 0.4},
    )
    simulation = covact.Simulation(scene)
    result = simulation.run()
    plate, history = result.bodies["plate"], result.history
    near = np.linalg.norm(plate.nodes - [5, 5, 0], axis=1).argmin()
    for axis, column in enumerate("xyz"):
        assert history[f"probe.middle.{column}"][-1] == pytest.approx(plate.displacement[near, axis], abs=1e-12)
    # The rim bears what the ball exerts.
    assert history["probe.rim.z"][-1] == pytest.approx(-history["force.ball.z"][-1], rel=1e-6)
    assert history["probe.stress"][-1] == pytest.approx(plate.fields["von_mises"].max(), rel=1e-5)
    assert history["probe.deepest"][-1] == pytest.approx(np.linalg.norm(plate.displacement, axis=1).max(), rel=1e-9)
    top = plate.displacement[plate.node_sets["top"]].mean(axis=0)
    assert history["probe.top.z"][-1] == pytest.approx(top[2], rel=1e-9)
    assert simulation.value("probe.top.z") == history["probe.top.z"][-1]
    # Every step has its number.
    assert len(history["probe.middle.z"]) == len(history["time"]) and np.all(np.diff(history["probe.middle.z"]) < 0)
    with pytest.raises(KeyError, match="did you mean `probe.middle.z`"):
        history["probe.midle.z"]


def test_probes_that_are_wrong():
    with pytest.raises(covact.SceneError, match="middel"):
        covact.check(press(probes={"p": {"on": "plate.middel"}}))
    with pytest.raises(covact.SceneError, match="von_mises"):
        covact.check(press(probes={"p": {"near": [5, 5, 0], "quantity": "von_mise"}}))


def test_a_callback_changes_loads():
    scene = press(
        surfaces={},
        contacts={},
        loads={"air": {"on": "plate.top", "pressure": 0.01}},
        probes={"middle": {"near": [5, 5, 0]}},
        stages=[{"name": "blow", "loads": {"air": 1}}],
    )
    turned = []

    def vent(simulation, step):
        if not turned and simulation.value("probe.middle.z") < -0.05:
            turned.append(step.time)
            simulation.begin_stage({"name": "vent", "until": step.time + 0.5, "loads": {"air": 0}})

    result = covact.run(scene, callback=vent)
    middle = result.history["probe.middle.z"]
    assert result.done and 0 < turned[0] < 1 and middle.min() < -0.05
    # Without the pressure the plate is flat again.
    assert abs(middle[-1]) < 1e-8 and result.history["time"][-1] == pytest.approx(turned[0] + 0.5)
