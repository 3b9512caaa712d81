//! Projects a million points onto the surfaces of a CAD file:
//! `cargo run --release -p covact-geometry --example project_points FILE [POINTS]`
use covact_geometry::{Location, PatchSet, Status, Vec3, io};
use std::{env, error::Error, path::Path, time::Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args().nth(1).ok_or("name a CAD file")?;
    let n: u32 = env::args().nth(2).map_or(Ok(1_000_000), |n| n.parse())?;
    let file = io::read_path(Path::new(&path))?;
    for skipped in &file.skipped {
        println!("skipped: entity {}: {}", skipped.entity, skipped.reason);
    }
    let surface = PatchSet::new(file.patches.into_iter().map(|p| p.patch).collect(), None)?;

    // Points that fill the box around the surface evenly (Roberts' quasi-random sequence).
    let [low, high] = surface.bounds();
    let steps = Vec3::new(0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901);
    let place = |k| low + (high - low).component_mul(&steps.map(|s| (f64::from(k) * s).fract()));
    let points: Vec<Vec3> = (0..n).map(place).collect();
    let mut feet = vec![None; points.len()];
    let start = Instant::now();
    surface.project_batch(&points, &[], f64::INFINITY, &mut feet)?;
    let time = start.elapsed().as_secs_f64() * 1e6 / f64::from(n);
    println!("{n} points: {time:.2} us per point");

    // The check: every point has a foot, and inside a face the line to it is normal to the surface.
    for (q, foot) in points.iter().zip(feet) {
        let foot = foot.ok_or("a point without a foot")?;
        let tangents = foot.jet.rho_i.map(|t| t.normalize());
        let slope = tangents.map(|t| t.dot(&(q - foot.jet.rho)).abs());
        let face = foot.location == Location::Face && foot.status == Status::Unique;
        assert!(!face || slope[0].max(slope[1]) < 1e-9 * surface.size());
    }
    Ok(())
}
