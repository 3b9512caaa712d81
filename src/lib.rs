//! Contact between finite-element shells and CAD surfaces.
//!
//! Bodies of solid-shell elements touch rigid NURBS surfaces, each other and themselves, under large displacements, with
//! friction. Contact is measured on the surfaces as they are: NURBS patches are not replaced by facets.
//!
//! # A first run
//! A run takes a scene, goes on step by step, and is read in memory; no file is touched.
//!
//! ```
//! use covact::run::{Options, Simulation};
//! use covact::scene::{Axis, Block, Body, Contact, Elastic, MaterialChoice, SceneBuilder, SphereShape, Support, Surface};
//!
//! // A quarter of a rubber block under a ball that comes down by 0.4 until time 1.
//! let block = Block { min: [0., 0., -4.], max: [4., 4., 0.], elements: [6; 3], spacing: Default::default() };
//! let ball = SphereShape { radius: 5.0, center: [0., 0., 5.], axis: [0., 1., 0.] };
//! let scene = SceneBuilder::new("A ball on rubber")
//!     .material("rubber", MaterialChoice::NeoHooke(Elastic::new(2.0, 0.45)))
//!     .body("block", Body::new(block, "rubber"))
//!     .surface("ball", Surface::from(ball).moved(["0", "0", "-0.4*t"]))
//!     .contact("press", Contact::new("block.top", "ball"))
//!     .support("ground", Support::fixed("block.bottom"))
//!     .support("middle_x", Support::symmetry("block.x_min", Axis::X))
//!     .support("middle_y", Support::symmetry("block.y_min", Axis::Y))
//!     .build()?;
//!
//! let mut simulation = Simulation::new(scene, Options::default())?;
//! while let Some(step) = simulation.step()? {
//!     let force = simulation.force("ball")?.force;
//!     println!("time {:.2}: {} iterations, force {:.4}", step.time, step.iterations, force.z);
//!     // Stepped from outside, a run may end where its user has seen enough.
//!     if force.z < -0.5 {
//!         break;
//!     }
//! }
//!
//! // What the ball pushes down, the ground holds.
//! let [ball, ground] = [simulation.force("ball")?, simulation.force("ground")?];
//! assert!(ball.force.z < -0.5 && (ball.force.z + ground.force.z).abs() < 1e-6);
//! // Fields are those of the `.vtu` files, a value or more per node.
//! let pressure = simulation.field("block", "contact_pressure")?;
//! let nodes = &simulation.model().bodies[0].mesh.nodes;
//! let corner = nodes.iter().position(|x| x.norm() == 0.0).expect("the point under the ball");
//! assert!(pressure.at(corner, 0) > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What to look at
//! - [`scene`]: what is solved. [`scene::SceneBuilder`] puts a scene together in a program, with meshes and surfaces as
//!   values; [`scene::load`] reads one from a JSON file. Whatever is wrong is told with the path of the field.
//! - [`run`]: solving it. [`run::Simulation`] is stepped and read in memory; [`run::Sink`]s receive every accepted step,
//!   and [`run::ResultsFolder`] is the one that writes files; [`run::run`] is what the command line does.
//! - [`mesh`]: meshes of bodies: generators, readers of mesh files, sets.
//! - [`geometry`]: the crate `covact-geometry`: NURBS patches, CAD files, closest points.
//! - [`output`]: what a results folder holds, and reading it back.
//! - [`study`]: one scene over a grid of choices.
//!
//! `examples/` has programs that end in their own check: a ball pressed to a given force, a mesh and a surface given as
//! arrays, a study in memory.
//!
//! A sink is any type with a method for an accepted step:
//!
//! ```
//! use covact::run::{RunError, Simulation, Sink};
//!
//! /// Keeps the largest contact pressure of every step.
//! struct Peaks(Vec<f64>);
//!
//! impl Sink for Peaks {
//!     fn step(&mut self, run: &Simulation) -> Result<(), RunError> {
//!         let peak = run.value("pressure.max").map_err(|e| RunError::Sink(e.into()))?;
//!         self.0.push(peak);
//!         Ok(())
//!     }
//! }
//! ```
//!
//! # Inside
//! The other modules are the inside of a run, from [`contact`], the covariant core, to [`assembly`] and [`solve`]. They are
//! open to tests and benchmarks and to those who want to look; their interfaces follow the needs of the program.
//! `docs/architecture.md` shows how they stand on each other.

// Public items are documented: what is not to be seen from outside is `pub(crate)`.
#![deny(missing_docs)]

pub mod assembly;
pub mod contact;
pub mod effects;
pub mod fem;
pub mod gauntlet;
pub mod machine;
pub mod mesh;
pub mod model;
pub mod output;
pub mod page;
pub mod plan;
pub mod run;
pub mod scene;
pub mod shell;
pub mod soak;
pub mod solve;
pub mod study;
pub mod system;

#[cfg(feature = "cli")]
pub mod cli;

pub use covact_geometry as geometry;
