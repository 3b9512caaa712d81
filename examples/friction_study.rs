//! A study in memory: how hard a pressed block is dragged by a plane that slides under it, for several coefficients of friction.
//!
//! ```sh
//! cargo run --release --example friction_study
//! ```
use covact::run::{Options, Simulation};
use covact::scene::{
    Block, Body, Contact, Elastic, LoadedScene, MaterialChoice, PlaneShape, SceneBuilder,
    SceneError, Solution, Spacing, Step, Support, Surface, Value,
};
use std::error::Error;

/// A block on a plane that comes up until time 1, and then slides.
fn scene(mu: f64) -> Result<LoadedScene, SceneError> {
    let block = Block {
        min: [0.0; 3],
        max: [4.0, 2.0, 1.0],
        elements: [8, 4, 2],
        spacing: [Spacing::Uniform; 3],
    };
    let plane = PlaneShape {
        center: [2.0, 1.0, 0.0],
        normal: [0.0, 0.0, 1.0],
        size: [20.0, 20.0],
    };
    let slides = Value::from(vec![[1.0, 0.0], [2.0, 0.1]]);
    let rises = Value::from(vec![[0.0, 0.0], [1.0, 0.02]]);
    SceneBuilder::new(format!("A block dragged with friction {mu}"))
        .material(
            "elastic",
            MaterialChoice::NeoHooke(Elastic::new(100.0, 0.3)),
        )
        .body("block", Body::new(block, "elastic"))
        .surface(
            "plane",
            Surface::from(plane).moved([slides, 0.0.into(), rises]),
        )
        .contact("drag", Contact::new("block.bottom", "plane").friction(mu))
        .support("held", Support::fixed("block.top"))
        .solution(Solution {
            end_time: 2.0,
            step: Step {
                initial: 0.25,
                max: 0.25,
                ..Step::default()
            },
            ..Solution::default()
        })
        .build()
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut worst = 0.0f64;
    for mu in [0.05, 0.1, 0.2, 0.3] {
        let mut simulation = Simulation::new(scene(mu)?, Options::default())?;
        while simulation.step()?.is_some() {}
        let force = simulation.force("plane")?.force;
        let ratio = force.x / force.z;
        println!(
            "mu {mu}: drag {:.5}, pressed by {:.5}, ratio {ratio:.6}",
            force.x, force.z
        );
        worst = worst.max((ratio / mu - 1.0).abs());
    }
    // Every point slides along x but for the little that the block spreads sideways.
    match worst < 1e-4 {
        true => Ok(()),
        false => Err(format!("a ratio is off by {worst:e}").into()),
    }
}

#[test]
fn the_check_passes() {
    main().unwrap();
}
