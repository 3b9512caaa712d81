//! Projects a million points onto the surfaces of a CAD file:
//! `cargo run --release -p covact-geometry --example project_points [FILE] [POINTS]`
use covact_geometry::{PatchSet, Status, Vec3, io};
use rayon::prelude::*;
use std::{env, error::Error, path::Path, time::Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/punch.igs");
    let path = env::args().nth(1).unwrap_or_else(|| default.into());
    let n: u32 = env::args().nth(2).map_or(Ok(1_000_000), |n| n.parse())?;
    let file = io::read_path(Path::new(&path))?;
    for skipped in &file.skipped {
        println!("skipped: entity {}: {}", skipped.entity, skipped.reason);
    }
    let surface = PatchSet::new(file.patches.into_iter().map(|p| p.patch).collect(), None)?;

    // Points that fill the box around the surface evenly (Roberts' quasi-random sequence).
    let [low, high] = surface.bounds();
    let place = |k: u32| {
        let steps = Vec3::new(0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901);
        low + (high - low).component_mul(&steps.map(|s| (f64::from(k) * s).fract()))
    };
    let start = Instant::now();
    let project = |k| (k, surface.project(&place(k), None, f64::INFINITY));
    let feet: Vec<_> = (0..n).into_par_iter().map(project).collect();
    let time = start.elapsed().as_secs_f64() * 1e6 / f64::from(n);
    println!(
        "{n} points: {time:.2} us per point on {} threads",
        rayon::current_num_threads()
    );

    // The check: every point has a foot, and where it lies inside of a face the line to it is normal to the surface.
    for (k, foot) in feet {
        let foot = foot.ok_or("a point without a foot")?;
        let d = place(k) - foot.jet.rho;
        let slope = foot.jet.rho_i.map(|t| d.dot(&t) / t.norm());
        let inside =
            foot.location == covact_geometry::Location::Face && foot.status == Status::Unique;
        assert!(
            !inside || slope.iter().all(|s| s.abs() < 1e-9 * surface.size()),
            "{foot:?}"
        );
    }
    Ok(())
}
