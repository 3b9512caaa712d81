//! Scenes made in a program are those of files, with meshes and surfaces as values, and say what is wrong with them.
use crate::support::{scene_json, set, solve};
use covact::mesh::{self, ElementKind};
use covact::run::{Options, RunError, Simulation};
use covact::scene::{
    self, Axis, Body, Contact, Elastic, Element, Load, MaterialChoice, MeshArrays, Output, Penalty,
    Plate, Points, SceneBuilder, SceneError, Solution, Spacing, SphereShape, Step, Support,
    Surface,
};
use covact::solve::event::{Event, Observer};
use covact_geometry::{Vec3, primitives};
use serde_json::json;
use std::sync::{Arc, Mutex};

fn plate() -> Plate {
    Plate {
        size: [50.0, 50.0],
        thickness: 2.0,
        elements: [8, 8],
        layers: 1,
        origin: [0.0; 3],
        spacing: [Spacing::Uniform; 2],
    }
}

/// The shipped ball on a plate on a coarse mesh, from its parts.
fn ball_on_plate(body: Body, ball: Surface) -> SceneBuilder {
    let mut press = Contact::new("plate.top", "ball");
    press.penalty = Penalty::Value(60000.0);
    press.points = Points::Gauss(2);
    SceneBuilder::new("Clamped plate under a rigid ball")
        .material(
            "plate",
            MaterialChoice::StVenantKirchhoff(Elastic::new(12000.0, 0.3)),
        )
        .body("plate", body)
        .surface("ball", ball.moved(["0", "0", "-10*t"]))
        .contact("press", press)
        .support("clamped_x", Support::fixed("plate.x_max"))
        .support("clamped_y", Support::fixed("plate.y_max"))
        .support("symmetry_x", Support::symmetry("plate.x_min", Axis::X))
        .support("symmetry_y", Support::symmetry("plate.y_min", Axis::Y))
        .solution(Solution {
            end_time: 0.5,
            step: Step {
                initial: 0.125,
                max: 0.125,
                ..Step::default()
            },
            stops: vec![0.25],
            threads: 1,
            ..Solution::default()
        })
        .output(Output {
            every: 0,
            ..Output::default()
        })
}

#[test]
fn a_scene_of_values_is_that_of_its_file() {
    let mut file = scene_json("ball_on_plate.json");
    set(
        &mut file,
        "/bodies/plate/mesh/plate/elements",
        json!([8, 8]),
    );
    file["solution"]["threads"] = json!(1);
    file["solution"]["end_time"] = json!(0.5);
    file["solution"]["stops"] = json!([0.25]);
    let outcome = solve(&file);
    let shape = SphereShape {
        radius: 25.0,
        center: [0.0, 0.0, 26.0],
        axis: [0.0, 1.0, 0.0],
    };
    let patch = primitives::sphere(25.0, Vec3::new(0.0, 0.0, 26.0), Vec3::y()).expect("a sphere");
    let mesh = mesh::plate(&plate(), ElementKind::H8).expect("a plate");
    let made = ball_on_plate(Body::new(plate(), "plate"), shape.into());
    let given = ball_on_plate(Body::new(mesh, "plate"), patch.into());
    for builder in [made, given] {
        let scene = builder.build().expect("valid");
        let mut simulation = Simulation::new(scene, Options::default()).expect("a model");
        while simulation.step().expect("an equilibrium").is_some() {}
        assert_eq!(simulation.history().rows, outcome.history.rows);
        assert!(simulation.force("ball").expect("a surface").force.z < 0.0);
    }
}

/// Its text is a scene file without what is as by default; a checksum stands where a file cannot hold a value.
#[test]
fn the_text_of_a_scene_of_values_is_a_scene_file() {
    let shape = SphereShape {
        radius: 25.0,
        center: [0.0, 0.0, 26.0],
        axis: [0.0, 1.0, 0.0],
    };
    let made = ball_on_plate(Body::new(plate(), "plate"), shape.into());
    let made = made
        .load("push", Load::pressure("plate.bottom", "0.1*t"))
        .build()
        .expect("valid");
    assert!(
        !made.text.contains("\"element\"") && !made.text.contains("linear_solver"),
        "{}",
        made.text
    );
    let read = scene::parse(&made.text, "scene.json").expect("valid");
    assert_eq!(read.scene, made.scene);

    let mesh = mesh::plate(&plate(), ElementKind::H8).expect("a plate");
    let text = |mesh| {
        let built = ball_on_plate(Body::new(mesh, "plate"), shape.into()).build();
        built.expect("valid").text.clone()
    };
    let mut moved = mesh.clone();
    moved.nodes[0].x -= 1e-9;
    let [one, same, other] = [text(mesh.clone()), text(mesh), text(moved)];
    assert_eq!(one, same);
    assert_ne!(one, other);
    // No key of a file.
    let error = scene::parse(&one, "scene.json").expect_err("arrays in a file");
    assert!(
        error.to_string().contains("unknown variant `arrays`")
            || error.to_string().contains("`arrays`"),
        "{error}"
    );
}

/// The pointers of what a check finds.
fn wrong(builder: SceneBuilder) -> Vec<(String, String)> {
    match builder.build() {
        Err(SceneError::Wrong { problems, .. }) => problems
            .into_iter()
            .map(|p| (p.pointer, p.message))
            .collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_wrong_is_told_with_the_field() {
    let good = || {
        ball_on_plate(
            Body::new(plate(), "plate"),
            SphereShape {
                radius: 25.0,
                center: [0.0, 0.0, 26.0],
                axis: [0.0, 1.0, 0.0],
            }
            .into(),
        )
    };
    let cases = [
        (
            good().contact("press", Contact::new("plate.top", "ball")),
            "/contacts/press",
            "two parts of the scene have this name",
        ),
        (
            good().contact("other", Contact::new("plate.tob", "ball")),
            "/contacts/other/slave",
            "has no set `tob`",
        ),
        (
            good().body("more", Body::new(plate(), "plait")),
            "/bodies/more/material",
            "plait",
        ),
        (
            good().load("push", Load::pressure("plate.top", f64::NAN)),
            "/loads/push/pressure",
            "NaN",
        ),
        (
            good().material("bad", MaterialChoice::NeoHooke(Elastic::new(-1.0, 0.3))),
            "/materials/bad/neo_hooke/E",
            "-1",
        ),
        (
            good().surface("none", Surface::default()),
            "/surfaces/none",
            "does not say what it is",
        ),
    ];
    for (builder, pointer, message) in cases {
        let found = wrong(builder);
        assert!(
            found
                .iter()
                .any(|(p, m)| p == pointer && m.contains(message)),
            "{pointer}: {found:?}"
        );
    }
    // A set that a mesh of arrays has is known, and one that it has not is not.
    let mesh = mesh::plate(&plate(), ElementKind::H8).expect("a plate");
    let arrays = || {
        ball_on_plate(
            Body::new(mesh.clone(), "plate"),
            Surface::from(covact::scene::PlaneShape {
                center: [0.0, 0.0, 3.0],
                normal: [0.0, 0.0, -1.0],
                size: [9.0, 9.0],
            }),
        )
    };
    assert!(arrays().build().is_ok());
    let found = wrong(arrays().support("more", Support::fixed("plate.tob")));
    assert_eq!(found[0].0, "/supports/more/on");

    // What only the mesh can tell, with the field as well.
    let unit = |elements: Vec<u32>, each| MeshArrays {
        nodes: (0..8u32)
            .map(|i| [0, 1, 2].map(|k| f64::from(i >> k & 1)))
            .collect(),
        nodes_per_element: each,
        elements,
        ..MeshArrays::default()
    };
    let built = |mesh: MeshArrays, element| {
        let body = Body::new(mesh, "rubber").element(element);
        let scene = SceneBuilder::new("one element")
            .material("rubber", MaterialChoice::NeoHooke(Elastic::new(5.0, 0.4)))
            .body("one", body)
            .build()
            .expect("a form");
        match Simulation::new(scene, Options::default()).err() {
            Some(RunError::Scene {
                message, pointer, ..
            }) => (pointer, message),
            other => panic!("{other:?}"),
        }
    };
    for (mesh, element, message) in [
        (
            unit((0..8).collect(), 8),
            Element::Q18,
            "18, which the element of the body has",
        ),
        (
            unit((0..9).collect(), 8),
            Element::H8,
            "a multiple of 8 node numbers",
        ),
        (unit((1..9).collect(), 8), Element::H8, "node 8"),
        (
            unit(vec![1, 0, 2, 3, 4, 5, 6, 7], 8),
            Element::H8,
            "inverted",
        ),
    ] {
        let (pointer, found) = built(mesh, element);
        assert_eq!(pointer, "/bodies/one/mesh");
        assert!(found.contains(message), "{found}");
    }
}

/// Notes how many system calls that write the thread of the run has made when the model is there, and at the end.
#[cfg(target_os = "linux")]
struct Writes(Arc<Mutex<Vec<u64>>>);

#[cfg(target_os = "linux")]
impl Observer for Writes {
    fn event(&mut self, event: &Event) {
        if matches!(event, Event::Model { .. } | Event::Finished { .. }) {
            let io = std::fs::read_to_string("/proc/thread-self/io")
                .expect("what a thread has read and written");
            let count = io
                .lines()
                .find_map(|line| line.strip_prefix("syscw: "))
                .expect("a count");
            self.0
                .lock()
                .expect("one thread")
                .push(count.parse().expect("a number"));
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_without_sinks_writes_nothing() {
    let writes = |sinks: bool| {
        let counts = Arc::new(Mutex::new(Vec::new()));
        let options = Options {
            observer: Box::new(Writes(Arc::clone(&counts))),
            ..Options::default()
        };
        let shape = SphereShape {
            radius: 25.0,
            center: [0.0, 0.0, 26.0],
            axis: [0.0, 1.0, 0.0],
        };
        let scene = ball_on_plate(Body::new(plate(), "plate"), shape.into())
            .build()
            .expect("valid");
        let mut simulation = Simulation::new(scene, options).expect("a model");
        let folder = tempfile::tempdir().expect("temporary folder");
        let mut files =
            covact::run::ResultsFolder::new(folder.path().join("out")).expect("nothing there");
        match sinks {
            true => simulation.run(&mut [&mut files]),
            false => simulation.run(&mut []),
        }
        .expect("a run");
        let counts = counts.lock().expect("one thread");
        counts[1] - counts[0]
    };
    assert!(writes(true) > 10);
    assert_eq!(writes(false), 0);
}
