//! What effects that are off cost: instructions of the contact evaluation of a frictionless rigid scene, as the program
//! does it and as a kernel written for that case alone does it ([`kernel`]), counted by callgrind; then what every effect
//! costs that is on.
//!
//! `cargo bench --bench free` prints both tables and fails where the program needs more than 2 % more instructions than
//! the kernel for the evaluation of a contact point, its closest point included. It needs valgrind; `cargo bench --bench free -- --times` prints nanoseconds in place of instructions,
//! measured side by side, without a verdict.
mod callgrind;
mod effects;
mod kernel;
mod program;
mod scene;
mod table;

use callgrind::counted_by_callgrind;
use kernel::{Kernel, Turn, position};
use program::Program;
use scene::{Distance, Effects, TIME};

use covact::model::Model;
use covact::model::state::State;
use covact::model::surface::SurfaceSet;
use covact_geometry::{PatchSet, Surface};
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// What is done with the evaluations.
enum Meter {
    /// Under callgrind: once each, and a line to standard output.
    Count,
    /// The fastest of many, in nanoseconds.
    Time(Vec<(String, u64)>),
}

/// Rounds of which the fastest counts.
const ROUNDS: usize = 41;

impl Meter {
    /// Measures `run`, which changes its context; `reset` takes the change back.
    fn measure<C>(
        &mut self,
        label: &str,
        context: &mut C,
        reset: impl Fn(&mut C),
        run: impl Fn(&mut C),
    ) {
        match self {
            Meter::Count => {
                reset(context);
                println!("counted {label}");
                counted_by_callgrind(&mut || run(context));
            }
            Meter::Time(times) => {
                let mut best = u64::MAX;
                for _ in 0..ROUNDS {
                    reset(context);
                    let start = Instant::now();
                    run(context);
                    best = best.min(start.elapsed().as_nanos() as u64);
                }
                times.push((label.to_owned(), best));
            }
        }
    }
}

/// Largest difference of two vectors, relative to the largest entry.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    a.iter()
        .zip(b)
        .fold(0.0f64, |m, (x, y)| m.max((x - y).abs()))
        / largest
}

/// Both kernels and the search alone, at all distances.
fn compare<S: Surface>(master: &str, model: &Model, set: &PatchSet<S>, meter: &mut Meter) {
    let pose = model.surfaces[0].pose(TIME, &[]).expect("a motion");
    let mut program = Program::new(model);
    let mut kernel = Kernel::new(model, set, program.assembler.matrix().pattern().clone());
    for distance in Distance::ALL {
        let label = |who: &str| format!("{master}/{}/{who}", distance.name());
        program.bring(distance);
        meter.measure(
            &label("program"),
            &mut program,
            Program::reset,
            Program::evaluate,
        );
        let start = program.start.clone();
        let mut residual = vec![0.0; program.residual.len()];
        for (who, two) in [("one loop", false), ("two loops", true)] {
            let mut context = (&mut kernel, start.clone(), &mut residual, None);
            meter.measure(
                &label(who),
                &mut context,
                |(kernel, state, _, _)| {
                    kernel.matrix.clear();
                    state.copy_from(&start);
                },
                |(kernel, State { u, points, .. }, residual, sums)| {
                    *sums = Some(match two {
                        false => kernel.one_loop(&pose, u, points, residual),
                        true => kernel.two_loops(&pose, u, points, residual),
                    });
                },
            );
            let (_, state, _, sums) = context;
            let sums = sums.expect("it ran").expect("a point that it knows");
            let same = [
                difference(&program.residual, &residual),
                difference(program.assembler.contact_forces(), &kernel.contact),
                difference(program.assembler.matrix().values(), kernel.matrix.values()),
                difference(&program.numbers(), &sums.numbers()),
            ];
            assert!(same.iter().all(|d| *d < 1e-14), "{} {same:?}", label(who));
            assert!(state.points == program.state.points, "{}", label(who));
            let (active, points) = (sums.active, state.points.len());
            assert!(
                match distance {
                    Distance::Closed => active == points,
                    Distance::Open => active == 0,
                    Distance::Mixed => active > points / 4 && active < points,
                },
                "{active} of {points} closed"
            );
        }
        let turn = Turn::new(&pose);
        let depth = model.surfaces[0].depth;
        let queries: Vec<_> = (model.pairs[0].points.iter().zip(&start.points))
            .map(|(p, s)| (turn.local(&position(model, &start.u, p)), s.hint))
            .collect();
        meter.measure(
            &label("search"),
            &mut (),
            |_| {},
            |_| {
                for (x, hint) in &queries {
                    black_box(set.project(black_box(x), *hint, depth));
                }
            },
        );
    }
}

/// All that is measured.
fn measure(meter: &mut Meter) {
    for (master, ball) in scene::masters() {
        let model = scene::counted(&Effects {
            ball,
            ..Effects::default()
        });
        match &model.surfaces[0].set {
            SurfaceSet::Nurbs(set) => compare(master, &model, set, meter),
            SurfaceSet::Bilinear(set) => compare(master, &model, set, meter),
            SurfaceSet::Biquadratic(set) => compare(master, &model, set, meter),
        }
    }
    effects::measure(meter);
}

fn main() -> ExitCode {
    let asked = |what: &str| std::env::args().any(|a| a == what);
    // One thread, which does all the work itself.
    let pool = rayon_pool();
    if asked("--count") {
        pool.install(|| measure(&mut Meter::Count));
        return ExitCode::SUCCESS;
    }
    let mut meter = Meter::Time(Vec::new());
    if asked("--times") {
        pool.install(|| measure(&mut meter));
        let Meter::Time(times) = meter else {
            return ExitCode::FAILURE;
        };
        table::print(&times, "nanoseconds");
        return ExitCode::SUCCESS;
    }
    let counts = tempfile::tempdir()
        .map_err(|e| e.to_string())
        .and_then(|dir| callgrind::count(dir.path()));
    match counts {
        Ok(counts) => table::print(&counts, "instructions"),
        Err(error) => {
            eprintln!("{error}\n(`-- --times` compares times instead)");
            ExitCode::FAILURE
        }
    }
}

fn rayon_pool() -> rayon::ThreadPool {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread")
}
