//! A ball pressed on a clamped plate until it pushes back with a given force: no file is read or written.
//!
//! ```sh
//! cargo run --release --example ball_on_plate
//! ```
use covact::run::{Options, Simulation};
use covact::scene::{
    Axis, Body, Contact, Elastic, MaterialChoice, Plate, SceneBuilder, Solution, Spacing,
    SphereShape, Step, Support, Surface,
};
use std::error::Error;

/// Edge length and thickness of the plate, Young's modulus and Poisson's ratio.
const A: f64 = 100.0;
const H: f64 = 2.0;
const E: f64 = 12000.0;
const NU: f64 = 0.3;
/// The run ends once the ball exerts this force.
const FORCE: f64 = 20.0;

fn main() -> Result<(), Box<dyn Error>> {
    // A quarter of the plate; its sets are named after its sides.
    let plate = Plate {
        size: [A / 2.0; 2],
        thickness: H,
        elements: [20, 20],
        layers: 1,
        origin: [0.0; 3],
        spacing: [Spacing::Uniform; 2],
    };
    let ball = SphereShape {
        radius: 25.0,
        center: [0.0, 0.0, 25.0 + 0.5 * H],
        axis: [0.0, 1.0, 0.0],
    };
    let scene = SceneBuilder::new("Clamped plate under a ball")
        .material(
            "elastic",
            MaterialChoice::StVenantKirchhoff(Elastic::new(E, NU)),
        )
        .body("plate", Body::new(plate, "elastic"))
        .surface("ball", Surface::from(ball).moved(["0", "0", "-t"]))
        .contact("press", Contact::new("plate.top", "ball"))
        .support("clamped", Support::fixed(["plate.x_max", "plate.y_max"]))
        .support("middle_x", Support::symmetry("plate.x_min", Axis::X))
        .support("middle_y", Support::symmetry("plate.y_min", Axis::Y))
        .solution(Solution {
            step: Step {
                initial: 0.02,
                max: 0.02,
                ..Step::default()
            },
            ..Solution::default()
        })
        .build()?;

    let mut simulation = Simulation::new(scene, Options::default())?;
    let mut force = 0.0;
    while let Some(step) = simulation.step()? {
        // Four quarters.
        force = -4.0 * simulation.force("ball")?.force.z;
        println!(
            "time {:.2}: {} iterations, force {force:.3}",
            step.time, step.iterations
        );
        if force >= FORCE {
            break;
        }
    }

    // The middle of the plate, where both planes of symmetry meet.
    let nodes = &simulation.model().bodies[0].mesh.nodes;
    let middle = (nodes.iter())
        .position(|x| x.x == 0.0 && x.y == 0.0)
        .ok_or("no middle")?;
    let deflection = -simulation.displacements("plate")?[middle].z;
    let pressure = simulation.field("plate", "contact_pressure")?;
    let highest = pressure.data.iter().copied().fold(0.0, f64::max);
    println!("deflection {deflection:.4}, highest contact pressure {highest:.2}");

    // S. Timoshenko and S. Woinowsky-Krieger, Theory of Plates and Shells: a clamped square plate under a central force.
    let stiffness = E * H.powi(3) / (12.0 * (1.0 - NU * NU));
    let expected = 0.0056 * force * A * A / stiffness;
    let error = deflection / expected - 1.0;
    println!(
        "thin plate: {expected:.4}, difference {:.1} %",
        100.0 * error
    );
    match force >= FORCE && error.abs() < 0.04 && highest > 0.0 {
        true => Ok(()),
        false => Err("the deflection is not that of a thin plate".into()),
    }
}

#[test]
fn the_check_passes() {
    main().unwrap();
}
