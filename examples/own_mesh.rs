//! A mesh and a NURBS surface given as arrays: a cube whose inner nodes are moved about is squeezed by a flat tool.
//!
//! ```sh
//! cargo run --release --example own_mesh
//! ```
use covact::geometry::{NurbsPatch, Vec3};
use covact::run::{Options, Simulation};
use covact::scene::{
    Axis, Body, Contact, Elastic, Element, MaterialChoice, MeshArrays, SceneBuilder, Support,
    Surface, Value,
};
use std::collections::BTreeMap;
use std::error::Error;

/// Elements along each edge of the cube, whose edges have length 1.
const N: u32 = 4;
const E: f64 = 100.0;
const NU: f64 = 0.3;
/// How far the tool comes down.
const DEPTH: f64 = 0.1;

/// A cube of elements whose inner nodes are not where a regular mesh has them.
fn cube() -> MeshArrays {
    let number = |i: u32, j: u32, k: u32| i + (N + 1) * (j + (N + 1) * k);
    let mut mesh = MeshArrays {
        nodes_per_element: 8,
        ..MeshArrays::default()
    };
    for k in 0..=N {
        for j in 0..=N {
            for i in 0..=N {
                let inner = [i, j, k].iter().all(|n| (1..N).contains(n));
                let shift = |a: u32, b: u32| match inner {
                    true => 0.06 * f64::sin(f64::from(7 * a + 3 * b)),
                    false => 0.0,
                };
                let at = |n: u32, shift: f64| f64::from(n) / f64::from(N) + shift;
                mesh.nodes
                    .push([at(i, shift(j, k)), at(j, shift(k, i)), at(k, shift(i, j))]);
            }
        }
    }
    let mut face_sets: BTreeMap<String, Vec<(u32, u8)>> = BTreeMap::new();
    for k in 0..N {
        for j in 0..N {
            for i in 0..N {
                let element = mesh.elements.len() as u32 / 8;
                // Along r fastest, then s, then t.
                for (a, b, c) in (0..8).map(|n| (n & 1, n >> 1 & 1, n >> 2)) {
                    mesh.elements.push(number(i + a, j + b, k + c));
                }
                let sides = [
                    (i == 0, "left", 0),
                    (j == 0, "front", 2),
                    (k == 0, "below", 4),
                    (k == N - 1, "above", 5),
                ];
                for (_, name, face) in sides.into_iter().filter(|side| side.0) {
                    face_sets
                        .entry(name.into())
                        .or_default()
                        .push((element, face));
                }
            }
        }
    }
    mesh.face_sets = face_sets;
    mesh
}

/// A flat tool above the cube: biquadratic and rational, so that its parameters run unevenly over the plane.
fn tool() -> Result<NurbsPatch, Box<dyn Error>> {
    let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let mut points = Vec::new();
    for x in [-0.5, 0.7, 1.5] {
        for y in [-0.5, 0.2, 1.5] {
            points.push(Vec3::new(x, y, 1.0));
        }
    }
    let weights = [1.0, 0.6, 1.0, 0.8, 2.0, 0.8, 1.0, 1.3, 1.0];
    Ok(NurbsPatch::new(
        [2, 2],
        [knots(), knots()],
        [3, 3],
        &points,
        Some(&weights),
    )?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let down: [Value; 3] = [
        0.0.into(),
        0.0.into(),
        vec![[0.0, 0.0], [1.0, -DEPTH]].into(),
    ];
    let mut press = Contact::new("cube.above", "tool");
    // The penalty is chosen so that forces are this near to those of rigid contact.
    press.accuracy = Some(2e-4);
    let scene = SceneBuilder::new("A cube squeezed by a tool")
        .material(
            "elastic",
            MaterialChoice::StVenantKirchhoff(Elastic::new(E, NU)),
        )
        // Plain bricks have states of constant strain on any mesh.
        .body(
            "cube",
            Body::new(cube(), "elastic").element(Element::H8Displacement),
        )
        .surface("tool", Surface::from(tool()?).moved(down))
        .contact("press", press)
        .support("left", Support::symmetry("cube.left", Axis::X))
        .support("front", Support::symmetry("cube.front", Axis::Y))
        .support("below", Support::symmetry("cube.below", Axis::Z))
        .build()?;
    let mut simulation = Simulation::new(scene, Options::default())?;
    while let Some(step) = simulation.step()? {
        println!(
            "time {:.2}: force {:.4}",
            step.time,
            simulation.force("tool")?.force.z
        );
    }

    // Uniaxial stress under a St. Venant-Kirchhoff law, exactly: P = E G l with the strain G = (l^2 - 1) / 2 along the axis
    // and -NU G across it. The undeformed area is 1.
    let stretch = 1.0 - DEPTH;
    let expected = E * 0.5 * (stretch * stretch - 1.0) * stretch;
    let force = simulation.force("tool")?.force.z;
    println!("force {force:.5}, closed form {expected:.5}");
    // The same pressure on every undeformed area, however the inner nodes lie.
    let pressure = -expected;
    let nodes = &simulation.model().bodies[0].mesh.nodes;
    let found = simulation.field("cube", "contact_pressure")?;
    let mut worst = 0.0f64;
    for (node, _) in nodes.iter().enumerate().filter(|(_, x)| x.z == 1.0) {
        worst = worst.max((found.at(node, 0) / pressure - 1.0).abs());
    }
    println!("pressure {pressure:.4}, largest difference {worst:.2e}");
    match (force / expected - 1.0).abs() < 1e-3 && worst < 1e-3 {
        true => Ok(()),
        false => Err("the force or the pressure is not that of the closed form".into()),
    }
}

#[test]
fn the_check_passes() {
    main().unwrap();
}
